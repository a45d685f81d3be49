//! A motion by `Fixed64<12>`.
#![no_std]
#![no_main]

use double_pendulum::Fixed64;

#[cortex_m_rt::entry]
fn main() -> ! {
    minimal::swing(minimal::start::<Fixed64<12>>(), 2, minimal::draw)
}
