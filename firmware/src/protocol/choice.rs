//! Closed sets of named choices: one row each gives the value, its code on the wire and its name for people.

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
