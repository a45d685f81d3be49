//! Logs a line and panics on purpose, for the test of the crash report.
#![no_std]
#![no_main]

use firmware as _;

#[cortex_m_rt::entry]
fn main() -> ! {
    defmt::info!("boot: about to panic");
    panic!("injected with the number {}", 42)
}
