//! An example of an added integrator: Kutta's 3/8 rule (`[Hairer I]`, II.1). A new
//! integrator needs a file like this, a line in the test of the order conditions and a row of the
//! table.

use core::array::from_fn;

use double_pendulum::Real;
use double_pendulum::parts::RungeKutta;

/// The 3/8 rule, of order 4: a [`RungeKutta`] for the motion type `Canonical`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreeEighths;

impl RungeKutta for ThreeEighths {
    const ORDER: u32 = 4;
    const STABLE: f64 = crate::bounds::RK4_STABLE; // as for all of order 4 with four stages

    fn step<R: Real, const N: usize>(f: impl Fn(&[R; N]) -> [R; N], z: &[R; N], dt: R) -> [R; N] {
        let [third, eighth] = [3.0, 8.0].map(|parts| dt / R::from_f64(parts));
        let k1 = f(z);
        let k2 = f(&from_fn(|i| z[i] + third * k1[i]));
        let k3 = f(&from_fn(|i| z[i] + dt * k2[i] - third * k1[i]));
        let k4 = f(&from_fn(|i| z[i] + dt * (k1[i] - k2[i] + k3[i])));
        let three = R::from_f64(3.0);
        from_fn(|i| z[i] + eighth * (k1[i] + three * (k2[i] + k3[i]) + k4[i]))
    }
}
