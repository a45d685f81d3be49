//! A motion carried out as a plan has it.

use super::cost::{Costs, ORDER};
use super::run::Directions;
use crate::error::Error;
use crate::form::{DirectionForm, Fixed32Form, Fixed64Form, Form, Plain, Stepper, UnwrappedStepper};
use crate::hamiltonian::Pendulum;
use crate::method::Method;
use crate::modes::Modes;
use crate::params::Parameters;
use crate::real::Real;
use crate::small_oscillations::SmallOscillations;
use crate::state::{Motion, State};

/// How a motion is computed: a method, and how fine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Way {
    /// The method.
    pub method: Method,
    /// Steps to a frame; of no meaning to the closed form, which has none.
    pub steps: u32,
}

/// A motion, frame by frame, in the way that was chosen for it: to the bit what the search looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WayStepper {
    way: Way,
    rate: u16,
    /// Frames since the start.
    frame: u64,
    motion: Carried,
}

#[expect(clippy::large_enum_variant, reason = "without a heap there is nowhere else to keep it")]
#[derive(Clone, Copy, Debug, PartialEq)]
enum Carried {
    ClosedForm(SmallOscillations<f32>, Pendulum<f32>),
    DirectionPlain(UnwrappedStepper<f32, DirectionForm<f32, Plain>>),
    Direction(UnwrappedStepper<f32, DirectionForm<f32>>),
    Fixed32(UnwrappedStepper<f32, Fixed32Form>),
    /// Read in `f32`: in `f64` that would take as long as a fifth of a step.
    Fixed64(UnwrappedStepper<f32, Fixed64Form<ORDER>>),
}

/// At so many admissible steps or less in one, the roundings of [`Method::Extrapolation10Fixed64`] are what ends its horizon, not its steps.
pub(super) const RESOLVING: f64 = 2.1;

/// The first step looked at is no longer than this many admissible ones: the fastest rate that the energy allows turns a
/// radian in it. In longer steps two runs could miss alike what neither sees.
pub(super) const FIRST_STEP: f64 = 4.0;

/// Finer steps than this many to a frame are never tried.
pub(super) const MOST_STEPS: u32 = 1 << 16;

/// The fewest steps by `method` to a frame, of which there are `rate` in a second, that are no longer than `longest` s; in 32
/// bits a power of two, as the steps that refine them.
#[inline(never)] // once in flash
pub(super) fn steps_to_frame(method: Method, rate: u16, longest: f64) -> u32 {
    let fewest = libm::ceil(1.0 / (longest * f64::from(rate)));
    let fewest = (fewest as u32).clamp(1, MOST_STEPS);
    if method == Method::Extrapolation10Fixed64 { fewest } else { fewest.next_power_of_two() }
}

/// Angles and momenta of `start`, and the longest step that resolves every motion of its energy, s.
///
/// Refuses what [`Pendulum::new`] and [`Pendulum::admissible_step`] refuse.
#[inline(never)] // once in flash
pub(super) fn start_and_step(parameters: &Parameters<f64>, start: &Motion<f64>) -> Result<(State<f64>, f64), Error> {
    let pendulum = Pendulum::new(*parameters)?;
    let state = pendulum.to_state(start);
    Ok((state, pendulum.admissible_step(&state)?))
}

impl Way {
    /// The way that a motion may be shown in while nothing is known of it but its energy: by [`Method::Extrapolation10Fixed64`] where
    /// `frame`, which a frame may cost, allows for it, in steps that resolve all there may be or, if those cost too much, the
    /// longest that are looked at; else by such steps in 32 bits, or as many as can be had.
    ///
    /// Refuses what [`Pendulum::new`] and [`Pendulum::admissible_step`] refuse.
    pub fn lasting(
        parameters: &Parameters<f64>,
        start: &Motion<f64>,
        rate: u16,
        costs: &Costs,
        frame: f32,
    ) -> Result<Self, Error> {
        let (_, admissible) = start_and_step(parameters, start)?;
        for longest in [RESOLVING, FIRST_STEP] {
            if let Some(way) = Self::fixed64(parameters, start, rate, longest * admissible, costs, frame) {
                return Ok(way);
            }
        }
        let affordable = |method| {
            let mut steps = steps_to_frame(method, rate, FIRST_STEP * admissible);
            while steps > 1 && costs.of_frame(method, steps) > frame {
                steps /= 2;
            }
            Self { method, steps }
        };
        let fixed = affordable(Method::Rk4Fixed32);
        let is_fixed = costs.fixed32 < costs.direction && fixed.takes(parameters, start, rate);
        Ok(if is_fixed { fixed } else { affordable(Method::Rk4F32Direction) })
    }

    /// By `method`, in the longest steps that resolve every motion of this energy.
    ///
    /// Refuses what [`lasting`](Self::lasting) refuses.
    pub fn of(parameters: &Parameters<f64>, start: &Motion<f64>, rate: u16, method: Method) -> Result<Self, Error> {
        let (_, admissible) = start_and_step(parameters, start)?;
        let longest = if method == Method::Extrapolation10Fixed64 { RESOLVING } else { FIRST_STEP };
        Ok(Self { method, steps: steps_to_frame(method, rate, longest * admissible) })
    }

