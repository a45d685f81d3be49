//! The one table of methods.

use core::fmt;

macro_rules! named {
    ($(#[$doc:meta])* $type:ident { $($variant:ident $name:literal $means:literal;)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[doc(hidden)]
        pub enum $type { $(#[doc = $means] $variant,)* }

        impl fmt::Display for $type {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.pad(match self { $(Self::$variant => $name),* })
            }
        }
    };
}

named! {
    /// What is integrated.
    Equations {
        Hamilton "Hamilton" "Hamilton's equations in angles and momenta: [`Pendulum::derivatives`](crate::Pendulum::derivatives).";
        Directions "directions" "Hamilton's equations in rod directions and momenta: no sines.";
        Textbook "textbook" "Hamilton's equations as `[math24]` prints them, nothing simplified: for comparison.";
        Linear "linear" "The linear equations of small oscillations: [`SmallOscillations`](crate::SmallOscillations).";
    }
}

named! {
    /// What is computed in.
    Numbers {
        F32 "f32" "Single precision.";
        CompensatedF32 "compensated f32" "Single precision; the rounding error of each sum is carried into the next.";
        F64 "f64" "Double precision.";
        CompensatedF64 "compensated f64" "Double precision, likewise.";
        Fixed32 "fixed32" "Fixed point in 32 bits.";
        Fixed64 "fixed64" "Fixed point in 64 bits.";
    }
}

named! {
    /// How a step is made.
    Integrator {
        Rk4 "RK4" "The classical Runge-Kutta method.";
        Extrapolation "extrapolation" "W. B. Gragg's extrapolation, of any even order.";
        ClosedForm "closed form" "The solution at any time at once, without steps.";
    }
}

macro_rules! drawn {
    ($method:ident drawn) => {
        Method::$method
    };
}

macro_rules! methods {
    ($($(#[cfg($when:meta)])? $method:ident $name:literal $equations:ident $numbers:ident $integrator:ident $order:literal $($drawn:ident)?;)*) => {
        /// Every way to compute a motion: equations, numbers, integrator and its order, and whether scenes are drawn by it.
        ///
        /// | name | equations | numbers | integrator | order | |
        /// |---|---|---|---|---|---|
        $(#[cfg_attr(all($($when)?), doc = concat!(
            "| `", $name, "` | ", stringify!($equations), " | ", stringify!($numbers), " | ", stringify!($integrator), " | ", $order, " | ", $(stringify!($drawn),)? " |"
        ))])*
        ///
        /// To add one: a row here, and its type in the firmware's `job::table`.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub enum Method { $($(#[cfg($when)])? #[doc = concat!("`", $name, "`")] $method,)* }

        const ALL: &[Method] = &[$($(#[cfg($when)])? Method::$method,)*];
        const DRAWN: &[Method] = &[$($(drawn!($method $drawn),)?)*];

        impl Method {
            const fn row(self) -> (&'static str, Equations, Numbers, Integrator, u32) {
                match self {
                    $($(#[cfg($when)])? Method::$method => {
                        ($name, Equations::$equations, Numbers::$numbers, Integrator::$integrator, $order)
                    })*
                }
            }
        }
    };
}

#[rustfmt::skip]
methods! {
    Rk4F64                "rk4-f64"                 Hamilton   F64            Rk4           4;
    Rk4F32                "rk4-f32"                 Hamilton   F32            Rk4           4;
    Rk4F32Direction       "rk4-f32-direction"       Directions CompensatedF32 Rk4           4 drawn;
    Rk4F32DirectionPlain  "rk4-f32-direction-plain" Directions F32            Rk4           4 drawn;
    Rk4Fixed32            "rk4-fixed32"             Directions Fixed32        Rk4           4 drawn;
    Extrapolation8Fixed64  "extrapolation8-fixed64"  Directions Fixed64        Extrapolation 8;
    Extrapolation10Fixed64 "extrapolation10-fixed64" Directions Fixed64        Extrapolation 10 drawn;
    Extrapolation12Fixed64 "extrapolation12-fixed64" Directions Fixed64        Extrapolation 12;
    Extrapolation16Fixed64 "extrapolation16-fixed64" Directions Fixed64        Extrapolation 16;
    Extrapolation12F64    "extrapolation12-f64"     Directions CompensatedF64 Extrapolation 12;
    Extrapolation16F64    "extrapolation16-f64"     Directions CompensatedF64 Extrapolation 16;
    ClosedFormF64         "closed-form-f64"         Linear     F64            ClosedForm    0;
    ClosedFormF32         "closed-form-f32"         Linear     F32            ClosedForm    0 drawn;
    Rk4F32Micromath       "rk4-f32-micromath"       Hamilton   F32            Rk4           4;
    TextbookF32           "textbook-f32"            Textbook   F32            Rk4           4;
    #[cfg(test)] Rk4F64Lagrange "rk4-f64-lagrange"  Hamilton   F64            Rk4           4;
}

impl Method {
    /// Every method.
    pub const ALL: &[Method] = ALL;

    /// What a [plan](crate::plan) chooses from.
    pub const DRAWN: &[Method] = DRAWN;

    /// Its name: integrator, numbers, equations.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.row().0
    }

    /// The method of this name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL
            .iter()
            .copied()
            .find(|method| method.name() == name)
    }
}

#[doc(hidden)]
impl Method {
    #[must_use]
    pub const fn equations(self) -> Equations {
        self.row().1
    }

    #[must_use]
    pub const fn numbers(self) -> Numbers {
        self.row().2
    }

    #[must_use]
    pub const fn integrator(self) -> Integrator {
        self.row().3
    }

    /// The order of its steps; 0 for the closed form.
    #[must_use]
    pub const fn order(self) -> u32 {
        self.row().4
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
