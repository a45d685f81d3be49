//! Extrapolation in the direction form, in `f64`: the motion to almost the last digit of an `f64`.
//!
//! The unit of time of the [direction form](crate::methods::direction) is a whole step, so that the
//! slope that a row of n substeps adds is the change over 2 h = 2/n.
//!
//! The [rows](crate::methods::extrapolation) of a step do not depend on each other. Four of them
//! are computed side by side, in the vectors of processors that have them. The ends are added in
//! the order of their completion, which is the same on every machine.

use crate::error::Error;
use crate::methods::direction::{Coefficients, Scale, Sums, changes, directions, prepare, rates};
use crate::methods::extrapolation::{Extrapolation, ROWS, is_order, stable};
use crate::methods::{Advance, FormOperations};
use crate::numbers::{Lanes, Real, RealOperations};
use crate::pendulum::{Direction, Parameters, State};

/// Two vectors of SSE2 hide each other's latency.
const LANES: usize = 4;

type Numbers = Lanes<f64, LANES>;

/// A motion in the direction form, stepped by [`Extrapolation`] of order `ORDER`, 2, 4 .. 16, in
/// `f64`. Another order does not compile.
///
/// The sums of the state are compensated, and the lengths of the directions restored after every
/// step. Angles are within [-pi, pi]; [`Run`](crate::Run) counts the turns on request.
/// [`Pendulum::run`](crate::Pendulum::run) lists the longest steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExtrapolationF64<const ORDER: u32> {
    coefficients: Coefficients<f64>,
    scale: Scale,
    method: Extrapolation<f64>,
    sums: Sums<f64, true>,
    inverse: f64,
    steps: u64,
}

/// The work of a lane.
#[derive(Clone, Copy, PartialEq)]
enum Work {
    /// The slope at the start of the step.
    FirstSlope,
    Row(usize),
    Done,
}

impl Work {
    fn slopes(self) -> usize {
        match self {
            Work::FirstSlope => 1,
            Work::Row(row) => 2 * row + 1,
            Work::Done => usize::MAX,
        }
    }
}

/// The constants for the rows that the lanes compute.
struct Pace {
    share: Numbers,
    gravity: [Numbers; 2],
}

impl<const ORDER: u32> ExtrapolationF64<ORDER> {
    fn step(&mut self) {
        let change = self.change();
        for (i, change) in change.into_iter().enumerate() {
            self.sums.add(i, change);
        }
        self.sums.restore_lengths(&self.coefficients);
    }

    fn change(&self) -> [f64; 6] {
        let (shares, weights, _) = self.method.parts();
        let mut first = [0.0; 6];
        let mut sum = [0.0; 6];
        let mut reference = [0.0; 6];
        let mut is_first_end = true;

        let mut work = [Work::FirstSlope; LANES];
        let mut taken = [0; LANES];
        let mut left = [1; LANES];

        // The last midpoint of each lane and the one before, as changes from the start of the step.
        let mut even = [Numbers::splat(0.0); 6];
        let mut odd = even;
        let mut before = &mut even;
        let mut last = &mut odd;

        let mut pace = self.pace([0; LANES]);
        while work.iter().any(|&work| work != Work::Done) {
            // Advance all lanes until the first of them is done with its work.
            let slopes = left.iter().fold(usize::MAX, |least, &left| least.min(left));
            for _ in 0..slopes {
                let slope = self.slope(&pace, last);
                for i in 0..6 {
                    before[i] = before[i] + slope[i];
                }
                core::mem::swap(&mut before, &mut last);
            }

            for lane in 0..LANES {
                left[lane] -= slopes;
                if left[lane] > 0 {
                    continue;
                }

                // Use the result, and take the next row.
                let end: [f64; 6] = core::array::from_fn(|i| last[i].0[lane]);
                match work[lane] {
                    Work::FirstSlope => first = end,
                    Work::Done => {}
                    Work::Row(_) if is_first_end => {
                        is_first_end = false;
                        sum = end;
                        reference = end;
                    }
                    // All weights sum to 1, so that the small differences from the first end can be
                    // weighted instead of the ends themselves.
                    Work::Row(row) => {
                        for i in 0..6 {
                            sum[i] += (end[i] - reference[i]) * weights[row % ROWS];
                        }
                    }
                }

                work[lane] = self.next_work(lane, taken[lane]);
                taken[lane] += 1;
                left[lane] = work[lane].slopes();
                if let Work::Row(row) = work[lane] {
                    for i in 0..6 {
                        before[i].0[lane] = 0.0;
                        last[i].0[lane] = 0.5 * (first[i] * shares[row % ROWS]);
                    }
                }
            }
            pace = self.pace(work.map(|work| match work {
                Work::Row(row) => row,
                Work::FirstSlope | Work::Done => 0,
            }));
        }
        sum
    }

    /// Returns the next row of a lane. Long rows come first. The lanes take them in alternating
    /// directions, so that all end at about the same time.
    fn next_work(&self, lane: usize, taken: usize) -> Work {
        let (_, _, rows) = self.method.parts();
        let place = if taken % 2 == 0 {
            lane
        } else {
            LANES - 1 - lane
        };
        match rows.checked_sub(1 + taken * LANES + place) {
            Some(row) => Work::Row(row),
            None => Work::Done,
        }
    }

