//! The equations of motion, as recurrences for the power series of a solution.

use super::number::Number;

/// The constants of the equations, time in any unit T.
///
/// With D = a1 - a2, S and C its sine and cosine, M = (m1 + m2)/2^e, P1 = p1 T/(M l1^2), P2 = p2 T/(m2 l2^2):
///
/// - u = a1' = (P1 - c C P2)/(k + l S^2), v = a2' = P2 - n C u
/// - P1' = -G1 sin a1 - c u v S, P2' = -G2 sin a2 + n u v S, where sin a2 = C sin a1 - S cos a1
#[derive(Clone, Copy, Debug)]
pub struct Constants<N> {
    /// k = m1/M.
    pub upper: N,
    /// l = m2/M.
    pub lower: N,
    /// n = l1/l2.
    pub rods: N,
    /// c = l/n.
    pub coupling: N,
    /// G1 = 2^e g T^2/l1 and G2 = g T^2/l2.
    pub gravity: [N; 2],
}

impl<N: Copy> Constants<N> {
    /// In another kind of number.
    pub fn map<T>(&self, to: impl Fn(N) -> T) -> Constants<T> {
        let Self { upper, lower, rods, coupling, gravity } = *self;
        let [upper, lower, rods, coupling] = [upper, lower, rods, coupling].map(&to);
        Constants { upper, lower, rods, coupling, gravity: gravity.map(to) }
    }
}

/// The coefficients 0 to `order` of the power series of the six numbers (sin a1, cos a1, S, C, P1, P2) from `start`, their time in T by
/// 2^`halvings`.
pub fn series<N: Number>(constants: &Constants<N>, start: &[N; 6], order: usize, halvings: u32) -> [Vec<N>; 6] {
    let &Constants { upper, lower, rods, coupling, gravity: [gravity1, gravity2] } = constants;
    let mut z = start.map(|z| {
        let mut series = Vec::with_capacity(order + 1);
        series.push(z);
        series
    });
    let [mut den, mut u, mut v, mut uv, mut turn] = [(); 5].map(|()| Vec::with_capacity(order));
    let mut inverse = N::ZERO;
    for k in 0..order {
        let [sin1, cos1, s, c, p1, p2] = &z;
        let square = lower * N::product(s, s);
        den.push(if k == 0 { upper + square } else { square });
        if k == 0 {
            inverse = den[0].inverse();
        }
        let momentum = p1[k] - coupling * N::product(c, p2);
        u.push((momentum - N::product(&den[1..], &u)) * inverse);
        v.push(p2[k] - rods * N::product(c, &u));
        uv.push(N::product(&u, &v));
        turn.push(u[k] - v[k]);
        let force = N::product(&uv, s);
        let sin2 = N::product(sin1, c) - N::product(cos1, s);
        let slopes = [
            N::product(&u, cos1),
            N::ZERO - N::product(&u, sin1),
            N::product(&turn, c),
            N::ZERO - N::product(&turn, s),
            N::ZERO - gravity1 * sin1[k] - coupling * force,
            rods * force - gravity2 * sin2,
        ];
        for (z, slope) in z.iter_mut().zip(slopes) {
            z.push(slope.over((k as u32 + 1) << halvings));
        }
    }
    z
}
