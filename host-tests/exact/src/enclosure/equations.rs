//! The equations of motion: recurrences for the power series of a solution, and discs in complex
//! time that bound its remainder.
//!
//! A [`Fixed`] is a ball, a midpoint with a bound of its error. A result that leaves its range is
//! unknown (its radius is infinite), and so is every result from an unknown one.

use std::array::from_fn;

use super::Fixed;

/// The constants of the equations, with time in any unit T and any whole number e.
///
/// With D = a1 - a2, S and C its sine and cosine, M = (m1 + m2)/2^e, P1 = p1 T/(M l1^2) and P2 = p2
/// T/(m2 l2^2):
///
/// - u = a1' = (P1 - c C P2)/(k + l S^2), v = a2' = P2 - n C u
/// - P1' = -G1 sin a1 - c u v S, P2' = -G2 sin a2 + n u v S, where sin a2 = C sin a1 - S cos a1
/// - k = m1/M, l = m2/M, n = l1/l2, c = l/n, G1 = 2^e g T^2/l1, G2 = g T^2/l2, in the order
///   of the fields
///
/// [`Start::enclose`](super::Start::enclose) chooses T and e.
#[derive(Clone, Copy, Debug)]
pub struct Equations {
    pub(super) upper: Fixed,
    pub(super) lower: Fixed,
    pub(super) rods: Fixed,
    pub(super) coupling: Fixed,
    pub(super) gravity: [Fixed; 2],
}

impl Equations {
    /// Returns the coefficients 0 to `order` of the power series of the six numbers (sin a1, cos
    /// a1, S, C, P1, P2) from `start`, in time in units of `step` T: first the number, then the
    /// power. Each ball contains the coefficient for every start and step in their balls.
    pub fn series(&self, start: &[Fixed; 6], order: usize, step: Fixed) -> [Vec<Fixed>; 6] {
        let &Self {
            upper,
            lower,
            rods,
            coupling,
            gravity: [gravity1, gravity2],
        } = self;
        let mut z: [_; 6] = from_fn(|i| Vec::from_iter([start[i]]));
        let [mut den, mut u, mut v, mut uv, mut turn] = [(); 5].map(|()| Vec::new());

        for k in 0..order {
            let [sin1, cos1, s, c, p1, p2] = &z;
            let square = lower * Fixed::product(s, s);
            den.push(if k == 0 {
                (upper + square).inverse()
            } else {
                square
            });
            let momentum = p1[k] - coupling * Fixed::product(c, p2);
            u.push((momentum - Fixed::product(&den[1..], &u)) * den[0]);
            v.push(p2[k] - rods * Fixed::product(c, &u));
            uv.push(Fixed::product(&u, &v));
            turn.push(u[k] - v[k]);

            let force = Fixed::product(&uv, s);
            let sin2 = Fixed::product(sin1, c) - Fixed::product(cos1, s);
            let slopes = [
                Fixed::product(&u, cos1),
                Fixed::ZERO - Fixed::product(&u, sin1),
                Fixed::product(&turn, c),
                Fixed::ZERO - Fixed::product(&turn, s),
                Fixed::ZERO - gravity1 * sin1[k] - coupling * force,
                rods * force - gravity2 * sin2,
            ];
            for (z, slope) in z.iter_mut().zip(slopes) {
                z.push(slope.over(k as u32 + 1) * step);
            }
        }

        z
    }

    /// Divided by M l1^2/T^2. The potential energy is 0 where both bobs are level with the pivot.
    pub fn energy(&self, &[sin1, cos1, s, c, p1, p2]: &[Fixed; 6]) -> Fixed {
        let &Self {
            upper,
            lower,
            rods,
            coupling,
            gravity: [gravity1, gravity2],
        } = self;

        let u = (p1 - coupling * c * p2) * (upper + lower * s * s).inverse();
        let v = p2 - rods * c * u;
        let square = coupling * rods.inverse();
        let cos2 = cos1 * c + sin1 * s;
        let kinetic = ((upper + lower) * u * u + square * v * v).over(2) + coupling * u * v * c;
        kinetic - gravity1 * cos1 - square * gravity2 * cos2
    }
}

/// The part of the discs' radii within which solutions may start.
pub const STARTS: f64 = 0.0625;
/// The smallest radius, and the smallest ratio of a radius to the extent of the set. The extent is
/// then at most 1/4 of the region where solutions may start.
const LEAST: [f64; 2] = [1.0 / 65_536.0, 64.0];
/// The times to try, in steps, and the number of attempts for each. An attempt sets the radii to
/// the values that the time needs, with a margin.
const TIMES: [f64; 5] = [24.0, 16.0, 12.0, 9.0, 7.0];
const TRIES: usize = 12;
/// The shortest usable time, in steps. With it, a power series of 48 terms ends at 2^-116.
const SHORTEST: f64 = 6.0;

/// Returns the longest time found, in steps of `step` T, and the radii of discs about `middle`;
/// `None` if no time is usable. No solution that starts within [`STARTS`] of these radii leaves the
/// discs in complex times up to that time. `extent` is the largest distance of each number of the
/// starts from `middle`.
///
/// Theorem (Picard and Lindeloef for analytic equations; Hille, Ordinary Differential Equations in
/// the Complex Domain, 2.3): if z0 + t f(B) is in the product of discs B for |t| <= T, one solution
/// from z0 exists there, is analytic in t and z0, and stays in B. f has no pole in B, because
/// otherwise the radius of its inverse would be infinite.
pub fn discs(
    equations: &Equations,
    middle: &[Fixed; 6],
    extent: &[f64; 6],
    step: Fixed,
) -> Option<(f64, [f64; 6])> {
    let least = extent.map(|extent| LEAST[0].max(LEAST[1] * extent));
    let mut best = (0.0, least);
    for time in TIMES {
        let mut radii = least;
        for _ in 0..TRIES {
            let slopes = equations
                .series(&from_fn(|i| middle[i].wider(radii[i])), 1, step)
                .map(|z| z[1].size());

            // Twice the share: the roundings are much smaller.
            let held = (0..6)
                .map(|i| (1.0 - 2.0 * STARTS) * radii[i] / slopes[i])
                .fold(time, f64::min);
            if held > best.0 {
                best = (held, radii);
            }

            if held == 0.0 {
                break;
            }

            radii = from_fn(|i| least[i].max(1.1 * time * slopes[i]));
        }
    }
    (best.0 >= SHORTEST).then_some(best)
}
