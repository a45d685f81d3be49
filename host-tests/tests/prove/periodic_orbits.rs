//! Two periodic orbits that another project has proved, with other programs and other equations.
//!
//! Source: C. Hendrick, "Chaos and Analytic Non-Integrability of the Classical Double Pendulum: A
//! Computer-Assisted Proof", preprint of 27 September 2026, `data/E0.txt` and `data/Ehalf.txt` of
//! <https://github.com/ChaseHendrick/double-pendulum> (doi:10.5281/zenodo.23096228). The intervals
//! are computed with CAPD; its author checked energy 0 with Arb as well.
//!
//! Masses, rods and g are 1. The orbits start with both rods hanging, a1 = a2 = 0, with
//! p1 = p2 + sqrt(2 (E + 3) - p2^2), so that the energy is E and rod 1 swings upwards. They are
//! back at a1 = 0 with the same momenta when rod 2 has made one turn backwards.

use std::f64::consts::TAU;

use double_pendulum::{Motion, Parameters};
use exact::enclosure::{Enclosure, Fineness, Fixed, Start};

use crate::RATE;

struct Orbit {
    twice_energy: u32,
    /// The bounds of p2, in kg m^2/s and units of 1e-16, as the time in s.
    p2: [i64; 2],
    time: [i64; 2],
}

const ORBITS: [Orbit; 2] = [
    Orbit {
        twice_energy: 0,
        p2: [-14_623_730_924_803_009, -14_623_730_924_794_167],
        time: [29_534_890_074_349_835, 29_534_890_133_549_041],
    },
    Orbit {
        twice_energy: 1,
        p2: [-16_270_449_592_034_013, -16_270_449_592_027_154],
        time: [25_643_622_220_661_313, 25_643_622_276_596_547],
    },
];

const UNIT: u64 = 10_u64.pow(16);

/// The distance from the middle of the momenta's intervals to their ends. It is 4.4e-13 for p2, and
/// the slope of p1 in p2 is at most 1.8.
const MOMENTA: f64 = 1e-12;

/// The starting box of 1e-12 grows by less than 10. Interpolation between the ends of the interval
/// of 6e-9 s adds 1e-16.
const RETURN: f64 = 1e-11;

/// The finest bit of a time, s: 2^-50, so that times are rounded by a millionth of their interval.
const FINEST: u32 = 50;

fn start(orbit: &Orbit) -> Enclosure {
    let energy = f64::from(orbit.twice_energy) / 2.0;
    let p2 = orbit.p2[0] + (orbit.p2[1] - orbit.p2[0]) / 2;
    let p2_about = p2 as f64 / UNIT as f64;

    // With both rods straight down, w1 = p1 - p2 and w2 = 2 p2 - p1.
    let w1_about = (2.0 * (energy + 3.0) - p2_about * p2_about).sqrt();
    let w1 = (w1_about * UNIT as f64).round() as i64;
    let w2 = p2 - w1;

    let parameters = Parameters {
        m1: 1.0,
        m2: 1.0,
        l1: 1.0,
        l2: 1.0,
        g: 1.0,
    };
    let motion = Motion {
        a1: 0.0,
        a2: 0.0,
        w1: w1_about,
        w2: w2 as f64 / UNIT as f64,
    };
    let one = (1, 1);
    let point = Start {
        about: (parameters, motion),
        fractions: Some([
            (0, 1),
            (0, 1),
            (w1, UNIT),
            (w2, UNIT),
            one,
            one,
            one,
            one,
            one,
        ]),
        degrees: [false; 2],
    }
    .enclose(RATE);

    let mut box_of_starts = point.hull();
    for momentum in &mut box_of_starts[4..] {
        *momentum = momentum.wider(MOMENTA * f64::from(-point.frame.0).exp2());
    }
    Enclosure::new(
        point.equations,
        point.frame,
        box_of_starts,
        Fineness::default(),
    )
}

