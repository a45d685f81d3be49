//! The table of methods: one row of plain data per method.
//!
//! To add a method, add a variant to [`Method`], its row and its place in [`Method::ALL`]. The
//! compiler then reports the missing type that computes it.

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
    /// Single precision. The rounding error of each sum is carried into the next.
    CompensatedF32,
    /// Double precision.
    F64,
    /// Double precision. The rounding error of each sum is carried into the next.
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

/// The ways to compute a motion. Displays as the name. [`Method::visit`] calls generic code with
/// the type that computes each.
///
/// | name | equations | numbers | integrator | order | scenes are drawn by it |
/// |---|---|---|---|---|---|
/// | `rk4-f64` | Hamilton | F64 | Rk4 | 4 |  |
/// | `rk4-f32` | Hamilton | F32 | Rk4 | 4 |  |
/// | `rk4-f32-direction` | Directions | CompensatedF32 | Rk4 | 4 | yes |
/// | `rk4-f32-direction-plain` | Directions | F32 | Rk4 | 4 | yes |
/// | `rk4-fixed32` | Directions | Fixed32 | Rk4 | 4 | yes |
/// | `extrapolation8-fixed64` | Directions | Fixed64 | Extrapolation | 8 |  |
/// | `extrapolation10-fixed64` | Directions | Fixed64 | Extrapolation | 10 | yes |
/// | `extrapolation12-fixed64` | Directions | Fixed64 | Extrapolation | 12 |  |
/// | `extrapolation16-fixed64` | Directions | Fixed64 | Extrapolation | 16 |  |
/// | `extrapolation12-f64` | Directions | CompensatedF64 | Extrapolation | 12 |  |
/// | `extrapolation16-f64` | Directions | CompensatedF64 | Extrapolation | 16 |  |
/// | `closed-form-f64` | Linear | F64 | ClosedForm | 0 |  |
/// | `closed-form-f32` | Linear | F32 | ClosedForm | 0 | yes |
/// | `rk4-f32-micromath` | Hamilton | F32 | Rk4 | 4 |  |
/// | `textbook-f32` | Textbook | F32 | Rk4 | 4 |  |
///
/// The order of the closed form, which has no steps, is 0. `rk4-f32-micromath` is `rk4-f32` with
/// the sines of the `micromath` crate.
///
/// Binary formats of `serde` store the position of the variant. A new method is therefore the last
/// one. Text formats store the name of the variant, such as `Rk4F64`, not that of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Method {
    /// `rk4-f64`
    Rk4F64,
    /// `rk4-f32`
    Rk4F32,
    /// `rk4-f32-direction`
    Rk4F32Direction,
    /// `rk4-f32-direction-plain`
    Rk4F32DirectionPlain,
    /// `rk4-fixed32`
    Rk4Fixed32,
    /// `extrapolation8-fixed64`
    Extrapolation8Fixed64,
    /// `extrapolation10-fixed64`
    Extrapolation10Fixed64,
    /// `extrapolation12-fixed64`
    Extrapolation12Fixed64,
    /// `extrapolation16-fixed64`
    Extrapolation16Fixed64,
    /// `extrapolation12-f64`
    Extrapolation12F64,
    /// `extrapolation16-f64`
    Extrapolation16F64,
    /// `closed-form-f64`
    ClosedFormF64,
    /// `closed-form-f32`
    ClosedFormF32,
    /// `rk4-f32-micromath`
    Rk4F32Micromath,
    /// `textbook-f32`
    TextbookF32,
}

/// The properties of a method: its row of the table.
struct Row {
    /// The unique name, which users type.
    name: &'static str,
    equations: Equations,
    numbers: Numbers,
    integrator: Integrator,
    /// The order of its steps; 0 for the closed form.
    order: u32,
}

impl Method {
    /// The methods of the table, in its order.
    pub const ALL: &[Method] = &[
        Method::Rk4F64,
        Method::Rk4F32,
        Method::Rk4F32Direction,
        Method::Rk4F32DirectionPlain,
        Method::Rk4Fixed32,
        Method::Extrapolation8Fixed64,
        Method::Extrapolation10Fixed64,
        Method::Extrapolation12Fixed64,
        Method::Extrapolation16Fixed64,
        Method::Extrapolation12F64,
        Method::Extrapolation16F64,
        Method::ClosedFormF64,
        Method::ClosedFormF32,
        Method::Rk4F32Micromath,
        Method::TextbookF32,
    ];

