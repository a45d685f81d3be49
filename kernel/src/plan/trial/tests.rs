//! Tests of the comparisons, perturbations and costs of a trial.

use super::*;
use crate::methods::Fixed32;
use crate::pendulum::{Motion, Parameters};
use crate::plan::cost::admissible_step;
use crate::plan::problem::Perturbation;

/// Oscillations of equal rods, for a second.
fn oscillation() -> Problem {
    Problem {
        pendulum: Parameters::equal_rods(1.0, 1.0, 9.81),
        start: Motion::at_rest(0.5, 0.5),
        tolerance: 0.01,
        duration: 1.0,
        rate: 60,
    }
}

/// The factors for two and three finer runs are multiplied by `alike`. The factor for a single
/// finer run is not.
#[test]
fn errors_in_common_do_not_change_the_factor_of_a_single_finer_run() {
    let stepping = Stepping {
        method: Method::Rk4Fixed32,
        steps: 4,
    };
    let [one, two, three] = BESIDE_FINER_RUNS;
    for (number, expected) in [(1, one), (2, 4.0 * two), (3, 4.0 * three)] {
        let judges = Judges::FinerRuns(number);
        let mut trial = Trial::new(stepping, &oscillation(), judges, stepping);
        trial.alike = 4.0;
        assert_eq!(trial.factor(), expected, "{number}");
    }
}

/// The bound has a factor of 8 if the steps are longer than 64 admissible steps.
#[test]
fn bound_is_larger_in_very_long_steps() -> Result<(), Error> {
    for (length, expected) in [(63.9, 1.0), (64.1, 8.0)] {
        // A step lasts a third of a second. Without gravity, the admissible step is inversely
        // proportional to the velocity.
        let mut problem = Problem {
            rate: 1,
            ..oscillation()
        };
        problem.pendulum.g = 0.0;
        problem.start = Motion {
            a1: 1.0,
            a2: 0.5,
            w1: 1.0,
            w2: 0.0,
        };
        problem.start.w1 *= 3.0 * length * admissible_step(&problem)?;
        let stepping = Stepping {
            method: Method::Rk4F32Direction,
            steps: 3,
        };
        let judges = Judges::FinerRuns(MOST_FINER_RUNS);
        let trial = Trial::new(stepping, &problem, judges, stepping);
        assert_eq!(trial.alike, expected, "{length}");
    }
    Ok(())
}

/// Asserts that the frame of `motion` is valid at first, and NaN after the steps of `stepping`,
/// although the directions of the motion still look valid then.
fn assert_diverges<M: Advance>(stepping: Stepping, motion: M) {
    let mut run = Run::new(stepping);
    run.motion = Some(motion);
    assert!(run.frame().as_flattened().iter().all(|part| !part.is_nan()));
    run.advance(&Costs::CORTEX_M3, f32::INFINITY);
    let frame = run.frame();
    let shown = run.motion.map(|motion| motion.directions::<f32>());
    assert!(
        frame.as_flattened().iter().all(|part| part.is_nan()),
        "{stepping:?}: {frame:?}"
    );
    assert!(
        shown.is_some_and(|shown| shown.as_flattened().iter().all(|part| part.abs() <= 1.0)),
        "{stepping:?}: {shown:?}"
    );
}

/// The frame of a motion that has diverged is NaN, in 32 and in 64 bits, although its
/// directions look valid.
#[test]
fn frame_of_a_diverged_motion_is_nan() -> Result<(), Error> {
    let pendulum = Pendulum::new(&oscillation().pendulum)?;
    let parameters = pendulum.parameters();
    let small = pendulum.to_state(&oscillation().start);
    let high = pendulum.to_state(&Motion::at_rest(2.0, 2.0));

    // The units are those of the small oscillation, so that the check refuses more energy.
    let dt = 1.0 / 512.0;
    let fixed32 = Fixed32::new(parameters, &small, dt)?.started(&high)?;
    let method = Method::Rk4Fixed32;
    assert_diverges(
        Stepping { method, steps: 32 },
        Motion32::Rk4Fixed32(fixed32),
    );

    // In 64 bits the velocities of a fast start have no room in the units of the small one.
    let fast = pendulum.to_state(&Motion {
        a1: 0.0,
        a2: 0.0,
        w1: 20.0,
        w2: 20.0,
    });
    let fixed64 = Motion64::new(parameters, &small, dt)?.started(&fast)?;
    let method = Method::Extrapolation10Fixed64;
    assert_diverges(Stepping { method, steps: 1 }, fixed64);
    Ok(())
}

