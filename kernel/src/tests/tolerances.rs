//! How far a number may be off, and why just so far: what the kernel's tests share with those of the host.

use double_pendulum::Real;

/// A budget for each precision.
#[derive(Clone, Copy, Debug)]
pub struct PerPrecision {
    /// With `f32`.
    pub single: f64,
    /// With `f64`.
    pub double: f64,
}

impl PerPrecision {
    /// The budget for `R`.
    pub fn of<R: Real>(&self) -> f64 {
        if R::EPSILON.to_f64() > f64::EPSILON {
            self.single
        } else {
            self.double
        }
    }
}

/// Each derivative against the page's own form, relative to its largest term: some twenty roundings (6e-8 and 1.1e-16 each),
/// and the momenta of unlike bobs multiply those of the velocities.
pub const DERIVATIVES: PerPrecision = PerPrecision {
    single: 2e-6,
    double: 1e-13,
};

/// Energies, momenta and velocities that two formulas give for one state, relative to the sum of the terms' magnitudes:
/// some thirty roundings, the kinetic energy being divided by den.
pub const FORMULAS: PerPrecision = PerPrecision {
    single: 4e-6,
    double: 8e-15,
};

/// A motion run for a second and back: RK4's own error, twice (measured 6e-12), with a factor of ten.
pub const RETURN: f64 = 1e-10;

/// Angles of the scenes in closed form, per rad of amplitude, at any time: half an epsilon of the phase, up to pi, and some
/// roundings of amplitudes and sines (measured 3e-7).
pub const CLOSED_FORM: f64 = 5.0 * f32::EPSILON as f64;
