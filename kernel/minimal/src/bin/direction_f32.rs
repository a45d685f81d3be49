//! A motion by `DirectionF32`.
#![no_std]
#![no_main]

use double_pendulum::DirectionF32;

#[cortex_m_rt::entry]
fn main() -> ! {
    minimal::swing(
        minimal::start::<DirectionF32>(),
        minimal::STEPS_IN_F32,
        minimal::draw,
    )
}
