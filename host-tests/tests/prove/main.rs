//! The enclosure contains the exact motion, and no longer contains it without one of its
//! allowances.

mod motions;
mod periodic_orbits;

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use double_pendulum::{Motion, Parameters};
use exact::enclosure::{Enclosure, Fineness, Fixed, Start, sin_cos};
use exact::known_answers::table;
use exact::random::symmetric;
use exact::taylor::Reference;
use fastrand::Rng;
use firmware::scenes::SceneName;
use host_tests::prove::{HEADING, horizons, known_answers};

/// The times of frames are exact in `f64`.
const RATE: u16 = 64;

/// Equal rods of 1 m that are let go at 2 rad, with P1 equal to `p1`.
fn equal_rods(g: f64, rate: u16, p1: Fixed, fineness: Fineness) -> Enclosure {
    let parameters = Parameters {
        m1: 1.0,
        m2: 1.0,
        l1: 1.0,
        l2: 1.0,
        g,
    };
    let set = Start::of(&parameters, &Motion::at_rest(2.0, 2.0)).enclose(rate);
    let mut start = set.hull().map(Fixed::middle);
    start[4] = p1;
    Enclosure::new(set.equations, set.frame, start, fineness)
}

fn after(frames: u32, mut set: Enclosure) -> Enclosure {
    (0..frames).for_each(|_| set.advance().expect("it can be followed"));
    set
}

/// Returns true if two boxes may have points that are at most `more` apart in each coordinate.
fn meet(one: &[Fixed], other: &[Fixed], more: f64) -> bool {
    one.iter()
        .zip(other)
        .all(|(one, other)| (*one - *other).wider(more).is_positive().is_none())
}

#[test]
fn the_readme_has_the_table_that_the_command_makes() {
    let line = horizons(SceneName::Figure7).expect("it can be proved");
    let readme = include_str!("../../README.md");
    assert!(
        HEADING
            .lines()
            .chain([&*line])
            .all(|line| readme.lines().any(|other| other == line)),
        "{line}"
    );
}

#[test]
fn the_known_answers_are_those_that_the_command_makes() {
    let scene: Vec<_> = table()
        .expect("the file")
        .into_iter()
        .filter(|row| row.scene == "S11")
        .collect();
    let kept = include_str!("../../exact/known_answers.csv")
        .lines()
        .filter(|line| line.starts_with("S11,"));
    assert_eq!(
        known_answers(&scene).expect("it can be proved"),
        kept.collect::<Vec<_>>()
    );
}

#[test]
fn roundings_are_inside_the_enclosure() {
    let mut rng = Rng::with_seed(1);
    for _ in 0..1000 {
        let [a, b] = [(); 2].map(|()| symmetric(&mut rng) * 8.0);
        let [x, y] = [a, b].map(Fixed::of);
        let [sin, cos] = sin_cos(x);
        let products = (x + y) * (x - y) - x * x + y * y;
        let quotient = y * y.inverse() - Fixed::ONE;
        let one = sin * sin + cos * cos - Fixed::ONE;
        for zero in [products, quotient, one] {
            assert!(
                zero.is_positive().is_none() && zero.size() < 1e-30,
                "{a} {b}: {zero:?}"
            );
        }
        assert!(
            (sin - Fixed::of(a.sin()))
                .wider(1e-15)
                .is_positive()
                .is_none(),
            "{a}"
        );
    }

    // A third is not exact. Its middle alone is not enough.
    let third = Fixed::ONE.over(3);
    let three = Fixed::of(3.0);
    assert!(
        (third * three - Fixed::ONE).is_positive().is_none()
            && (third.middle() * three).middle() != Fixed::ONE
    );
    assert_eq!((third - Fixed::fraction(1, 3, 0)).middle(), Fixed::ZERO);
    assert!(
        (Fixed::fraction(-1000, 3, -9) * Fixed::of(128.0) + Fixed::of(250.0).over(3))
            .is_positive()
            .is_none()
    );
    assert_eq!(
        Fixed::of(-1.5).over(8).decimal(33.0),
        format!("-0.1875{:0<29}", "")
    );
    assert_eq!(third.wider(9e-5).decimal(33.0), "0.3333");
}

/// The digits were computed with 90 digits.
#[test]
fn whole_turns_are_removed_exactly() {
    let [zero, one] = [(0, 1), (1, 1)];
    let hull = |angles: [(i64, u64); 2], degrees: bool| {
        let [a1, a2] = angles.map(|(above, below)| above as f64 / below as f64);
        let [a1, a2] = [a1, a2].map(|a| if degrees { a.to_radians() } else { a });
        let parameters = Parameters::equal_rods(1.0, 1.0, 1.0);
        let start = Start {
            about: (parameters, Motion::at_rest(a1, a2)),
            fractions: Some([angles[0], angles[1], zero, zero, one, one, one, one, one]),
            degrees: [degrees, false],
        };
        (
            start.enclose(RATE).hull(),
            Start::of(&parameters, &start.about.1).enclose(RATE).hull(),
        )
    };

    for (angle, digits, width) in [
        ((1000, 1), "0.826879540532002560255887429109", 1e-31),
        (
            (12_345_678, 1000),
            "-0.704081313753298916640886018839",
            1e-30,
        ),
        ((1_000_000_000_000_001, 1), "0.031889", 1e-18),
    ] {
        let (exact, _) = hull([angle, zero], false);
        let sine = exact[0].decimal(30.0);
        assert!(sine.starts_with(digits), "{sine} for {digits}");
        assert!(
            exact[0].radius() < width,
            "{angle:?}: {:e}",
            exact[0].radius()
        );
    }

    // 300 degrees equal -60, and a million degrees equal 280, which equals -80.
    for (angle, less) in [
        ((300, 1), (-60, 1)),
        ((1_000_000, 1), (-80, 1)),
        ((1441, 2), (1, 2)),
    ] {
        let [(large, _), (small, _)] = [angle, less].map(|angle| hull([angle, (10, 1)], true));
        assert_eq!(large, small, "{angle:?} degrees");
    }

    let (exact, double) = hull([(1000, 1), (-700, 1)], false);
    assert_eq!(exact, double);
}