/// Returns the motion of `problem` by this method and step count, with perturbed inputs.
fn perturbed(
    problem: &Problem,
    Stepping { method, steps }: Stepping,
    by: Perturbation,
) -> Result<Motion32, Error> {
    let start = Pendulum::new(&problem.pendulum)?.to_state(&problem.start);
    let (parameters, start) = problem.perturbed(&start, by, method);
    let dt = 1.0 / (f64::from(problem.rate) * f64::from(steps));
    Motion32::new(method, &parameters, &start, dt)
}

/// A single finer run has the third perturbation, and three finer runs have one each. The
/// candidates and all runs of a trial with a reference are not perturbed.
#[test]
fn only_finer_runs_are_perturbed() -> Result<(), Error> {
    let problem = oscillation();
    let stepping = Stepping {
        method: Method::Rk4F32Direction,
        steps: 4,
    };
    let [first, second, third] = PERTURBATIONS.map(Some);
    let none = Some(NONE);
    for (judges, expected) in [
        (Judges::FinerRuns(1), [none, third, None, none, None]),
        (Judges::FinerRuns(3), [none, first, second, none, third]),
        (
            Judges::Reference(Pair::new(6, 8)),
            [none, none, none, none, None],
        ),
    ] {
        let mut trial = Trial::new(stepping, &problem, judges, stepping);
        while trial.prepare(&problem)? {}
        for (place, (run, by)) in trial.single.iter().zip(expected).enumerate() {
            let expected = by.map(|by| perturbed(&problem, run.stepping, by));
            assert_eq!(run.motion.map(Ok), expected, "{judges:?}, {place}");
        }
    }
    Ok(())
}

/// A finer run that is refused with its perturbation gets the opposite one. Here fixed point
/// refuses the steps as too long if rod 2 is slightly shorter than rod 1, as with the third
/// perturbation. If rod 2 is slightly longer, it accepts them.
#[test]
fn refused_perturbation_is_reversed() -> Result<(), Error> {
    let problem = Problem {
        pendulum: Parameters {
            m2: 1.0 / 3.0,
            ..Parameters::equal_rods(1.0, 1.0, 9.81)
        },
        start: Motion {
            a1: 0.0,
            a2: 0.0,
            w1: 20.0,
            w2: 0.0,
        },
        rate: 36,
        ..oscillation()
    };
    let stepping = Stepping {
        method: Method::Rk4Fixed32,
        steps: 4,
    };

    // The perturbation is refused, and the opposite one is accepted.
    let mut trial = Trial::new(stepping, &problem, Judges::FinerRuns(1), stepping);
    let finer = trial.single[1].stepping;
    let [.., third] = PERTURBATIONS;
    let refused = perturbed(&problem, finer, third);
    assert!(
        matches!(refused, Err(Error::TooLarge { .. })),
        "{refused:?}"
    );
    let opposite = perturbed(&problem, finer, third.map(|by| -by))?;

    // Prepare all motions.
    let prepared = loop {
        let prepared = trial.prepare(&problem);
        if prepared != Ok(true) {
            break prepared;
        }
    };
    assert_eq!(prepared, Ok(false));
    assert_eq!(trial.single[1].motion, Some(opposite));
    Ok(())
}

/// The runs of a pendulum that hangs at rest do not differ, so that rounding is not the larger
/// error.
#[test]
fn pendulum_at_rest_is_not_limited_by_rounding() -> Result<(), Error> {
    let problem = Problem {
        start: Motion::at_rest(0.0, 0.0),
        ..oscillation()
    };
    let stepping = Stepping {
        method: Method::Rk4F32Direction,
        steps: 4,
    };
    let mut trial = Trial::new(stepping, &problem, Judges::FinerRuns(3), stepping);
    while trial.prepare(&problem)? {}
    while trial.advance(&Costs::CORTEX_M3, f32::INFINITY) > 0.0 {}
    trial.compare(problem.time(1));
    assert_eq!(trial.candidates[0].error, 0.0);
    assert!(!trial.is_limited_by_rounding());
    Ok(())
}

/// A piece may advance several shadows: the price of one and a half frames pays for a frame of
/// one shadow and for half a frame of the next one.
#[test]
fn piece_advances_as_many_shadows_as_it_pays_for() -> Result<(), Error> {
    let problem = oscillation();
    let costs = Costs::CORTEX_M3;
    let stepping = Stepping {
        method: Method::Rk4Fixed32,
        steps: 4,
    };
    let judges = Judges::Reference(Pair::new(6, 8));
    let mut trial = Trial::new(stepping, &problem, judges, stepping);
    while trial.prepare(&problem)? {}

    // Advance the other runs to the frame.
    for (_, run) in trial.single() {
        run.advance(&costs, f32::INFINITY);
    }
    for run in trial.double() {
        run.advance(&costs, f32::INFINITY);
    }
    let cost = 6.0 * costs.fixed32;
    assert_eq!(trial.advance(&costs, cost), cost);
    Ok(())
}

