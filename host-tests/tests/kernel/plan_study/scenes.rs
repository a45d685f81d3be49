//! The scenes of the study: random classes, and single scenes that are difficult.

use std::f64::consts::PI;

use double_pendulum::plan::Problem;
use double_pendulum::{Motion, Parameters};
use fastrand::Rng;
use firmware::config::GRAVITY;
use firmware::motion::half_pixel;
use host_tests::oracle::random::{log_uniform, symmetric};

/// The height of the display, pixels, if the class has no other.
const HEIGHT: f64 = 64.0;
/// Frames per second, if the class has no other.
const RATE: u16 = 60;
/// The duration of a scene, s, if the class has no other.
const SECONDS: [f64; 2] = [2.0, 30.0];

/// The smallest amplitude, rad.
const LEAST: f64 = 0.01;
/// The largest velocity of a rod, in units of its own sqrt(g/l) and in rad/s.
const GREATEST: [f64; 2] = [20.0, 60.0];

/// A kind of scene.
///
/// Bob 1 has 1 kg and rod 1 has 1 m. Since gravity is given, only the ratios matter. `log` means
/// evenly distributed in the logarithm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Mass ratio m2/m1 1e-3 to 1e3, length ratio l2/l1 1e-2 to 1e2, 2 to 30 s: log.
    ///
    /// - Amplitude 0.01 to pi rad: every other one log, the others evenly.
    /// - One angle is as large as the amplitude. The other one is equal to it in every third scene,
    ///   and at most as large in the other scenes.
    /// - Every other scene starts at rest. The others start with velocities up to a share of the
    ///   largest ones: 20 times the rod's own sqrt(g/l), at most 60 rad/s. The share of 0.01 to 1
    ///   has the same distribution as the amplitude.
    Broad,
    /// A start at rest with both rods at 1.5 to 3.3 rad, to either side. Mass ratio 1 to 10 and
    /// length ratio 0.5 to 2, log. 30 s.
    High,
    /// A start at rest with one rod or both within 1e-10 to 1e-7 rad of upright, log, and the other
    /// rod hanging. Mass ratio 1e-2 to 1e2 and length ratio 0.1 to 10, log.
    Upright,
    /// The class [`Broad`](Self::Broad) with mass ratios of 10 to 1000.
    Heavy,
    /// The class [`Broad`](Self::Broad) with mass ratios of 1e-3 to 0.1.
    Light,
    /// The class [`Broad`](Self::Broad) with mass ratios of 0.1 to 10, length ratios of 0.3 to 3,
    /// and velocities of -60 to 60 rad/s, evenly.
    Fast,
    /// The class [`Broad`](Self::Broad) with 1 to 3000 frames per second and heights of 32 to 1e5
    /// pixels, log. At most [`MOST_FRAMES`].
    Odd,
}

/// The largest number of frames of a scene with an odd frame rate, so that the study ends.
const MOST_FRAMES: f64 = 3_000.0;

impl Class {
    /// All classes.
    pub const ALL: [Self; 7] = [
        Self::Broad,
        Self::High,
        Self::Upright,
        Self::Heavy,
        Self::Light,
        Self::Fast,
        Self::Odd,
    ];

    /// Returns the scenes of this class, without end.
    pub fn scenes(self, seed: u64) -> impl Iterator<Item = Problem> {
        let mut rng = Rng::with_seed(seed);
        std::iter::repeat_with(move || self.scene(&mut rng))
    }

    /// Returns the next random scene of this class.
    fn scene(self, rng: &mut Rng) -> Problem {
        // The ranges of the class.
        let [least_mass, greatest_mass] = match self {
            Self::Broad | Self::Odd => [1e-3, 1e3],
            Self::High => [1.0, 10.0],
            Self::Upright => [1e-2, 1e2],
            Self::Heavy => [10.0, 1e3],
            Self::Light => [1e-3, 0.1],
            Self::Fast => [0.1, 10.0],
        };
        let [least_length, greatest_length] = match self {
            Self::High => [0.5, 2.0],
            Self::Upright => [0.1, 10.0],
            Self::Fast => [0.3, 3.0],
            Self::Broad | Self::Heavy | Self::Light | Self::Odd => [1e-2, 1e2],
        };
        let pendulum = Parameters {
            m1: 1.0,
            m2: log_uniform(rng, least_mass, greatest_mass),
            l1: 1.0,
            l2: log_uniform(rng, least_length, greatest_length),
            g: GRAVITY,
        };

        // The start.
        let start = match self {
            Self::High => {
                let mut angle = || (1.5 + 1.8 * rng.f64()) * if rng.bool() { 1.0 } else { -1.0 };
                Motion::at_rest(angle(), angle())
            }
            Self::Upright => {
                let mut upright =
                    || PI + log_uniform(rng, 1e-10, 1e-7) * if rng.bool() { 1.0 } else { -1.0 };
                let [a1, a2] = [upright(), upright()];
                match rng.u8(0..3) {
                    0 => Motion::at_rest(a1, a2),
                    1 => Motion::at_rest(a1, 0.0),
                    _ => Motion::at_rest(0.0, a2),
                }
            }
            Self::Fast => Motion {
                w1: 60.0 * symmetric(rng),
                w2: 60.0 * symmetric(rng),
                ..swing(rng)
            },
            Self::Broad | Self::Heavy | Self::Light | Self::Odd => {
                let start = swing(rng);
                pushed(rng, &pendulum, start)
            }
        };

        // The duration, and the display.
        let [shortest, longest] = SECONDS;
        let duration = match self {
            Self::High => 30.0,
            _ => log_uniform(rng, shortest, longest),
        };
        let usual = shown(pendulum, start, duration);
        if self != Self::Odd {
            return usual;
        }
        let rate = log_uniform(rng, 1.0, 3e3).round();
        Problem {
            tolerance: half_pixel(&pendulum, log_uniform(rng, 32.0, 1e5)),
            duration: duration.min(MOST_FRAMES / rate),
            rate: rate as u16,
            ..usual
        }
    }
}