    /// By [`Method::Extrapolation10Fixed64`] in steps of `longest` s or less, as coarse as its numbers take, if they cost no more than `frame`.
    pub(super) fn fixed64(
        parameters: &Parameters<f64>,
        start: &Motion<f64>,
        rate: u16,
        longest: f64,
        costs: &Costs,
        frame: f32,
    ) -> Option<Self> {
        let mut way = Self {
            method: Method::Extrapolation10Fixed64,
            steps: steps_to_frame(Method::Extrapolation10Fixed64, rate, longest),
        };
        while costs.of_frame(way.method, way.steps) <= frame && way.steps < MOST_STEPS {
            if way.takes(parameters, start, rate) {
                return Some(way);
            }
            way.steps *= 2;
        }
        None
    }

    /// Whether a motion can be started in this way.
    ///
    /// Never inlined: the motion stands on the stack.
    #[inline(never)]
    pub(super) fn takes(self, parameters: &Parameters<f64>, start: &Motion<f64>, rate: u16) -> bool {
        WayStepper::new(parameters, start, rate, self).is_ok()
    }
}

impl WayStepper {
    /// At `start`, with `rate` frames to a second. No steps count as one.
    ///
    /// Refuses what [`Form::new`] and [`Form::start`] refuse, what has no normal modes if the way is the closed form, and a method
    /// that is none of [`Method::DRAWN`].
    #[inline(never)] // once in flash
    pub fn new(parameters: &Parameters<f64>, start: &Motion<f64>, rate: u16, way: Way) -> Result<Self, Error> {
        start.check()?;
        let steps = if way.steps > 0 { way.steps } else { 1 };
        let state = Pendulum::new(*parameters)?.to_state(start);
        let dt = 1.0 / (f64::from(rate) * f64::from(steps));
        let motion = match way.method {
            Method::ClosedFormF32 => {
                let motion = SmallOscillations::new(Modes::new(parameters)?, &start.cast());
                Carried::ClosedForm(motion, Pendulum::new(parameters.cast())?)
            }
            Method::Rk4F32DirectionPlain => Carried::DirectionPlain(stepper(parameters, &state, dt)?),
            Method::Rk4F32Direction => Carried::Direction(stepper(parameters, &state, dt)?),
            Method::Rk4Fixed32 => Carried::Fixed32(stepper(parameters, &state, dt)?),
            Method::Extrapolation10Fixed64 => {
                let motion = Stepper::<f64, Fixed64Form<ORDER>>::new(parameters, &state, dt)?;
                Carried::Fixed64(UnwrappedStepper::of(motion.read_in(), state.cast().angles()))
            }
            method => return Err(Error::NotDrawn { method }),
        };
        let steps = if way.method == Method::ClosedFormF32 { 1 } else { steps };
        Ok(Self { way: Way { steps, ..way }, rate, frame: 0, motion })
    }

    /// The way it goes.
    #[must_use]
    pub fn way(&self) -> Way {
        self.way
    }

    /// Moves on by a frame.
    #[inline(never)] // once in flash
    pub fn advance(&mut self) {
        self.frame += 1;
        let steps = self.way.steps;
        match &mut self.motion {
            Carried::ClosedForm(..) => {}
            Carried::DirectionPlain(motion) => motion.advance(steps),
            Carried::Direction(motion) => motion.advance(steps),
            Carried::Fixed32(motion) => motion.advance(steps),
            Carried::Fixed64(motion) => motion.advance(steps),
        }
    }

    /// Frames since the start.
    #[must_use]
    pub fn frame(&self) -> u64 {
        self.frame
    }

    /// Seconds since the start.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.frame as f64 / f64::from(self.rate)
    }

    /// Where the rods point, (sin, cos) each.
    #[must_use]
    #[inline(never)] // once in flash
    pub fn directions(&self) -> Directions {
        match &self.motion {
            Carried::ClosedForm(motion, _) => motion.directions(self.time()),
            Carried::DirectionPlain(motion) => motion.directions(),
            Carried::Direction(motion) => motion.directions(),
            Carried::Fixed32(motion) => motion.directions(),
            Carried::Fixed64(motion) => motion.directions(),
        }
    }

    /// The canonical state in SI units when the rods point to the [`directions`](Self::directions), rounded to `f32`, the angles
    /// with all their turns: what a picture needs.
    #[must_use]
    #[inline(never)] // once in flash
    pub fn rounded_state(&self) -> State<f32> {
        match &self.motion {
            Carried::ClosedForm(motion, pendulum) => pendulum.to_state(&motion.at(self.time())),
            Carried::DirectionPlain(motion) => motion.rounded_state(),
            Carried::Direction(motion) => motion.rounded_state(),
            Carried::Fixed32(motion) => motion.rounded_state(),
            Carried::Fixed64(motion) => motion.rounded_state(),
        }
    }

    /// The canonical state in SI units to the last digit carried, the angles with all their turns.
    #[must_use]
    #[inline(never)] // once in flash
    pub fn state(&self) -> State<f64> {
        match &self.motion {
            Carried::ClosedForm(motion, pendulum) => pendulum.to_state(&motion.at(self.time())).cast(),
            Carried::DirectionPlain(motion) => motion.state(),
            Carried::Direction(motion) => motion.state(),
            Carried::Fixed32(motion) => motion.state(),
            Carried::Fixed64(motion) => motion.state(),
        }
    }
}

/// Never inlined: each kind's preparations would stand side by side on the stack.
#[inline(never)]
fn stepper<R: Real, F: Form<R>>(
    parameters: &Parameters<f64>,
    state: &State<f64>,
    dt: f64,
) -> Result<UnwrappedStepper<R, F>, Error> {
    UnwrappedStepper::new(&parameters.cast(), &state.cast(), dt)
}
