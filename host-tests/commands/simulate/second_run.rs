//! A second run, which shows when the rows stop being right.
//!
//! It is an extrapolation of order 16 in compensated `f64`, in steps of another length. Its
//! pendulum is a few roundings heavier and in more gravity than the given one, so that the
//! roundings of the given numbers show, too. It costs less than the rows by RK4 in the usual steps.

use double_pendulum::{Error, ExtrapolationF64, Method, Motion, Parameters, Pendulum, Run};
use firmware::job::Request;

use crate::table::at_most;

const LEVELS: [(f64, &str); 3] = [(1e-6, "1e-6"), (0.01, "0.01"), (1.0, "1")];
/// The step, in admissible steps of RK4. The error of order 16 is then that of `f64`.
const SHARE: f64 = 2.0;
/// A number of steps from row to row that is never too many.
const FEW: u32 = 16;
/// The changes of m2 and g, relative to them. Each is rounded by at most a quarter of this.
const ROUNDINGS: [f64; 2] = [2.0 * f64::EPSILON, -2.0 * f64::EPSILON];

pub struct SecondRun {
    run: Option<Run<ExtrapolationF64<16>, true>>,
    stride: u32,
    /// The largest difference of an angle until now, rad.
    worst: f64,
    until: [Option<f64>; LEVELS.len()],
    end: f64,
}

impl SecondRun {
    pub fn new(request: &Request, every: f64) -> Self {
        let longest = Request {
            method: Method::Rk4F64,
            ..*request
        };
        let longest = longest.admissible_step().unwrap_or(every) * SHARE;
        // Steps of the same length by the same method would have the same errors.
        let least = if request.method == Method::Extrapolation16F64 {
            request.stride.saturating_add(request.stride.div_ceil(2))
        } else {
            1
        };
        // An extremely fast motion is not followed more finely than by the rows.
        let most = (request.stride / 2).max(FEW);
        let stride = ((every / longest).ceil() as u32).min(most).max(least);
        Self {
            run: begun(request, every / f64::from(stride)).ok(),
            stride,
            worst: 0.0,
            until: [None; LEVELS.len()],
            end: 0.0,
        }
    }

    pub fn compare(&mut self, time: f64, angles: [f64; 2]) {
        if self.worst > LEVELS[2].0 {
            self.end = time;
            return;
        }
        if time > 0.0 {
            let is_lost = |run: &mut Run<_, true>| run.advance(self.stride).is_err();
            self.run.take_if(is_lost);
        }
        let second = self
            .run
            .as_ref()
            .map_or([f64::INFINITY; 2], |run| run.state().angles());
        let [one, other] = [0, 1].map(|rod| (angles[rod] - second[rod]).abs());
        let rounding = f64::EPSILON * angles[0].abs().max(angles[1].abs());
        let apart = one.max(other) + rounding;
        self.worst = if apart.is_nan() {
            f64::INFINITY
        } else {
            self.worst.max(apart)
        };
        for (until, (level, _)) in self.until.iter_mut().zip(LEVELS) {
            if self.worst <= level {
                *until = Some(time);
            }
        }
        self.end = time;
    }

    pub fn words(&self) -> String {
        if self.worst <= LEVELS[0].0 {
            let worst = at_most(self.worst);
            return format!("the angles of every row are within {worst} rad of the exact motion");
        }
        let mut levels = Vec::new();
        for ((_, level), until) in LEVELS.iter().zip(self.until) {
            let Some(until) = until.filter(|until| *until > 0.0) else {
                continue;
            };
            let of = if levels.is_empty() {
                " of the exact motion"
            } else {
                ""
            };
            if until == self.end {
                let worst = at_most(self.worst);
                levels.push(format!("within {worst} rad{of} until the end"));
                break;
            }
            let until = (1e3 * until).round() / 1e3;
            levels.push(format!("within {level} rad{of} until {until} s"));
        }
        if levels.is_empty() {
            return "no row after the start is within 1 rad of the exact motion".to_owned();
        }
        format!("the angles are {}", levels.join(", "))
    }
}

fn begun(request: &Request, dt: f64) -> Result<Run<ExtrapolationF64<16>, true>, Error> {
    let ([a1, a2], [w1, w2]) = (request.angles, request.velocities);
    let [heavier, stronger] = ROUNDINGS;
    let given = request.parameters;
    let parameters = Parameters {
        m2: given.m2 * (1.0 + heavier),
        g: given.g * (1.0 + stronger),
        ..given
    };
    let pendulum = Pendulum::new(&parameters)?;
    let start = pendulum.to_state(&Motion { a1, a2, w1, w2 });
    Ok(pendulum.run(&start, dt)?.counting_turns())
}
