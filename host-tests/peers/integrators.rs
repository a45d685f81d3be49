//! `cargo bench --bench integrators --features peers`: this kernel compared with an integration
//! library, on this machine and in one run.
//!
//! Times are measured in turns and printed as ratios only, because a machine's speed drifts. The
//! last lines compare them with the project's goals.

use std::hint::black_box;
use std::iter::successors;
use std::time::Instant;

use double_pendulum::parts::{DirectionF64, Rk4Direction};
use double_pendulum::{ExtrapolationF64, Form};
use double_pendulum::{Motion, Parameters};
use exact::taylor;
use exact::trials::largest_difference;
use ode_solvers::dop_shared::OutputType;
use ode_solvers::{Dop853, Rk4, System, Vector4};

const PARAMETERS: Parameters<f64> = Parameters {
    m1: 1.0,
    m2: 1.0,
    l1: 1.0,
    l2: 1.0,
    g: 9.81,
};
const SCENES: [(&str, f64, u32); 2] = [("regular", 0.5, 10), ("chaotic", 2.0, 5)];
const PARTS: u32 = 8;
/// The number of runs of each contestant, in turns; the fastest is used.
const ROUNDS: usize = 200;

#[derive(Clone, Copy)]
struct Scene {
    start: [f64; 4],
    part: f64,
}

