//! The map of flips: the number of correct points, and the points in doubt.

use std::f64::consts::PI;

use double_pendulum::flips::{Flip, Flips};
use double_pendulum::parts::DirectionF64;
use double_pendulum::{Error, Motion, Parameters};
use exact::taylor::Reference;
use fastrand::Rng;
use host_tests::flips::map::{FlipPair, Map};

/// The smallest share, of 1, of correct points in a map of flips with a limit of 10 sqrt(l/g),
/// among the points that may turn over. A point is correct if it differs from far finer steps in
/// `f64` by at most one grey level of the panel's map, which has 14 for the time of a flip.
const FLIPS_RIGHT: f64 = 0.999;

/// The largest share, of 1, of points that are wrong by more than a grey level, as in
/// [`FLIPS_RIGHT`], but in a map with a limit of 100 sqrt(l/g), where chaos leaves fewer correct
/// ones.
const FLIPS_WRONG: f64 = 0.04;

/// The largest share, of 1, of points that are wrong without being in doubt, among the points that
/// may turn over, in a map with a limit of 100 sqrt(l/g). A point is in doubt if half the step
/// changes it by more than a grey level.
const FLIPS_UNSUSPECTED: f64 = 0.01;

const FINER: u32 = 16;
/// The time between two samples of the exact motion, sqrt(l1/g).
const SAMPLE: f64 = 0.1;
/// Each takes 0.1 s by the reference.
const JUDGED: usize = 60;

/// Returns a map of equal rods and bobs. Times are in sqrt(l/g).
fn map(limit: f32, size: usize) -> Map {
    Map::new(Parameters::equal_rods(1.0, 1.0, 1.0), limit, [size, size]).expect("a pendulum")
}

/// By its energy no rod turns over if 2 cos a1 + cos a2 > 1.
fn turning(map: &Map) -> Result<Vec<([f32; 2], FlipPair)>, Error> {
    let points = map.starts().into_iter().zip(map.points(|_| ())?);
    let may_turn = |([a1, a2], [flip, _]): &([f32; 2], FlipPair)| {
        let cannot = 2.0 * a1.cos() + a2.cos() > 1.0;
        assert_eq!(*flip == Flip::Never, cannot, "{a1} {a2}");
        !cannot
    };

    Ok(points.filter(may_turn).collect())
}

/// Returns the numbers of points that are wrong by more than a grey level, of wrong points that are
/// not in doubt, of points in doubt, and of all points.
fn judge(map: &Map) -> Result<[usize; 4], Error> {
    let dt = map.dt / f64::from(FINER);
    let fine = Flips::<DirectionF64>::new(
        &map.parameters.cast(),
        dt,
        (f64::from(map.limit) / dt) as u32,
    )?;
    turning(map)?
        .into_iter()
        .try_fold([0; 4], |counts, (start, point)| {
            let [a1, a2] = start.map(f64::from);
            let exact = match exact::flip(&fine, a1, a2)? {
                Flip::Never => Flip::Never,
                Flip::After(time) => Flip::After(time as f32),
                Flip::Later => Flip::Later,
            };

            let wrong = map.differ([point[0], exact]);
            let doubtful = map.differ(point);
            let these = [wrong, wrong && !doubtful, doubtful, true];
            Ok(std::array::from_fn(|i| counts[i] + usize::from(these[i])))
        })
}

fn exact(map: &Map, [a1, a2]: [f32; 2]) -> Flip<f32> {
    let mut motion = Reference::new(
        &map.parameters.cast(),
        &Motion::at_rest(a1.into(), a2.into()),
    );
    let mut before = [a1, a2].map(f64::from);
    for look in 1..=(f64::from(map.limit) / SAMPLE) as u32 {
        let time = f64::from(look) * SAMPLE;
        motion.advance_to(time);
        let after = motion.motion().angles();
        // A rod has passed straight up since the last sample. The time is interpolated.
        let passed = |rod: usize| {
            (after[rod].abs() > PI)
                .then(|| (after[rod].abs() - PI) / (after[rod] - before[rod]).abs())
        };
        if let Some(since) = [0, 1].into_iter().filter_map(passed).reduce(f64::max) {
            return Flip::After((time - since * SAMPLE) as f32);
        }
        before = after;
    }
    Flip::Later
}

#[test]
fn points_are_accurate_to_a_grey_level() -> Result<(), Error> {
    let short = map(10.0, 64);
    let [wrong, .., points] = judge(&short)?;
    println!("limit 10: {wrong} of {points} wrong");
    assert!(
        (1000..1700).contains(&points) && wrong as f64 <= (1.0 - FLIPS_RIGHT) * points as f64,
        "{wrong} of {points}"
    );

    let mut sample = turning(&short)?;
    Rng::with_seed(1).shuffle(&mut sample);
    for (start, point) in &sample[..JUDGED] {
        assert!(
            !short.differ([point[0], exact(&short, *start)]),
            "{start:?}: {point:?}"
        );
    }

    Ok(())
}

/// Because of chaos the map is partly noise, so that some points are wrong and some in doubt.
#[test]
fn most_wrong_points_are_in_doubt() -> Result<(), Error> {
    let [wrong, unsuspected, doubtful, points] = judge(&map(100.0, 32))?;
    println!(
        "limit 100: {wrong} wrong, {unsuspected} not in doubt, {doubtful} in doubt of {points}"
    );
    assert!(wrong > 0 && doubtful > 0, "nothing is in doubt");
    assert!(
        (wrong as f64) < FLIPS_WRONG * points as f64,
        "{wrong} of {points}"
    );
    assert!(
        unsuspected as f64 <= FLIPS_UNSUSPECTED * points as f64,
        "{unsuspected} of {points}"
    );
    Ok(())
}
