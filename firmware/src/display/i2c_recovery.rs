//! A panel that holds the data line of its I2C bus low is freed.
//!
//! A board that is reset in the middle of a byte, or a panel plugged in while the bus runs, leaves the panel in the middle of
//! an answer: it holds the line for a bit that is never fetched, and no start can be made.
//!
//! Source: NXP UM10204, I2C-bus specification, 3.1.16 (bus clear).

use core::convert::Infallible;

use embedded_hal::digital::{InputPin, OutputPin};

/// The most clocks that a panel can be waiting for: the eight bits of a byte and its acknowledgement.
const MOST_CLOCKS: u32 = 9;

/// Clocks the bus until the data line is high, at most nine times, then makes a stop. A bus whose data line is high already is
/// left alone. Whether the line is high in the end: if not, the panel is defective, or the line is short of a resistor.
///
/// Both pins are open-drain outputs that are high at first; `wait` lets half a clock pass.
pub fn free_bus(
    clock: &mut impl OutputPin<Error = Infallible>,
    data: &mut (impl InputPin<Error = Infallible> + OutputPin<Error = Infallible>),
    mut wait: impl FnMut(),
) -> bool {
    let Ok(is_free) = data.is_high();
    if is_free {
        return true;
    }
    for _ in 0..MOST_CLOCKS {
        let Ok(()) = clock.set_low();
        wait();
        let Ok(()) = clock.set_high();
        wait();
        if data.is_high() == Ok(true) {
            break;
        }
    }
    // A stop: the data line rises while the clock is high.
    let Ok(()) = clock.set_low();
    let Ok(()) = data.set_low();
    wait();
    let Ok(()) = clock.set_high();
    wait();
    let Ok(()) = data.set_high();
    wait();
    data.is_high() == Ok(true)
}
