//! A motion by `DirectionF32Plain`.
#![no_std]
#![no_main]

use double_pendulum::DirectionF32Plain;

#[cortex_m_rt::entry]
fn main() -> ! {
    minimal::swing(
        minimal::start::<DirectionF32Plain>(),
        minimal::STEPS_IN_F32,
        minimal::draw,
    )
}
