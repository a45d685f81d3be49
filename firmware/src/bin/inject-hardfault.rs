//! Executes an undefined instruction on purpose, for the test of the report.
#![no_std]
#![no_main]

use firmware as _;

#[cortex_m_rt::entry]
fn main() -> ! {
    defmt::info!("boot: about to execute an undefined instruction");
    cortex_m::asm::udf()
}
