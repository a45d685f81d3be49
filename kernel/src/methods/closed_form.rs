//! Small oscillations in closed form: the linear motion at any time, and as a method with steps.

use super::scaling::lost;
use super::{Advance, FormOperations};
use crate::bounds::check_step;
use crate::error::{Error, Parameter};
use crate::numbers::Real;
use crate::pendulum::{Direction, Motion, Parameters, Pendulum, State};
use crate::small::{Mode, Modes};

/// The share of one normal mode in the angle of rod 1: C cos wt + S sin wt. Its share in the angle
/// of rod 2 is this times the shape of the mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Oscillation<R> {
    cosine: R,
    sine: R,
}

impl<R: Real> Oscillation<R> {
    /// Returns the amplitude of rod 1, rad. Its squares underflow in `f32` if the shape, up to 1e18,
    /// makes it an amplitude of rod 2 of 1 rad.
    pub fn amplitude(&self) -> R {
        let [cosine, sine] = [self.cosine, self.sine].map(R::to_f64);
        R::from_f64(libm::sqrt(cosine * cosine + sine * sine))
    }

    /// Returns the phase, rad: C cos wt + S sin wt = amplitude cos(wt + phase).
    pub fn phase(&self) -> R {
        (-self.sine).atan2(self.cosine)
    }
}

/// The linear motion of a pendulum (`[math24]`, "Small oscillations").
///
/// The fast mode has the frequency w1 and the shape r1, the slow mode w2 and r2:
///
/// - a1(t) = C1 cos w1 t + S1 sin w1 t + C2 cos w2 t + S2 sin w2 t
/// - a2(t) = r1 (C1 cos w1 t + S1 sin w1 t) + r2 (C2 cos w2 t + S2 sin w2 t)
///
/// Here w1 and w2 are angular frequencies, rad/s, not the angular velocities of a [`Motion`]. C1,
/// S1, C2 and S2 are constants of the motion, rad, not the S and C of the direction form.
///
/// It is the limit of the exact motion for small angles. With equal rods of 0.25 m, equal masses,
/// and a start at rest with only rod 2 at 30 degrees, the two are 1 degree apart after 0.07 s. With
/// rod 2 at 5 degrees, bob 2 is within 0.7 mm of its exact position for 10 s (the repository's test
/// `closed_form`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmallOscillations<R> {
    /// The frequencies in turns per second; in `f32` the phase would be arbitrary after a day.
    turns: [f64; 2],
    modes: [Mode<R>; 2],
    pub(crate) fast: Oscillation<R>,
    pub(crate) slow: Oscillation<R>,
    /// True if an angle may exceed [`SMALL`].
    is_wide: bool,
}

/// The largest angle, rad, whose direction is computed by the first terms of its series.
const SMALL: f64 = 0.6;

impl<R: Real> SmallOscillations<R> {
    /// Returns the linear motion in `modes` that starts as `start`.
    ///
    /// C1 = (r2 a1 - a2)/(r2 - r1) and C2 = (a2 - r1 a1)/(r2 - r1). w1 S1 and w2 S2 follow in the
    /// same way from the angular velocities.
    ///
    /// `modes` must be those of the pendulum, which is not checked. A start that is not finite
    /// gives angles that are NaN or infinite.
    #[must_use]
    pub fn new(modes: Modes<f64>, start: &Motion<R>) -> Self {
        let turns = [modes.fast, modes.slow].map(|mode| mode.frequency / core::f64::consts::TAU);
        let modes = [modes.fast, modes.slow].map(|Mode { frequency, shape }| Mode {
            frequency: R::from_f64(frequency),
            shape: R::from_f64(shape),
        });
        let [
            Mode {
                frequency: fast,
                shape: r1,
            },
            Mode {
                frequency: slow,
                shape: r2,
            },
        ] = modes;

        let split = |x1: R, x2: R| [(r2 * x1 - x2) / (r2 - r1), (x2 - r1 * x1) / (r2 - r1)];
        let [c1, c2] = split(start.a1, start.a2);
        let [v1, v2] = split(start.w1, start.w2);
        let fast = Oscillation {
            cosine: c1,
            sine: v1 / fast,
        };
        let slow = Oscillation {
            cosine: c2,
            sine: v2 / slow,
        };

        let mut linear = Self {
            turns,
            modes,
            fast,
            slow,
            is_wide: false,
        };
        let small = R::from_f64(SMALL);
        linear.is_wide = linear.reach().map(|most| most <= small) != [true; 2];
        linear
    }

