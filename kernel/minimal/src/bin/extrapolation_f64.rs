//! A motion by `ExtrapolationF64<12>`.
#![no_std]
#![no_main]

use double_pendulum::ExtrapolationF64;

#[cortex_m_rt::entry]
fn main() -> ! {
    minimal::swing(minimal::start::<ExtrapolationF64<12>>(), 1, minimal::draw)
}
