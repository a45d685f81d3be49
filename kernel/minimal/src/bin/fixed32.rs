//! A motion by `Fixed32`, drawn from integers.
#![no_std]
#![no_main]

use core::hint::black_box;

use double_pendulum::Fixed32;

#[cortex_m_rt::entry]
fn main() -> ! {
    minimal::swing(minimal::start::<Fixed32>(), 32, |run| {
        black_box(run.directions_q30());
    })
}
