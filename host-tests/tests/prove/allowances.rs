//! Each allowance is needed: without it the exact motion leaves the set.

use host_tests::prove::{Enclosure, Fineness};

use crate::{after, meet, page, page_at};

/// How far the start of a large set reaches, rad.
const REACH: f64 = 1e-7;

/// A set that all starts within [`REACH`] are in, and its corner where both rods are at the largest angle: in which frame, up to
/// `frames`, that leaves the set. Not followed any farther, it has not left.
fn left(frames: u32, fineness: Fineness) -> Option<u32> {
    let narrow = page(2.0, fineness);
    let start = narrow.hull().map(|x| x.wider(REACH));
    let mut set = Enclosure::new(*narrow.constants(), narrow.unit(), start, fineness);
    let mut corner = page(2.0 + REACH, Fineness::default());
    for frame in 1..=frames {
        set.advance().and(corner.advance()).ok()?;
        if !meet(&set.hull(), &corner.hull(), 0.0) {
            return Some(frame);
        }
    }
    None
}

#[test]
fn the_derivatives_are_bounded_to_their_last_term() {
    let coarse = Fineness { tangents: 0, ..Fineness::default() };
    assert_eq!(left(20, coarse), None);
    assert!(left(20, Fineness { allowances: [1.0, 1.0, 0.0, 1.0], ..coarse }).is_some());
}

/// Columns of 0.9: what is measured along them is too little.
#[test]
fn axes_that_are_not_at_right_angles_are_allowed_for() {
    let coarse = Fineness { axes: 0.45, ..Fineness::default() };
    assert_eq!(left(20, coarse), None);
    assert!(left(20, Fineness { allowances: [1.0, 1.0, 1.0, 0.0], ..coarse }).is_some());
    assert_eq!(left(60, Fineness::default()), None);
}

#[test]
fn the_series_of_the_midpoint_is_bounded_to_its_last_term() {
    let coarse = Fineness { terms: 8, ..Fineness::default() };
    let without = Fineness { allowances: [1.0, 0.0, 1.0, 1.0], ..coarse };
    let exact = after(10, page(2.0, Fineness::default())).hull();
    assert!(meet(&exact, &after(10, page(2.0, coarse)).hull(), 0.0));
    assert!(!meet(&exact, &after(10, page(2.0, without)).hull(), 0.0));
}

/// One point, in two units of time, which has other roundings: a second later it is in both sets. (The rest of the series, which would
/// hide that, is less than one rounding.)
#[test]
fn roundings_of_the_midpoint_are_counted() {
    let meet = |rounding: f64| {
        let fineness = Fineness { allowances: [rounding, 0.0, 1.0, 1.0], ..Fineness::default() };
        let moved = |rate: u16| {
            let set = page_at(rate, 2.0, fineness);
            let point = set.hull().map(|x| x.split().0);
            after(rate.into(), Enclosure::new(*set.constants(), set.unit(), point, fineness)).hull()
        };
        meet(&moved(64)[..4], &moved(48)[..4], 0.0)
    };
    assert!(meet(1.0) && !meet(0.0));
}
