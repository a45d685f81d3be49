//! A motion by `DirectionF32`, with a count of whole turns.
#![no_std]
#![no_main]

use double_pendulum::{DirectionF32, Run};

#[cortex_m_rt::entry]
fn main() -> ! {
    minimal::swing(
        minimal::start::<DirectionF32>().map(Run::counting_turns),
        minimal::STEPS_IN_F32,
        minimal::draw,
    )
}
