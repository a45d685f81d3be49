//! What a row of the table is: a motion that can be started, stepped and read.

use double_pendulum::Direction;
use double_pendulum::{Error, Motion, Parameters, Pendulum, Real, State};

use super::{JobError, Request};

/// One motion under way, with all that its arithmetic carries along: the one trait that a new row's type implements.
pub trait Run: Copy {
    /// At step 0, with the request's angles and velocities; refuses what the kernel refuses.
    fn start(request: &Request) -> Result<Self, JobError>;

    /// Makes `steps` steps. How they are dealt out to calls makes no difference to any bit.
    fn advance(&mut self, steps: u32);

    /// The canonical state now, SI units, to the last digit carried; of the angles, whole turns may be missing where there
    /// are [`directions`](Self::directions).
    fn state(&self) -> State<f64>;

    /// The directions of the rods, if it knows nothing else, so that somebody has to count whole turns.
    fn directions(&self) -> Option<[Direction<f64>; 2]> {
        None
    }

    /// Gives `feed` the bit patterns of all that is carried from step to step.
    fn bits(&self, feed: impl FnMut(u64));
}

/// The request's numbers in the arithmetic `R`, each rounded once.
pub(super) fn rounded<R: Real>(request: &Request) -> (Parameters<R>, Motion<R>) {
    let ([a1, a2], [w1, w2]) = (request.angles, request.velocities);
    (request.parameters.cast(), Motion { a1, a2, w1, w2 }.cast())
}

/// The request in the arithmetic `R`, checked: the pendulum and its state at the start.
///
/// Never inlined: flash has room for one of it, not for one of each row.
#[inline(never)]
pub(super) fn checked<R: Real>(request: &Request) -> Result<(Pendulum<R>, State<R>), Error> {
    let (parameters, start) = rounded(request);
    start.check()?;
    let pendulum = Pendulum::new(parameters)?;
    pendulum.check_step(request.dt)?;
    let state = pendulum.to_state(&start);
    state.check()?;
    Ok((pendulum, state))
}
