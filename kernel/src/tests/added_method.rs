//! An example of an added method: a row in the table (`rk4-f64-lagrange`, in these tests only) and
//! its type.

use double_pendulum::parts::{Canonical, Derivatives};
use double_pendulum::{Error, Method, Motion, Parameters, Pendulum, Real, State};

use super::forms;

/// Lagrange's equations with the momenta as variables: a' = M^-1 p, p' = dL/da.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Lagrange<R>(Pendulum<R>);

impl<R: Real> Derivatives<R> for Lagrange<R> {
    fn prepare(parameters: &Parameters<R>) -> Result<Self, Error> {
        Pendulum::new(parameters).map(Self)
    }

    fn derivatives(&self, z: &[R; 4]) -> [R; 4] {
        let Motion { a1, a2, w1, w2 } = self.0.to_motion(&State::from(*z));
        let [sin1, _] = sin_cos(a1);
        let [sin2, _] = sin_cos(a2);
        let [sin_d, _] = sin_cos(a1 - a2);
        let [[torque1, _], [_, torque2]] = self.0.stiffness();
        let [[_, coupling], _] = self.0.mass_matrix(R::ONE);
        let force = coupling * w1 * w2 * sin_d;
        [w1, w2, -torque1 * sin1 - force, -torque2 * sin2 + force]
    }
}

fn sin_cos<R: Real>(angle: R) -> [R; 2] {
    angle.own_sin_cos().into()
}

#[test]
fn added_method_needs_only_a_row_and_a_type() {
    let method = Method::from_name("rk4-f64-lagrange").expect("a row of the table");
    assert!(Method::ALL.contains(&method) && method.order() == 4);
    forms::is_that_of_hamiltons_equations::<Canonical<f64, Lagrange<f64>>>(forms::RK4);
}

#[test]
fn method_names_are_unique() {
    Method::ALL
        .iter()
        .for_each(|method| assert_eq!(Method::from_name(method.name()), Some(*method)));
}
