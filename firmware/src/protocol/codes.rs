//! Codes on the wire of what has its names elsewhere.

use double_pendulum::Method;
use double_pendulum::plan::Limit;

use super::choice::choice;

choice! {
    BoardName {
        /// Stellaris' evaluation board.
        Lm3s6965evb = 0, "lm3s6965evb";
        /// ARM's MPS2 with image AN386.
        Mps2An386 = 1, "mps2-an386";
        /// Any board with an STM32F405 or F407.
        Stm32f405 = 2, "stm32f405";
        /// Raspberry Pi's Pico.
        Pico = 3, "pico";
    }
}

/// The code of no method: none that can be afforded meets the tolerance.
pub const NO_METHOD: u8 = u8::MAX;

/// A method's code: its place in the table.
pub const fn method_code(method: Method) -> u8 {
    method as u8
}

pub fn method_of(code: u8) -> Option<Method> {
    Method::ALL.get(usize::from(code)).copied()
}

/// The code of what ends a horizon, likewise.
pub const fn limit_code(limit: Limit) -> u8 {
    limit as u8
}