    /// Returns the row of the table.
    const fn row(self) -> Row {
        match self {
            Method::Rk4F64 => Row {
                name: "rk4-f64",
                equations: Equations::Hamilton,
                numbers: Numbers::F64,
                integrator: Integrator::Rk4,
                order: 4,
            },
            Method::Rk4F32 => Row {
                name: "rk4-f32",
                equations: Equations::Hamilton,
                numbers: Numbers::F32,
                integrator: Integrator::Rk4,
                order: 4,
            },
            Method::Rk4F32Direction => Row {
                name: "rk4-f32-direction",
                equations: Equations::Directions,
                numbers: Numbers::CompensatedF32,
                integrator: Integrator::Rk4,
                order: 4,
            },
            Method::Rk4F32DirectionPlain => Row {
                name: "rk4-f32-direction-plain",
                equations: Equations::Directions,
                numbers: Numbers::F32,
                integrator: Integrator::Rk4,
                order: 4,
            },
            Method::Rk4Fixed32 => Row {
                name: "rk4-fixed32",
                equations: Equations::Directions,
                numbers: Numbers::Fixed32,
                integrator: Integrator::Rk4,
                order: 4,
            },
            Method::Extrapolation8Fixed64 => Row {
                name: "extrapolation8-fixed64",
                equations: Equations::Directions,
                numbers: Numbers::Fixed64,
                integrator: Integrator::Extrapolation,
                order: 8,
            },
            Method::Extrapolation10Fixed64 => Row {
                name: "extrapolation10-fixed64",
                equations: Equations::Directions,
                numbers: Numbers::Fixed64,
                integrator: Integrator::Extrapolation,
                order: 10,
            },
            Method::Extrapolation12Fixed64 => Row {
                name: "extrapolation12-fixed64",
                equations: Equations::Directions,
                numbers: Numbers::Fixed64,
                integrator: Integrator::Extrapolation,
                order: 12,
            },
            Method::Extrapolation16Fixed64 => Row {
                name: "extrapolation16-fixed64",
                equations: Equations::Directions,
                numbers: Numbers::Fixed64,
                integrator: Integrator::Extrapolation,
                order: 16,
            },
            Method::Extrapolation12F64 => Row {
                name: "extrapolation12-f64",
                equations: Equations::Directions,
                numbers: Numbers::CompensatedF64,
                integrator: Integrator::Extrapolation,
                order: 12,
            },
            Method::Extrapolation16F64 => Row {
                name: "extrapolation16-f64",
                equations: Equations::Directions,
                numbers: Numbers::CompensatedF64,
                integrator: Integrator::Extrapolation,
                order: 16,
            },
            Method::ClosedFormF64 => Row {
                name: "closed-form-f64",
                equations: Equations::Linear,
                numbers: Numbers::F64,
                integrator: Integrator::ClosedForm,
                order: 0,
            },
            Method::ClosedFormF32 => Row {
                name: "closed-form-f32",
                equations: Equations::Linear,
                numbers: Numbers::F32,
                integrator: Integrator::ClosedForm,
                order: 0,
            },
            Method::Rk4F32Micromath => Row {
                name: "rk4-f32-micromath",
                equations: Equations::Hamilton,
                numbers: Numbers::F32,
                integrator: Integrator::Rk4,
                order: 4,
            },
            Method::TextbookF32 => Row {
                name: "textbook-f32",
                equations: Equations::Textbook,
                numbers: Numbers::F32,
                integrator: Integrator::Rk4,
                order: 4,
            },
        }
    }

    /// Returns the unique name, the first column of the table, such as `rk4-f32-direction`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.row().name
    }

    /// Returns the method of exactly this [`name`](Self::name), in lower case; `None` if there is
    /// no such method.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL
            .iter()
            .copied()
            .find(|method| method.name() == name)
    }

    /// Returns the equations that the method integrates.
    #[must_use]
    pub const fn equations(self) -> Equations {
        self.row().equations
    }

    /// Returns the numbers that the method computes in.
    #[must_use]
    pub const fn numbers(self) -> Numbers {
        self.row().numbers
    }

    /// Returns the integrator that computes the steps.
    #[must_use]
    pub const fn integrator(self) -> Integrator {
        self.row().integrator
    }

    /// Returns the order of the steps; 0 for the closed form.
    #[must_use]
    pub const fn order(self) -> u32 {
        self.row().order
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

// `Method::ALL` has the order of the variants.
const _: () = {
    let mut i = 0;
    while i < Method::ALL.len() {
        let method = Method::ALL[i];
        assert!(method as usize == i, "a method is missing in Method::ALL");
        i += 1;
    }
};

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use super::*;

    /// Equations, numbers and integrators are displayed as their documentation says.
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

    /// Each name of the table must lead back to its method by `Method::from_name`.
    #[test]
    fn method_names_are_unique() {
        for method in Method::ALL {
            assert_eq!(Method::from_name(method.name()), Some(*method));
        }
    }
}