    /// Returns the amplitudes of rod 1 in the fast and in the slow mode, rad: sqrt(C1^2 + S1^2) and
    /// sqrt(C2^2 + S2^2). Those of rod 2 are these times the magnitudes of the shapes of the modes.
    #[must_use]
    pub fn amplitudes(&self) -> [R; 2] {
        [self.fast, self.slow].map(|mode| mode.amplitude())
    }

    /// Returns the phases of the fast and of the slow mode at the start, rad, in [-pi, pi]: C cos
    /// wt + S sin wt = A cos(wt + phase), where A is the [amplitude](Self::amplitudes).
    #[must_use]
    pub fn phases(&self) -> [R; 2] {
        [self.fast, self.slow].map(|mode| mode.phase())
    }

    /// Returns upper bounds of both angles, rad: the sums of the amplitudes of the modes.
    fn reach(&self) -> [R; 2] {
        let [fast, slow] = self.amplitudes();
        let [of_fast, of_slow] = self.modes.map(|mode| mode.shape.abs());
        [fast + slow, of_fast * fast + of_slow * slow]
    }

    /// Returns the angles, rad, with whole turns, and angular velocities, rad/s, of both rods at a
    /// time `t`, s, after the start, or before it if `t` is negative.
    ///
    /// The phase w t is reduced to a turn in `f64`. Its error is below 3e-16 of w t: 1e-9 rad in a
    /// day at w = 38 rad/s. All numbers are NaN if `t` is not finite or w t overflows.
    #[must_use]
    pub fn at(&self, t: f64) -> Motion<R> {
        let phases = self.sincos(t);
        let [a1, a2] = self.angles(phases);
        let ([fast, slow], [(sin_fast, cos_fast), (sin_slow, cos_slow)]) = (&self.modes, phases);

        let w_fast = fast.frequency * (self.fast.sine * cos_fast - self.fast.cosine * sin_fast);
        let w_slow = slow.frequency * (self.slow.sine * cos_slow - self.slow.cosine * sin_slow);
        Motion {
            a1,
            a2,
            w1: w_fast + w_slow,
            w2: fast.shape * w_fast + slow.shape * w_slow,
        }
    }

    /// Returns the directions of rod 1 and rod 2, (sin, cos) each, a time `t`, s, after the start.
    ///
    /// If neither angle can exceed 0.6 rad, the first terms of the series are used: sin a = a -
    /// a^3/6 and cos a = 1 - a^2/2 + a^4/24. The error is at most 7e-4, and the length 1 to within
    /// 4e-4: far less than the error of the linear motion. This costs two sincos and no division;
    /// otherwise two more sincos.
    #[must_use]
    pub fn directions(&self, t: f64) -> [Direction<R>; 2] {
        let angles = self.angles(self.sincos(t));
        if self.is_wide {
            return angles.map(|a| a.own_sin_cos().into());
        }

        angles.map(|a| {
            let square = a * a;
            let [sixth, twelfth] = [R::from_f64(1.0 / 6.0), R::from_f64(1.0 / 12.0)];
            [
                a - a * square * sixth,
                R::ONE - R::HALF * square * (R::ONE - square * twelfth),
            ]
        })
    }

    #[inline] // One function with the directions, which boards run in memory.
    fn sincos(&self, t: f64) -> [(R, R); 2] {
        let phase = |turns: f64| {
            let turns = turns * t;
            (R::from_f64(turns - libm::rint(turns)) * R::from_f64(core::f64::consts::TAU))
                .own_sin_cos()
        };
        [phase(self.turns[0]), phase(self.turns[1])]
    }

    fn angles(&self, [(sin_fast, cos_fast), (sin_slow, cos_slow)]: [(R, R); 2]) -> [R; 2] {
        let a_fast = self.fast.cosine * cos_fast + self.fast.sine * sin_fast;
        let a_slow = self.slow.cosine * cos_slow + self.slow.sine * sin_slow;
        let [fast, slow] = self.modes;
        [a_fast + a_slow, fast.shape * a_fast + slow.shape * a_slow]
    }
}