fn check_start(orbit: &Orbit, set: &Enclosure) {
    let [_, _, _, _, p1, p2] = set.hull();
    let exponent = -set.frame.0;
    let ends = orbit.p2.map(|end| Fixed::fraction(end, UNIT, exponent));
    assert_eq!(ends.map(|end| (p2 - end).is_positive()), [None; 2]);

    // (p1 - p2)^2 = 2 (E + 3) - p2^2 has a solution p1 in the box for either end.
    let energy = Fixed::fraction(i64::from(6 + orbit.twice_energy), 1, 2 * exponent);
    for end in ends {
        // The equation has opposite signs at the ends of the box.
        let beyond = [-1.0, 1.0].map(|side| {
            let p1 = p1.middle() + Fixed::of(side * p1.radius());
            ((p1 - end) * (p1 - end) + end * end - energy).is_positive()
        });
        assert_eq!(beyond, [Some(false), Some(true)]);
    }

    // The energy is counted in M l1^2/T^2, where M is 1 kg. Velocities are below 4 m/s, and the box
    // forgets that its momenta belong together.
    let energy = Fixed::fraction(i64::from(orbit.twice_energy), 2, 2 * exponent);
    let difference = set.equations.energy(&set.hull()) - energy;
    assert!(
        difference.is_positive().is_none() && difference.size() < 100.0 * MOMENTA,
        "energy {}/2: {:e} within {:e}",
        orbit.twice_energy,
        difference.about(),
        difference.radius()
    );
}

fn advanced(mut set: Enclosure, time: u64) -> Enclosure {
    let frame @ (unit, _) = set.frame;
    for bit in 0..=FINEST {
        let shorter = i32::try_from(FINEST - bit).expect("a small number");
        if time >> bit & 1 == 1 {
            set.frame = (unit - shorter, 1);
            set.advance().expect("it can be followed");
        }
    }
    set.frame = frame;
    set
}

/// Every motion of the box must pass a1 = 0 upwards within the source's interval of time, with the
/// momenta of the start.
#[test]
fn periodic_orbits_return_when_and_where_another_proof_says() {
    for orbit in ORBITS {
        let set = start(&orbit);
        check_start(&orbit, &set);
        let first = set.hull();

        let [early, late] = orbit.time.map(|time| time as f64 / UNIT as f64);
        let frames = (early * f64::from(RATE)) as u32;
        let mut moving = set;
        let mut angles = [0.0; 2];
        for _ in 0..frames {
            moving.advance().expect("it can be followed");
            // The angles without the whole turns that the directions hide.
            let now = moving
                .directions()
                .map(|[sin, cos]| sin.about().atan2(cos.about()));
            for (angle, now) in angles.iter_mut().zip(now) {
                *angle += (now - *angle) - TAU * ((now - *angle) / TAU).round();
            }
        }

        // The ends of the interval, rounded inwards.
        let bit = f64::from(1 << 25).powi(-2);
        let [early, late] = [(early / bit).ceil(), (late / bit).floor()].map(|time| time as u64);
        let shown = u64::from(frames) * ((1 << FINEST) / u64::from(RATE));
        let at_early = advanced(moving, early - shown);
        let at_late = advanced(at_early.clone(), late - early);

        let now = at_late
            .directions()
            .map(|[sin, cos]| sin.about().atan2(cos.about()));
        for (angle, now) in angles.iter_mut().zip(now) {
            *angle += (now - *angle) - TAU * ((now - *angle) / TAU).round();
        }
        assert!(
            angles[0].abs() < 1e-6 && (angles[1] + TAU).abs() < 1e-6,
            "rod 2 has made one turn backwards, rod 1 none: {angles:?}"
        );

        let [before, after] = [at_early.hull(), at_late.hull()];
        let sides = [before[0], after[0]].map(Fixed::is_positive);
        assert_eq!(
            sides,
            [Some(false), Some(true)],
            "energy {}/2",
            orbit.twice_energy
        );

        let [sin_before, sin_after] = [before[0], after[0]].map(Fixed::about);
        let share = -sin_before / (sin_after - sin_before);
        for i in [2, 4, 5] {
            let change = (after[i] - before[i]).about();
            let off = (before[i] - first[i]).about() + share * change;
            assert!(
                off.abs() < RETURN,
                "energy {}/2, number {i}: {off:e}",
                orbit.twice_energy
            );
        }
    }
}
