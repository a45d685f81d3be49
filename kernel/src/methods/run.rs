//! A motion under way: checked, and its turns counted.

use super::{Fixed32, Form, Turns};
use crate::error::Error;
use crate::numbers::Real;
use crate::pendulum::{Direction, Pendulum, State};

/// A motion by the method that `F` is: made by [`Pendulum::run`].
///
/// A few hundred bytes, all it needs. A step must not turn a rod by more than a quarter turn, or turns are miscounted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run<F: Form> {
    pendulum: Pendulum<F::Real>,
    motion: F,
    turns: [Turns; 2],
    dt: f64,
    steps: u64,
}

impl<R: Real> Pendulum<R> {
    /// The motion from `start` in steps of `dt` seconds by the method that `F` is; a negative step runs backwards.
    ///
    /// Only that method is linked. Refuses a step that is NaN, infinite, zero or subnormal, a start that is not finite, and
    /// what is out of the range of the method's numbers. Not a step that is too long for RK4, because that depends on the
    /// motion: ask [`check_step`](Self::check_step) for what no motion survives and
    /// [`admissible_step`](Self::admissible_step) for what resolves every motion of an energy.
    pub fn run<F: Form>(&self, start: &State<R>, dt: f64) -> Result<Run<F>, Error> {
        let parameters = self.parameters().cast();
        let motion = F::new(&parameters, &start.cast(), dt)?;
        let turns = Turns::of(start.angles().map(R::to_f64), motion.sides());
        Ok(Run { pendulum: Pendulum::new(&parameters.cast())?, motion, turns, dt, steps: 0 })
    }
}

impl<F: Form> Run<F> {
    /// Makes `steps` steps, or none: [`Error::Diverged`] if they led out of the finite numbers, and the run stays as it was.
    /// How steps are dealt out to calls makes no difference to any bit.
    pub fn advance(&mut self, steps: u32) -> Result<(), Error> {
        let Self { mut motion, mut turns, .. } = *self;
        for _ in 0..steps {
            motion.advance(1);
            if !F::HAS_TURNS {
                Turns::observe(&mut turns, motion.sides());
            }
        }
        motion.check()?;
        (self.motion, self.turns) = (motion, turns);
        self.steps += u64::from(steps);
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
        if F::HAS_TURNS { state } else { Turns::unwrap(&self.turns, state) }
    }

    /// The energy H, J, when the rods point to the [`directions`](Self::directions) ([`Pendulum::energy`]).
    #[must_use]
    pub fn energy(&self) -> F::Real {
        self.pendulum.energy_at(self.directions(), self.motion.momenta())
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
