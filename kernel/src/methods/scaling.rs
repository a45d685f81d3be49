//! The units in which every quantity of a motion is small and none is needlessly so.

use crate::bounds::Bounds;
use crate::error::{Error, Parameter};
use crate::numbers::fixed::scaled;
use crate::pendulum::Parameters;

/// The most a quantity may be shifted: masses and rods of a ratio beyond some 1000 are refused.
const MOST: i32 = 12;

/// Units for a pendulum's motion of some energy: constants and momenta as the equations
/// ([`Coefficients`](crate::methods::direction::Coefficients)) have them, but
///
/// - time in a unit T such that no rate that the energy allows ([`Bounds`]) exceeds some limit, nor any torque,
/// - (S, C) over the power of two sigma that leaves nu/sigma in (1/2, 1], and u or v, whichever is smaller, as many times
///   larger as makes both alike,
/// - r in the power of two that makes it at most 1, and P1 in what leaves u = (P1 - C P2) r.
///
/// For equal rods and masses all shifts are 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scaling {
    /// T, s; negative where time runs backwards.
    pub time: f64,
    /// P1 and P2 to a kg m^2/s.
    pub momenta: [f64; 2],
    /// nu/sigma.
    pub norm: f64,
    /// m.
    pub inertia: f64,
    /// G1 and G2.
    pub gravity: [f64; 2],
    /// What the quantities' units differ by.
    pub shifts: Shifts,
}

/// What the quantities' units differ by, as powers of two.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Shifts {
    /// C P2 is so many times less as a part of P1.
    pub momentum: u32,
    /// r is so many times more than its number.
    pub inverse: u32,
    /// u is so many times less as a rate of a1, ...
    pub upper: u32,
    /// ... and v of a2.
    pub lower: u32,
}

/// What [`Form::check`](super::Form::check) says of a motion in fixed point.
pub(super) fn lost(is_lost: bool) -> Result<(), Error> {
    if is_lost {
        Err(Error::Diverged {
            parameter: Parameter::A1,
            value: f64::NAN,
        })
    } else {
        Ok(())
    }
}

impl Scaling {
    /// The same in another unit of time, `time` of this one's.
    #[must_use]
    pub fn in_unit(self, time: f64) -> Self {
        Self {
            time: self.time * time,
            momenta: self.momenta.map(|momentum| momentum * time),
            gravity: self.gravity.map(|gravity| gravity * time * time),
            ..self
        }
    }

    /// With T = 1 s.
    #[inline(never)]
    pub fn in_seconds(parameters: &Parameters<f64>) -> Result<Self, Error> {
        let &Parameters { m1, m2, l1, l2, g } = parameters;
        let nu = l1 / l2;
        // one more than there may be is enough to refuse it
        let places = |places: f64| (places as i32).clamp(-MOST - 1, MOST + 1);
        let sigma = places(libm::ceil(libm::log2(nu)));
        let norm = scaled(nu, -sigma);
        let (upper, lower) = (sigma.max(0), (-sigma).max(0));
        let ratio = m1 / m2 * norm * norm;
        let parts = places(libm::floor(libm::log2(ratio)));
        let (momentum, inverse) = (parts.max(0), (-parts).max(0));
        if upper.max(lower).max(momentum).max(inverse) > MOST {
            return Err(parameters.out_of_range());
        }

        let momentum2 = scaled(1.0 / (m2 * l2 * l2), lower);
        let momentum1 = scaled(momentum2, -sigma - momentum);
        let gravity2 = scaled(g / l1, upper);
        let gravity1 = scaled(gravity2 * (m1 + m2) / m2 * norm * norm, -momentum);
        Ok(Self {
            time: 1.0,
            momenta: [momentum1, momentum2],
            norm,
            inertia: scaled(ratio, inverse - momentum),
            gravity: [gravity1, gravity2],
            shifts: Shifts {
                momentum: momentum as u32,
                inverse: inverse as u32,
                upper: upper as u32,
                lower: lower as u32,
            },
        })
    }

    /// The longest T in which no rate of a motion within `bounds` exceeds `rate`, and that in which no torque of gravity
    /// exceeds `torque`.
    pub fn longest(&self, bounds: &Bounds<f64>, [rate, torque]: [f64; 2]) -> [f64; 2] {
        let [momentum1, momentum2] = self.momenta;
        let rates = [
            bounds.elbow,
            scaled(bounds.w1, self.shifts.upper as i32),
            scaled(bounds.w2, self.shifts.lower as i32),
            bounds.p1 * momentum1,
            bounds.p2 * momentum2,
        ];
        let fastest = rates.into_iter().fold(0.0, f64::max);
        let [gravity1, gravity2] = self.gravity;
        [
            rate / fastest,
            libm::sqrt(torque / libm::fmax(gravity1, gravity2 * self.norm)),
        ]
    }
}

impl Shifts {
    /// Rods and masses that are about equal.
    pub const NONE: Self = Self {
        momentum: 0,
        inverse: 0,
        upper: 0,
        lower: 0,
    };
}
