//! Every setting that the keys reach, on every class of processors. No scene stops, no motion loses
//! its energy, and every frame is within half a pixel of the exact motion until the time on the
//! panel.

use boards::host::Show;
use double_pendulum::{Modes, Parameters, Pendulum, SmallOscillations};
use exact::taylor::Reference;
use firmware::config::{
    CORTEX_M0PLUS, CORTEX_M4F, HALF_PIXEL, MASS_RATIOS, PROCESSORS, Processor, REACH, TICK_RATE,
};
use firmware::graphics::{Format, Place};
use firmware::motion::{Horizon, Settings};
use firmware::protocol::PlayState;
use firmware::scenes::SceneName;
use rayon::prelude::*;

/// The times for which a scene is played, s.
const SHORT: u32 = 20;
const LONG: u32 = 200;

/// Relative. A motion in steps that do not resolve it gains or loses several percent within
/// seconds.
const ENERGY: f32 = 1e-2;

const CHUNK: usize = 500;

#[derive(Clone, Copy, Debug)]
struct Case {
    name: SceneName,
    settings: Settings,
}

impl Case {
    fn new(name: SceneName, mass_ratio: f64, degrees: f64) -> Self {
        let first = name.first_settings();
        let turn = degrees - first.degrees[1];
        let settings = Settings {
            degrees: first
                .degrees
                .map(|angle| (angle + turn).clamp(-180.0, 180.0)),
            ..first.with_mass_ratio(mass_ratio)
        };
        Self { name, settings }
    }
}

struct Shown {
    processor: Processor,
    angles: Vec<[f64; 2]>,
    /// The latest time that any frame claimed to be accurate, s.
    claimed: f64,
    /// The frames before planning had verified anything.
    undecided: u32,
    energy_errors: Vec<f32>,
    states: Vec<PlayState>,
}

impl Shown {
    fn new(case: &Case, processor: Processor, seconds: u32) -> Self {
        let mut show = Show::on(processor, case.name, &case.settings).expect("good settings");

        let mut shown = Self {
            processor,
            angles: Vec::new(),
            claimed: 0.0,
            undecided: 0,
            energy_errors: Vec::new(),
            states: vec![show.player.state()],
        };

        for _ in 0..seconds * TICK_RATE {
            show.tick();
            let report = show.report();
            shown.states.push(show.player.state());
            shown.angles.push(report.state.angles().map(f64::from));
            shown.claimed = shown.claimed.max(report.horizon.verified().into());
            shown.energy_errors.push(report.energy_error.abs());
            match report.horizon {
                Horizon::Undecided => shown.undecided += 1,
                Horizon::AtLeast(until) => assert!(
                    until >= report.time as f32,
                    "{case:?}: {until} s is claimed at {} s",
                    report.time
                ),
                Horizon::Until(_) | Horizon::Always => {}
            }
        }

        shown
    }

    fn is_too_fast(&self) -> bool {
        self.states.contains(&PlayState::Stopped)
    }

    fn has_lost_energy(&self) -> bool {
        self.energy_errors.iter().any(|error| *error > ENERGY)
    }

    fn claimed_frames(&self) -> usize {
        if self.is_too_fast() {
            return 0;
        }
        let frames = (self.claimed * f64::from(TICK_RATE) + 0.5) as usize;
        frames.min(self.angles.len())
    }
}

fn distance(case: &Case, exact: [f64; 2], shown: [f64; 2]) -> f64 {
    let parameters = case.settings.parameters.cast::<f64>();
    let off = [0, 1].map(|rod| {
        let off = shown[rod] - exact[rod];
        off - std::f64::consts::TAU * (off / std::f64::consts::TAU).round()
    });

    match case.name {
        SceneName::SmallLight | SceneName::SmallEqual | SceneName::SmallHeavy => {
            let scale = curve_scale(&case.settings);
            off.map(|off| scale * off.abs())
                .into_iter()
                .fold(0.0, f64::max)
        }
        SceneName::Beats3To2
        | SceneName::Beats2To1
        | SceneName::Beats5To2
        | SceneName::Beats3To1 => {
            let [across, up] = in_modes(&parameters, off);
            figure_scale(&case.settings) * across.hypot(up)
        }
        name => {
            let reach = match name {
                SceneName::Page => REACH,
                _ => Place::halves(Format::OLED)[0].reach,
            };
            let scale = f64::from(reach) / (parameters.l1 + parameters.l2);
            let pendulum = Pendulum::new(&parameters).expect("good settings");
            let [bobs, exact] = [shown, exact].map(|angles| pendulum.positions(angles));
            let off = |i: usize| scale * (bobs[i].x - exact[i].x).hypot(bobs[i].y - exact[i].y);
            off(0).max(off(1))
        }
    }
}

