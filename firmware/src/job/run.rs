//! What a row of the table is: a motion that can be started, stepped and read.

use double_pendulum::{Error, Form, Integrator, Motion, Parameters, Pendulum, Real, State};

use super::Request;

/// One motion under way, with all that its arithmetic carries along: the one trait that a new row's type implements.
pub trait Run: Copy {
    /// Makes `steps` steps. How they are dealt out to calls makes no difference to any bit.
    fn advance(&mut self, steps: u32);

    /// The canonical state now, SI units, to the last digit carried; of the angles, whole turns may be missing where there
    /// are [`sides`](Self::sides).
    fn state(&self) -> State<f64>;

    /// The signs of the rods' directions, if somebody has to count whole turns by them.
    fn sides(&self) -> Option<[[i32; 2]; 2]> {
        None
    }

    /// Gives `feed` the bit patterns of all that is carried from step to step.
    fn bits(&self, feed: impl FnMut(u64));
}

/// At step 0, with the request's angles and velocities; refuses what the kernel refuses.
#[inline(never)]
pub(super) fn start<F: Form>(request: &Request) -> Result<F, Error> {
    let checked = if request.method.is_single() {
        checked::<f32>
    } else {
        checked::<f64>
    };
    let (parameters, state) = checked(request)?;
    Form::new(&parameters, &state, request.dt)
}

/// By any method of the kernel that makes steps.
impl<F: Form> Run for F {
    #[inline(always)]
    fn advance(&mut self, steps: u32) {
        Form::advance(self, steps);
    }

    fn state(&self) -> State<f64> {
        Form::state(self)
    }

    fn sides(&self) -> Option<[[i32; 2]; 2]> {
        (!F::HAS_TURNS).then(|| Form::sides(self))
    }

    fn bits(&self, feed: impl FnMut(u64)) {
        Form::bits(self, feed);
    }
}

/// The pendulum and its state at the start, each number rounded once to the arithmetic `R`, checked and computed in it.
#[inline(never)] // flash has room for one of it, not for one of each row
fn checked<R: Real>(request: &Request) -> Result<(Parameters<f64>, State<f64>), Error> {
    let ([a1, a2], [w1, w2]) = (request.angles, request.velocities);
    let (parameters, start) = (
        request.parameters.cast::<R>(),
        Motion { a1, a2, w1, w2 }.cast::<R>(),
    );
    start.check()?;
    let pendulum = Pendulum::new(&parameters)?;
    if request.method.integrator() != Integrator::ClosedForm {
        pendulum.check_step(request.dt)?;
    }
    let state = pendulum.to_state(&start);
    state.check()?;
    Ok((parameters.cast(), state.cast()))
}
