//! How a method is added: a row in the table (here `rk4-f64-lagrange`, in tests alone) and its type.

use double_pendulum::parts::{Canonical, Derivatives};
use double_pendulum::{Error, Method, Motion, Parameters, Pendulum, Real, State};

use super::forms;

/// Lagrange's equations in the momenta: a' = M^-1 p, p' = dL/da.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Lagrange<R>(Pendulum<R>);

impl<R: Real> Derivatives<R> for Lagrange<R> {
    fn prepare(parameters: &Parameters<R>) -> Result<Self, Error> {
        Pendulum::new(parameters).map(Self)
    }

    fn derivatives(&self, z: &[R; 4]) -> [R; 4] {
        let Motion { a1, a2, w1, w2 } = self.0.to_motion(&State::from(*z));
        let ([sin1, _], [sin2, _], [sin_d, _]) = (sin_cos(a1), sin_cos(a2), sin_cos(a1 - a2));
        let ([[torque1, _], [_, torque2]], [[_, coupling], _]) =
            (self.0.stiffness(), self.0.mass_matrix(R::ONE));
        let force = coupling * w1 * w2 * sin_d;
        [w1, w2, -torque1 * sin1 - force, -torque2 * sin2 + force]
    }
}

fn sin_cos<R: Real>(angle: R) -> [R; 2] {
    angle.own_sin_cos().into()
}

#[test]
fn a_method_is_a_row_and_a_type() {
    let method = Method::from_name("rk4-f64-lagrange").expect("a row of the table");
    assert!(Method::ALL.contains(&method) && method.order() == 4);
    forms::is_that_of_hamiltons_equations::<Canonical<f64, Lagrange<f64>>>(forms::RK4);
}

#[test]
fn every_method_has_a_name_of_its_own() {
    Method::ALL
        .iter()
        .for_each(|method| assert_eq!(Method::from_name(method.name()), Some(*method)));
}
