//! The one table of methods.

use core::fmt;

/// What is integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Equations {
    /// Hamilton's equations of (a1, a2, p1, p2), SI units: [`Pendulum::derivatives`](crate::Pendulum::derivatives).
    Hamilton,
    /// The same for rods of one length, without dimensions: [`EqualRods`](crate::EqualRods).
    EqualRods,
    /// Hamilton's equations of rod directions and momenta, without sines: [`methods`](crate::methods).
    Directions,
    /// Hamilton's equations as `[math24]` prints them, nothing simplified: for comparison.
    Textbook,
    /// Small oscillations: [`SmallOscillations`](crate::SmallOscillations).
    Linear,
}

/// What is computed in. Compensated sums carry the rounding error of each addition into the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Numbers {
    /// Single precision.
    F32,
    /// Single precision, compensated sums.
    CompensatedF32,
    /// Double precision.
    F64,
    /// Double precision, compensated sums.
    CompensatedF64,
    /// Fixed point of 32 bits.
    Fixed32,
    /// Fixed point of 64 bits.
    Fixed64,
}

/// How a step is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integrator {
    /// The classical Runge-Kutta method.
    Rk4,
    /// Gragg's [`Extrapolation`](crate::methods::extrapolation::Extrapolation).
    Extrapolation,
    /// No steps at all: any time at once.
    ClosedForm,
}

macro_rules! names {
    ($type:ident: $($variant:ident $name:literal),*) => {
        impl fmt::Display for $type {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.pad(match self { $(Self::$variant => $name),* })
            }
        }
    };
}

names!(Equations: Hamilton "Hamilton", EqualRods "equal rods", Directions "directions", Textbook "textbook", Linear "linear");
names!(Numbers: F32 "f32", CompensatedF32 "compensated f32", F64 "f64", CompensatedF64 "compensated f64", Fixed32 "fixed32", Fixed64 "fixed64");
names!(Integrator: Rk4 "RK4", Extrapolation "extrapolation", ClosedForm "closed form");

macro_rules! methods {
    ($($method:ident $name:literal $equations:ident $numbers:ident $integrator:ident $order:literal;)*) => {
        /// Every way to compute a motion: equations, numbers, integrator and its order.
        ///
        /// | name | equations | numbers | integrator | order |
        /// |---|---|---|---|---|
        $(#[doc = concat!("| `", $name, "` | ", stringify!($equations), " | ", stringify!($numbers), " | ", stringify!($integrator), " | ", $order, " |")])*
        ///
        /// To add one: a row here, and its type in the firmware's `job::table`.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub enum Method { $(#[doc = concat!("`", $name, "`")] $method,)* }

        impl Method {
            /// Every method.
            pub const ALL: &[Method] = &[$(Method::$method,)*];

            /// Its name: integrator, numbers, equations.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Method::$method => $name,)* }
            }

            /// What it integrates.
            #[must_use]
            pub const fn equations(self) -> Equations {
                match self { $(Method::$method => Equations::$equations,)* }
            }

            /// What it computes in.
            #[must_use]
            pub const fn numbers(self) -> Numbers {
                match self { $(Method::$method => Numbers::$numbers,)* }
            }

            /// How it makes a step.
            #[must_use]
            pub const fn integrator(self) -> Integrator {
                match self { $(Method::$method => Integrator::$integrator,)* }
            }

            /// The order of its steps; 0 for the closed form.
            #[must_use]
            pub const fn order(self) -> u32 {
                match self { $(Method::$method => $order,)* }
            }
        }
    };
}

#[rustfmt::skip]
methods! {
    Rk4F64                "rk4-f64"                 Hamilton   F64            Rk4           4;
    Rk4F32                "rk4-f32"                 Hamilton   F32            Rk4           4;
    Rk4F64EqualRods       "rk4-f64-equal-rods"      EqualRods  F64            Rk4           4;
    Rk4F64Direction       "rk4-f64-direction"       Directions F64            Rk4           4;
    Rk4F32Direction       "rk4-f32-direction"       Directions CompensatedF32 Rk4           4;
    Rk4F32DirectionPlain  "rk4-f32-direction-plain" Directions F32            Rk4           4;
    Rk4Fixed32            "rk4-fixed32"             Directions Fixed32        Rk4           4;
    Extrapolation8Fixed64  "extrapolation8-fixed64"  Directions Fixed64        Extrapolation 8;
    Extrapolation10Fixed64 "extrapolation10-fixed64" Directions Fixed64        Extrapolation 10;
    Extrapolation12Fixed64 "extrapolation12-fixed64" Directions Fixed64        Extrapolation 12;
    Extrapolation16Fixed64 "extrapolation16-fixed64" Directions Fixed64        Extrapolation 16;
    Extrapolation8F64     "extrapolation8-f64"      Directions CompensatedF64 Extrapolation 8;
    Extrapolation12F64    "extrapolation12-f64"     Directions CompensatedF64 Extrapolation 12;
    Extrapolation16F64    "extrapolation16-f64"     Directions CompensatedF64 Extrapolation 16;
    ClosedFormF64         "closed-form-f64"         Linear     F64            ClosedForm    0;
    ClosedFormF32         "closed-form-f32"         Linear     F32            ClosedForm    0;
    Rk4F32Libm            "rk4-f32-libm"            Hamilton   F32            Rk4           4;
    Rk4F32Micromath       "rk4-f32-micromath"       Hamilton   F32            Rk4           4;
    TextbookF32           "textbook-f32"            Textbook   F32            Rk4           4;
    TextbookF64           "textbook-f64"            Textbook   F64            Rk4           4;
}

impl Method {
    /// What a [plan](crate::plan) chooses from.
    pub const DRAWN: &[Method] = &[
        Method::ClosedFormF32,
        Method::Rk4F32DirectionPlain,
        Method::Rk4F32Direction,
        Method::Rk4Fixed32,
        Method::Extrapolation10Fixed64,
    ];

    /// The method of this name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|method| method.name() == name)
    }

    /// Whether its numbers are those of an `f32`.
    #[must_use]
    pub const fn is_single(self) -> bool {
        matches!(self.numbers(), Numbers::F32 | Numbers::CompensatedF32)
    }

    /// Whether its numbers are integers.
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
