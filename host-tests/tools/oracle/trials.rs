//! Trials: motions that are computed by the methods of the table and compared with the reference,
//! the exact motion to about 30 digits ([`taylor::Reference`]).

use std::f64::consts::TAU;
use std::fmt::Debug;

use double_pendulum::parts::DirectionF64;
use double_pendulum::{
    Direction, Equations, Error, Form, FormVisitor, Method, Parameters, Pendulum, Run, State,
};
use firmware::job::visit;
use reference::{advance, taylor};

/// Returns all methods whose errors depend on the step, in the order of [`Method::ALL`]. The
/// others, which are left out, are the closed form in `f32` and `f64`, with the error of its linear
/// equations, and the `micromath` method, with the error of its sines.
pub fn exact_methods() -> impl Iterator<Item = Method> {
    let is_exact = |method: &Method| {
        method.equations() != Equations::Linear && *method != Method::Rk4F32Micromath
    };
    Method::ALL.iter().copied().filter(is_exact)
}

/// A [`Run`] that counts turns, whose method is chosen at run time. Its numbers are widened to
/// `f64`. Before the first step they are those of the start, as the method holds it. Whole turns
/// may be miscounted if a step turns a rod by more than a quarter turn.
pub trait CountingRun: Debug {
    /// Advances by `steps` steps. 0 steps are possible. An error means that the motion has diverged
    /// ([`Run::advance`]); the run is then unchanged.
    fn advance(&mut self, steps: u32) -> Result<(), Error>;
    /// Returns the angles, rad, with all turns, and the canonical momenta, kg m^2/s, at the number
    /// of steps times `dt`.
    fn state(&self) -> State<f64>;
    /// Returns (sin, cos) of both angles, rod 1 first. In the direction form in floating point they
    /// may be up to half a step ahead of the state or behind it.
    fn directions(&self) -> [Direction<f64>; 2];
    /// Returns the angles a1 and a2, rad, with all turns, at the time of the directions.
    fn angles(&self) -> [f64; 2];
    /// Returns the energy, J, at the time of the directions. The potential energy is 0 where both
    /// bobs are level with the pivot.
    fn energy(&self) -> f64;
}

impl<F: Form> CountingRun for Run<F, true> {
    fn advance(&mut self, steps: u32) -> Result<(), Error> {
        Run::advance(self, steps)
    }

    fn state(&self) -> State<f64> {
        Run::state(self)
    }

    fn directions(&self) -> [Direction<f64>; 2] {
        Run::directions(self).map(|direction| direction.map(Into::into))
    }

    fn angles(&self) -> [f64; 2] {
        Run::angles(self).map(Into::into)
    }

    fn energy(&self) -> f64 {
        Run::energy(self).into()
    }
}

/// Starts a motion of `pendulum`.
struct Start<'a> {
    pendulum: Pendulum<f64>,
    state: &'a State<f64>,
    dt: f64,
}

impl FormVisitor for Start<'_> {
    type Output = Result<Box<dyn CountingRun>, Error>;

    fn visit<F: Form>(self) -> Self::Output {
        let run = self.pendulum.run::<F>(self.state, self.dt)?;
        Ok(Box::new(run.counting_turns()))
    }
}

/// Returns the motion of a pendulum from its start by `method`, in steps of `dt` s; a negative `dt`
/// runs backwards. All numbers are in SI units and are rounded to those of the method. An error
/// means that the kernel refuses the pendulum ([`Pendulum::new`]), the start or the step
/// ([`Pendulum::run`]): a step of 0, for example, or one that is too long. The closed form accepts
/// large angles, too, for which it is wrong.
pub fn run(
    method: Method,
    parameters: &Parameters<f64>,
    start: &State<f64>,
    dt: f64,
) -> Result<Box<dyn CountingRun>, Error> {
    let pendulum = Pendulum::new(parameters)?;
    let state = start;
    visit(
        method,
        Start {
            pendulum,
            state,
            dt,
        },
    )
}

/// A motion to try, in SI units. Nothing is checked until it is computed; the duration is not
/// checked even then.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    /// Masses (kg), lengths (m) and gravity (m/s^2).
    pub parameters: Parameters<f64>,
    /// The start of the motion: angles, rad, and canonical momenta, kg m^2/s.
    pub start: State<f64>,
    /// The duration, s, finite and greater than 0.
    pub seconds: f64,
}

/// The number of moments of a comparison, evenly spread over the motion. The last one is its end;
/// the start is not included.
pub const MOMENTS: u32 = 16;

impl Trial {
    /// Returns a motion from rest at (`a1`, `a2`), rad, with rods of 1 m, a bob 1 of 1 kg, a bob 2
    /// of `mass_ratio` kg, and g = 9.81 m/s^2. It takes `seconds` s.
    pub fn at_rest(mass_ratio: f64, a1: f64, a2: f64, seconds: f64) -> Self {
        Self {
            parameters: Parameters::equal_rods(mass_ratio, 1.0, 9.81),
            start: State::at_rest(a1, a2),
            seconds,
        }
    }

    /// Returns a regular motion of `seconds` s, from rest with both rods at 0.5 rad. The bobs have
    /// 1 kg, the rods 1 m, and g is 9.81 m/s^2.
    pub fn regular(seconds: f64) -> Self {
        Self::at_rest(1.0, 0.5, 0.5, seconds)
    }

    /// Returns a chaotic motion of `seconds` s, from rest with both rods at 2 rad. After some time
    /// rods turn over. The bobs have 1 kg, the rods 1 m, and g is 9.81 m/s^2.
    pub fn chaotic(seconds: f64) -> Self {
        Self::at_rest(1.0, 2.0, 2.0, seconds)
    }