/// A start in rad at the `f64` of a quarter turn is that quarter turn, as in the kernel.
#[test]
fn number_nearest_to_a_quarter_turn_counts_as_one() {
    let parameters = Parameters::equal_rods(1.0, 1.0, 1.0);
    let at = |a1, a2| Start::of(&parameters, &Motion::at_rest(a1, a2));
    assert!(at(PI, -PI).rests());
    assert!(at(TAU, 3.0 * PI).rests());
    assert!(!at(PI.next_up(), PI).rests());
    assert!(!at(PI, FRAC_PI_2).rests());

    let typed = |angles: [(i64, u64); 2], in_degrees: bool| {
        let [zero, one] = [(0, 1), (1, 1)];
        let start = Start {
            about: at(FRAC_PI_2, -PI).about,
            fractions: Some([angles[0], angles[1], zero, zero, one, one, one, one, one]),
            degrees: [in_degrees, false],
        };
        let mut exact = Reference::of(&start);
        exact.advance_to(1.0);
        (start.enclose(RATE).hull(), exact.motion())
    };
    let digits = 10_u64.pow(16);
    let in_rad = [
        (15_707_963_267_948_966, digits),
        (-31_415_926_535_897_930, digits),
    ];
    let (box_in_rad, in_rad) = typed(in_rad, false);
    let (box_in_degrees, in_degrees) = typed([(90, 1), (-180, 1)], true);
    assert_eq!(in_rad, in_degrees);
    for (one, other) in box_in_rad.into_iter().zip(box_in_degrees) {
        assert!((one - other).size() < 1e-30);
    }
}

#[test]
fn numbers_out_of_range_and_quotients_by_zero_have_no_bound() {
    let large = Fixed::of(200.0);
    let wide = Fixed::ZERO.wider(1e-30);
    let quotients =
        [wide, Fixed::fraction(1, 1000, 0), Fixed::of(0.5).wider(0.5)].map(Fixed::inverse);
    let outside = [
        large + large,
        large * large,
        Fixed::of(1e9),
        Fixed::fraction(1 << 60, 1, 0),
    ];
    for unknown in quotients.iter().chain(&outside) {
        assert_eq!(unknown.size(), f64::INFINITY, "{unknown:?}");
    }
}

/// Returns true if a set that is a segment at the start, `reach` to both sides along P1, loses its
/// end within a second.
fn is_left(reach: f64, fineness: Fineness) -> bool {
    let mut set = equal_rods(9.81, RATE, Fixed::ZERO.wider(reach), fineness);
    let mut end = equal_rods(9.81, RATE, Fixed::of(reach), Fineness::default());
    (0..RATE)
        .map_while(|_| {
            set.advance()
                .and(end.advance())
                .map(|()| meet(&set.hull(), &end.hull(), 0.0))
        })
        .any(|meets| !meets)
}

/// The errors of the derivatives are the remainder of their series, the curvature of the motion,
/// and the error of a difference quotient. Each is made large in turn; the set must lose the motion
/// without the allowance for it.
#[test]
fn errors_of_the_derivatives_are_inside_the_enclosure() {
    let fine = Fineness::default();
    // Fewer terms of the derivatives, a long segment, and a coarse difference quotient.
    let cases = [
        (
            1e-7,
            Fineness {
                tangents: 4,
                ..fine
            },
        ),
        (1e-3, fine),
        (
            1e-9,
            Fineness {
                offset: 1e-4,
                ..fine
            },
        ),
    ];

    for (reach, fineness) in cases {
        let without = Fineness {
            allowances: [1.0, 1.0, 0.0, 1.0],
            ..fineness
        };
        assert!(
            !is_left(reach, fineness) && is_left(reach, without),
            "{fineness:?}"
        );
    }
}

/// The differences are so small that their roundings are visible.
#[test]
fn roundings_of_the_segments_are_counted() {
    let fineness = Fineness {
        offset: 1e-29,
        ..Fineness::default()
    };
    let without = Fineness {
        allowances: [1.0, 1.0, 1.0, 0.0],
        ..fineness
    };
    assert!(!is_left(1e-10, fineness) && is_left(1e-10, without));
}

#[test]
fn the_series_of_the_midpoint_is_bounded_to_its_last_term() {
    let coarse = Fineness {
        terms: 8,
        ..Fineness::default()
    };
    let without = Fineness {
        allowances: [1.0, 0.0, 1.0, 1.0],
        ..coarse
    };

    let hull = |fineness| after(10, equal_rods(9.81, RATE, Fixed::ZERO, fineness)).hull();
    let exact = hull(Fineness::default());
    assert!(meet(&exact, &hull(coarse), 0.0) && !meet(&exact, &hull(without), 0.0));
}

/// The steps of two lengths have different roundings. The remainder of the series, which would hide
/// that, is smaller than one rounding.
#[test]
fn roundings_of_the_midpoint_are_counted() {
    let hull = |rate: u16, rounding: f64| {
        let fineness = Fineness {
            allowances: [rounding, 0.0, 1.0, 1.0],
            ..Fineness::default()
        };
        after(rate.into(), equal_rods(9.81, rate, Fixed::ZERO, fineness)).hull()
    };
    let meet = |rounding: f64| meet(&hull(64, rounding)[..4], &hull(48, rounding)[..4], 0.0);
    assert!(meet(1.0) && !meet(0.0));
}
