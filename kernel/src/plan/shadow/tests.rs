//! Tests of the error that shadows show, and of their starts.

use super::*;
use crate::pendulum::Motion;

/// A pendulum with a bob 1 of 1 kg and a rod 1 of 1 m, and its start.
struct Case {
    m2: f64,
    l2: f64,
    /// Two angles, rad, and two angular velocities, rad/s.
    start: [f64; 4],
    /// True if fixed point refuses the usual steps of the shadows as too long.
    needs_finer_steps: bool,
    /// The smallest and the largest ratio of the error that the shadows show to the exact one.
    ratios: [f64; 2],
}

/// In the first motion an error of the second second grows 30 times as much as one of the
/// start. The others have a heavy bob 2, in small and in large oscillations, unlike rods, a
/// light bob 2 whose shadows need finer steps in fixed point, and a start in motion.
const CASES: [Case; 7] = [
    Case {
        m2: 2.984898867826733,
        l2: 1.8673452819254164,
        start: [2.2082918834551712, 1.9751053641836052, 0.0, 0.0],
        needs_finer_steps: false,
        ratios: [0.8, 1.3],
    },
    Case {
        m2: 1000.0,
        l2: 1.0,
        start: [0.05, 0.05, 0.0, 0.0],
        needs_finer_steps: false,
        ratios: [0.8, 1.8],
    },
    Case {
        m2: 100.0,
        l2: 1.0,
        start: [1.0, 1.5, 0.0, 0.0],
        needs_finer_steps: false,
        ratios: [0.2, 10.0],
    },
    Case {
        m2: 1.0,
        l2: 0.1,
        start: [2.0, 2.0, 0.0, 0.0],
        needs_finer_steps: false,
        ratios: [0.7, 2.2],
    },
    Case {
        m2: 1.0,
        l2: 10.0,
        start: [2.0, 2.0, 0.0, 0.0],
        needs_finer_steps: false,
        ratios: [0.7, 1.4],
    },
    Case {
        m2: 0.05,
        l2: 10.0,
        start: [2.5, 2.5, 0.0, 0.0],
        needs_finer_steps: true,
        ratios: [0.45, 1.3],
    },
    Case {
        m2: 0.5,
        l2: 0.7,
        start: [0.5, 1.0, 6.0, -9.0],
        needs_finer_steps: false,
        ratios: [0.65, 1.2],
    },
];

impl Case {
    fn problem(&self) -> Problem {
        let [a1, a2, w1, w2] = self.start;
        Problem {
            pendulum: Parameters {
                m1: 1.0,
                m2: self.m2,
                l1: 1.0,
                l2: self.l2,
                g: 9.81,
            },
            start: Motion { a1, a2, w1, w2 },
            tolerance: 0.04,
            duration: 8.0,
            rate: 60,
        }
    }

    /// Returns the state after a frame, in steps of at most an eighth of the admissible step.
    fn after_frame(&self, pendulum: &Pendulum<f64>, start: &State<f64>) -> State<f64> {
        let longest = pendulum.admissible_step(start).expect("a motion") / 8.0;
        let steps = steps_to_frame(Method::Rk4F64, 60, longest);
        let dt = 1.0 / (60.0 * f64::from(steps));
        (0..steps).fold(*start, |state, _| pendulum.step(&state, dt))
    }

    /// Returns the Jacobian matrix of a frame, in units of `scales`, by central differences.
    fn jacobian(&self, pendulum: &Pendulum<f64>, start: &State<f64>, scales: [f64; 2]) -> Matrix {
        const STEP: f64 = 1e-6;
        let columns: Matrix = core::array::from_fn(|j| {
            let [less, more] = [-STEP, STEP].map(|by| {
                let mut change = [0.0; 4];
                change[j] = by;
                self.after_frame(pendulum, &beside(start, change, scales))
            });
            let [s1, s2] = scales;
            let change = [
                more.a1 - less.a1,
                more.a2 - less.a2,
                (more.p1 - less.p1) / s1,
                (more.p2 - less.p2) / s2,
            ];
            change.map(|change| change / (2.0 * STEP))
        });
        core::array::from_fn(|i| columns.map(|column| column[i]))
    }
}