fn in_modes(parameters: &Parameters<f64>, [a1, a2]: [f64; 2]) -> [f64; 2] {
    let modes = Modes::new(parameters).expect("good settings");
    let fast = modes.fast.shape;
    let slow = modes.slow.shape;
    let across = slow * (a2 - fast * a1) / (slow - fast);
    [across, a2 - across]
}

/// The largest angle that the amplitudes of both modes allow is drawn 10.5 pixels high.
fn curve_scale(settings: &Settings) -> f64 {
    let modes = Modes::new(&settings.parameters.cast()).expect("good settings");
    let motion = SmallOscillations::<f32>::new(modes, &settings.motion().cast());
    let [fast, slow] = motion.amplitudes().map(f64::from);
    let greatest = (fast + slow).max(modes.fast.shape.abs() * fast + modes.slow.shape.abs() * slow);
    10.5 / greatest
}

/// The mode with the larger swing is 21.5 pixels large.
fn figure_scale(settings: &Settings) -> f64 {
    let modes = Modes::new(&settings.parameters.cast()).expect("good settings");
    let linear = SmallOscillations::<f64>::new(modes, &settings.motion().cast());
    let [fast, slow] = linear.amplitudes();
    let fast = fast * modes.fast.shape.abs();
    let slow = slow * modes.slow.shape.abs();
    21.5 / fast.max(slow)
}

#[derive(Debug)]
#[expect(dead_code, reason = "the numbers are printed")]
enum Fault {
    Stopped,
    Energy,
    /// A frame at this time is off by more than half a pixel, but a later horizon was claimed.
    Violation {
        wrong: f64,
        claimed: f64,
    },
}

fn faults(case: &Case, processors: &[Processor], seconds: u32) -> Vec<(Case, u8, Fault)> {
    let shown: Vec<_> = processors
        .iter()
        .map(|&processor| Shown::new(case, processor, seconds))
        .collect();

    let frames = shown.iter().map(Shown::claimed_frames).max().unwrap_or(0);
    let mut start = case.settings.motion();
    if case.name == SceneName::Upright {
        [start.a1, start.a2] = start.angles().map(|angle| f64::from(angle as f32));
    }
    let mut reference = Reference::new(&case.settings.parameters, &start);
    let exact: Vec<_> = (1..=frames)
        .map(|frame| {
            reference.advance_to(frame as f64 / f64::from(TICK_RATE));
            reference.motion().angles()
        })
        .collect();

    let mut faults = Vec::new();
    for shown in shown {
        let code = shown.processor.code;
        let mut found = |fault| faults.push((*case, code, fault));

        if shown.is_too_fast() {
            // Plain `f32` computes sines, and its scene also needs a motion in 64 bits.
            let is_said_at_once = shown
                .states
                .iter()
                .all(|state| *state == PlayState::Stopped);
            if case.name != SceneName::Upright || !is_said_at_once {
                found(Fault::Stopped);
            }
            continue;
        }
        if case.name != SceneName::Upright && shown.has_lost_energy() {
            found(Fault::Energy);
        }
        let is_wrong = |(exact, angles): (&[f64; 2], &[f64; 2])| {
            distance(case, *exact, *angles) > f64::from(HALF_PIXEL)
        };

        let claimed = shown.claimed_frames();
        let wrong = exact
            .iter()
            .zip(&shown.angles)
            .take(claimed)
            .position(is_wrong);
        if let Some(frame) = wrong {
            found(Fault::Violation {
                wrong: (frame + 1) as f64 / f64::from(TICK_RATE),
                claimed: shown.claimed,
            });
        }
    }

    faults
}

fn sweep(cases: &[Case], processors: &[Processor], seconds: u32) {
    let mut found = Vec::new();
    for (chunk, some) in cases.chunks(CHUNK).enumerate() {
        let more: Vec<_> = some
            .par_iter()
            .flat_map_iter(|case| faults(case, processors, seconds))
            .collect();
        more.iter().for_each(|fault| println!("{fault:?}"));
        found.extend(more);

        let done = (chunk * CHUNK + some.len()) * processors.len();
        println!("{done} scenes, {} faults", found.len());
    }

    assert!(found.is_empty());
}

const OTHERS: [SceneName; 10] = [
    SceneName::Figure7,
    SceneName::Butterfly,
    SceneName::Upright,
    SceneName::Beats3To2,
    SceneName::Beats2To1,
    SceneName::Beats5To2,
    SceneName::Beats3To1,
    SceneName::SmallLight,
    SceneName::SmallEqual,
    SceneName::SmallHeavy,
];

