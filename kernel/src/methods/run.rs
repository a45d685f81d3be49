//! A motion under way: checked, and its turns counted.

use super::{Fixed32, Form};
use crate::bounds::stable_step;
use crate::error::{Error, Parameter};
use crate::numbers::Real;
use crate::pendulum::{Direction, Parameters, Pendulum, State};

/// A motion by the method that `F` is: made by [`Pendulum::run`].
///
/// A few hundred bytes, all it needs. A step must not turn a rod by more than a quarter turn, or turns are miscounted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run<F: Form> {
    pendulum: Pendulum<F::Real>,
    /// The energy H, J, above which the motion counts as diverged; unused if `F` checks its energy.
    most_energy: F::Real,
    motion: F,
    turns: [Turns; 2],
    dt: f64,
    steps: u64,
}

impl<R: Real> Pendulum<R> {
    /// The motion from `start` in steps of `dt` seconds by the method that `F` is; a negative step runs backwards.
    ///
    /// Only that method is linked. Refuses a step that is NaN, infinite, zero or subnormal, a start that is not finite, one of
    /// more than 2^31 turns where directions are carried, and what is out of the range of the method's numbers.
    ///
    /// Refuses a step beyond the method's limit of stability on the fast mode, w1 dt = 2.83 for RK4
    /// ([`check_step`](Self::check_step)). Extrapolation of the orders 2, 4 .. 16 is stable, or lets the mode grow by less
    /// than a tenth in a step, up to w1 dt = 0.95, 2.86, 2.51, 3.67, 5.28, 4.77, 6.37 and 7.35. A faster motion may need far
    /// shorter steps: [`admissible_step`](Self::admissible_step) resolves every motion of an energy.
    pub fn run<F: Form>(&self, start: &State<R>, dt: f64) -> Result<Run<F>, Error> {
        let parameters = self.parameters().cast();
        let motion: F = start_within(&parameters, &start.cast(), dt)?;
        let angles = if F::HAS_TURNS {
            [0.0; 2]
        } else {
            start.angles().map(R::to_f64)
        };
        let turns = Turns::of(angles, motion.sides())?;
        let pendulum = Pendulum::new(&parameters.cast())?;
        let most_energy = if F::CHECKS_ENERGY {
            F::Real::ZERO
        } else {
            let energy = Pendulum::new(&parameters)?.energy_above_rest(&start.cast());
            F::Real::from_f64(ENERGY_GROWTH * energy)
        };
        Ok(Run {
            pendulum,
            most_energy,
            motion,
            turns,
            dt,
            steps: 0,
        })
    }
}

/// Prepares the motion; refuses a step beyond the method's limit of stability, or of its numbers.
fn start_within<F: Form>(
    parameters: &Parameters<f64>,
    start: &State<f64>,
    dt: f64,
) -> Result<F, Error> {
    let stable = stable_step(parameters, F::STABLE);
    let too_large = |limit: f64| Error::TooLarge {
        parameter: Parameter::Dt,
        value: dt,
        limit: libm::fmin(limit, stable),
    };
    match F::new(parameters, start, dt) {
        Ok(_) if libm::fabs(dt) > stable => Err(too_large(stable)),
        Err(Error::TooLarge {
            parameter: Parameter::Dt,
            limit,
            ..
        }) => Err(too_large(limit)),
        started => started,
    }
}

/// The energy H at which a motion counts as diverged, in energies above rest of its start.
///
/// Measured from rest, that is a hundred times the energy of the start and, on top, what lifts both
/// bobs by the length of their rods.
const ENERGY_GROWTH: f64 = 100.0;

impl<F: Form> Run<F> {
    /// Makes `steps` steps, or none: [`Error::Diverged`] if they led out of the finite numbers, and the run stays as it was.
    /// How steps are dealt out to calls makes no difference to any bit.
    ///
    /// Also refuses an energy far above that of the start, because a step was too long for the motion. The energy above rest
    /// is at most 100 times that of the start, and (m1 + m2) g l1 + m2 g l2 more; [`Fixed32`] allows 9/8 of that of the start
    /// and what rounding may add. Refuses directions shorter than 1/2 or longer than 2. Energy and lengths are checked once at
    /// the end of each call, not after every step.
    pub fn advance(&mut self, steps: u32) -> Result<(), Error> {
        let Self {
            mut motion,
            mut turns,
            ..
        } = *self;
        if F::HAS_TURNS {
            motion.advance(steps);
        } else {
            for _ in 0..steps {
                motion.advance(1);
                Turns::observe(&mut turns, motion.sides());
            }
        }
        motion.check()?;
        if !F::CHECKS_ENERGY {
            self.check_energy(&motion)?;
        }
        (self.motion, self.turns) = (motion, turns);
        self.steps += u64::from(steps);
        Ok(())
    }

    /// Refuses directions that are far too short or too long, and an energy that is far too large.
    #[inline(never)] // never inlined, because it is called once for many steps
    fn check_energy(&self, motion: &F) -> Result<(), Error> {
        let directions = motion.directions();
        let [shortest, longest] = [0.25, 4.0].map(F::Real::from_f64);
        for (parameter, [s, c]) in [Parameter::A1, Parameter::A2].into_iter().zip(directions) {
            let square = s * s + c * c;
            if !(shortest..=longest).contains(&square) {
                let value = square.sqrt().to_f64();
                return Err(Error::Diverged { parameter, value });
            }
        }

        let energy = self.pendulum.energy_at(directions, motion.momenta());
        let is_bounded = energy <= self.most_energy; // false if it is NaN
        if self.most_energy.is_finite() && !is_bounded {
            return Err(Error::Diverged {
                parameter: Parameter::Energy,
                value: energy.to_f64(),
            });
        }
        Ok(())
    }

