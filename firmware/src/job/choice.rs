//! What a motion is computed with.

use crate::protocol::choice::choice;

choice! {
    /// The numbers a motion is computed in.
    Arithmetic {
        /// Double precision.
        F64 = 0x64, "f64";
        /// Single precision.
        F32 = 0x32, "f32";
        /// Single precision whose sums carry their rounding errors along.
        F32Compensated = 0x33, "f32-compensated";
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
    }
}

choice! {
    /// The quantities that are stepped.
    Formulation {
        /// The model's own, as its book writes them down.
        Canonical = 0, "canonical";
        /// Angles and momenta in the units of the step: [`AngleForm`](double_pendulum::form::AngleForm).
        Angle = 1, "angle";
        /// Directions and momenta: [`DirectionForm`](double_pendulum::form::DirectionForm), its whole turns counted.
        Direction = 2, "direction";
    }
}
