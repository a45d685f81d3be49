//! The interface of a motion that a job advances, and its start.

use double_pendulum::parts::DrawnMotion;
use double_pendulum::{Error, Form, Integrator, Motion, Parameters, Pendulum, Real, State};

use super::Request;

/// A motion in progress. The types of all methods implement this trait, and so does
/// [`OnBoards`](super::OnBoards).
pub trait Run: Copy {
    /// Makes `steps` steps of the request's step size. `advance(a); advance(b)` is bit-identical to
    /// `advance(a + b)`. The number of steps is not limited.
    ///
    /// A motion may diverge. Numbers of the [`state`](Self::state) then are not finite or, in `f32`
    /// and `f64`, may be finite but meaningless. `rk4-fixed32` shows it at most 32 steps late.
    fn advance(&mut self, steps: u32);

    /// Returns the canonical state now, in SI units (rad, kg m^2/s), with all digits that are
    /// carried.
    ///
    /// If [`sides`](Self::sides) returns a value, the angles are in [-pi, pi], without whole turns.
    fn state(&self) -> State<f64>;

    /// Returns (sin, cos) of rod 1 and of rod 2 as words whose highest bit is the sign, if the
    /// caller must count whole turns by these signs after each step. The other bits are in the
    /// format of the method, and the words of a diverged motion are arbitrary. Returns `None` if
    /// the angles of the state include the turns.
    fn sides(&self) -> Option<[[i32; 2]; 2]>;
}

/// Returns the motion of a request at its start, by the method that the type `F` computes. Not
/// checked: it is the method of the request. Returns the kernel's error if it refuses the request.
pub(super) fn start<F: Form>(request: &Request) -> Result<F, Error> {
    let (parameters, state) = rounded(request)?;
    F::new(&parameters, &state, request.dt)
}

/// Returns the same by the request's method. Refuses, by [`Error::NotDrawn`], methods that scenes
/// are not drawn by.
pub(super) fn start_drawn(request: &Request) -> Result<DrawnMotion, Error> {
    let (parameters, state) = rounded(request)?;
    DrawnMotion::new(request.method, &parameters, &state, request.dt)
}

/// Returns the pendulum's parameters and its initial state, rounded to the numbers of the method.
fn rounded(request: &Request) -> Result<(Parameters<f64>, State<f64>), Error> {
    let checked = if request.method.is_single() {
        checked::<f32>
    } else {
        checked::<f64>
    };
    checked(request)
}

/// Every method of the kernel that is a [`Form`].
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

/// Returns the pendulum's parameters and its initial state. Each number is rounded once to the
/// arithmetic `R`, and checked and computed in it.
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