/// The number of frames after which the two errors are compared. At first the shadows lag
/// behind, because errors are only added when they are restarted.
const FIRST_FRAMES: u32 = 120;
/// The steps per frame of the run in 64 bits, which is only assumed.
const FINE_STEPS: u32 = 12;

/// Returns the root of the expected square of the distance of two frames, in the unit of
/// `rods`, if the covariance matrix of the error is `root` times its transpose.
fn expected_distance([l1, l2]: [f64; 2], state: &State<f64>, root: &Matrix) -> f64 {
    let [a1, a2, ..] = root;
    let bob1 = l1 * l1 * dot(a1, a1);
    let relative = l2 * l2 * dot(a2, a2);
    let cos = libm::cos(state.a1 - state.a2);
    let bob2 = bob1 + relative + 2.0 * l1 * l2 * cos * dot(a1, a2);
    libm::sqrt(bob1.max(relative).max(bob2))
}

/// Returns the smallest and the largest ratio of the error that shadows by `method` show to the
/// error that random errors of the start and of every frame cause. The covariance matrix of the
/// latter is propagated by the Jacobian matrix of every frame.
fn ratios(case: &Case, method: Method) -> Result<[f64; 2], Error> {
    let problem = case.problem();
    let pendulum = Pendulum::new(&problem.pendulum)?;
    let mut state = pendulum.to_state(&problem.start);
    let rods = [problem.pendulum.l1, problem.pendulum.l2].map(|l| l / problem.tolerance);

    // Prepare the shadows.
    let scales = scales(&pendulum, &state);
    let admissible = pendulum.admissible_step(&state)?;
    let stepping = Shadows::stepping(method, problem.rate, admissible);
    let mut shadows = Shadows::new(stepping, &problem, scales, admissible, FINE_STEPS);
    while !shadows.are_prepared() {
        shadows.prepare(&problem, &state)?;
    }
    let has_finer_steps = shadows.runs[0].stepping != stepping;
    assert_eq!(
        has_finer_steps,
        case.needs_finer_steps && method == Method::Rk4Fixed32
    );

    // Begin with a root of the covariance matrix of the start. The shadows represent the same.
    let [of_start, _] = ROUNDING.map(f64::from);
    let mut root = [[0.0; 4]; 4];
    let [s1, s2] = scales;
    for (i, share) in [1.0, 1.0, state.p1 / s1, state.p2 / s2]
        .into_iter()
        .enumerate()
    {
        root[i][i] = of_start * share;
    }
    let [center, others @ ..] = shadows.runs.each_ref().map(Place::of);
    for (column, other) in others.iter().enumerate() {
        for (row, difference) in other.minus(&center, scales).into_iter().enumerate() {
            let shown = f64::from(shadows.unit) * difference;
            assert!(
                (shown - root[row][column]).abs() < 0.01 * of_start,
                "{row} {column}: {shown} {root:?}"
            );
        }
    }

    let mut ratios = [f64::INFINITY, 0.0];
    for frame in 1..=problem.frames() {
        // Propagate the error by the Jacobian matrix, and add that of the frame.
        let columns = |row: [f64; 4]| {
            core::array::from_fn(|column| (0..4).map(|j| row[j] * root[j][column]).sum())
        };
        let propagated = case.jacobian(&pendulum, &state, scales).map(columns);
        let variance = f64::from(shadows.frame_error).powi(2);
        root = cholesky(&propagated, variance, variance);

        // Advance the shadows and the motion to the frame.
        if shadows.is_due() {
            shadows.restart(&state);
        }
        for run in shadows.runs() {
            let steps = run.stepping.steps;
            run.motion.as_mut().expect("prepared").advance(steps);
        }
        state = case.after_frame(&pendulum, &state);
        let shown = f64::from(shadows.compare(rods.map(|rod| rod as f32)));

        // Compare the two.
        let ratio = shown / expected_distance(rods, &state, &root);
        assert!(ratio.is_finite(), "frame {frame}: {shown}");
        if frame > FIRST_FRAMES {
            let [least, most] = ratios;
            ratios = [least.min(ratio), most.max(ratio)];
        }
    }
    Ok(ratios)
}

