//! The double-pendulum application for Cortex-M.
//!
//! All but `board` is portable: it is built and tested on the host as well as on the chip. A room imports only from
//! the rooms below it in this table; data flows from the first row to the last and back only as commands.
//!
//! | room | what is in it |
//! |---|---|
//! | `board` | the chips: registers, clocks, interrupts, all `unsafe`; one folder a board |
//! | [`app`] | the run loop: buttons and serial messages become commands, the player executes them, each tick is integrated, drawn, sent; warm restart |
//! | [`protocol`] | commands and what a board answers, framed and checked on the serial link |
//! | [`scenes`] | what a scene is, the catalogue, the accuracy horizon |
//! | [`job`] | motions computed on request: one table of arithmetics |
//! | [`motion`] | settings, the moving state, the planner |
//! | [`display`] | panel drivers, generic over `embedded-hal` |
//! | [`graphics`] | canvas, brush, fade layer, plot, text and its font, frame buffers |
//! | [`fault`] | what a crash report says |
//! | [`config`] | every number that may be tuned |
//! | [`prices`] | what steps cost on each core, as counted |
#![cfg_attr(not(test), no_std)]
#![deny(unsafe_code)]
#![allow(missing_docs, reason = "what name and type say is not said again")]

/// A closed set of named choices: a row each gives the value and its name for people. The first is the default.
macro_rules! choice {
    ($(#[$doc:meta])* $name:ident { $($(#[$row_doc:meta])* $row:ident = $text:literal;)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
        #[cfg_attr(target_os = "none", derive(defmt::Format))]
        pub enum $name { $($(#[$row_doc])* #[doc = concat!("`", $text, "`")] $row,)* }

        impl $name {
            pub const ALL: &[$name] = &[$($name::$row,)*];

            pub const fn name(self) -> &'static str {
                match self { $($name::$row => $text,)* }
            }
        }

        impl Default for $name {
            fn default() -> Self {
                const { Self::ALL[0] }
            }
        }
    };
}

pub mod app;
#[cfg(all(target_arch = "arm", target_os = "none", not(feature = "cores")))]
#[allow(unsafe_code, reason = "here the hardware is reached")]
pub mod board;
pub mod config;
pub mod display;
pub mod fault;
pub mod graphics;
pub mod job;
pub mod motion;
pub mod prices;
pub mod protocol;
pub mod scenes;
