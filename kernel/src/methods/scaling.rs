//! The units of fixed point: in them every quantity of a motion fits its format, and none is
//! needlessly small.

use crate::bounds::Bounds;
use crate::error::{Error, Parameter};
use crate::numbers::fixed::scaled;
use crate::pendulum::{Parameters, State};

/// The largest shift of a quantity.
const MOST: i32 = 12;

/// The units of a motion, and the constants of the equations in these units, which have no
/// dimension.
///
/// The constants and momenta are as in the [direction form](crate::methods::direction), with these
/// changes of units:
///
/// - The unit of time T is so short that no rate and no torque that the energy allows ([`Bounds`])
///   exceeds a limit.
/// - (S, C) is divided by sigma, the power of two that leaves nu/sigma in (1/2, 1]. The smaller one
///   of u and v is multiplied by a power of two, so that both are of about the same size.
/// - r is divided by the power of two that makes it at most 1, and P1 is scaled such that
///   u = (P1 - C P2) r still holds.
///
/// For equal rods and masses all shifts are 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scaling {
    /// T, s. Negative if time runs backwards.
    pub time: f64,
    /// P1/p1 and P2/p2, s/(kg m^2).
    pub momenta: [f64; 2],
    /// nu/sigma.
    pub norm: f64,
    /// m, in the unit of the divided (S, C) and r; from 1 to 2.
    pub inertia: f64,
    pub gravity: [f64; 2],
    pub shifts: Shifts,
}

/// The differences between the units of the quantities, as powers of two.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Shifts {
    /// The shift to the right of C P2 in P1 - C P2.
    pub momentum: u32,
    /// The shift to the left of products with r.
    pub inverse: u32,
    /// The shift to the right from u to the rate of a1.
    pub upper: u32,
    /// The shift to the right from v to the rate of a2.
    pub lower: u32,
}

/// Returns [`Error::Diverged`] if a motion `is_lost`, with a1 = NaN, because the quantity that left
/// its range is not recorded.
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

/// Refuses a start of infinite energy.
pub(super) fn check_energy(
    parameters: &Parameters<f64>,
    start: &State<f64>,
    energy: f64,
) -> Result<(), Error> {
    let (parameter, value) = if libm::fabs(start.p1) >= libm::fabs(start.p2) {
        (Parameter::P1, start.p1)
    } else {
        (Parameter::P2, start.p2)
    };
    if energy.is_finite() {
        Ok(())
    } else if value == 0.0 {
        Err(parameters.out_of_range())
    } else {
        Err(Error::OutOfRange { parameter, value })
    }
}

/// Returns the start as fixed point takes it. With less than 1e-280 J nothing moves in the age of
/// the universe, and the unit of time would be out of range.
pub(super) fn without_least_momenta(start: &State<f64>, energy: f64) -> State<f64> {
    if energy < 1e-280 {
        State::at_rest(start.a1, start.a2)
    } else {
        *start
    }
}

impl Scaling {
    /// Returns the same scaling with a unit of time that is `time` times as long.
    #[must_use]
    pub fn in_unit(self, time: f64) -> Self {
        Self {
            time: self.time * time,
            momenta: self.momenta.map(|momentum| momentum * time),
            gravity: self.gravity.map(|gravity| gravity * time * time),
            ..self
        }
    }

    /// Returns the scaling with T = 1 s. Refuses ratios of masses or rods that need a shift above
    /// [`MOST`], by [`Error::OutOfRange`].
    pub fn in_seconds(parameters: &Parameters<f64>) -> Result<Self, Error> {
        let &Parameters { m1, m2, l1, l2, g } = parameters;
        let nu = l1 / l2;
        // One more than allowed is enough to be refused below.
        let places = |ratio: f64| libm::ilogb(ratio).clamp(-MOST - 1, MOST + 1);
        let sigma = -places(1.0 / nu);
        let norm = scaled(nu, -sigma);
        let upper = sigma.max(0);
        let lower = (-sigma).max(0);
        let ratio = m1 / m2 * norm * norm;
        let parts = places(ratio);
        let momentum = parts.max(0);
        let inverse = (-parts).max(0);
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

    /// Returns the longest units of time, s, for a motion within `bounds`: the longest that keeps
    /// every rate and momentum within `rate`, and the longest that keeps every torque of gravity
    /// within `torque`.
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

        // The rates grow with the unit of time, the torques with its square.
        let [gravity1, gravity2] = self.gravity;
        [
            rate / fastest,
            libm::sqrt(torque / libm::fmax(gravity1, gravity2 * self.norm)),
        ]
    }
}

impl Shifts {
    /// The shifts of about equal rods and masses: l1/l2 above 1/2 and at most 1, and (m1/m2)
    /// (l1/l2)^2 from 1 to below 2.
    pub const NONE: Self = Self {
        momentum: 0,
        inverse: 0,
        upper: 0,
        lower: 0,
    };
}
