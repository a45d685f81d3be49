//! A motion by `ClosedFormF32`.
#![no_std]
#![no_main]

use double_pendulum::ClosedFormF32;

#[cortex_m_rt::entry]
fn main() -> ! {
    minimal::swing(minimal::start::<ClosedFormF32>(), 8, minimal::draw)
}