/// A way to integrate a scene: its name, the largest useful effort, and the function that returns
/// the state after some parts of the scene. The effort is the number of steps in a part, or a
/// tolerance of 10^(-effort/8).
type Contestant = (&'static str, u32, fn(Scene, u32, u32) -> [f64; 4]);

const OURS: &str = "double-pendulum";
const DIRECTION: &str = "double-pendulum, direction form";
const EXTRAPOLATED: &str = "double-pendulum, extrapolated to order 16";

const CLASSICAL: &[Contestant] = &[
    (OURS, 8192, |scene, parts, steps| {
        let pendulum = pendulum();
        let dt = scene.part / f64::from(steps);
        (0..parts * steps)
            .fold(scene.start.into(), |state, _| pendulum.step(&state, dt))
            .into()
    }),
    (DIRECTION, 8192, form::<Rk4Direction<f64, false>>),
    (
        "double-pendulum, direction form compensated",
        8192,
        form::<DirectionF64>,
    ),
    (
        "ode_solvers, the book's equations",
        8192,
        |scene, parts, steps| library_rk4(book, scene, parts, steps),
    ),
    (
        "ode_solvers, this kernel's equations",
        8192,
        |scene, parts, steps| library_rk4(ours(), scene, parts, steps),
    ),
];

const TIGHT: &[Contestant] = &[
    (EXTRAPOLATED, 8192, form::<ExtrapolationF64<16>>),
    (
        "double-pendulum, direction form of RK4",
        8192,
        form::<DirectionF64>,
    ),
    (
        "ode_solvers DOP853, the book's equations",
        128,
        |scene, parts, effort| dop853(book, scene, parts, effort),
    ),
    (
        "ode_solvers DOP853, this kernel's equations",
        128,
        |scene, parts, effort| dop853(ours(), scene, parts, effort),
    ),
];

fn pendulum() -> double_pendulum::Pendulum<f64> {
    double_pendulum::Pendulum::new(&PARAMETERS).unwrap_or_else(|error| panic!("{error}"))
}

fn form<F: Form>(scene: Scene, parts: u32, steps: u32) -> [f64; 4] {
    let dt = scene.part / f64::from(steps);
    let motion = F::new(&PARAMETERS, &scene.start.into(), dt);
    let mut motion = motion.unwrap_or_else(|error| panic!("{error}"));
    motion.advance(parts * steps);
    motion.state().into()
}

fn ours() -> impl Fn(&[f64; 4]) -> [f64; 4] {
    let pendulum = pendulum();
    move |z| pendulum.derivatives(z)
}

/// The equations as the book prints them, with the standard library's sine and cosine. A user would
/// probably write them this way.
fn book(&[a1, a2, p1, p2]: &[f64; 4]) -> [f64; 4] {
    let Parameters { m1, m2, l1, l2, g } = PARAMETERS;
    let sin = (a1 - a2).sin();
    let cos = (a1 - a2).cos();
    let den = m1 + m2 * sin * sin;
    let squares =
        p1 * p1 * m2 * l2 * l2 - 2.0 * p1 * p2 * m2 * l1 * l2 * cos + p2 * p2 * (m1 + m2) * l1 * l1;
    let a_1 = p1 * p2 * sin / (l1 * l2 * den);
    let a_2 = squares * (2.0 * (a1 - a2)).sin() / (2.0 * l1 * l1 * l2 * l2 * den * den);
    [
        (p1 * l2 - p2 * l1 * cos) / (l1 * l1 * l2 * den),
        (p2 * (m1 + m2) * l1 - p1 * m2 * l2 * cos) / (m2 * l1 * l2 * l2 * den),
        -(m1 + m2) * g * l1 * a1.sin() - a_1 + a_2,
        -m2 * g * l2 * a2.sin() + a_1 - a_2,
    ]
}

struct Problem<E>(E);

impl<E: Fn(&[f64; 4]) -> [f64; 4]> System<f64, Vector4<f64>> for Problem<E> {
    fn system(&self, _t: f64, z: &Vector4<f64>, dz: &mut Vector4<f64>) {
        *dz = self.0(&[z[0], z[1], z[2], z[3]]).into();
    }
}

/// The result of an integrator that ends early at tolerances near the resolution of f64.
const ENDED_EARLY: [f64; 4] = [f64::NAN; 4];

fn library_rk4(
    equations: impl Fn(&[f64; 4]) -> [f64; 4],
    scene: Scene,
    parts: u32,
    steps: u32,
) -> [f64; 4] {
    let start = Vector4::from(scene.start);
    let end = scene.part * f64::from(parts);
    let dt = scene.part / f64::from(steps);
    let mut stepper = Rk4::new(Problem(equations), 0.0, start, end, dt);
    stepper
        .integrate()
        .unwrap_or_else(|error| panic!("{error}"));
    stepper.y_out().last().map_or(ENDED_EARLY, |&z| z.into())
}

fn dop853(
    equations: impl Fn(&[f64; 4]) -> [f64; 4],
    scene: Scene,
    parts: u32,
    effort: u32,
) -> [f64; 4] {
    let start = Vector4::from(scene.start);
    let end = scene.part * f64::from(parts);
    let tolerance = 10_f64.powf(-f64::from(effort) / 8.0);
    let mut stepper = Dop853::new(
        Problem(equations),
        0.0,
        end,
        end,
        start,
        tolerance,
        tolerance,
    );
    stepper.set_output(OutputType::Sparse);
    let ended = stepper.integrate().ok();
    ended
        .and_then(|_| stepper.y_out().last().copied())
        .map_or(ENDED_EARLY, Into::into)
}

struct Entry {
    contestant: Contestant,
    effort: u32,
    error: f64,
    time: f64,
}

/// Returns the contestants, each with the smallest effort that has an error of at most `largest`,
/// rad, and its fastest time.
fn race(contestants: &[Contestant], scene: Scene, largest: f64) -> Vec<Entry> {
    let parts = PARTS / 2 + 1..=PARTS;
    let times = parts.clone().map(|parts| scene.part * f64::from(parts));
    let exact = taylor::states(
        &PARAMETERS,
        &Motion::at_rest(scene.start[0], scene.start[1]),
        times,
    );

    let entry = |&contestant: &Contestant| {
        let (_, most, follow) = contestant;
        let efforts = successors(Some(4), |last| Some(last + 1 + last / 128))
            .take_while(|&next| next <= most);
        let mut tries = efforts.map(|effort| {
            let ends: Vec<_> = parts
                .clone()
                .map(|parts| follow(scene, parts, effort).into())
                .collect();
            Entry {
                contestant,
                effort,
                error: largest_difference(&ends, &exact),
                time: f64::INFINITY,
            }
        });
        tries.find(|entry| entry.error <= largest)
    };

    let mut entries: Vec<_> = contestants.iter().filter_map(entry).collect();
    for _ in 0..ROUNDS {
        for entry in &mut entries {
            let start = Instant::now();
            black_box((entry.contestant.2)(scene, PARTS, black_box(entry.effort)));
            entry.time = start.elapsed().as_secs_f64().min(entry.time);
        }
    }
    entries
}

/// The contestants, the error to reach, rad, the contestant with a goal, and its largest share of
/// the fastest peer's time in each scene.
const RACES: [(&[Contestant], f64, &str, [f64; 2]); 3] = [
    (CLASSICAL, 1e-8, DIRECTION, [0.45; 2]),
    (TIGHT, 1e-9, EXTRAPOLATED, [1.0 / 1.5; 2]),
    (TIGHT, 1e-12, EXTRAPOLATED, [0.2, 1.0 / 1.5]),
];

fn main() {
    let mut goals = Vec::new();
    for (index, (name, angle, seconds)) in SCENES.into_iter().enumerate() {
        let scene = Scene {
            start: [angle, angle, 0.0, 0.0],
            part: f64::from(seconds) / f64::from(PARTS),
        };
        for (contestants, error, counted, most) in RACES {
            let entries = race(contestants, scene, error);

            let peers = entries
                .iter()
                .filter(|entry| !entry.contestant.0.starts_with(OURS));
            let peer = peers.map(|entry| entry.time).fold(f64::INFINITY, f64::min);
            println!(
                "\n{name}: time to an error of {error:e} rad\n{:51} {:>7} {:>9} {:>6}",
                "", "effort", "error", "time"
            );

            let mut measured = f64::INFINITY;
            for Entry {
                contestant: (entrant, ..),
                effort,
                error,
                time,
            } in entries
            {
                println!("{entrant:51} {effort:7} {error:9.1e} {:6.2}", time / peer);
                measured = if entrant == counted {
                    time / peer
                } else {
                    measured
                };
            }
            goals.push((
                format!("{name}: {counted}, to {error:e} rad"),
                measured,
                most[index],
            ));
        }
    }

    println!("\ngoals, of the fastest peer's time at equal error");
    for (race, measured, most) in goals {
        let verdict = if measured <= most { "met" } else { "MISSED" };
        println!("{race:63} {measured:6.2}, at most {most:.2} required: {verdict}");
    }
}