/// In small oscillations the errors hardly grow, so that the shadows are restarted by the phase
/// only. Over ten restarts, the estimated cost of a frame is right to a hundredth.
#[test]
fn estimated_cost_is_that_of_all_steps_and_restarts() -> Result<(), Error> {
    let problem = Problem {
        pendulum: Parameters::equal_rods(1.0, 1.0, 9.81),
        start: Motion::at_rest(0.05, 0.05),
        tolerance: 0.04,
        duration: 60.0,
        rate: 60,
    };
    let costs = Costs::CORTEX_M3;
    let pendulum = Pendulum::new(&problem.pendulum)?;
    let start = pendulum.to_state(&problem.start);
    let admissible = pendulum.admissible_step(&start)?;
    let stepping = Shadows::stepping(Method::Rk4Fixed32, problem.rate, admissible);
    let scales = scales(&pendulum, &start);
    let mut shadows = Shadows::new(stepping, &problem, scales, admissible, FINE_STEPS);
    while !shadows.are_prepared() {
        shadows.prepare(&problem, &start)?;
    }

    // Add the costs of all frames up to the tenth restart.
    let mut cost = 0.0;
    let mut frames = 0;
    let mut restarts = 0;
    while restarts < 10 {
        for run in shadows.runs() {
            run.motion
                .as_mut()
                .expect("prepared")
                .advance(run.stepping.steps);
            cost += costs.of_frame(run.stepping);
        }
        shadows.compare([25.0; 2]);
        frames += 1;
        if shadows.is_due() {
            let central = shadows.runs[0].motion.as_ref().expect("prepared");
            let state = central.state();
            shadows.restart(&state);
            cost += costs.preparation;
            restarts += 1;
        }
    }
    let estimated = Shadows::cost_of_frame(stepping, admissible, problem.rate, &costs);
    let measured = cost / frames as f32;
    assert!(
        (estimated / measured - 1.0).abs() < 0.01,
        "{estimated} {measured}"
    );
    Ok(())
}

/// The shadows show the rounding error that random errors of the start and of all frames cause.
/// Before the first frame, they represent the errors of the start.
#[test]
fn shadows_show_the_expected_error_of_roundings_in_all_frames() -> Result<(), Error> {
    for case in &CASES {
        for method in [Method::Rk4Fixed32, Method::Rk4F32Direction] {
            let [least, most] = ratios(case, method)?;
            let [lowest, highest] = case.ratios;
            assert!(
                lowest < least && most < highest,
                "m2 = {}, l2 = {}, {method:?}: {least} to {most}",
                case.m2,
                case.l2
            );
        }
    }
    Ok(())
}

