//! The equations of motion, as recurrences for the power series of a solution.

use std::array::from_fn;

use super::fixed::Fixed;

/// The constants of the equations, time in any unit T.
///
/// With D = a1 - a2, S and C its sine and cosine, M = (m1 + m2)/2^e, P1 = p1 T/(M l1^2), P2 = p2 T/(m2 l2^2):
///
/// - u = a1' = (P1 - c C P2)/(k + l S^2), v = a2' = P2 - n C u
/// - P1' = -G1 sin a1 - c u v S, P2' = -G2 sin a2 + n u v S, where sin a2 = C sin a1 - S cos a1
#[derive(Clone, Copy, Debug)]
pub struct Constants {
    /// k = m1/M.
    pub upper: Fixed,
    /// l = m2/M.
    pub lower: Fixed,
    /// n = l1/l2.
    pub rods: Fixed,
    /// c = l/n.
    pub coupling: Fixed,
    /// G1 = 2^e g T^2/l1 and G2 = g T^2/l2.
    pub gravity: [Fixed; 2],
}

impl Constants {
    /// The coefficients 0 to `order` of the power series of the six numbers (sin a1, cos a1, S, C, P1, P2) from `start`, their time in
    /// T by `step`.
    pub fn series(&self, start: &[Fixed; 6], order: usize, step: Fixed) -> [Vec<Fixed>; 6] {
        let &Self { upper, lower, rods, coupling, gravity: [gravity1, gravity2] } = self;
        let mut z: [_; 6] = from_fn(|i| Vec::from_iter([start[i]]));
        let [mut den, mut u, mut v, mut uv, mut turn] = [(); 5].map(|()| Vec::new());
        for k in 0..order {
            let [sin1, cos1, s, c, p1, p2] = &z;
            let square = lower * Fixed::product(s, s);
            den.push(if k == 0 { (upper + square).inverse() } else { square });
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
}
