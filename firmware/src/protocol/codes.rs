//! Codes on the wire: of boards, of what a request or a command is about and can be wrong in, and of what has its names elsewhere.

use double_pendulum::plan::Limit;
use double_pendulum::{Error, Method, Parameter};

/// A closed set of named choices: a row each gives the value, its code on the wire and its name for people.
macro_rules! choice {
    ($(#[$doc:meta])* $name:ident { $($(#[$row_doc:meta])* $row:ident = $code:literal, $text:literal;)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[cfg_attr(target_os = "none", derive(defmt::Format))]
        pub enum $name { $($(#[$row_doc])* #[doc = concat!("`", $text, "`")] $row,)* }

        impl $name {
            /// All of them, the default first.
            pub const ALL: &[$name] = &[$($name::$row,)*];

            /// Its code on the wire.
            pub const fn code(self) -> u8 {
                match self { $($name::$row => $code,)* }
            }

            /// Its name on the command line.
            pub const fn name(self) -> &'static str {
                match self { $($name::$row => $text,)* }
            }

            pub fn from_code(code: u8) -> Option<Self> {
                Self::ALL.iter().copied().find(|choice| choice.code() == code)
            }
        }
    };
}

pub(crate) use choice;

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

choice! {
    Field {
        /// The method, by its [`method_code`](super::method_code); to set the scene's, [`NO_METHOD`](super::NO_METHOD) is as
        /// the plan has it.
        Method = 0, "method";
        M1 = 2, "m1";
        M2 = 3, "m2";
        L1 = 4, "l1";
        L2 = 5, "l2";
        G = 6, "g";
        A1 = 7, "a1";
        A2 = 8, "a2";
        W1 = 9, "w1";
        W2 = 10, "w2";
        Dt = 11, "step size";
        /// Mass ratio m2/m1: sets m2.
        MassRatio = 12, "mu";
        Angle = 13, "angle";
        /// Simulated time per real time.
        Speed = 14, "speed";
        Field = 15, "field";
        Scene = 17, "scene";
        /// The message itself: of no known kind, or not with that kind's fields.
        Message = 18, "message";
        Key = 22, "key";
    }
}

impl From<Error> for Field {
    fn from(error: Error) -> Self {
        if let Error::Diverged { .. } = error {
            return Field::Dt;
        }
        match error.parameter() {
            Parameter::M1 => Field::M1,
            Parameter::M2 => Field::M2,
            Parameter::L1 => Field::L1,
            Parameter::L2 => Field::L2,
            Parameter::G => Field::G,
            Parameter::A1 => Field::A1,
            Parameter::A2 => Field::A2,
            // A momentum at the start is the velocity times masses and lengths.
            Parameter::W1 | Parameter::P1 => Field::W1,
            Parameter::W2 | Parameter::P2 => Field::W2,
            _ => Field::Dt,
        }
    }
}
