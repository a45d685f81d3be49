//! Trials: motions that are computed by the methods of the table and compared with the reference,
//! the exact motion to about 30 digits ([`taylor::Reference`]).

use std::f64::consts::TAU;
use std::fmt::Debug;

use crate::{advance, taylor};
use double_pendulum::parts::DirectionF64;
use double_pendulum::{
    Direction, Equations, Error, Form, FormVisitor, Method, Parameters, Pendulum, Run, State,
};
use firmware::job::visit;

/// Returns all methods whose errors depend on the step. The closed form has the error of its linear
/// equations, and `micromath` that of its sines.
pub fn exact_methods() -> impl Iterator<Item = Method> {
    let is_exact = |method: &Method| {
        method.equations() != Equations::Linear && *method != Method::Rk4F32Micromath
    };
    Method::ALL.iter().copied().filter(is_exact)
}

/// A [`Run`] that counts turns, whose method is chosen at run time, in `f64`.
pub trait CountingRun: Debug {
    fn advance(&mut self, steps: u32) -> Result<(), Error>;
    fn state(&self) -> State<f64>;
    /// Returns (sin, cos) of both angles. In the direction form in floating point they may be up to
    /// half a step ahead of the state or behind it.
    fn directions(&self) -> [Direction<f64>; 2];
    /// Returns a1 and a2 at the time of the directions.
    fn angles(&self) -> [f64; 2];
    /// Returns the energy at the time of the directions.
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

struct CountingStart<'a> {
    pendulum: Pendulum<f64>,
    state: &'a State<f64>,
    dt: f64,
}

impl FormVisitor for CountingStart<'_> {
    type Output = Result<Box<dyn CountingRun>, Error>;

    fn visit<F: Form>(self) -> Self::Output {
        let run = self.pendulum.run::<F>(self.state, self.dt)?;
        Ok(Box::new(run.counting_turns()))
    }
}

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
        CountingStart {
            pendulum,
            state,
            dt,
        },
    )
}

/// A motion to try, in SI units.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    pub parameters: Parameters<f64>,
    pub start: State<f64>,
    pub seconds: f64,
}

/// The moments of a comparison, evenly spread over the motion, without its start.
pub const MOMENTS: u32 = 16;

impl Trial {
    /// A motion from rest, with rods of 1 m, a bob 1 of 1 kg, and g = 9.81 m/s^2.
    pub fn at_rest(mass_ratio: f64, a1: f64, a2: f64, seconds: f64) -> Self {
        Self {
            parameters: Parameters::equal_rods(mass_ratio, 1.0, 9.81),
            start: State::at_rest(a1, a2),
            seconds,
        }
    }

    /// A motion from rest with both rods at 0.5 rad.
    pub fn regular(seconds: f64) -> Self {
        Self::at_rest(1.0, 0.5, 0.5, seconds)
    }

    /// A motion from rest with both rods at 2 rad. After some time rods turn over.
    pub fn chaotic(seconds: f64) -> Self {
        Self::at_rest(1.0, 2.0, 2.0, seconds)
    }

    /// A motion at small angles, in motion at the start, with unlike bobs and rods.
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

    /// Returns the trial with its numbers rounded once to `f32`, if `method` holds them in `f32`.
    /// The methods in directions form their constants and their start in `f64`.
    pub fn held_by(&self, method: Method) -> Self {
        if !method.is_single() || method.equations() == Equations::Directions {
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

    fn steps(&self, dt: f64, moments: u32) -> u32 {
        (self.seconds / dt / f64::from(moments)).round() as u32
    }

    /// Returns the states by `method` at the [`MOMENTS`] moments, which must fall on whole steps;
    /// NaN after the motion has diverged.
    pub fn states(&self, method: Method, dt: f64) -> Result<Vec<State<f64>>, Error> {
        let mut run = run(method, &self.parameters, &self.start, dt)?;
        let steps = self.steps(dt, MOMENTS);
        let next = |_| {
            run.advance(steps)
                .map_or([f64::NAN; 4].into(), |()| run.state())
        };
        Ok((0..MOMENTS).map(next).collect())
    }

    /// Returns the states by RK4 in the direction form in compensated `f64`, which is not in the
    /// table.
    pub fn states_in_f64(&self, dt: f64, moments: u32) -> Result<Vec<State<f64>>, Error> {
        let mut run = Pendulum::new(&self.parameters)?
            .run::<DirectionF64>(&self.start, dt)?
            .counting_turns();
        let steps = self.steps(dt, moments);
        (0..moments)
            .map(|_| advance(&mut run, steps).map(|()| run.state()))
            .collect()
    }

    pub fn exact(&self) -> Result<Vec<State<f64>>, Error> {
        let pendulum = Pendulum::new(&self.parameters)?;
        let at = |moment: u32| self.seconds * f64::from(moment) / f64::from(MOMENTS);
        Ok(taylor::states(
            &self.parameters,
            &pendulum.to_motion(&self.start),
            (1..=MOMENTS).map(at),
        ))
    }

    /// Returns the largest error of an angle at the [`MOMENTS`] moments, rad, without whole turns;
    /// infinite if the motion has diverged. It is compared with the exact motion of the rounded
    /// numbers ([`Trial::held_by`]).
    pub fn error(&self, method: Method, dt: f64) -> Result<f64, Error> {
        Ok(largest_difference(
            &self.states(method, dt)?,
            &self.held_by(method).exact()?,
        ))
    }
}

/// Returns the angle between two directions, rad, from 0 to pi; infinite if one is not finite.
pub fn apart(a: f64, b: f64) -> f64 {
    let turns = (a - b) / TAU;
    let apart = (turns - turns.round()).abs() * TAU;
    if apart.is_finite() {
        apart
    } else {
        f64::INFINITY
    }
}

/// Returns the largest difference of the angles, rad, without whole turns.
pub fn largest_difference(states: &[State<f64>], others: &[State<f64>]) -> f64 {
    let pairs = states.iter().zip(others);
    pairs
        .flat_map(|(x, y)| [apart(x.a1, y.a1), apart(x.a2, y.a2)])
        .fold(0.0, f64::max)
}