/// Returns a number from `LEAST` to `most`. Half of the numbers are distributed evenly in the
/// logarithm, the others evenly.
fn size(rng: &mut Rng, most: f64) -> f64 {
    if rng.bool() {
        log_uniform(rng, LEAST, most)
    } else {
        LEAST + (most - LEAST) * rng.f64()
    }
}

/// Returns a start at rest, whose larger angle is from [`LEAST`] to pi rad.
fn swing(rng: &mut Rng) -> Motion<f64> {
    let amplitude = size(rng, PI);
    let other = amplitude * symmetric(rng);
    match rng.u8(0..3) {
        0 => Motion::at_rest(amplitude, amplitude),
        1 => Motion::at_rest(other, amplitude),
        _ => Motion::at_rest(amplitude, other),
    }
}

/// Gives every other start velocities.
fn pushed(rng: &mut Rng, pendulum: &Parameters<f64>, start: Motion<f64>) -> Motion<f64> {
    if !rng.bool() {
        return start;
    }
    let share = size(rng, 1.0);
    let [of_own, in_all] = GREATEST;
    let mut velocity =
        |l: f64| share * symmetric(rng) * (of_own * (GRAVITY / l).sqrt()).min(in_all);
    Motion {
        w1: velocity(pendulum.l1),
        w2: velocity(pendulum.l2),
        ..start
    }
}

/// Returns a scene on a display of [`HEIGHT`], accurate to half a pixel.
pub fn shown(pendulum: Parameters<f64>, start: Motion<f64>, duration: f64) -> Problem {
    Problem {
        pendulum,
        start,
        tolerance: half_pixel(&pendulum, HEIGHT),
        duration,
        rate: RATE,
    }
}

/// Returns scenes that are accurate for some 20 s in 64 bits, each with neighbours, whose roundings
/// differ.
pub fn long() -> impl Iterator<Item = Problem> {
    let scenes = [
        (1.18219, 0.714144, 2.17128, 1.27892),
        (2.15233, 1.72009, -2.41900, -2.39437),
    ];
    scenes.into_iter().flat_map(|(m2, l2, a1, a2)| {
        [-1e-6, 0.0, 1e-6].map(|by| shown(pendulum(m2, l2), Motion::at_rest(a1 + by, a2), 30.0))
    })
}

/// Returns scenes with a short rod 2 whose horizons were once predicted too long. The last scene
/// was wrong on processors with a floating-point unit, the others on processors without one.
///
/// Each method was compared with runs in finer steps, and these had most of its rounding error,
/// too.
pub fn short_rods() -> impl Iterator<Item = Problem> {
    // A row has the mass of bob 2, the length of rod 2, the rate, the height, and a small number.
    // It is added to both angles; relative to their values, it is added to the mass, and 0.7 of it
    // to the length.
    let scenes = [
        (0.85, 0.016, 104, 5856.0, 38e-5),
        (0.01, 0.016, 104, 5856.0, 31e-5),
        (0.05, 0.0125, 300, 5856.0, 66e-5),
        (0.2, 0.014, RATE, HEIGHT, 13e-5),
        (0.05, 0.0125, RATE, HEIGHT, 64e-5),
    ];
    let at_rest = scenes.into_iter().map(|(m2, l2, rate, height, by)| {
        let pendulum = pendulum(m2 * (1.0 + by), l2 * (1.0 + 0.7 * by));
        let start = Motion::at_rest(2.2 + by, 2.2 + by);
        Problem {
            tolerance: half_pixel(&pendulum, height),
            rate,
            ..shown(pendulum, start, 8.0)
        }
    });
    let fast = Problem {
        pendulum: pendulum(0.011192425328762969, 0.021502645912321146),
        start: Motion {
            a1: 0.2940251127879723,
            a2: 0.2884150947959518,
            w1: 16.4131052129195,
            w2: -17.142257446857524,
        },
        tolerance: 6.961391928707436e-5,
        duration: 4.31689099445246,
        rate: 16,
    };
    at_rest.chain([fast])
}