    /// Returns a motion of `seconds` s at small angles that is in motion at the start, with bobs of
    /// 0.7 kg and 1.3 kg, rods of 0.6 m and 1.1 m, and g = 9.81 m/s^2.
    pub fn unlike(seconds: f64) -> Self {
        let parameters = Parameters {
            m1: 0.7,
            m2: 1.3,
            l1: 0.6,
            l2: 1.1,
            g: 9.81,
        };
        Self {
            parameters,
            start: State {
                a1: 0.3,
                a2: -0.2,
                p1: 0.1,
                p2: -0.1,
            },
            seconds,
        }
    }

    /// Returns the trial with its numbers rounded once to `f32`, if the numbers of `method` are
    /// `f32`, plain or compensated ([`Method::is_single`]). A number beyond the range of `f32`
    /// becomes infinite, and one that is too small 0. For all other methods, also in 32-bit fixed
    /// point, the trial is unchanged. The duration is never rounded.
    pub fn held_by(&self, method: Method) -> Self {
        if !method.is_single() {
            return *self;
        }
        let parameters = self.parameters.cast::<f32>();
        let start = self.start.cast::<f32>();
        Self {
            parameters: parameters.cast(),
            start: start.cast(),
            ..*self
        }
    }

    /// Returns the number of steps of `dt`, s, from one of `moments` moments to the next.
    fn steps(&self, dt: f64, moments: u32) -> u32 {
        (self.seconds / dt / f64::from(moments)).round() as u32
    }

    /// Returns the states by `method` at the [`MOMENTS`] moments, in steps of `dt`, s, with all
    /// turns. All four numbers are NaN after the motion has diverged. An error means that the
    /// kernel refuses the trial or the step, as in [`run`].
    ///
    /// The number of steps between two moments is rounded, so the moments are exact only if they
    /// fall on whole steps. If `dt` is more than twice the time between two moments, or negative,
    /// each state is the start.
    pub fn states(&self, method: Method, dt: f64) -> Result<Vec<State<f64>>, Error> {
        let mut run = run(method, &self.parameters, &self.start, dt)?;
        let steps = self.steps(dt, MOMENTS);
        let next = |_| {
            run.advance(steps)
                .map_or([f64::NAN; 4].into(), |()| run.state())
        };
        Ok((0..MOMENTS).map(next).collect())
    }

    /// Returns the states at `moments` moments, evenly spread up to the end, by RK4 in the
    /// direction form in compensated `f64`, which is not in the table, in steps of `dt`, s. The
    /// start is not among them. The number of steps between two moments is rounded as in
    /// [`Trial::states`]. 0 moments give an empty list. An error means that the kernel refuses the
    /// trial or the step, or that the motion diverges.
    pub fn states_in_f64(&self, dt: f64, moments: u32) -> Result<Vec<State<f64>>, Error> {
        let mut run = Pendulum::new(&self.parameters)?
            .run::<DirectionF64>(&self.start, dt)?
            .counting_turns();
        let steps = self.steps(dt, moments);
        (0..moments)
            .map(|_| advance(&mut run, steps).map(|()| run.state()))
            .collect()
    }

    /// Returns the exact states at the [`MOMENTS`] moments, by the reference, with all turns and
    /// rounded to `f64`. The start is not among them. An error means that the kernel refuses the
    /// parameters.
    ///
    /// Not checked: a start that is not finite gives numbers without a meaning, and an infinite
    /// duration never returns. If the duration is negative, each state is the start.
    pub fn exact(&self) -> Result<Vec<State<f64>>, Error> {
        let pendulum = Pendulum::new(&self.parameters)?;
        let at = |moment: u32| self.seconds * f64::from(moment) / f64::from(MOMENTS);
        Ok(taylor::states(
            &self.parameters,
            &pendulum.to_motion(&self.start),
            (1..=MOMENTS).map(at),
        ))
    }

    /// Returns the largest error of an angle at the [`MOMENTS`] moments, rad and at most pi, by
    /// `method` with steps of `dt`, s; infinite if the motion has diverged. Whole turns do not
    /// count. The reference is the exact motion of the rounded numbers ([`Trial::held_by`]). An
    /// error is one of [`Trial::states`].
    ///
    /// The moments must fall on whole steps, which is not checked; otherwise two different times
    /// are compared. The conditions of [`Trial::exact`] apply, too.
    pub fn error(&self, method: Method, dt: f64) -> Result<f64, Error> {
        Ok(largest_difference(
            &self.states(method, dt)?,
            &self.held_by(method).exact()?,
        ))
    }
}

/// Returns the angle between two directions, rad, from 0 to pi. `a` and `b` are angles in rad. It
/// is infinite if one of them is not finite.
pub fn apart(a: f64, b: f64) -> f64 {
    let turns = (a - b) / TAU;
    let apart = (turns - turns.round()).abs() * TAU;
    if apart.is_finite() {
        apart
    } else {
        f64::INFINITY
    }
}

/// Returns the largest difference of the angles, rad, at most pi, without whole turns. Momenta are
/// not compared. The shorter list decides the number of states. It is infinite if an angle is not
/// finite, and 0 if a list is empty.
pub fn largest_difference(states: &[State<f64>], others: &[State<f64>]) -> f64 {
    let pairs = states.iter().zip(others);
    pairs
        .flat_map(|(x, y)| [apart(x.a1, y.a1), apart(x.a2, y.a2)])
        .fold(0.0, f64::max)
}
