//! Each allowance is needed: without it the exact motion leaves the set.

use reference::enclosure::{Fineness, Fixed};

use crate::{RATE, after, equal_rods, meet};

/// Whether a set that is a segment at the start, `reach` to both sides along P1, loses its end within a second.
fn is_left(reach: f64, fineness: Fineness) -> bool {
    let mut set = equal_rods(9.81, RATE, Fixed::ZERO.wider(reach), fineness);
    let mut end = equal_rods(9.81, RATE, Fixed::of(reach), Fineness::default());
    (0..RATE)
        .map_while(|_| set.advance().and(end.advance()).map(|()| meet(&set.hull(), &end.hull(), 0.0)))
        .any(|meets| !meets)
}

/// By the rest of their series, by the bend of the motion, and by what a quotient of differences is off.
#[test]
fn what_the_derivatives_lack_is_counted() {
    let fine = Fineness::default();
    let cases = [(1e-7, Fineness { tangents: 4, ..fine }), (1e-3, fine), (1e-9, Fineness { beside: 1e-4, ..fine })];
    for (reach, fineness) in cases {
        let without = Fineness { allowances: [1.0, 1.0, 0.0, 1.0], ..fineness };
        assert!(!is_left(reach, fineness) && is_left(reach, without), "{fineness:?}");
    }
}

/// Those of differences so small that they show.
#[test]
fn roundings_of_the_segments_are_counted() {
    let fineness = Fineness { beside: 1e-29, ..Fineness::default() };
    let without = Fineness { allowances: [1.0, 1.0, 1.0, 0.0], ..fineness };
    assert!(!is_left(1e-10, fineness) && is_left(1e-10, without));
}

#[test]
fn the_series_of_the_midpoint_is_bounded_to_its_last_term() {
    let coarse = Fineness { terms: 8, ..Fineness::default() };
    let without = Fineness { allowances: [1.0, 0.0, 1.0, 1.0], ..coarse };
    let hull = |fineness| after(10, equal_rods(9.81, RATE, Fixed::ZERO, fineness)).hull();
    let exact = hull(Fineness::default());
    assert!(meet(&exact, &hull(coarse), 0.0) && !meet(&exact, &hull(without), 0.0));
}

/// One point, in steps of two lengths, which have other roundings: a second later it is in both sets. (The rest of the series, which
/// would hide that, is less than one rounding.)
#[test]
fn roundings_of_the_midpoint_are_counted() {
    let hull = |rate: u16, rounding: f64| {
        let fineness = Fineness { allowances: [rounding, 0.0, 1.0, 1.0], ..Fineness::default() };
        after(rate.into(), equal_rods(9.81, rate, Fixed::ZERO, fineness)).hull()
    };
    let meet = |rounding: f64| meet(&hull(64, rounding)[..4], &hull(48, rounding)[..4], 0.0);
    assert!(meet(1.0) && !meet(0.0));
}