/// At the start the error of shadows is in proportion to the rods. At 1 frame per second the
/// error in rods of 1 cm grows by more than shadows can show. Then it is unknown, instead of
/// too small. The errors of frames are independent, so that the recent error of 9 frames is 3
/// times that of one.
#[test]
fn error_is_known_until_shadows_are_too_far_apart() -> Result<(), Error> {
    let problem = Problem {
        pendulum: Parameters::equal_rods(1.0, 0.01, 9.81),
        start: Motion::at_rest(2.5, 2.5),
        tolerance: 1e-3,
        duration: 1.0,
        rate: 1,
    };
    let pendulum = Pendulum::new(&problem.pendulum)?;
    let start = pendulum.to_state(&problem.start);
    let admissible = pendulum.admissible_step(&start)?;
    let stepping = Shadows::stepping(Method::Rk4Fixed32, 1, admissible);
    let scales = scales(&pendulum, &start);
    let mut shadows = Shadows::new(stepping, &problem, scales, admissible, FINE_STEPS);
    while !shadows.are_prepared() {
        shadows.prepare(&problem, &start)?;
    }
    // At the start the error is known and in proportion to the rods.
    let [error, doubled] = [1.0, 2.0].map(|scale| {
        let mut at_start = shadows;
        at_start.compare([scale, 3.0 * scale])
    });
    assert!(error > 0.0 && (doubled / (2.0 * error) - 1.0).abs() < 1e-6);

    for run in shadows.runs() {
        let steps = run.stepping.steps;
        run.motion.as_mut().expect("prepared").advance(steps);
    }
    assert!(shadows.compare([1.0; 2]).is_nan());

    shadows.frames = 9;
    assert_eq!(shadows.recent_error(), 3.0 * shadows.frame_error);
    Ok(())
}

/// Fixed point refuses the first steps per frame as too long. For rods of 150 m one step
/// becomes two. For rods of 1 um 256 steps become more, until they are accepted. For rods of 1
/// pm not even 65,536 steps ([`MOST_STEPS`]) are enough, and [`Shadows::prepare`] returns that
/// error.
#[test]
fn refused_steps_of_shadows_become_finer_up_to_65_536() -> Result<(), Error> {
    for (length, first, accepted) in [
        (150.0, 1, Some(2)),
        (1e-6, 256, Some(32_768)),
        (1e-8, 256, None),
    ] {
        let problem = Problem {
            pendulum: Parameters::equal_rods(1.0, length, 9.81),
            start: Motion::at_rest(0.1, 0.1),
            tolerance: 1e-3,
            duration: 1.0,
            rate: 1,
        };
        let pendulum = Pendulum::new(&problem.pendulum)?;
        let start = pendulum.to_state(&problem.start);
        let stepping = Stepping {
            method: Method::Rk4Fixed32,
            steps: first,
        };
        let scales = scales(&pendulum, &start);
        let mut shadows = Shadows::new(stepping, &problem, scales, 1.0, FINE_STEPS);
        let refused = loop {
            if shadows.are_prepared() {
                break None;
            }
            if let Err(error) = shadows.prepare(&problem, &start) {
                break Some(error);
            }
        };
        let most = shadows.runs().map(|run| run.stepping.steps).max();
        assert_eq!(most, accepted.or(Some(MOST_STEPS)), "{length}");
        let is_too_long = matches!(
            refused,
            Some(Error::TooLarge {
                parameter: Parameter::Dt,
                ..
            })
        );
        assert_eq!(is_too_long, accepted.is_none(), "{length}: {refused:?}");
    }
    Ok(())
}

/// If the method refuses a shadow on one side of the start, the shadow is prepared on the opposite
/// side. Here the step is just short enough for the energy of the start, so that all shadows
/// with more energy are refused.
#[test]
fn refused_shadow_is_prepared_on_the_opposite_side() -> Result<(), Error> {
    // An increase of any number of the state increases the energy. The longest step that is
    // accepted is in inverse proportion to the speed.
    let at_speed = |speed: f64| Problem {
        pendulum: Parameters::equal_rods(1.0, 1.0, 9.81 * speed * speed),
        start: Motion {
            a1: 0.5,
            a2: 0.5,
            w1: 5.0 * speed,
            w2: 5.0 * speed,
        },
        tolerance: 1e-3,
        duration: 1.0,
        rate: 1,
    };
    let stepping = Stepping {
        method: Method::Rk4Fixed32,
        steps: 64,
    };

    // Choose the speed from the longest step that is accepted at a speed of 1.
    let Problem {
        pendulum, start, ..
    } = at_speed(1.0);
    let start = Pendulum::new(&pendulum)?.to_state(&start);
    let refused = Motion32::new(stepping.method, &pendulum, &start, 1.0);
    let Err(Error::TooLarge { limit, .. }) = refused else {
        panic!("a step of 1 s is not refused: {refused:?}");
    };
    let problem = at_speed(64.0 * limit * (1.0 - 1e-9));

    // Prepare all shadows.
    let pendulum = Pendulum::new(&problem.pendulum)?;
    let start = pendulum.to_state(&problem.start);
    let scales = scales(&pendulum, &start);
    let mut shadows = Shadows::new(stepping, &problem, scales, 1.0, FINE_STEPS);
    while !shadows.are_prepared() {
        assert_eq!(shadows.prepare(&problem, &start), Ok(()));
    }

    // The steps are unchanged, and all others have less energy than the central shadow.
    let [center, others @ ..] = shadows.runs.map(|run| {
        assert_eq!(run.stepping, stepping);
        let state = run.motion.expect("prepared").state();
        pendulum.energy_above_rest(&state)
    });
    assert!(
        others.iter().all(|energy| *energy < center),
        "{center} {others:?}"
    );
    Ok(())
}