/// Without a reference, the estimated error of a frame is its distance to the frame of the single
/// candidate, plus the greatest distance of that to the finer runs. With a reference it is the
/// distance to the frame of the fine run, plus the error of that.
#[test]
fn estimated_errors_contain_those_of_the_compared_runs() -> Result<(), Error> {
    let problem = Problem {
        tolerance: 0.125,
        rate: 6,
        ..oscillation()
    };
    let rods = [8.0; 2]; // 1 m divided by the tolerance.
    let stepping = Stepping {
        method: Method::Rk4F32Direction,
        steps: 4,
    };
    let reference = Judges::Reference(Pair::new(1, 2));
    for judges in [Judges::FinerRuns(3), reference] {
        let mut trial = Trial::new(stepping, &problem, judges, stepping);
        trial.share_of_fine = 0.5;
        while trial.prepare(&problem)? {}

        // Rounded to `f32`, both runs of the reference are equal, unless one starts elsewhere.
        if let Some(coarse) = &mut trial.double[0].motion {
            *coarse = coarse.started(&State::at_rest(0.51, 0.5))?;
        }
        while trial.advance(&Costs::CORTEX_M3, f32::INFINITY) > 0.0 {}
        let [own, second, third, plain, fourth] = trial.single.each_mut().map(Run::frame);
        let double = trial.double.each_mut().map(Run::frame);
        trial.compare(problem.time(1));

        let closed = trial.closed.expect("the pendulum has normal modes");
        let closed = closed.directions(problem.time(1));
        let between = |a, b| distance(rods, &a, &b);
        let (compared, error) = match judges {
            Judges::FinerRuns(_) => {
                let distances = [second, third, fourth].map(|finer| between(own, finer));
                (own, distances.into_iter().fold(0.0, greater))
            }
            Judges::Reference(_) => {
                let [coarse, fine] = double;
                (fine, 0.5 * between(coarse, fine))
            }
        };
        assert!(error > 0.0, "{judges:?}: the runs do not differ");
        for (candidate, shown) in [(0, own), (PLAIN, plain), (CLOSED, closed)] {
            let candidate = &trial.candidates[candidate];
            assert!(candidate.is_accurate(), "{judges:?}: {candidate:?}");
            let expected = between(shown, compared) + error;
            assert_eq!(candidate.error, expected, "{judges:?}: {candidate:?}");
        }
    }
    Ok(())
}

/// Finer steps gain little if 4 times the steps have a horizon less than 1.5 times that of twice
/// the steps. This is not known if neither has one.
#[test]
fn finer_steps_gain_little_if_four_times_the_steps_do() {
    let stepping = Stepping {
        method: Method::Rk4Fixed32,
        steps: 4,
    };
    let judges = Judges::Reference(Pair::new(6, 8));
    for (horizons, expected) in [
        ([10, 14], true),
        ([10, 15], false),
        ([10, 0], true),
        ([0, 0], false),
    ] {
        let mut trial = Trial::new(stepping, &oscillation(), judges, stepping);
        for (candidate, frames) in trial.candidates[1..].iter_mut().zip(horizons) {
            candidate.accurate_frames = frames;
        }
        assert_eq!(trial.finer_steps_gain_little(), expected, "{horizons:?}");
    }
}

/// Errors grow fast if the bound was at most 1/64 of the tolerance for more than a quarter of the
/// accurate frames.
#[test]
fn errors_grow_fast_if_they_are_small_for_more_than_a_quarter() {
    let stepping = Stepping {
        method: Method::Rk4Fixed32,
        steps: 4,
    };
    let mut trial = Trial::new(stepping, &oscillation(), Judges::FinerRuns(3), stepping);
    for (small, accurate, expected) in [
        (0, 0, false),
        (0, 1, false),
        (1, 1, true),
        (5, 20, false),
        (6, 20, true),
    ] {
        trial.small_frames = small;
        trial.candidates[OWN].accurate_frames = accurate;
        assert_eq!(trial.errors_grow_fast(), expected, "{small} of {accurate}");
    }
}