/// A motion by the closed form: the [`SmallOscillations`] of a pendulum, computed at the time of
/// each step.
///
/// There is no longest step, but a time at which w t overflows counts as diverged. The angles of
/// the state include whole turns. Its momenta follow from the linear angles and angular velocities
/// by [`Pendulum::to_state`], so that its energy H, unlike the energy of the linear equations, is
/// not constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosedForm<R> {
    parameters: Parameters<f64>,
    /// The number of steps per second. If it is whole, the times of whole seconds are exact.
    rate: f64,
    pendulum: Pendulum<R>,
    pub(crate) oscillations: SmallOscillations<R>,
    directions: [Direction<R>; 2],
    steps: u64,
}

impl<R: Real> ClosedForm<R> {
    fn time(&self) -> f64 {
        self.steps as f64 / self.rate
    }
}

impl<R: Real> Advance for ClosedForm<R> {
    fn has_turns(&self) -> bool {
        true
    }

    fn started(&self, start: &State<f64>) -> Result<Self, Error> {
        start.check()?;
        let motion = Pendulum::new(&self.parameters)?.to_motion(start);
        let modes = Modes::new(&self.parameters)?;
        let oscillations = SmallOscillations::new(modes, &motion.cast());
        let started = Self {
            oscillations,
            directions: oscillations.directions(0.0),
            steps: 0,
            ..*self
        };

        let most_turns = R::from_f64(f64::from(i32::MAX) * core::f64::consts::TAU);
        let has_turns = oscillations.reach().map(|most| most <= most_turns) == [true; 2];
        if has_turns && started.check().is_ok() {
            return Ok(started);
        }

        // Name a number that is infinite in `R`, otherwise the one that leads to the largest angle.
        start.cast::<R>().check()?;
        let slow = modes.slow.frequency;
        let mut worst = (Parameter::A1, motion.a1, 1.0);
        let angle = |(_, value, rate): (Parameter, f64, f64)| libm::fabs(value) / rate;
        for number in [
            (Parameter::A2, motion.a2, 1.0),
            (Parameter::W1, motion.w1, slow),
            (Parameter::W2, motion.w2, slow),
        ] {
            if angle(number) > angle(worst) {
                worst = number;
            }
        }
        let (parameter, value, _) = worst;
        Err(Error::OutOfRange { parameter, value })
    }

    fn advance(&mut self, steps: u32) {
        for _ in 0..steps {
            self.steps += 1;
            self.directions = self.oscillations.directions(self.time());
        }
    }

    fn check(&self) -> Result<(), Error> {
        lost(
            !self
                .directions
                .iter()
                .flatten()
                .all(|part| part.is_finite()),
        )?;
        self.state().check().map_err(Error::diverged)
    }

    fn sides(&self) -> [[i32; 2]; 2] {
        self.directions.map(|direction| direction.map(R::side))
    }

    fn directions<Q: Real>(&self) -> [Direction<Q>; 2] {
        self.directions.map(|direction| direction.map(R::cast))
    }

    fn momenta<Q: Real>(&self) -> [Q; 2] {
        let State { p1, p2, .. } = self.state();
        [Q::from_f64(p1), Q::from_f64(p2)]
    }

    fn energy_above_rest(&self, pendulum: &Pendulum<f64>) -> f64 {
        pendulum.energy_above_rest(&self.state())
    }

    fn state(&self) -> State<f64> {
        self.pendulum
            .to_state(&self.oscillations.at(self.time()))
            .cast()
    }
}

impl<R: Real> FormOperations for ClosedForm<R> {
    type Real = R;
    const STABLE: f64 = f64::INFINITY;
    const CHECKS_ENERGY: bool = true; // The linear motion keeps its own energy.

    fn new(parameters: &Parameters<f64>, start: &State<f64>, dt: f64) -> Result<Self, Error> {
        check_step::<f64>(dt)?;
        let oscillations = SmallOscillations::new(Modes::new(parameters)?, &Motion::default());

        let whole = libm::rint(1.0 / dt);
        let rate = if 1.0 / whole == dt { whole } else { 1.0 / dt };

        let pendulum = Pendulum::new(&parameters.cast())?;
        let directions = oscillations.directions(0.0);
        Self {
            parameters: *parameters,
            rate,
            pendulum,
            oscillations,
            directions,
            steps: 0,
        }
        .started(start)
    }

    fn side_value(side: i32) -> R {
        R::from_side(side)
    }

    fn bits(&self, mut feed: impl FnMut(u64)) {
        self.directions
            .iter()
            .flatten()
            .for_each(|x| feed(x.bits()));
        feed(self.steps);
    }
}
