//! The table of methods: a line for each.
//!
//! To add a method:
//!
//! 1. Its type gets a file in `methods/`, `pub use` in `methods/mod.rs` and `lib.rs`, and `use` in
//!    `methods/any.rs`. Equations alone implement `Derivatives`, and an alias of `Canonical`, such
//!    as `HamiltonF64`, steps them; any other method implements `Advance` and `FormOperations`.
//! 2. It gets the last line of the table, over which `simulate`, `count`, the report and the tests
//!    loop, and for the boards a line in `BoardMotion` (`firmware/src/job/table.rs`).
//! 3. After `cargo setup`, `BLESS=1 cargo test -p host-tests --test kernel golden::` adds its golden
//!    bits, `--test firmware link::` its number on the link, and `--test commands cli::output` its
//!    name in the outputs.
//!
//! If scenes are drawn by it:
//!
//! 1. In `methods/any.rs` it gets a line in `DrawnMotion` and, if it computes in 32 bits, one in
//!    `Motion32`.
//! 2. The compiler requires a price: a field of `Costs` and an arm of `Costs::step`
//!    (`plan/cost.rs`), a number in each list of `plan/prices.rs`, and its counting in
//!    `host-tests/commands/count/application.rs`. Any number will do until `cargo count
//!    --write-prices` replaces it.
//! 3. `cargo demo --method` and `cargo prove --method` then take it. A search without a requested
//!    method tries only the candidates of `plan/mod.rs`.
//!
//! To add an integrator of order 4:
//!
//! 1. A file of 25 lines implements `RungeKutta`, as `Rk4` in `methods/canonical.rs`, with `pub use`
//!    in `methods/mod.rs` and in `parts` (`lib.rs`). In `methods/any.rs` `Canonical<f64,
//!    Hamilton<f64>, MyIntegrator>` is then a motion; a method, as above.
//! 2. [`Integrator`] gets a variant. The compiler names the matches to extend: its name here, its
//!    longest step in `firmware/src/job/mod.rs`, its evaluations in
//!    `host-tests/commands/simulate/tolerance.rs`, and `tests/integrators.rs`, which then says what
//!    is wrong: a weight, or the limit of stability.
//!
//! The tests expect order 4 or more, and stability without friction, which no explicit integrator of
//! order 2 has. Any other integrator needs tolerances of its own there.

use core::fmt;

/// The equations that a method integrates. Displays as `Hamilton`, `directions`, `textbook` or
/// `linear`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Equations {
    /// Hamilton's equations in angles and momenta:
    /// [`Pendulum::derivatives`](crate::Pendulum::derivatives).
    Hamilton,
    /// Hamilton's equations in directions of the rods and momenta, without sines.
    Directions,
    /// Hamilton's equations as `[math24]` prints them for any rods, not simplified: for comparison.
    /// None of the misprints is in them.
    Textbook,
    /// The linear equations of small oscillations: [`SmallOscillations`](crate::SmallOscillations).
    Linear,
}

impl fmt::Display for Equations {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Equations::Hamilton => "Hamilton",
            Equations::Directions => "directions",
            Equations::Textbook => "textbook",
            Equations::Linear => "linear",
        })
    }
}

/// The numbers that a method computes in. Displays as `f32`, `compensated f32`, `f64`,
/// `compensated f64`, `fixed32` or `fixed64`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Numbers {
    /// Single precision.
    F32,
    /// Single precision with [compensated](crate#glossary) sums.
    CompensatedF32,
    /// Double precision.
    F64,
    /// Double precision with compensated sums.
    CompensatedF64,
    /// Fixed point of 32 bits. Each number of the state has 64 bits.
    Fixed32,
    /// Fixed point of 64 bits.
    Fixed64,
}

impl fmt::Display for Numbers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Numbers::F32 => "f32",
            Numbers::CompensatedF32 => "compensated f32",
            Numbers::F64 => "f64",
            Numbers::CompensatedF64 => "compensated f64",
            Numbers::Fixed32 => "fixed32",
            Numbers::Fixed64 => "fixed64",
        })
    }
}

/// The integrator that computes a step. Displays as `RK4`, `extrapolation` or `closed form`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integrator {
    /// The classical Runge-Kutta method.
    Rk4,
    /// W. B. Gragg's extrapolation, of an even order from 2 to 16.
    Extrapolation,
    /// The solution at any time, without steps.
    ClosedForm,
}

impl fmt::Display for Integrator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Integrator::Rk4 => "RK4",
            Integrator::Extrapolation => "extrapolation",
            Integrator::ClosedForm => "closed form",
        })
    }
}