/// Returns a pendulum with a bob 1 of 1 kg and a rod 1 of 1 m.
fn pendulum(m2: f64, l2: f64) -> Parameters<f64> {
    Parameters {
        m1: 1.0,
        m2,
        l1: 1.0,
        l2,
        g: GRAVITY,
    }
}

/// Returns scenes with horizons that planners have once predicted too long.
///
/// In most of them the 64-bit run that others were compared with was as inaccurate as these, by the
/// truncation of its steps and along the same unstable direction. In some, two runs in long steps
/// had almost the same error. In others, the growth of rounding errors was estimated too low: of
/// early ones, or when shadows had not been started again for seconds. The last three at rest start
/// so close to upright that torques are some 100 units of 32-bit fixed point.
pub fn hard() -> impl Iterator<Item = Problem> {
    // A row has the mass of bob 2, the length of rod 2, both angles, and the duration.
    let at_rest = [
        (
            1.4826889256467146,
            1.4799525044318236,
            [-2.0018157303742776, 1.5338129848838782],
            30.0,
        ),
        (
            9.21277683541668,
            1.0810234776001242,
            [2.8729130334994313, 1.8442480319308214],
            30.0,
        ),
        (
            4.531706614680641,
            1.2479179547187897,
            [3.158238877824255, 3.2087658676989745],
            21.564,
        ),
        (
            1.0472617484882536,
            1.055621710215608,
            [-2.158383629003499, 2.0514647871209992],
            30.0,
        ),
        (
            9.177492549219721,
            1.5931701961118174,
            [-1.9199503961822268, 1.5437370172036957],
            30.0,
        ),
        (1.5, 1.5, [-1.9, 1.5], 30.0),
        (
            3.4351644469898424,
            0.8252731667216725,
            [2.954107937931796, -2.8533645723251544],
            30.0,
        ),
        (
            3.5655412876168424,
            0.991392561863083,
            [2.2300776406129033, 1.5698256601019014],
            30.0,
        ),
        (
            2.984898867826733,
            1.8673452819254164,
            [2.2082918834551712, 1.9751053641836052],
            30.0,
        ),
        (
            5.059922776667145,
            0.7875533309654146,
            [1.9840807868409727, -2.3164628977526847],
            30.0,
        ),
        (
            4.808452641890087,
            1.0320854427363506,
            [-1.550699714462983, 2.0555724626043013],
            30.0,
        ),
        (
            2.4126302322162503,
            0.911639004985877,
            [3.0246924974103186, 3.2781311372549506],
            30.0,
        ),
        (
            3.6645988090899904,
            0.6130338972866217,
            [-3.1557213068029744, -2.861459305394095],
            30.0,
        ),
        (
            6.243382693506682,
            0.8753101683050682,
            [3.282449549873869, -2.214502754869359],
            30.0,
        ),
        (
            8.104633467615994,
            0.6928820764391944,
            [-1.8067514901545316, 3.246225940068654],
            30.0,
        ),
        (
            3.2485178311660228,
            1.2442032103378218,
            [1.6646630311859791, -1.724569579598427],
            30.0,
        ),
        (
            3.1113151661264635,
            0.5406506074470387,
            [-1.84185473189565, 2.382330233059772],
            30.0,
        ),
        (
            36.52164454459284,
            0.9099955648494059,
            [0.0, 3.141592526716453],
            4.168,
        ),
        (
            12.163950762818784,
            0.525717763591576,
            [3.141592931761884, 0.0],
            4.168,
        ),
        (
            26.02443797796008,
            0.11214485532614257,
            [0.0, 3.1415926713421167],
            4.168,
        ),
    ]
    .map(|(m2, l2, [a1, a2], duration)| shown(pendulum(m2, l2), Motion::at_rest(a1, a2), duration));
    // Only this scene starts with velocities.
    let moving = Problem {
        rate: 11,
        ..shown(
            pendulum(5.548479106136162, 1.7324935668359651),
            Motion {
                a1: 1.2317869673428747,
                a2: -0.40585594813669523,
                w1: -7.6660058872035,
                w2: 4.276755632018979,
            },
            14.5,
        )
    };
    at_rest.into_iter().chain([moving])
}
