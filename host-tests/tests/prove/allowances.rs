//! Each allowance is needed: without it the exact motion leaves the set.

use reference::enclosure::{Enclosure, Fineness, Fixed};

use crate::{RATE, after, meet, page, page_at};

/// A set that is a segment at the start, `reach` to both sides along P1, and its end: in which frame of a second that leaves the set. Not
/// followed any farther, it has not left.
fn left(reach: f64, fineness: Fineness) -> Option<u32> {
    let page = page(2.0, fineness);
    let middle = page.hull().map(|x| x.split().0);
    let from = |start, fineness| Enclosure::new(*page.constants(), page.unit(), start, fineness);
    let (mut segment, mut end) = (middle, middle);
    (segment[4], end[4]) = (middle[4].wider(reach), middle[4] + Fixed::of(reach));
    let (mut set, mut end) = (from(segment, fineness), from(end, Fineness::default()));
    for frame in 1..=u32::from(RATE) {
        set.advance().and(end.advance()).ok()?;
        if !meet(&set.hull(), &end.hull(), 0.0) {
            return Some(frame);
        }
    }
    None
}

#[test]
fn the_derivatives_are_bounded_to_their_last_term() {
    let coarse = Fineness { tangents: 0, ..Fineness::default() };
    assert_eq!(left(1e-7, coarse), None);
    assert!(left(1e-7, Fineness { allowances: [1.0, 1.0, 0.0, 1.0], ..coarse }).is_some());
}

/// They are what a set is bent by, too.
#[test]
fn roundings_of_the_segments_are_counted() {
    let without = Fineness { allowances: [1.0, 1.0, 1.0, 0.0], ..Fineness::default() };
    for reach in [1e-4, 1e-7] {
        assert_eq!(left(reach, Fineness::default()), None);
        assert!(left(reach, without).is_some(), "{reach}");
    }
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
