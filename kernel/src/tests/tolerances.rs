use double_pendulum::Real;

#[derive(Clone, Copy, Debug)]
pub struct PerPrecision {
    pub single: f64,
    pub double: f64,
}

impl PerPrecision {
    pub fn of<R: Real>(&self) -> f64 {
        if R::EPSILON.to_f64() > f64::EPSILON {
            self.single
        } else {
            self.double
        }
    }
}

/// Relative to the largest term. There are about twenty rounding errors. In the rates of the
/// momenta the errors of the velocities are multiplied by the momenta, if the bobs are unlike.
pub const DERIVATIVES: PerPrecision = PerPrecision {
    single: 2e-6,
    double: 1e-13,
};

/// Numbers that two formulas give for the same input, relative to the sum of the magnitudes of the
/// terms. There are about thirty rounding errors. The kinetic energy is divided by den, which is
/// small for a light bob 1.
pub const FORMULAS: PerPrecision = PerPrecision {
    single: 4e-6,
    double: 8e-15,
};

/// The distance from the start of a motion run forth and back: rad, and momenta relative to their
/// bounds. It covers the truncation errors of both ways (measured: 6e-12).
pub const RETURN: f64 = 1e-10;

/// Per radian of amplitude. It covers half an epsilon of the phase, and some rounding errors of
/// amplitudes and sines (measured: 3e-7).
pub const CLOSED_FORM: f64 = 5.0 * f32::EPSILON as f64;