/// If nothing can move, the units of the momenta are 1.
#[test]
fn units_of_momenta_are_never_zero() -> Result<(), Error> {
    let pendulum = Pendulum::new(&Parameters::equal_rods(1.0, 1.0, 0.0))?;
    assert_eq!(scales(&pendulum, &State::at_rest(1.0, 2.0)), [1.0; 2]);
    Ok(())
}

/// The difference of angles is given by its sine, or by 1 or -1 beyond a right angle. That of
/// momenta is in units of the scales.
#[test]
fn differences_of_places_are_in_the_order_of_the_state() {
    let place = |[a1, a2]: [f64; 2], momenta| Place {
        directions: [a1, a2].map(|a| [libm::sin(a), libm::cos(a)]),
        momenta,
    };
    for (from, to, expected) in [
        ([1.0, -2.0], [1.1, -2.2], [libm::sin(0.1), libm::sin(-0.2)]),
        ([1.0, -2.0], [3.0, -5.0], [1.0, -1.0]),
        // Rod 1 passes the horizontal, and rod 2 the vertical.
        (
            [1.571, -0.001],
            [1.5, 0.1],
            [libm::sin(-0.071), libm::sin(0.101)],
        ),
    ] {
        let from = place(from, [3.0, 4.0]);
        let difference = place(to, [3.5, 3.0]).minus(&from, [2.0, 4.0]);
        let [a1, a2] = expected;
        for (value, expected) in difference.into_iter().zip([a1, a2, 0.25, -0.25]) {
            assert!((value - expected).abs() < 1e-15, "{difference:?}");
        }
    }
}

/// The product of the Cholesky factor with its transpose is D D^T + v I, to 1e-14. If that is
/// singular, the factor is finite, and its diagonal elements have the least square.
#[test]
fn cholesky_factor_is_a_root_of_the_matrix() {
    let rows = [
        [1.0, 0.0, 0.1, 0.0],
        [2.0, 1.5, -0.7, 0.0],
        [-1.0, 0.3, 1.0, 0.0],
        [0.5, -0.2, 0.0, 0.4],
    ];
    let factor = cholesky(&rows, 0.25, 0.0);
    for i in 0..4 {
        for j in 0..4 {
            let variance = if i == j { 0.25 } else { 0.0 };
            let expected = dot(&rows[i], &rows[j]) + variance;
            let product = dot(&factor[i], &factor[j]);
            assert!(
                (product - expected).abs() < 1e-14,
                "{i} {j}: {product} {expected}"
            );
            assert!(j <= i || factor[i][j] == 0.0);
        }
    }

    let singular = cholesky(&rows.map(|[first, ..]| [first, 0.0, 0.0, 0.0]), 0.0, 1e-6);
    assert_eq!([1, 2, 3].map(|i| singular[i][i]), [1e-3; 3]);
}
