//! `cargo figures` and `cargo flips`: the curves compared with known values, and the committed
//! files with the kernel's results.

use std::f64::consts::PI;
use std::fs;

use double_pendulum::{Motion, State};
use exact::taylor::Reference;
use exact::tolerances;
use firmware::scenes::SceneName;
use host_tests::figures::small::{CurvePoint, MASS_RATIOS, modes, points};
use host_tests::figures::{animation, chaos, figures, folder, record};

use super::cli::{output, program};

/// The energies, J: the plotted path of the misprinted form must reach the first or less, and more
/// than the second (measured -45 to 63.1, from 62.9 at the start).
const MISPRINT_SWING: [f64; 2] = [-40.0, 60.0];

/// Relative, where a curve crosses a level: half of the last digit of the shortest given number,
/// 1.3e-6, and the shift of a crossing by joining the points with straight lines, which is (w
/// dt)^3/16 of a radian for points dt apart and a frequency w, or 2e-5 for the fastest curve, over
/// the 23 rad shown at least.
const PLOTTED_FREQUENCY: f64 = 3e-6;

/// Relative to a curve's maximum. Between two points, dt apart, a curve of frequency w is at most
/// (w dt/2)^2/2 higher, 4e-4 for the fastest envelope. A curve this near to its envelope touches
/// it.
const PLOTTED_AMPLITUDE: f64 = 5e-4;

/// The largest difference of two energies along the path, J, of 127 J above rest (measured 2.4e-3).
const FIGURE_7_ENERGY: f64 = 0.01;

/// The error of the path, m: a hundredth of the width of the lines (measured: 3e-6).
const FIGURE_7_PATH: f64 = 1e-4;

/// Figures 3 to 5: w1, w2 (rad/s), the envelope's period (s), the largest |a1| (degrees).
const SMALL: [[f64; 4]; 3] = [
    [8.139042, 5.275983, 2.194571, 12.2474],
    [11.568802, 4.791955, 0.927155, 21.2132],
    [21.211017, 4.526893, 0.376597, 27.3861],
];
/// The angle 2 at the start, which is also the largest, degrees.
const START: f64 = 30.0;

#[test]
fn the_committed_figures_equal_the_kernels() {
    for (name, svg) in figures().expect("the figures can be drawn") {
        assert!(
            fs::read_to_string(folder().join(&name)).ok() == Some(svg),
            "accept by `cargo figures`: {name}"
        );
    }
}

/// Each committed animation of three short ones is equal, byte by byte, to what is drawn now. All are
/// made by one command.
#[test]
fn the_committed_animations_equal_those_drawn_now() {
    let scenes = [
        SceneName::Frequencies,
        SceneName::SmallEqual,
        SceneName::Beats2To1,
    ];
    let new = tempfile::tempdir().expect("a folder");
    fs::create_dir(new.path().join("panel")).expect("a folder");
    for scene in scenes {
        record(scene, new.path()).expect("it can be drawn");
        let [old, new] = [&folder(), new.path()].map(|folder| fs::read(animation(scene, folder)));
        assert!(
            old.ok() == new.ok(),
            "accept by `cargo figures --animations`: {}",
            scene.name()
        );
    }
}

fn between_crossings(points: &[CurvePoint], value: impl Fn(&CurvePoint) -> f64) -> f64 {
    let crossing = |pair: &[CurvePoint]| {
        let [(t, before), (later, after)] =
            [&pair[0], &pair[1]].map(|point| (point.time, value(point)));
        ((before < 0.0) != (after < 0.0)).then(|| t + (later - t) * before / (before - after))
    };
    let crossings: Vec<_> = points.windows(2).filter_map(crossing).collect();
    let [first, .., last] = crossings[..] else {
        panic!("{crossings:?}")
    };
    (last - first) / (crossings.len() - 1) as f64
}

fn assert_close(value: f64, expected: f64, relative: f64, what: &str) {
    assert!(
        (value / expected - 1.0).abs() < relative,
        "{what}: {value} instead of {expected}"
    );
}