/// A frame counts as small if no bound until then has exceeded 1/64 of the tolerance.
#[test]
fn small_frames_end_at_the_first_larger_bound() -> Result<(), Error> {
    let problem = Problem {
        rate: 30,
        tolerance: 2e-4,
        ..oscillation()
    };
    let stepping = Stepping {
        method: Method::Rk4Fixed32,
        steps: 1,
    };
    let mut trial = Trial::new(stepping, &problem, Judges::FinerRuns(3), stepping);
    let mut small = 0;
    for frame in 1..=60 {
        while trial.prepare(&problem)? {}
        while trial.advance(&Costs::CORTEX_M3, f32::INFINITY) > 0.0 {}
        trial.compare(problem.time(frame));

        // The estimated error is the largest distance until now.
        if trial.factor() * trial.candidates[OWN].error <= 1.0 / 64.0 {
            small = frame;
        }
        assert_eq!(trial.small_frames, small, "{frame}");
    }
    assert!((1..60).contains(&small), "{small}");
    Ok(())
}

/// [`Trial::cost`] estimates the cost of a frame exactly, with each number of finer runs and
/// with a reference, except for the closed form and the shadows. The cost of a whole frame
/// includes both.
#[test]
fn estimated_cost_of_a_frame_is_exact() -> Result<(), Error> {
    let problem = oscillation();
    let costs = Costs::CORTEX_M3;
    // With 8 steps, the finer runs make 10, 12 and 14, and the other candidates 16 and 32.
    let [fixed, float] = [Method::Rk4Fixed32, Method::Rk4F32Direction];
    let both = costs.direction + costs.direction_plain;
    for (method, judges, expected) in [
        (fixed, Judges::FinerRuns(1), 18.0 * costs.fixed32),
        (fixed, Judges::FinerRuns(2), 30.0 * costs.fixed32),
        (fixed, Judges::FinerRuns(3), 44.0 * costs.fixed32),
        (
            float,
            Judges::FinerRuns(1),
            10.0 * costs.direction + 8.0 * both,
        ),
        (
            float,
            Judges::FinerRuns(3),
            36.0 * costs.direction + 8.0 * both,
        ),
        (
            fixed,
            Judges::Reference(Pair::new(6, 8)),
            56.0 * costs.fixed32 + 14.0 * costs.fixed64,
        ),
    ] {
        let stepping = Stepping { method, steps: 8 };
        let mut trial = Trial::new(stepping, &problem, judges, stepping);
        let shadows = if trial.has_reference() {
            5.0 * costs.of_frame(stepping)
        } else {
            0.0
        };
        let with_shadows = trial.frame_cost(&costs) - shadows;
        trial.exclude_64_bits();
        while trial.prepare(&problem)? {}
        let whole = trial.frame_cost(&costs);

        let mut spent = 0.0;
        loop {
            let piece = trial.advance(&costs, f32::INFINITY);
            if piece == 0.0 {
                break;
            }
            spent += piece;
        }
        let estimated = Trial::cost(&costs, stepping, judges);
        let [whole, with_shadows] = [whole, with_shadows].map(|cost| cost - costs.closed_form);
        for cost in [spent, estimated, whole, with_shadows] {
            assert!(
                (cost / expected - 1.0).abs() < 1e-5,
                "{method}, {judges:?}: {cost} instead of {expected}"
            );
        }
    }
    Ok(())
}

/// In a chaotic motion, truncation is the larger error of a reference in long steps when its
/// runs fail, and rounding is the larger error of one in short steps.
#[test]
fn larger_error_of_64_bits_depends_on_the_steps() -> Result<(), Error> {
    let problem = Problem {
        pendulum: Parameters::equal_rods(1.0, 1.0, 9.81),
        start: Motion::at_rest(2.5, 2.5),
        tolerance: 0.01,
        duration: 60.0,
        rate: 60,
    };
    let shadow = Stepping {
        method: Method::Rk4Fixed32,
        steps: 4,
    };
    for (coarse, fine, by_rounding) in [(1, 2, false), (8, 11, true)] {
        let method = Method::Extrapolation10Fixed64;
        let stepping = Stepping {
            method,
            steps: fine,
        };
        let judges = Judges::Reference(Pair::new(coarse, fine));
        let mut trial = Trial::new(stepping, &problem, judges, shadow);
        let mut frame = 0;
        while trial.has_candidate_in_64_bits() && frame < problem.frames() {
            while trial.prepare(&problem)? {}
            while trial.advance(&Costs::CORTEX_M3, f32::INFINITY) > 0.0 {}
            frame += 1;
            trial.compare(problem.time(frame));
        }
        assert!(frame < problem.frames(), "nothing has failed");
        assert_eq!(
            trial.is_limited_by_rounding(),
            by_rounding,
            "{coarse} {fine}"
        );
    }
    Ok(())
}
