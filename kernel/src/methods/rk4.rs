//! The classical Runge-Kutta step of order 4, for any system of first-order equations.

use crate::numbers::Real;
use crate::pendulum::{Pendulum, State};

/// One step of the classical Runge-Kutta method for z' = f(z): the state a time `dt` after `z`.
///
/// Y1 = dt f(z), Y2 = dt f(z + Y1/2), Y3 = dt f(z + Y2/2), Y4 = dt f(z + Y3),
/// z' = z + (Y1 + 2 Y2 + 2 Y3 + Y4)/6.
///
/// The error of one step is O(dt^5), of a fixed interval O(dt^4). A negative `dt` steps backwards.
#[must_use]
#[inline]
pub fn step<R: Real, const N: usize>(f: impl Fn(&[R; N]) -> [R; N], z: &[R; N], dt: R) -> [R; N] {
    let half = dt * R::HALF;
    let k1 = f(z);
    let k2 = f(&advanced(z, half, &k1));
    let k3 = f(&advanced(z, half, &k2));
    let k4 = f(&advanced(z, dt, &k3));
    let sixth = dt / R::from_f64(6.0);
    core::array::from_fn(|i| z[i] + sixth * (k1[i] + R::TWO * (k2[i] + k3[i]) + k4[i]))
}

/// z + dt k, component by component.
#[inline(always)]
fn advanced<R: Real, const N: usize>(z: &[R; N], dt: R, k: &[R; N]) -> [R; N] {
    core::array::from_fn(|i| z[i] + dt * k[i])
}

impl<R: Real> Pendulum<R> {
    /// The state a time `dt` (s) after `state`, by one classical RK4 step; a negative `dt` steps backwards.
    ///
    /// Nothing is refused: a state or a step that is NaN gives NaN, and a step too long for the motion gives what has
    /// nothing to do with it, infinite or NaN in the end. Ask [`check_step`](Self::check_step) or
    /// [`admissible_step`](Self::admissible_step) before the first step, and [`State::finite`] after each.
    #[must_use]
    #[inline]
    pub fn step(&self, state: &State<R>, dt: R) -> State<R> {
        step(|z| self.derivatives(z), &(*state).into(), dt).into()
    }
}

#[cfg(test)]
mod tests {
    use super::step;

    /// One step of length 1 from 0: the first component is the left-hand side of the order condition that `f` isolates.
    fn weight<const N: usize>(f: fn(&[f64; N]) -> [f64; N]) -> f64 {
        step(f, &[0.0; N], 1.0)[0]
    }

    /// The order conditions of [Hairer I], table II.2.1, with the weights b, the matrix a and the nodes c_i = sum_j a_ij. Each rooted
    /// tree has a system of equations whose only elementary differential is the tree's own.
    #[test]
    fn order_4_is_reached_and_order_5_is_not() {
        for (condition, value, exact) in [
            ("order 1: sum b", weight(|_: &[f64; 1]| [1.0]), 1.0),
            ("order 2: sum b c", weight(|&[_, c]| [c, 1.0]), 1.0 / 2.0),
            ("order 3: sum b c c", weight(|&[_, c]| [c * c, 1.0]), 1.0 / 3.0),
            ("order 3: sum b a c", weight(|&[_, ac, c]| [ac, c, 1.0]), 1.0 / 6.0),
            ("order 4: sum b c c c", weight(|&[_, c]| [c * c * c, 1.0]), 1.0 / 4.0),
            ("order 4: sum b c a c", weight(|&[_, ac, c]| [c * ac, c, 1.0]), 1.0 / 8.0),
            ("order 4: sum b a c c", weight(|&[_, acc, c]| [acc, c * c, 1.0]), 1.0 / 12.0),
            ("order 4: sum b a a c", weight(|&[_, aac, ac, c]| [aac, ac, c, 1.0]), 1.0 / 24.0),
            ("order 5, not 1/5: sum b c c c c", weight(|&[_, c]| [c * c * c * c, 1.0]), 5.0 / 24.0),
        ] {
            assert!((value - exact).abs() <= f64::EPSILON, "{condition} is {value} instead of {exact}");
        }
    }
}
