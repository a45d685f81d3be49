//! The start of a requested motion.

use double_pendulum::{Error, Form, Integrator, Motion, Parameters, Pendulum, Real, State};

use super::Request;

/// Returns the motion of a request at its start, by the method that the type `F` computes.
pub(super) fn start<F: Form>(request: &Request) -> Result<F, Error> {
    let (parameters, state) = rounded(request)?;
    F::new(&parameters, &state, request.dt)
}

/// Returns the pendulum and the start of a request, rounded to the numbers of its method.
pub(super) fn rounded(request: &Request) -> Result<(Parameters<f64>, State<f64>), Error> {
    let checked = if request.method.is_single() {
        checked::<f32>
    } else {
        checked::<f64>
    };
    checked(request)
}

/// Rounds each number once to the arithmetic `R`, so that host and chip start from the same one.
fn checked<R: Real>(request: &Request) -> Result<(Parameters<f64>, State<f64>), Error> {
    let ([a1, a2], [w1, w2]) = (request.angles, request.velocities);
    let parameters = request.parameters.cast::<R>();
    let start = Motion { a1, a2, w1, w2 }.cast::<R>();
    start.check()?;
    let pendulum = Pendulum::new(&parameters)?;
    if request.method.integrator() != Integrator::ClosedForm {
        pendulum.check_step(request.dt)?;
    }
    let state = pendulum.to_state(&start);
    state.check()?;
    Ok((parameters.cast(), state.cast()))
}
