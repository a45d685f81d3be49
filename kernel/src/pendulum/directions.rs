//! Hamilton's equations, written once for every kind of number.

use crate::numbers::{Lanes, Real, Scalar};
use crate::pendulum::State;

/// (sin, cos) of an angle from the downward vertical.
pub type Direction<R> = [R; 2];

/// The constants of the equations of motion, with momenta scaled to leave no needless factor.
///
/// With nu = l1/l2, (S, C) = nu (sin D, cos D), P = tau p/(m2 l2^2), and the constants
/// m = (m1/m2) nu^2, G2 = tau^2 g/l1, G1 = (m + nu^2) G2:
///
/// - r = 1/(m + S^2); u = a1' = (P1 - C P2) r; v = a2' = P2 - C u; F = u v S
/// - P1' = -G1 sin a1 - F; P2' = -G2 nu sin a2 + F, where nu sin a2 = C sin a1 - S cos a1
///
/// Rods of any lengths cost what equal rods do. Floating point counts time in tau, a step or half of one, so that no rate is
/// multiplied by dt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Coefficients<R, G = R> {
    /// nu.
    pub norm: R,
    /// m.
    pub inertia: R,
    /// G1 and G2.
    pub gravity: [G; 2],
}

/// The time derivatives.
#[derive(Clone, Copy)]
pub(crate) struct Rates<R: Scalar> {
    /// u and v.
    pub angles: [R; 2],
    /// P1' and P2'.
    pub momenta: [R::Torque; 2],
}

/// The units the quantities are counted in, where they are not all the same: what of one makes what of another.
///
/// The default is no difference, at no cost.
pub(crate) trait Units<R: Scalar>: Copy {
    /// C P2 as a part of P1.
    #[inline(always)]
    fn momentum(&self, product: R) -> R {
        product
    }
    /// `momentum` r as u.
    #[inline(always)]
    fn rate(&self, momentum: R, inverse: R) -> R {
        momentum * inverse
    }
    /// C u as a part of v.
    #[inline(always)]
    fn swing(&self, product: R) -> R {
        product
    }
    /// u by the time in which increments are counted.
    #[inline(always)]
    fn paced(&self, u: R) -> R {
        u
    }
    /// F = u v S.
    #[inline(always)]
    fn force(&self, u: R, v: R, s: R) -> R::Torque {
        u.torque(v, s)
    }
    /// u and v as rates of the angles.
    #[inline(always)]
    fn turns(&self, [u, v]: [R; 2]) -> [R; 2] {
        [u, v]
    }
    /// F as parts of P1' and P2'.
    #[inline(always)]
    fn forces(&self, force: R::Torque) -> [R::Torque; 2] {
        [force, force]
    }
    /// nu sin a2.
    #[inline(always)]
    fn lower(&self, sine: R) -> R {
        sine
    }
    /// The torque of gravity on rod 2 as a part of P2'.
    #[inline(always)]
    fn weight(&self, torque: R::Torque) -> R::Torque {
        torque
    }
}

/// All quantities in one system of units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Same;

impl<R: Scalar> Units<R> for Same {}

impl<R: Scalar> Coefficients<R> {
    /// m + S^2, whose inverse is r.
    #[inline(always)]
    pub fn denominator(&self, s: R) -> R {
        self.inertia + s * s
    }

    /// The same in every lane.
    #[inline(always)]
    pub fn splat<const N: usize>(&self) -> Coefficients<Lanes<R, N>> {
        let Self {
            norm,
            inertia,
            gravity,
        } = *self;
        Coefficients {
            norm: Lanes::splat(norm),
            inertia: Lanes::splat(inertia),
            gravity: gravity.map(Lanes::splat),
        }
    }
}

