//! The interface of a motion that a job advances, and its start.

use double_pendulum::parts::DrawnMotion;
use double_pendulum::{Error, Form, Integrator, Motion, Parameters, Pendulum, Real, State};

use super::Request;

/// A motion in progress.
pub trait Run: Copy {
    /// Makes `steps` steps. `advance(a); advance(b)` is bit-identical to `advance(a + b)`.
    fn advance(&mut self, steps: u32);

    /// Returns the canonical state now, in SI units. If [`sides`](Self::sides) returns a value, the
    /// angles are in [-pi, pi], without whole turns.
    fn state(&self) -> State<f64>;

    /// Returns (sin, cos) of both rods as words whose highest bit is the sign, from which the
    /// caller counts whole turns after each step; `None` if the angles of the state include the
    /// turns.
    fn sides(&self) -> Option<[[i32; 2]; 2]>;
}

/// Returns the motion of a request at its start, by the method that the type `F` computes.
pub(super) fn start<F: Form>(request: &Request) -> Result<F, Error> {
    let (parameters, state) = rounded(request)?;
    F::new(&parameters, &state, request.dt)
}

/// Returns the same by the request's method, if scenes are drawn by it.
pub(super) fn start_drawn(request: &Request) -> Result<DrawnMotion, Error> {
    let (parameters, state) = rounded(request)?;
    DrawnMotion::new(request.method, &parameters, &state, request.dt)
}

fn rounded(request: &Request) -> Result<(Parameters<f64>, State<f64>), Error> {
    let checked = if request.method.is_single() {
        checked::<f32>
    } else {
        checked::<f64>
    };
    checked(request)
}

impl<F: Form> Run for F {
    fn advance(&mut self, steps: u32) {
        self.advance(steps);
    }

    fn state(&self) -> State<f64> {
        self.state()
    }

    fn sides(&self) -> Option<[[i32; 2]; 2]> {
        (!F::HAS_TURNS).then(|| self.sides())
    }
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