/// A selection of the settings: regular and chaotic, light and heavy, near straight up, and at the
/// limits of the other scenes.
#[test]
fn settings_of_all_kinds_are_shown_as_claimed() {
    let mut cases = Vec::new();
    for ratio in [0.01, 1.0, 10.0, 100.0] {
        for degrees in [1.0, -120.0, 171.0, 180.0] {
            cases.push(Case::new(SceneName::Page, ratio, degrees));
        }
    }
    for name in OTHERS {
        let first = name.first_settings();
        cases.push(Case {
            name,
            settings: first,
        });
        for (ratio, degrees) in [(0.01, 120.0), (100.0, 179.0)] {
            cases.push(Case::new(name, ratio, degrees));
        }
    }
    // Here a plan of a slow processor ends early, in steps so long that the energy error would be
    // 2.6 % and 6.3 %.
    cases.push(Case::new(SceneName::Page, 100.0, 105.0));
    cases.push(Case::new(SceneName::Beats3To1, 63.0, -90.0));
    // With a heavy bob 2 the growth since the start does not show how rounding errors in 64 bits
    // grow later.
    cases.push(Case::new(SceneName::Page, 20.0, 123.0));
    cases.push(Case::new(SceneName::Beats3To2, 25.0, -135.0));
    cases.push(Case::new(SceneName::Butterfly, 16.0, 136.0));
    cases.push(Case::new(SceneName::Page, 5.0, -129.0));
    // Here two runs in 64 bits, in long steps, are closer to each other than to the exact motion.
    cases.push(Case::new(SceneName::Page, 8.0, 171.0));
    // Here the errors of runs in 32 bits of fixed point have the same sign.
    cases.push(Case::new(SceneName::Page, 50.0, -134.0));
    // Here a slow processor finds a plan whose horizon is past before it can be followed.
    cases.push(Case::new(SceneName::Beats3To1, 5.0, -180.0));
    // Here the ellipsoid was narrower than the rounding errors of the shadows.
    cases.push(Case::new(SceneName::Beats5To2, 80.0, 179.0));
    // So light a bob 2 makes the curve so small that the chord of an error matters.
    cases.push(Case::new(SceneName::SmallLight, 0.01, -165.0));
    sweep(&cases, &PROCESSORS, SHORT);
}

fn every_15th_degree() -> impl Iterator<Item = f64> {
    (-12..=12).map(|turn| 15.0 * f64::from(turn))
}

/// Returns every scene with a motion, in every mass ratio.
fn all_mass_ratios(degrees: &[f64]) -> Vec<Case> {
    let mut cases = Vec::new();
    for ratio in MASS_RATIOS {
        for name in [SceneName::Page].into_iter().chain(OTHERS) {
            cases.extend(
                degrees
                    .iter()
                    .map(|&degrees| Case::new(name, ratio, degrees)),
            );
        }
    }
    cases
}

#[test]
#[ignore = "an hour"]
fn all_mass_ratios_and_every_15th_degree_are_shown_as_claimed() {
    let degrees: Vec<_> = every_15th_degree()
        .chain([-179.0, -1.0, 1.0, 179.0])
        .collect();
    sweep(&all_mass_ratios(&degrees), &PROCESSORS, SHORT);
}

#[test]
#[ignore = "an hour"]
fn scenes_of_200_s_are_shown_as_claimed() {
    let degrees: Vec<_> = every_15th_degree().collect();
    // One without and one with floating point: all processors would take hours.
    let processors = [CORTEX_M0PLUS, CORTEX_M4F];
    sweep(&all_mass_ratios(&degrees), &processors, LONG);
}

/// The page alone.
#[test]
#[ignore = "an hour"]
fn all_mass_ratios_and_degrees_of_the_page_are_shown_as_claimed() {
    let mut cases = Vec::new();
    for ratio in MASS_RATIOS {
        for degrees in -180..=180 {
            cases.push(Case::new(SceneName::Page, ratio, degrees.into()));
        }
    }
    sweep(&cases, &PROCESSORS, SHORT);
}

#[test]
fn maps_and_frequencies_take_every_mass_ratio() {
    for name in [SceneName::Frequencies, SceneName::Flips] {
        for ratio in MASS_RATIOS {
            for processor in PROCESSORS {
                let settings = name.first_settings().with_mass_ratio(ratio);
                let mut show = Show::on(processor, name, &settings).expect("good settings");
                (0..30).for_each(|_| show.tick());
                assert_eq!(show.player.state(), PlayState::Playing, "{ratio}");
            }
        }
    }
}
