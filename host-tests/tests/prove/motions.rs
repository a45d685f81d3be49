//! The exact motion is inside.

use double_pendulum::{Motion, Parameters};
use fastrand::Rng;
use host_tests::oracle::random::{log_uniform, symmetric};
use host_tests::oracle::tolerances;
use reference::enclosure::{Fineness, Fixed, Start};
use reference::taylor::Reference;
use reference::taylor::series::sin_cos;
use reference::twofloat::TwoFloat;

use crate::{RATE, after, energy, meet, page};

/// Ratios of masses and of rods over three decades each, angles up to 3 rad, half of them with velocities.
fn random(rng: &mut Rng) -> (Parameters<f64>, Motion<f64>) {
    let [m1, m2, l1, l2] = [(); 4].map(|()| log_uniform(rng, 10_f64.powf(-0.75), 10_f64.powf(0.75)));
    let speed = if rng.bool() { 6.0 } else { 0.0 };
    let [a1, a2, w1, w2] = [3.0, 3.0, speed, speed].map(|most| most * symmetric(rng));
    (Parameters { m1, m2, l1, l2, g: 9.81 }, Motion { a1, a2, w1, w2 })
}

fn exactly(number: TwoFloat) -> Fixed {
    Fixed::of(number.hi()) + Fixed::of(number.lo())
}

/// (sin a1, cos a1, S, C) of the reference.
fn directions(reference: &Reference) -> [Fixed; 4] {
    let [a1, a2, ..] = reference.exact_state();
    let ((sin1, cos1), (s, c)) = (sin_cos(a1), sin_cos(a1 - a2));
    [sin1, cos1, s, c].map(exactly)
}

/// At every sample, to what the reference may itself be off by; and at all times the energy is that of the start.
fn follows(motions: u32, frames: u32) {
    let mut rng = Rng::with_seed(28);
    for number in 0..motions {
        let (parameters, motion) = random(&mut rng);
        let mut reference = Reference::new(&parameters, &motion);
        let mut set = Start::of(&parameters, &motion).enclose(RATE, Fineness::default());
        let first = energy(&set);
        let mut beside = Start::of(&Parameters { g: parameters.g.next_up(), ..parameters }, &motion)
            .enclose(RATE, Fineness::default());
        for frame in (5..=frames).step_by(5) {
            (set, beside) = (after(5, set), after(5, beside));
            reference.advance_to(f64::from(frame) / f64::from(RATE));
            let hull = set.hull();
            let apart = hull.iter().zip(beside.hull()).map(|(x, y)| (*x - y).ball().size()).fold(0.0, f64::max);
            let budget = tolerances::REFERENCE * (apart / f64::EPSILON).max(1.0);
            assert!(
                meet(&hull[..4], &directions(&reference), budget),
                "{number}: {parameters:?} {motion:?} frame {frame}"
            );
            assert!((energy(&set) - first).ball().holds_zero(), "{number}");
        }
    }
}

#[test]
fn the_reference_is_inside() {
    follows(200, 30);
}

#[test]
#[ignore = "minutes"]
fn the_reference_is_inside_for_long() {
    follows(200, 300);
}

/// Within a second, by g alone.
#[test]
fn one_bit_of_g_is_told_apart() {
    let parameters = Parameters { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: 9.81_f64.next_up() };
    let other = Start::of(&parameters, &Motion::at_rest(2.0, 2.0)).enclose(RATE, Fineness::default());
    let [one, other] = [page(2.0, Fineness::default()), other].map(|set| after(60, set).hull());
    assert!(!meet(&one, &other, 0.0));
}
