//! A motion by `HamiltonF32`.
#![no_std]
#![no_main]

use double_pendulum::HamiltonF32;

#[cortex_m_rt::entry]
fn main() -> ! {
    minimal::swing(minimal::start::<HamiltonF32>(), 8, minimal::draw)
}