impl<R: Scalar> Coefficients<R, R::Gravity> {
    /// The rates at sin a1, cos a1, S, C, P1, P2, where `inverse` is r.
    #[inline(always)]
    pub fn rates(
        &self,
        units: &impl Units<R>,
        &[sin1, cos1, s, c, p1, p2]: &[R; 6],
        inverse: R,
    ) -> Rates<R> {
        let [gravity1, gravity2] = self.gravity;
        let u = units.rate(p1 - units.momentum(c * p2), inverse);
        let v = p2 - units.swing(c * u);
        let u = units.paced(u);
        let [force1, force2] = units.forces(units.force(u, v, s));
        Rates {
            angles: units.turns([u, v]),
            momenta: [
                -R::weight(gravity1, sin1) - force1,
                force2 - units.weight(R::weight(gravity2, units.lower(sin1 * c - cos1 * s))),
            ],
        }
    }
}

/// The rates of sin a1, cos a1, S, C where rods 1 and 2 turn at u and v.
#[inline(always)]
pub(crate) fn turning<R: Scalar>(
    &[sin1, cos1, s, c, ..]: &[R; 6],
    [u, v]: [R; 2],
) -> [R::Slope; 4] {
    let w = u - v;
    [cos1.slope(u), -sin1.slope(u), c.slope(w), -s.slope(w)]
}

/// The rates of sin a1, cos a1, S, C, P1, P2, where all are numbers of one kind.
#[inline(always)]
pub(crate) fn increments<R: Scalar<Gravity = R, Slope = R, Torque = R>>(
    z: &[R; 6],
    rates: Rates<R>,
) -> [R; 6] {
    let [sin1, cos1, s, c] = turning(z, rates.angles);
    let [p1, p2] = rates.momenta;
    [sin1, cos1, s, c, p1, p2]
}

/// sin a1, cos a1, S, C, P1, P2 of a state, nu being `norm` and momenta being counted `units` to a kg m^2/s.
#[inline(never)] // one copy
pub(crate) fn quantities(
    &State { a1, a2, p1, p2 }: &State<f64>,
    norm: f64,
    [unit1, unit2]: [f64; 2],
) -> [f64; 6] {
    let (sin1, cos1) = a1.own_sin_cos();
    let (sin_d, cos_d) = (a1 - a2).own_sin_cos();
    [
        sin1,
        cos1,
        norm * sin_d,
        norm * cos_d,
        p1 * unit1,
        p2 * unit2,
    ]
}

/// The way back, angles within a turn.
#[inline(never)] // one copy
pub(crate) fn state_of(
    [sin1, cos1, s, c, p1, p2]: [f64; 6],
    [unit1, unit2]: [f64; 2],
) -> State<f64> {
    let [sin2, cos2] = lower_ray([sin1, cos1], [s, c]);
    State {
        a1: libm::atan2(sin1, cos1),
        a2: libm::atan2(sin2, cos2),
        p1: p1 / unit1,
        p2: p2 / unit2,
    }
}

/// The direction of rod 2 from that of rod 1 and (S, C), a2 = a1 - D, and as long as (S, C): enough to tell the angle by.
#[inline(always)]
pub(crate) fn lower_ray<R: Scalar>([sin1, cos1]: [R; 2], [s, c]: [R; 2]) -> [R; 2] {
    [sin1 * c - cos1 * s, cos1 * c + sin1 * s]
}

/// The directions of both rods from sin a1, cos a1, S, C; that of rod 2 as long as (S, C).
#[inline(always)]
pub(crate) fn rod_directions<R: Scalar>(&[sin1, cos1, s, c, ..]: &[R; 6]) -> [Direction<R>; 2] {
    [[sin1, cos1], lower_ray([sin1, cos1], [s, c])]
}

/// The same in full: each of length 1, nu being `norm`.
#[inline]
pub(crate) fn directions<R: Real>(z: &[R; 6], norm: R) -> [Direction<R>; 2] {
    let ([upper, lower], inverse) = (rod_directions(z), R::ONE / norm);
    [upper, lower.map(|x| x * inverse)]
}
