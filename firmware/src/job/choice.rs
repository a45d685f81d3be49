//! What a motion is computed with, in the words of the wire and of the command line.

use crate::protocol::choice::choice;

choice! {
    /// The numbers a motion is computed in, and whose sines.
    Arithmetic {
        /// Double precision.
        F64 = 0x64, "f64";
        /// Double precision whose sums carry their rounding errors along.
        F64Compensated = 0x65, "f64-compensated";
        /// Double precision with the sines of the `libm` crate.
        F64Libm = 0x66, "f64-libm";
        /// Single precision.
        F32 = 0x32, "f32";
        /// Single precision whose sums carry their rounding errors along.
        F32Compensated = 0x33, "f32-compensated";
        /// Single precision with the sines of the `libm` crate, which are computed in double precision.
        F32Libm = 0x34, "f32-libm";
        /// Single precision with the sines of the `micromath` crate.
        F32Micromath = 0x35, "f32-micromath";
        /// Fixed point of 32 bits, in units that the motion's energy chooses.
        Fixed32 = 0x20, "fixed32";
        /// Fixed point of 64 bits, likewise.
        Fixed64 = 0x40, "fixed64";
    }
}

impl Arithmetic {
    /// Whether its numbers are those of an `f32`.
    pub const fn is_single(self) -> bool {
        matches!(self, Self::F32 | Self::F32Compensated | Self::F32Libm | Self::F32Micromath)
    }

    /// Whether its numbers are whole ones of the processor.
    pub const fn is_fixed_point(self) -> bool {
        matches!(self, Self::Fixed32 | Self::Fixed64)
    }
}

choice! {
    /// The equations of motion.
    Model {
        /// Hamilton's equations for any masses and lengths.
        General = 0, "general";
        /// Hamilton's equations for rods of one length, in dimensionless form.
        EqualRods = 1, "equal-rods";
        /// Small oscillations in closed form.
        Linear = 2, "linear";
        /// Hamilton's equations as the book prints them, nothing simplified: for comparison.
        Textbook = 3, "textbook";
    }
}

choice! {
    /// The quantities that are stepped.
    Formulation {
        /// The model's own, as its book writes them down.
        Canonical = 0, "canonical";
        /// Directions and momenta: [`DirectionForm`](double_pendulum::form::DirectionForm).
        Direction = 2, "direction";
    }
}

choice! {
    /// How a step is made.
    Integrator {
        /// The classical Runge-Kutta method, of order 4.
        Rk4 = 4, "rk4";
        /// Gragg's extrapolation of any even order: [`Extrapolation`](double_pendulum::extrapolation::Extrapolation).
        Extrapolation = 2, "extrapolation";
        /// By the closed form, at any time; of no order.
        ClosedForm = 0, "closed-form";
    }
}
