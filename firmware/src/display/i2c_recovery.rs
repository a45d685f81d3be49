//! A panel that holds the data line of its I2C bus low is freed.
//!
//! A board that is reset in the middle of a byte, or a panel plugged in while the bus runs, leaves the panel in the middle of
//! an answer: it holds the line for a bit that is never fetched, and no start can be made.
//!
//! Source: NXP UM10204, I2C-bus specification, 3.1.16 (bus clear).

/// The two lines of a bus, high unless somebody pulls them low.
pub trait Lines {
    /// Pulls the clock low or lets it go.
    fn set_clock(&mut self, high: bool);

    fn set_data(&mut self, high: bool);

    fn is_data_high(&mut self) -> bool;

    /// Lets half a clock pass.
    fn wait(&mut self);
}

/// The most clocks that a panel can be waiting for: the eight bits of a byte and its acknowledgement.
const MOST_CLOCKS: u32 = 9;

/// Clocks the bus until the data line is high, at most nine times, then makes a stop. A bus whose data line is high already is
/// left alone. Whether the line is high in the end: if not, the panel is defective, or the line is short of a resistor.
///
/// Both lines have been let go before.
pub fn free_bus(lines: &mut impl Lines) -> bool {
    if lines.is_data_high() {
        return true;
    }
    for _ in 0..MOST_CLOCKS {
        lines.set_clock(false);
        lines.wait();
        lines.set_clock(true);
        lines.wait();
        if lines.is_data_high() {
            break;
        }
    }
    // A stop: the data line rises while the clock is high.
    lines.set_clock(false);
    lines.set_data(false);
    lines.wait();
    lines.set_clock(true);
    lines.wait();
    lines.set_data(true);
    lines.wait();
    lines.is_data_high()
}
