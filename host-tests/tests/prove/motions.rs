//! The enclosure contains the exact motion and the reference.

use double_pendulum::{Motion, Parameters, Pendulum};
use exact::enclosure::{Enclosure, Fineness, Fixed, Start};
use exact::hard_cases::hard_cases;
use exact::random::{log_uniform, symmetric};
use exact::taylor::Reference;
use exact::tolerances;
use fastrand::Rng;
use host_tests::prove::moving;

use crate::{RATE, after, equal_rods, meet};

/// The radius divided by the growth (measured: 2.3e-28 at most).
const ENCLOSURE: f64 = 1e-27;

/// Returns a random pendulum and its motion. Half of the motions have velocities.
fn random(rng: &mut Rng) -> (Parameters<f64>, Motion<f64>) {
    let [m1, m2, l1, l2] =
        [(); 4].map(|()| log_uniform(rng, 10_f64.powf(-0.75), 10_f64.powf(0.75)));
    let speed = if rng.bool() { 6.0 } else { 0.0 };
    let [a1, a2, w1, w2] = [3.0, 3.0, speed, speed].map(|most| most * symmetric(rng));
    (
        Parameters {
            m1,
            m2,
            l1,
            l2,
            g: 9.81,
        },
        Motion { a1, a2, w1, w2 },
    )
}

/// Checks that the box contains the reference and the energy of the start, and that no direction is
/// wider than [`ENCLOSURE`] times the growth of a small error.
fn is_inside(parameters: &Parameters<f64>, motion: &Motion<f64>, frames: u32) {
    let mut reference = Reference::new(parameters, motion);
    let mut set = Start::of(parameters, motion).enclose(RATE);
    let energy = |set: &Enclosure| set.equations.energy(&set.hull());
    let first = energy(&set);

    // The reference removes whole turns from an angle in double-double arithmetic.
    let farthest = motion.a1.abs().max(motion.a2.abs()).max(1.0);
    for frame in (5..=frames).step_by(5) {
        set = after(5, set);
        reference.advance_to(f64::from(frame) / f64::from(RATE));
        let directions = reference
            .directions()
            .map(|x| Fixed::of(x.hi()) + Fixed::of(x.lo()));
        let is_inside = meet(
            set.directions().as_flattened(),
            &directions,
            tolerances::REFERENCE * set.growth() * farthest,
        );

        let width = set
            .directions()
            .as_flattened()
            .iter()
            .map(|x| x.radius())
            .fold(0.0, f64::max)
            / set.growth();

        assert!(
            width < ENCLOSURE,
            "{parameters:?} {motion:?} frame {frame}: {width:e}"
        );
        assert!(
            is_inside && (energy(&set) - first).is_positive().is_none(),
            "{parameters:?} {motion:?} frame {frame}"
        );
    }
}

fn random_motions_are_inside(count: usize, frames: u32) {
    let mut rng = Rng::with_seed(28);
    for (parameters, motion) in std::iter::repeat_with(|| random(&mut rng)).take(count) {
        is_inside(&parameters, &motion, frames);
    }
}

#[test]
fn random_motions_are_inside_for_half_a_second() {
    random_motions_are_inside(50, 30);
}

#[test]
#[ignore = "minutes"]
fn random_motions_are_inside_for_long() {
    random_motions_are_inside(200, 300);
}

#[test]
fn the_reference_is_inside_where_it_is_used() {
    for case in hard_cases() {
        let pendulum = Pendulum::new(&case.trial.parameters).expect("valid");
        let frames = (case.trial.seconds * f64::from(RATE)) as u32;
        is_inside(
            &case.trial.parameters,
            &pendulum.to_motion(&case.trial.start),
            frames,
        );
    }

    // At rest without gravity the exact motion never leaves its start.
    let weightless = Parameters {
        m1: 1.0,
        m2: 1.0,
        l1: 1.0,
        l2: 1.0,
        g: 0.0,
    };
    is_inside(
        &weightless,
        &Motion {
            a1: 1.0,
            a2: 2.0,
            w1: 0.0,
            w2: 0.0,
        },
        60,
    );

    for name in moving() {
        let settings = name.first_settings();
        is_inside(
            &settings.parameters.cast(),
            &settings.motion().cast(),
            5 * u32::from(RATE),
        );
    }
}

#[test]
fn one_bit_of_g_makes_a_difference() {
    let hull = |g: f64| after(60, equal_rods(g, RATE, Fixed::ZERO, Fineness::default())).hull();
    assert!(!meet(&hull(9.81), &hull(9.81_f64.next_up()), 0.0));
}
