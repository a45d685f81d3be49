//! The double-pendulum application for Cortex-M microcontrollers.
//!
//! All modules except `board` are portable: they are built and tested on the host as well as on the
//! chips. A module of this table imports only from the modules below it. Without the feature
//! `application` there are only [`job`] and [`config`].
//!
//! | module | contents |
//! |---|---|
//! | `board` | the chips: registers, clocks, interrupts, all `unsafe` code; one module per board |
//! | [`app`] | executes commands, advances the scene, draws and sends it; warm restart |
//! | [`protocol`] | the messages on the serial link, both ways, with framing and checksum |
//! | [`scenes`] | the trait of all scenes, and the catalogue of scenes |
//! | [`job`] | motions that are computed on request, by any method |
//! | [`motion`] | settings, the motion in progress, the planner, the accuracy horizon |
//! | [`display`] | panel drivers, generic over `embedded-hal` |
//! | [`graphics`] | panels and their formats, canvas in two layers, brush, plots, text, colours |
//! | [`fault`] | the text of a crash report |
//! | [`config`] | all tunable numbers |
//!
//! Commands come from the buttons and from the serial link. The player executes them. Every tick
//! advances the scene; then the scene is drawn on the canvas, and the frame is sent to the panel
//! and over the link.
//!
//! # Where to look
//!
//! | where | file, in this folder or in `kernel/`, the crate [`double_pendulum`] |
//! |---|---|
//! | one step of RK4 | `kernel/src/methods/rk4_fixed32.rs`; with an FPU `rk4_direction.rs` |
//! | one step of the page, which RK4 does not draw | `kernel/src/methods/extrapolation_fixed64.rs` |
//! | the choice of method and steps | `kernel/src/plan/mod.rs`; its time: `motion/planner.rs` |
//! | the horizon, and its words on the panel | `kernel/src/plan/mod.rs`, `motion/horizon.rs` |
//! | a HardFault, also on a Pico | `board/cortex_m/crash.rs`, then `board/main_loop.rs` |
//! | how to add a panel controller, a board | the top of `display/mod.rs`, `board/mod.rs` |
//! | how to add a scene, a method | the top of `scenes/mod.rs`, `kernel/src/table.rs` |
//!
//! The functions, in the order of their calls:
//!
//! - **The step of a motion on the panel.** `Simulation::tick` (`motion/simulation.rs`),
//!   `PlannedRun::advance` (`kernel/src/plan/run.rs`), `DrawnMotion::advance`
//!   (`kernel/src/methods/any.rs`), and the step itself in the file of the method in
//!   `kernel/src/methods/`. `cargo plan --scene page --board lm3s6965evb` prints which one that is:
//!   - `extrapolation_fixed64.rs` (`Fixed64State::step`), with the equations in its `rows.rs`:
//!     64-bit fixed point, multiples of 2^-64 (`Q64`). It draws the page, on every board.
//!   - `rk4_fixed32.rs` (`Fixed32::step`): RK4 in 32-bit fixed point, multiples of 2^-30 (`Q30`).
//!     It draws regular motions on a chip without floating point, and the page with `cargo demo
//!     --method rk4-fixed32`.
//!   - `rk4_direction.rs` (`Rk4Direction::step`): RK4 in `f32`, for chips with a floating-point
//!     unit.
//! - **Its method and step count.** Before there is a plan: `Simulation::new`, with
//!   `Stepping::initial` (`kernel/src/plan/steps.rs`). Then `Planner::tick` (`motion/planner.rs`)
//!   advances a `Search` (`kernel/src/plan/search.rs`): a race of candidates against a reference
//!   (`race.rs`), from which `best` (`candidate.rs`) chooses. `Player::follow` (`app/player.rs`)
//!   adopts the plan when its motion has caught up (`CatchingUp`, `motion/simulation.rs`). The
//!   prices are in `kernel/src/plan/prices.rs`, the budgets in [`config`] (`Processor`).
//! - **The horizon.** `Race::compare` (`kernel/src/plan/race.rs`) compares the candidates with the
//!   reference, whose error is from `uncertainty.rs`. `Planner::horizon` reads the result,
//!   `Player::now` puts it into the report, and `draw_clock` (`scenes/mod.rs`) on the panel.
//! - **A button.** `Buttons::read` of the board (its `mod.rs`) reads the pins in `App::tick`
//!   (`app/mod.rs`). `Controls::tick` (`app/controls.rs`) debounces them and returns a
//!   [`protocol::Command`], such as `Heavier`. `Player::execute` (`app/player.rs`) calls
//!   `Settings::heavier` (`motion/settings.rs`), the next of `MASS_RATIOS`, and starts the scene
//!   again: `Player::play_by`, `AnyScene::start`, `Simulation::new`.
//! - **A frame on the link.** The table of bytes and the recipe for another field are at
//!   [`protocol::Frame`] (`protocol/to_host.rs`). `Player::frame` and `App::show` fill it, and
//!   `encode` (`protocol/mod.rs`) writes it.
//! - **A fault.** `hard_fault` and `crash` (`board/cortex_m/crash.rs`) store the cause in memory that
//!   a reset keeps (`board/cortex_m/retained.rs`); write a report where a debugger may read it, not
//!   on a Pico; and reset. Then `resume` (`board/main_loop.rs`) starts the same scene again, or
//!   after more than `MOST_RESTARTS` (`app/warm_restart.rs`) the first one, and logs the cause. The
//!   host asks for it and prints it (`describe_restart`, `host-tests/boards/src/link/mod.rs`).
//! - **The bytes for a panel.** `display/oled_i2c.rs`, with a row for each controller,
//!   `display/st7789.rs` or `display/ssd0323.rs`.
//! - **Another term of the equations, such as friction.** No scene has one. "Out of scope" in
//!   `kernel/README.md` says what it takes.
//!
//! # Glossary
//!
//! Terms of physics, numerics and plans are in the glossary of the kernel ([`double_pendulum`]).
//!
//! - **tick**: 1/60 s of the board's clock. At full speed the scene advances by one tick, too.
//! - **late**: behind the clock by more than one tick. No tick is left out, but its frame is.
//! - **scene**: a figure that moves, such as one pendulum or a plot ([`scenes::Scene`]).
//! - **page**: the article `[math24]` of the kernel, the source of the figures.
//! - **report**: the numbers of a scene at one tick ([`scenes::Report`]).
//! - **processor class**: processors with one price list and one set of budgets
//!   ([`config::Processor`]).
//! - **look-ahead**: the cycles for planning in each tick, which may be spent early.
//! - **unit**: the size of a text pixel: 1 pixel of an OLED, 2 of a larger panel
//!   ([`graphics::Format`]).
//! - **grey, brightness**: of a pixel, 0 (black) to 15; of a brush, 0 (black) to 255 (grey 15).
//! - **ink, foreground**: the layer of the traces of earlier frames, which may fade; the layer over
//!   it, drawn anew in each frame.
//! - **job**: a motion that is computed for the host ([`job::Job`]).
//! - **warm restart**: a reset that the board makes on its own; the same scene starts again, from a
//!   record that memory keeps ([`app::Record`]).
#![cfg_attr(not(test), no_std)]
#![deny(unsafe_code)]

