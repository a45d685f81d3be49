//! A search for the motion that leads furthest: unit tests are stopped where a sum or product does not fit its word.

use super::setting::Setting;
use super::{Fixed32, OFFSET, RENORMALISE_EVERY};
use crate::error::Error;
use crate::methods::Form;
use crate::methods::scaling::Scaling;
use crate::numbers::fixed::watch;
use crate::pendulum::{Parameters, Pendulum, State};
use fastrand::Rng;

/// A number between -1 and 1.
fn symmetric(rng: &mut Rng) -> f64 {
    2.0 * rng.f64() - 1.0
}

/// Makes the momenta so many times as large.
fn speed_up(motion: &mut Fixed32, times: f64) {
    for momentum in &mut motion.z[4..] {
        *momentum = libm::rint((*momentum - OFFSET) as f64 * times) as i64 + OFFSET;
    }
}

/// What is searched: powers of two of m2/m1 and l2/l1, where it is, the direction of its momenta, the energy, and how much
/// shorter than the coarsest the step is, as a power of two.
#[derive(Clone, Copy, Debug)]
struct Candidate([f64; 7]);

impl Candidate {
    fn random(rng: &mut Rng) -> Self {
        let mut most = |most: f64| most * symmetric(rng);
        let [mass, length] = [most(1.0), most(1.0)].map(|x| 11.0 * x * x * x);
        Self([
            mass,
            length,
            most(3.2),
            most(3.2),
            most(3.2),
            most(6.0),
            most(0.5) + 0.5,
        ])
    }

    fn near(self, rng: &mut Rng, distance: f64) -> Self {
        Self(self.0.map(|x| x + distance * symmetric(rng)))
    }

    fn parameters(&self) -> Parameters<f64> {
        let [mass, length, ..] = self.0.map(|power| libm::exp2(power.clamp(-11.0, 11.0)));
        Parameters {
            m1: 1.0,
            m2: mass,
            l1: 1.0,
            l2: length,
            g: 9.81,
        }
    }

    /// A state of the candidate's energy, most of it kinetic where that is large, and the motion from it in steps as coarse as
    /// the energy allows.
    fn motion(&self) -> Result<Fixed32, Error> {
        let parameters = self.parameters();
        let pendulum = Pendulum::new(&parameters)?;
        let [_, _, a1, a2, direction, energy, shorter] = self.0;
        let still = State::at_rest(a1, a2);
        let (sin, cos) = libm::sincos(direction);
        let scale = parameters.m2 * parameters.l2;
        let moving = State {
            p1: cos * scale,
            p2: sin * scale * parameters.l2,
            ..still
        };
        let unit = pendulum.energy_above_rest(&moving) - pendulum.energy_above_rest(&still);
        let times =
            libm::sqrt(libm::exp2(energy.clamp(-6.0, 6.0)) * parameters.m2 * parameters.l2 / unit);
        let state = State {
            p1: moving.p1 * times,
            p2: moving.p2 * times,
            ..still
        };
        let energy = pendulum.energy_above_rest(&state);
        let dt = match Setting::new(&parameters, energy, 1e6) {
            Err(Error::TooLarge { limit, .. }) => {
                0.999_999 * limit * libm::exp2(-shorter.clamp(0.0, 1.0))
            }
            other => return Err(other.map_or_else(|error| error, |_| parameters.out_of_range())),
        };
        Fixed32::new(&parameters, &state, dt)
    }

    /// How near to the end of its word, 1, anything comes between two looks at the energy that begin with as much as
    /// there may be.
    fn reach(&self) -> Result<f64, Error> {
        let mut motion = match self.motion() {
            Err(Error::OutOfRange { .. }) => return Ok(0.0),
            motion => motion?,
        };
        let mut still = motion;
        still.z[4..].fill(OFFSET);
        let (potential, most) = (still.energy(), motion.units.most_energy);
        let more =
            libm::sqrt((most - potential) as f64 / (motion.energy() - potential).max(1) as f64);
        speed_up(&mut motion, more);
        Ok(watch::largest(|| {
            motion.make(RENORMALISE_EVERY);
            motion.renormalise();
        }))
    }
}

/// Climbs from many places; each step shorter than the last where it leads nowhere.
#[test]
fn the_motion_that_leads_furthest_stays_in_range() -> Result<(), Error> {
    let mut rng = Rng::with_seed(1);
    let mut furthest = (0.0, Candidate([0.0; 7]));
    for _ in 0..400 {
        let mut candidate = Candidate::random(&mut rng);
        let (mut reach, mut distance) = (candidate.reach()?, 1.0);
        while distance > 1e-3 {
            let next = candidate.near(&mut rng, distance);
            let next_reach = next.reach()?;
            if next_reach > reach {
                (candidate, reach) = (next, next_reach);
            } else {
                distance *= 0.96;
            }
        }
        if reach > furthest.0 {
            furthest = (reach, candidate);
        }
    }
    assert!(
        (0.6..0.8).contains(&furthest.0),
        "as large as can be, and in range: {furthest:?}"
    );
    Ok(())
}

/// A motion that gains energy is lost at the next look, and says so.
#[test]
fn too_much_energy_is_noticed() -> Result<(), Error> {
    let parameters = Parameters::equal_rods(1.0, 1.0, 9.81);
    let motion = Fixed32::new(
        &parameters,
        &State {
            a1: 0.0,
            a2: 0.0,
            p1: 4.0,
            p2: 2.0,
        },
        1.0 / 240.0,
    )?;
    for (more, lost) in [(1.0, false), (1.2, true)] {
        let mut motion = motion;
        motion.advance(RENORMALISE_EVERY);
        speed_up(&mut motion, more);
        motion.advance(RENORMALISE_EVERY);
        assert_eq!(
            (motion.lost, motion.state().a1.is_nan()),
            (lost, lost),
            "momenta times {more}"
        );
    }
    Ok(())
}

/// The energy as the words have it is that of the state.
#[test]
fn the_energy_of_the_words_is_that_of_the_motion() -> Result<(), Error> {
    let mut rng = Rng::with_seed(2);
    for _ in 0..200 {
        let candidate = Candidate::random(&mut rng);
        let Ok(motion) = candidate.motion() else {
            continue;
        };
        let energy = Pendulum::new(&candidate.parameters())?.energy_above_rest(&motion.state());
        let Scaling {
            momenta: [_, unit2],
            time,
            shifts,
            ..
        } = motion.units.scaling;
        let down = (shifts.momentum + shifts.upper) as i32;
        let exact = libm::scalbn(energy * unit2 * time, 60 - down);
        // from far masses and rods few bits are left of it
        let error = libm::fabs(motion.energy() as f64 - exact) / motion.units.most_energy as f64;
        assert!(error < 0.02, "{error:e} of {motion:?}");
    }
    Ok(())
}