#[test]
fn figures_3_to_5_show_the_frequencies_envelopes_and_amplitudes_of_the_table() {
    for (mu, [w1, w2, envelope, largest_a1]) in MASS_RATIOS.into_iter().zip(SMALL) {
        let points = points(modes(mu).expect("a pendulum"));

        // a2 - r a1 contains the fast mode only, and a2 + r a1 the slow one.
        let r = ((1.0 + mu) / mu).sqrt();
        for (w, r) in [(w1, -r), (w2, r)] {
            let half_period =
                between_crossings(&points, |point| point.angles[1] + r * point.angles[0]);
            assert_close(PI / half_period, w, PLOTTED_FREQUENCY, "frequency");
        }
        for (rod, largest) in [largest_a1, START].into_iter().enumerate() {
            // The square of the envelope is a cosine about half its maximum.
            let half_period = between_crossings(&points, |point| {
                point.envelopes[rod].powi(2) - largest.powi(2) / 2.0
            });
            assert_close(2.0 * half_period, envelope, PLOTTED_FREQUENCY, "envelope");
            let highest = points
                .iter()
                .map(|point| point.envelopes[rod])
                .fold(0.0, f64::max);
            assert_close(highest, largest, PLOTTED_AMPLITUDE, "amplitude");

            let beyond = |point: &CurvePoint| point.angles[rod].abs() - point.envelopes[rod];
            let farthest = points.iter().map(beyond).fold(f64::NEG_INFINITY, f64::max);
            assert!(
                farthest < tolerances::FORMULAS.double * START,
                "mass ratio {mu}, rod {rod}: {farthest} beyond"
            );
            let touches = points.iter().filter(|point| {
                point.envelopes[rod] > highest / 2.0 && beyond(point) > -PLOTTED_AMPLITUDE * highest
            });
            assert!(touches.count() > 2, "mass ratio {mu}, rod {rod}");
        }
    }
}

/// The misprinted equations have no known exact solution: their path must equal a path in half the
/// step, and must not keep the energy.
#[test]
fn figure_7_shows_the_exact_path_and_a_converged_misprinted_path() {
    let pendulum = chaos::pendulum().expect("a pendulum");
    let State { a1, a2, .. } = chaos::start();
    let mut exact = Reference::new(pendulum.parameters(), &Motion::at_rest(a1, a2));
    let [[right, printed], [_, finer]] =
        [1, 2].map(|refinement| chaos::paths(refinement).expect("a pendulum"));

    let last = right.points.len() - 1;
    let exact = (0..=last).map(|i| {
        exact.advance_to(f64::from(chaos::DURATION) * i as f64 / last as f64);
        let [_, bob2] = pendulum.positions(exact.motion().angles());
        (bob2.x, bob2.y)
    });

    for (path, other) in [(&right, exact.collect()), (&printed, finer.points)] {
        assert_eq!(path.points.len(), other.len());
        for (i, ((x, y), (other_x, other_y))) in path.points.iter().zip(other).enumerate() {
            let off = (x - other_x).hypot(y - other_y);
            assert!(off < FIGURE_7_PATH, "{off} m off at point {i}");
        }
    }

    let [least, greatest] = right.energies;
    assert!(
        greatest - least < FIGURE_7_ENERGY,
        "{least} J to {greatest} J"
    );

    let [least, greatest] = printed.energies;
    let swing = least..greatest;
    assert!(
        MISPRINT_SWING.iter().all(|energy| swing.contains(energy)),
        "{swing:?} J"
    );
}

fn flips(arguments: &[&str], name: &str) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join(name);
    let output = output(program("flips").args(arguments).arg("--out").arg(&out));
    assert!(output.status.success(), "{output:?}");
    fs::read(out).expect("a file")
}

#[test]
fn the_committed_map_equals_a_new_one() {
    let committed = fs::read(folder().join("figures/flips.png")).expect("a picture");
    assert!(
        flips(&["--limit", "100"], "flips.png") == committed,
        "accept by the README's `cargo flips`"
    );
}

#[test]
fn a_table_has_every_start_and_is_its_own_mirror_image() {
    let table =
        String::from_utf8(flips(&["--size", "12x6", "--limit", "20"], "map.csv")).expect("text");
    let times: Vec<_> = table
        .lines()
        .skip(1)
        .filter_map(|line| line.split(',').nth(2))
        .collect();
    assert_eq!(times.len(), 72);

    // Mirroring both angles gives the same motion.
    assert!(times.iter().eq(times.iter().rev()));
    let [never, later] = ["", "inf"].map(|word| times.iter().filter(|time| **time == word).count());
    assert!(never > 10 && never < 40 && later > 0, "{table}");
    assert!(
        times
            .iter()
            .filter_map(|time| time.parse::<f32>().ok())
            .all(|time| time > 0.0 && (time <= 20.0 || time.is_infinite())),
        "{table}"
    );

    let cells = table.lines().skip(1).flat_map(|line| line.split(','));
    assert!(
        cells
            .filter(|cell| !cell.is_empty())
            .all(|cell| cell.parse::<f64>().is_ok()),
        "{table}"
    );
    assert!(
        table.starts_with(
            "a1 [rad],a2 [rad],time [sqrt(l1/g)],time_by_half_the_step [sqrt(l1/g)]\n"
        ),
        "{table}"
    );
}