    /// Where the rods point, (sin, cos) each: all that a drawing needs. Up to half a step ahead of the [`state`](Self::state).
    #[must_use]
    pub fn directions(&self) -> [Direction<F::Real>; 2] {
        self.motion.directions()
    }

    /// Both angles with all their turns, rad, when the rods point to the [`directions`](Self::directions); by an arc tangent.
    #[must_use]
    pub fn angles(&self) -> [F::Real; 2] {
        if F::HAS_TURNS {
            return self.state().cast().angles();
        }
        let [direction1, direction2] = self.directions();
        let [turns1, turns2] = &self.turns;
        [turns1.angle(direction1), turns2.angle(direction2)]
    }

    /// The canonical state in SI units, to the last digit carried, the angles with all their turns.
    ///
    /// Of the number of steps times dt, even where the motion carried is ahead of that ([`Form`]). It is taken back, which
    /// alters the energy by 1e-4 of itself at most where the fastest frequency times dt is 0.2 or less (asserted over a day).
    #[must_use]
    pub fn state(&self) -> State<f64> {
        let state = self.motion.state();
        if F::HAS_TURNS {
            state
        } else {
            Turns::unwrap(&self.turns, state)
        }
    }

    /// The energy H, J, when the rods point to the [`directions`](Self::directions) ([`Pendulum::energy`]).
    #[must_use]
    pub fn energy(&self) -> F::Real {
        self.pendulum
            .energy_at(self.directions(), self.motion.momenta())
    }

    /// Gives `feed` the bit patterns of all that the method carries from step to step.
    pub(crate) fn bits(&self, feed: impl FnMut(u64)) {
        self.motion.bits(feed);
    }

    /// Seconds since the start.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.steps as f64 * self.dt
    }
}

impl Run<Fixed32> {
    /// Where the rods point, (sin, cos) each times 2^30: by integers alone, to 2^-27.
    ///
    /// Steps are made of integers, too: no soft float is linked into such a loop.
    #[must_use]
    pub fn directions_q30(&self) -> [Direction<i32>; 2] {
        self.motion.q30()
    }
}

/// Returns a negative number if the sine, before and after, has changed its sign and the cosine is
/// negative.
#[inline(always)]
pub(crate) fn turns_over([from, to, cos]: [i32; 3]) -> i32 {
    (from ^ to) & cos
}

/// Counts how often a direction passes straight up, by the signs of its sine and cosine.
///
/// To be shown them at least once every quarter turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turns {
    whole: i32,
    last: [i32; 2],
}

impl Turns {
    /// For angles of `start` rad, whose directions have these signs. Refuses more turns than can be counted.
    #[inline(never)] // never inlined, to avoid a second copy
    pub fn of(start: [f64; 2], now: [[i32; 2]; 2]) -> Result<[Self; 2], Error> {
        let mut turns = start.map(|angle| {
            let whole = libm::rint(angle / core::f64::consts::TAU);
            let rest = angle - whole * core::f64::consts::TAU;
            Self {
                whole: whole as i32,
                last: [-i32::from(rest < 0.0), -1],
            }
        });
        for ((parameter, value), turns) in [Parameter::A1, Parameter::A2]
            .into_iter()
            .zip(start)
            .zip(&turns)
        {
            if turns.whole.unsigned_abs() >= i32::MAX as u32 {
                return Err(Error::OutOfRange { parameter, value });
            }
        }
        Self::observe(&mut turns, now);
        Ok(turns)
    }

    /// Takes note of the signs that the directions have now.
    #[inline]
    pub fn observe(both: &mut [Self; 2], now: [[i32; 2]; 2]) {
        for (turns, now) in both.iter_mut().zip(now) {
            if turns_over([turns.last[0], now[0], turns.last[1] & now[1]]) < 0 {
                turns.whole = turns.whole.wrapping_add(if now[0] < 0 { 1 } else { -1 });
            }
            turns.last = now;
        }
    }

    /// The angle with its turns, rad, of the direction last observed.
    #[inline(never)] // never inlined, to avoid a second copy
    pub fn angle<R: Real>(&self, [s, c]: Direction<R>) -> R {
        R::from_f64(f64::from(self.whole) * core::f64::consts::TAU) + s.atan2(c)
    }

    /// `state`, whose angles are known but for whole turns, with as many turns on as bring each nearest to the last direction.
    ///
    /// No trigonometry: a quarter turn to the side of that is within half a turn of it, near enough.
    #[inline(never)] // never inlined, to avoid a second copy
    #[must_use]
    pub fn unwrap([turns1, turns2]: &[Self; 2], state: State<f64>) -> State<f64> {
        use core::f64::consts::{FRAC_PI_2, TAU};
        let unwrapped = |turns: &Self, angle: f64| {
            let side = if turns.last[0] < 0 {
                -FRAC_PI_2
            } else {
                FRAC_PI_2
            };
            let near = f64::from(turns.whole) * TAU + side;
            angle + TAU * libm::rint((near - angle) / TAU)
        };
        State {
            a1: unwrapped(turns1, state.a1),
            a2: unwrapped(turns2, state.a2),
            ..state
        }
    }
}
