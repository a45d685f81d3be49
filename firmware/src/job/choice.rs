//! What a motion is computed with.

use crate::choice::choice;

choice! {
    /// The numbers a motion is computed in.
    Arithmetic {
        /// Double precision.
        F64 = 0x64, "f64";
        /// Single precision.
        F32 = 0x32, "f32";
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