    fn pace(&self, rows: [usize; LANES]) -> Pace {
        let (shares, _, _) = self.method.parts();
        let share = Lanes(rows.map(|row| shares[row % ROWS]));
        Pace {
            share,
            gravity: self
                .coefficients
                .gravity
                .map(|gravity| Numbers::splat(gravity) * share),
        }
    }

    fn slope(&self, pace: &Pace, change: &[Numbers; 6]) -> [Numbers; 6] {
        let start = &self.sums.z;
        let z: [Numbers; 6] = core::array::from_fn(|i| Numbers::splat(start[i]) + change[i]);
        let r = Lanes(z[2].0.map(|s| self.coefficients.inverse_at(s)));
        changes(&z, rates(pace.gravity, pace.share, &z, r))
    }

    fn rates(&self, z: &[f64; 6]) -> [f64; 6] {
        let r = self.coefficients.inverse_at(z[2]);
        changes(z, rates(self.coefficients.gravity, 1.0, z, r))
    }
}

impl<const ORDER: u32> Advance for ExtrapolationF64<ORDER> {
    fn started(&self, start: &State<f64>) -> Result<Self, Error> {
        let sums = Sums::at(&self.coefficients, &self.scale, start)?;
        Ok(Self {
            sums,
            inverse: self.coefficients.inverse_at(sums.z[2]),
            steps: 0,
            ..*self
        })
    }

    #[inline(never)] // Users without optimisation share the optimised function.
    fn advance(&mut self, steps: u32) {
        for _ in 0..steps {
            self.step();
        }
        self.inverse = self.coefficients.inverse_at(self.sums.z[2]);
        self.steps += u64::from(steps);
    }

    fn check(&self) -> Result<(), Error> {
        self.sums.check(&self.coefficients, self.momenta())
    }

    fn sides(&self) -> [[i32; 2]; 2] {
        self.sums.sides()
    }

    fn directions<Q: Real>(&self) -> [Direction<Q>; 2] {
        directions(&self.sums.z, self.coefficients.norm).map(|direction| direction.map(f64::cast))
    }

    fn momenta<Q: Real>(&self) -> [Q; 2] {
        let [.., p1, p2] = self.sums.z;
        [p1, p2].map(|p| (p / self.scale.momentum).cast())
    }

    fn state(&self) -> State<f64> {
        self.scale
            .state(&|z| self.rates(z), &self.sums.z, self.sums.lost, self.steps)
    }
}

impl<const ORDER: u32> FormOperations for ExtrapolationF64<ORDER> {
    type Real = f64;
    const STABLE: f64 = stable(ORDER);

    fn new(parameters: &Parameters<f64>, start: &State<f64>, dt: f64) -> Result<Self, Error> {
        const { assert!(is_order(ORDER), "the order is 2, 4 .. 16") }
        let (coefficients, scale) = prepare(parameters, dt, 1.0)?;
        let motion = Self {
            coefficients,
            scale,
            method: Extrapolation::new(ORDER)?,
            sums: Sums::ZERO,
            inverse: 0.0,
            steps: 0,
        };
        motion.started(start)
    }

    fn side_value(side: i32) -> f64 {
        f64::from_side(side)
    }

    fn bits(&self, mut feed: impl FnMut(u64)) {
        self.sums.z.iter().for_each(|z| feed(z.to_bits()));
        self.sums.lost.iter().for_each(|lost| feed(lost.to_bits()));
        feed(self.inverse.to_bits());
        feed(self.steps);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Parameter;

    const PARAMETERS: Parameters<f64> = Parameters {
        m1: 1.0,
        m2: 2.0,
        l1: 1.0,
        l2: 0.7,
        g: 9.81,
    };
    const START: State<f64> = State {
        a1: 0.5,
        a2: 1.3,
        p1: 2.0,
        p2: -1.0,
    };

    #[test]
    fn momentum_that_overflows_in_si_units_is_reported() -> Result<(), Error> {
        let motion = ExtrapolationF64::<4>::new(&PARAMETERS, &START, 1e-6)?;
        for (i, parameter) in [(4, Parameter::P1), (5, Parameter::P2)] {
            // The unit is 1e-6 s/(m2 l2^2), so that P is about 1e-6 times p.
            for (momentum, expected) in [
                (1e301, Ok(())),
                (
                    1e303,
                    Err(Error::Diverged {
                        parameter,
                        value: f64::INFINITY,
                    }),
                ),
            ] {
                let mut wrong = motion;
                wrong.sums.z[i] = momentum;
                assert_eq!(wrong.check(), expected, "{parameter:?}: {momentum:e}");
            }
        }
        Ok(())
    }

    /// The changes are those in a step of 1 us.
    #[test]
    fn rates_are_the_change_over_a_short_step() -> Result<(), Error> {
        let mut motion = ExtrapolationF64::<4>::new(&PARAMETERS, &START, 1e-6)?;
        let before = motion.sums.z;
        let rates = motion.rates(&before);
        motion.advance(1);
        for i in 0..6 {
            let error = motion.sums.z[i] - before[i] - rates[i];
            assert!(error.abs() <= 1e-5 * rates[i].abs(), "{i}: {error:e}");
        }
        Ok(())
    }
}