/// Defines an enum of named choices. Each row gives a variant and its name for people. The first
/// variant is the default. The call also contains the documentation of the enum and of its
/// variants.
#[cfg(feature = "application")]
macro_rules! choice {
    ($(#[$doc:meta])* $name:ident { $($(#[$row_doc:meta])* $row:ident = $text:literal;)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
        #[cfg_attr(target_os = "none", derive(defmt::Format))]
        pub enum $name { $($(#[$row_doc])* #[doc = concat!("`", $text, "`")] $row,)* }

        impl $name {
            /// The list of all variants of this enum of named choices, in the order of their
            /// declaration. It is never empty, and its first variant is the default.
            pub const ALL: &[$name] = &[$($name::$row,)*];

            /// Returns the name of this choice for people, as in the documentation of the variant:
            /// a few words such as `"ssd1306"` or `"step size"`.
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

// The image `cores` needs only the jobs.
#[cfg(feature = "application")]
pub mod app;
#[cfg(all(target_arch = "arm", target_os = "none", feature = "application"))]
#[allow(unsafe_code, reason = "here the hardware is reached")]
pub mod board;
pub mod config;
#[cfg(feature = "application")]
pub mod display;
#[cfg(feature = "application")]
pub mod fault;
#[cfg(feature = "application")]
pub mod graphics;
pub mod job;
#[cfg(feature = "application")]
pub mod motion;
#[cfg(feature = "application")]
pub mod protocol;
#[cfg(feature = "application")]
pub mod scenes;