/// Calls a macro with the lines of the table:
///
/// `number Variant = "name", equations, numbers, integrator, order, type;`
///
/// The type is `-` if it is not in this crate. Only `methods/any.rs` uses the types, so that this
/// module imports no method.
macro_rules! table {
    ($macro:ident) => {
        $macro! {
            0  Rk4F64 = "rk4-f64", Hamilton, F64, Rk4, 4, HamiltonF64;
            1  Rk4F32 = "rk4-f32", Hamilton, F32, Rk4, 4, HamiltonF32;
            2  Rk4F32Direction = "rk4-f32-direction", Directions, CompensatedF32, Rk4, 4, DirectionF32;
            3  Rk4F32DirectionPlain = "rk4-f32-direction-plain", Directions, F32, Rk4, 4, DirectionF32Plain;
            4  Rk4Fixed32 = "rk4-fixed32", Directions, Fixed32, Rk4, 4, Fixed32;
            5  Extrapolation8Fixed64 = "extrapolation8-fixed64", Directions, Fixed64, Extrapolation, 8, Fixed64<8>;
            6  Extrapolation10Fixed64 = "extrapolation10-fixed64", Directions, Fixed64, Extrapolation, 10, Fixed64<10>;
            7  Extrapolation12Fixed64 = "extrapolation12-fixed64", Directions, Fixed64, Extrapolation, 12, Fixed64<12>;
            8  Extrapolation16Fixed64 = "extrapolation16-fixed64", Directions, Fixed64, Extrapolation, 16, Fixed64<16>;
            9  Extrapolation12F64 = "extrapolation12-f64", Directions, CompensatedF64, Extrapolation, 12, ExtrapolationF64<12>;
            10 Extrapolation16F64 = "extrapolation16-f64", Directions, CompensatedF64, Extrapolation, 16, ExtrapolationF64<16>;
            11 ClosedFormF64 = "closed-form-f64", Linear, F64, ClosedForm, 0, ClosedFormF64;
            12 ClosedFormF32 = "closed-form-f32", Linear, F32, ClosedForm, 0, ClosedFormF32;
            13 Rk4F32Micromath = "rk4-f32-micromath", Hamilton, F32, Rk4, 4, -;
            14 TextbookF32 = "textbook-f32", Textbook, F32, Rk4, 4, -;
        }
    };
}
pub(crate) use table;

/// Writes [`Method`] with a variant for each line.
macro_rules! methods {
    ($(
        $number:literal $method:ident = $name:literal, $equations:ident, $numbers:ident,
        $integrator:ident, $order:literal, $form:tt $(<$of:literal>)?;
    )*) => {
        /// The ways to compute a motion. Displays as the name. [`Method::visit`] calls generic code
        /// with the type that computes each.
        ///
        /// | name | equations | numbers | integrator | order |
        /// |---|---|---|---|---|
        $(
            #[doc = concat!(
                "| `", $name, "` | ", stringify!($equations), " | ", stringify!($numbers), " | ",
                stringify!($integrator), " | ", $order, " |",
            )]
        )*
        ///
        /// The order of the closed form, which has no steps, is 0. `rk4-f32-micromath` is `rk4-f32`
        /// with the sines of the `micromath` crate. Scenes are drawn by those of [`Method::DRAWN`].
        /// Binary formats of `serde` store the number of the line, text formats the name of the
        /// variant.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub enum Method {
            $(
                #[doc = concat!("`", $name, "`")]
                $method,
            )*
        }

        // A method goes over the link as the number of its line.
        $(const _: () = assert!(Method::$method as u32 == $number);)*

        impl Method {
            /// The methods of the table, in its order.
            pub const ALL: &[Method] = &[$(Method::$method),*];

            /// Returns the unique name, the first column of the table, such as `rk4-f32-direction`.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Method::$method => $name,)*
                }
            }

            /// Returns the equations that the method integrates.
            #[must_use]
            pub const fn equations(self) -> Equations {
                match self {
                    $(Method::$method => Equations::$equations,)*
                }
            }

            /// Returns the numbers that the method computes in.
            #[must_use]
            pub const fn numbers(self) -> Numbers {
                match self {
                    $(Method::$method => Numbers::$numbers,)*
                }
            }

            /// Returns the integrator that computes the steps.
            #[must_use]
            pub const fn integrator(self) -> Integrator {
                match self {
                    $(Method::$method => Integrator::$integrator,)*
                }
            }

            /// Returns the order of the steps; 0 for the closed form.
            #[must_use]
            pub const fn order(self) -> u32 {
                match self {
                    $(Method::$method => $order,)*
                }
            }
        }
    };
}

table!(methods);

impl Method {
    /// Returns the method of exactly this [`name`](Self::name), in lower case.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL
            .iter()
            .copied()
            .find(|method| method.name() == name)
    }

    /// Returns true if the numbers are `f32`, compensated or not.
    #[must_use]
    pub const fn is_single(self) -> bool {
        matches!(self.numbers(), Numbers::F32 | Numbers::CompensatedF32)
    }

    /// Returns true if the numbers are fixed point, which is computed by integers.
    #[must_use]
    pub const fn is_fixed_point(self) -> bool {
        matches!(self.numbers(), Numbers::Fixed32 | Numbers::Fixed64)
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use super::*;

    #[test]
    fn properties_are_displayed_by_their_names() {
        let properties = |method: Method| {
            [
                method.equations().to_string(),
                method.numbers().to_string(),
                method.integrator().to_string(),
            ]
        };
        for (method, equations, numbers, integrator) in [
            (Method::Rk4F64, "Hamilton", "f64", "RK4"),
            (
                Method::Rk4F32Direction,
                "directions",
                "compensated f32",
                "RK4",
            ),
            (Method::Rk4Fixed32, "directions", "fixed32", "RK4"),
            (
                Method::Extrapolation10Fixed64,
                "directions",
                "fixed64",
                "extrapolation",
            ),
            (
                Method::Extrapolation12F64,
                "directions",
                "compensated f64",
                "extrapolation",
            ),
            (Method::ClosedFormF32, "linear", "f32", "closed form"),
            (Method::TextbookF32, "textbook", "f32", "RK4"),
        ] {
            assert_eq!(
                properties(method),
                [equations, numbers, integrator],
                "{method}"
            );
        }
    }

    #[test]
    fn method_names_are_unique() {
        for method in Method::ALL {
            assert_eq!(Method::from_name(method.name()), Some(*method));
        }
    }
}
