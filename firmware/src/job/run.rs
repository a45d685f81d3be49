//! The start of a requested motion.

use double_pendulum::{Error, Form, Integrator, Motion, Parameters, Pendulum, State};

use super::Request;

/// Returns the motion of a request at its start, by the method that the type `F` computes.
pub(super) fn start<F: Form>(request: &Request) -> Result<F, Error> {
    let (parameters, state) = checked(request)?;
    F::new(&parameters, &state, request.dt)
}

/// Returns the pendulum and the start of a request.
pub(super) fn checked(request: &Request) -> Result<(Parameters<f64>, State<f64>), Error> {
    let ([a1, a2], [w1, w2]) = (request.angles, request.velocities);
    let start = Motion { a1, a2, w1, w2 };
    start.check()?;
    let pendulum = Pendulum::new(&request.parameters)?;
    if request.method.integrator() != Integrator::ClosedForm {
        pendulum.check_step(request.dt)?;
    }
    let state = pendulum.to_state(&start);
    state.check()?;
    Ok((request.parameters, state))
}
