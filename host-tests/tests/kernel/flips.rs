//! The map of flips: what is known of it, and how many of its points are right.

use double_pendulum::Parameters;
use double_pendulum::flips::Flip;
use host_tests::commands::flips::judge::{Judgement, judge, sample};
use host_tests::commands::flips::map::{Followed, Map};
use host_tests::commands::flips::square::Square;
use host_tests::oracle::tolerances;

/// Equal rods and bobs; times in sqrt(l/g).
fn map(limit: f32, size: usize) -> Map {
    Map::new(Parameters::equal_rods(1.0, 1.0, 1.0), limit, Square::whole([size, size])).expect("a pendulum")
}

/// What the energy says: no rod turns over where 2 cos a1 + cos a2 > 1, and many do just outside.
#[test]
fn the_boundary_is_where_the_energy_has_it() {
    let map = map(100.0, 48);
    let points = map.points(|_| ()).expect("points");
    let (mut inside, mut flipped) = (0, 0);
    for ([a1, a2], Followed { flip, .. }) in map.starts().zip(points) {
        let cannot = 2.0 * a1.cos() + a2.cos() > 1.0;
        assert_eq!(flip == Flip::Never, cannot, "{a1} {a2}");
        inside += usize::from(cannot);
        flipped += usize::from(matches!(flip, Flip::After(_)));
    }
    assert!(inside > 300 && flipped > 600, "{inside} {flipped}");
}

/// All of a map by fine steps in `f64`, and those steps on some points by the reference.
#[test]
fn points_are_right_to_a_grey_level() {
    let short = map(10.0, 64);
    let Judgement { points, wrong, .. } = judge(&short).expect("a verdict");
    println!("limit 10: {wrong} of {points} wrong");
    assert!(points > 1000 && wrong as f64 <= (1.0 - tolerances::FLIPS_RIGHT) * points as f64, "{wrong} of {points}");

    assert_eq!(sample(&short, JUDGED), Ok(0));
}

/// Points that the reference judges: 0.1 s each.
const JUDGED: usize = 60;

/// With a limit ten times as long, chaos has made the map partly noise; doubt finds most of what is wrong.
#[test]
fn doubt_tells_what_is_wrong() {
    let verdict = judge(&map(100.0, 32)).expect("a verdict");
    println!("limit 100: {verdict:?}");
    let Judgement { points, wrong, doubtful, unsuspected } = verdict;
    assert!(wrong > 0 && doubtful > 0, "nothing is in doubt");
    assert!((wrong as f64) < tolerances::FLIPS_WRONG * points as f64, "{wrong} of {points}");
    assert!(unsuspected as f64 <= tolerances::FLIPS_UNSUSPECTED * points as f64, "{unsuspected} of {points}");
}
