//! Tests of the decisions of a search.

use core::f64::consts::PI;

use super::*;
use crate::error::Parameter;
use crate::pendulum::Parameters;
use crate::plan::cost::MOST_STEPS;
use crate::plan::trial::MOST_FINER_RUNS;

/// Returns `candidate` after `frames` accurate frames, followed by an inaccurate one if it
/// `fails`.
fn measured(mut candidate: Candidate, frames: u32, fails: bool) -> Candidate {
    for _ in 0..frames {
        candidate.note(0.5, 0.5);
    }
    if fails {
        candidate.note(2.0, 2.0);
    }
    candidate
}

/// Returns a search whose first trial is created, for large oscillations of equal rods on a
/// Cortex-M3.
fn in_first_trial() -> Result<Search, PlanError> {
    let problem = Problem {
        pendulum: Parameters::equal_rods(1.0, 1.0, 9.81),
        start: Motion::at_rest(1.0, 1.0),
        tolerance: 0.01,
        duration: 10.0,
        rate: 60,
    };
    let budget = Budget {
        frame: 1e6,
        planning: 1e10,
    };
    let mut search = Search::new(&problem, &Costs::CORTEX_M3, &budget)?;
    search.create_trial();
    Ok(search)
}

/// Returns a search whose next trial is in 64 bits, at 5 frames per second. A frame then has many
/// steps, so that all references of a trial differ.
fn at_a_low_rate() -> Result<Search, PlanError> {
    let mut search = in_first_trial()?;
    search.problem.rate = 5;
    let in_64_bits = search.in_64_bits().expect("a frame can pay for it");
    search.begin_trial(in_64_bits);
    Ok(search)
}

/// Returns the references that judge candidates in 64 bits, and whose coarse runs a frame can pay
/// for. The finest comes first.
fn judging_pairs(search: &Search) -> impl DoubleEndedIterator<Item = Pair> + use<> {
    let least = search.least_in_64_bits.expect("64 bits accept the motion");
    let (rate, admissible) = (search.problem.rate, search.admissible);
    Pair::all(rate, admissible, least, search.most_in_64_bits())
        .filter(move |pair| pair.judges_64_bits(rate, admissible))
}

/// Returns the best candidate after a trial. Before it, the best one was `best`; in the trial the
/// candidates with these indices were `tried`.
fn best_after(search: &Search, best: Candidate, tried: &[(usize, Candidate)]) -> Option<Candidate> {
    let mut search = *search;
    search.goal.set_best(best);
    let SearchState::Trying { trial, .. } = &mut search.state else {
        panic!("the trial is not created");
    };
    trial.retain(|_| false);
    for &(i, candidate) in tried {
        trial.candidates[i] = candidate;
    }
    search.keep_best();
    search.goal.best().copied()
}

/// Returns the accurate frames of the best candidate after a trial ([`best_after`]).
fn kept(search: &Search, best: Candidate, tried: &[(usize, Candidate)]) -> Option<u32> {
    best_after(search, best, tried).map(|best| best.accurate_frames)
}

/// A piece may cost exactly the rest of the planning budget. The piece is a preparation, whose cost
/// is a whole number, so that no sum is rounded.
#[test]
fn planning_budget_may_be_spent_completely() -> Result<(), PlanError> {
    let mut search = in_first_trial()?;
    let needed = search.spent + search.costs.preparation;
    for (planning, expected) in [(needed, false), (needed - 1.0, true)] {
        search.budget.planning = planning;
        assert_eq!(search.exceeds_planning_budget(), expected, "{planning}");
    }
    Ok(())
}

/// A candidate of 100 frames is measured again for fewer frames.
///
/// The second measurement counts if it is better and the candidate fails in it, also if not
/// even its first frame is accurate. A reference is better than finer runs, and more finer runs
/// are better than fewer. The second measurement does not count if the candidate has not
/// failed, because planning ended it.
#[test]
fn better_measurement_replaces_a_rough_one() -> Result<(), PlanError> {
    let search = in_first_trial()?;
    let SearchState::Trying { trial, .. } = search.state else {
        panic!("the trial is not created");
    };
    assert!(trial.has_reference());

    // The index 4 is that of the closed form, which takes part with any step count.
    for (i, finer) in [(0, 1), (4, 1), (4, 2)] {
        let tried = trial.candidates[i];
        let mut rough = Candidate::new(tried.stepping);
        rough.finer_runs = MOST_FINER_RUNS;
        rough.stepping.steps *= finer;
        let first = measured(rough, 100, true);
        let kept =
            |first, frames, fails| kept(&search, first, &[(i, measured(tried, frames, fails))]);
        assert_eq!(kept(first, 60, true), Some(60), "candidate {i}");
        assert_eq!(kept(first, 0, true), None, "candidate {i}");
        assert_eq!(kept(first, 60, false), Some(100), "candidate {i}");

        let judged = measured(tried, 100, true);
        assert_eq!(kept(judged, 60, true), Some(100), "candidate {i}");

        // The second measurement has two finer runs.
        for (number, expected) in [(1, 60), (2, 100), (3, 100)] {
            let mut few = first;
            few.finer_runs = number;
            let mut more = measured(tried, 60, true);
            more.finer_runs = 2;
            let kept = self::kept(&search, few, &[(i, more)]);
            assert_eq!(kept, Some(expected), "candidate {i}, {number}");
        }
    }

    // The others in the trial are compared with the second measurement.
    let [own, .., closed, _, _] = trial.candidates;
    let mut rough = Candidate::new(closed.stepping);
    rough.finer_runs = MOST_FINER_RUNS;
    let rough = measured(rough, 100, true);
    let tried = [
        (0, measured(own, 80, true)),
        (4, measured(closed, 60, true)),
    ];
    assert_eq!(kept(&search, rough, &tried), Some(80));
    Ok(())
}

/// If two candidates have equal horizons, the one that costs less is the best. If they also cost
/// the same, it is the one that was tried first.
#[test]
fn lower_cost_decides_between_equal_horizons() -> Result<(), PlanError> {
    let mut search = in_first_trial()?;
    let SearchState::Trying { trial, .. } = search.state else {
        panic!("the trial is not created");
    };
    let [own, .., closed, _, _] = trial.candidates;
    let cost = search.costs.of_frame(own.stepping);
    for (closed_form, expected) in [(0.999 * cost, closed), (cost, own), (1.001 * cost, own)] {
        search.costs.closed_form = closed_form;
        let first = measured(own, 100, true);
        let best = best_after(&search, first, &[(4, measured(closed, 100, true))]);
        assert_eq!(best, Some(measured(expected, 100, true)), "{closed_form}");
    }
    Ok(())
}

/// Finer steps in 32 bits are only tried if a frame in these steps costs less than one in
/// 64 bits.
#[test]
fn finer_steps_cost_less_than_64_bits() -> Result<(), PlanError> {
    let mut search = in_first_trial()?;
    let in_64_bits = search.in_64_bits().expect("a frame can pay for it");
    let steps = 2 * search.stepping.steps;
    let finer = Stepping {
        steps,
        ..search.stepping
    };
    // With these prices both frames cost the same, without a rounding error.
    search.costs.fixed32 = in_64_bits.steps as f32;
    for (price, expected) in [(steps, None), (steps + 1, Some(finer))] {
        search.costs.fixed64 = price as f32;
        assert_eq!(search.in_64_bits(), Some(in_64_bits));
        assert_eq!(search.finer(Some(2)), expected, "{price}");
    }
    Ok(())
}

/// If fixed point refuses its steps as too long, the next trial makes twice as many. From 65,536
/// ([`MOST_STEPS`]) on, it is in 64 bits.
#[test]
fn refused_steps_are_doubled_up_to_their_limit() -> Result<(), PlanError> {
    let too_long = Error::TooLarge {
        parameter: Parameter::Dt,
        value: 1.0,
        limit: 0.5,
    };
    for (steps, is_doubled) in [(8, true), (MOST_STEPS / 2, true), (MOST_STEPS, false)] {
        let mut search = in_first_trial()?;
        // A frame can pay for any of these steps.
        search.budget.frame = 1e9;
        search.stepping.steps = steps;
        let expected = if is_doubled {
            Stepping {
                steps: 2 * steps,
                ..search.stepping
            }
        } else {
            search.in_64_bits().expect("a frame can pay for it")
        };
        assert_eq!(search.after_refusal(too_long), Ok(None));
        assert_eq!(search.stepping, expected);
    }
    Ok(())
}

/// Finer steps in 32 bits are not tried if planning can pay for a trial of 64 bits, but not for
/// one that tries both: they would spend what 64 bits need. They are tried if planning can pay
/// for both or for neither, and if no frame was accurate before. Here 64 bits are not too
/// expensive.
#[test]
fn finer_steps_do_not_spend_the_budget_of_64_bits() -> Result<(), PlanError> {
    const FACTOR: u32 = 8;
    let mut search = in_first_trial()?;
    let Stepping { method, steps } = search.stepping;
    let finer = Stepping {
        method,
        steps: FACTOR * steps,
    };
    let in_64_bits = search.in_64_bits().expect("a frame can pay for it");
    let first = Candidate::new(search.stepping);

    let mut cases = [0; 3];
    for power in 0..40 {
        search.budget.planning = 1e5 * 1.5_f32.powi(power);
        search.goal = Goal::FindBest { best: None };
        assert_eq!(search.finer(Some(FACTOR)), Some(finer));

        search.goal.set_best(measured(first, 60, true));
        let [alone, both] =
            [in_64_bits, finer].map(|stepping| search.judging_pair(stepping).is_some());
        let expected = (!alone || both).then_some(finer);
        assert_eq!(search.finer(Some(FACTOR)), expected, "{power}");
        cases[usize::from(alone) + usize::from(both)] += 1;
    }
    assert!(cases.iter().all(|&count| count > 0), "{cases:?}");
    Ok(())
}

/// If planning cannot pay for half of all frames in an expensive trial of 64 bits, finer steps in
/// 32 bits are tried first. If 4 times the steps had a horizon less than 1.5 times that of twice
/// the steps, 64 bits are tried at once.
#[test]
fn expensive_64_bits_wait_for_finer_steps_that_gain_much() -> Result<(), PlanError> {
    const FACTOR: u32 = 8;
    let mut search = in_first_trial()?;
    let first = Candidate::new(search.stepping);
    search.goal.set_best(measured(first, 60, true));

    // A frame can pay for 64 bits, and planning for 1.25 times the known horizon of 60 of the 600
    // frames.
    search.costs.fixed64 *= 100.0;
    search.budget.frame = f32::MAX;
    let in_64_bits = search.in_64_bits().expect("a frame can pay for it");
    let pair = judging_pairs(&search).last().expect("there is a pair");
    let cost = Trial::cost(&search.costs, in_64_bits, Judges::Reference(pair));
    search.budget.planning = search.spent + 100.0 * cost;
    assert!(search.judging_pair(in_64_bits).is_some());

    for (second, third, is_tried) in [(40, 59, false), (40, 60, true)] {
        let SearchState::Trying { trial, .. } = &mut search.state else {
            panic!("the trial is not created");
        };
        assert!(trial.has_reference());
        for (candidate, frames) in trial.candidates[1..].iter_mut().zip([second, third]) {
            *candidate = measured(Candidate::new(candidate.stepping), frames, true);
        }
        let finer = search.finer(Some(FACTOR));
        assert_eq!(finer.is_some(), is_tried, "{second} {third}");
    }
    Ok(())
}

/// A trial in 64 bits needs an unspent planning budget for 1.25 times the known horizon of 60
/// frames. It must cover the runs of the cheapest pair that judges 64 bits, and the shadows.
#[test]
fn planning_pays_for_the_shadows_of_64_bits() -> Result<(), PlanError> {
    let mut search = in_first_trial()?;
    let in_64_bits = search.in_64_bits().expect("a frame can pay for it");
    let first = Candidate::new(search.stepping);
    search.goal.set_best(measured(first, 60, true));

    let (rate, admissible) = (search.problem.rate, search.admissible);
    let trial = judging_pairs(&search)
        .map(|pair| Trial::cost(&search.costs, in_64_bits, Judges::Reference(pair)))
        .fold(f32::INFINITY, f32::min);
    let shadows = Shadows::cost_of_frame(search.shadow(), admissible, rate, &search.costs);

    // Only the unspent part of the planning budget can pay.
    search.spent = 1e8;
    for (share, expected) in [(0.999, false), (1.001, true)] {
        search.budget.planning = search.spent + share * 1.25 * 60.0 * (trial + shadows);
        assert_eq!(search.judging_pair(in_64_bits).is_some(), expected);
    }
    Ok(())
}

/// A trial in 64 bits takes the finest reference that is affordable for 6 or else 2.75 times the
/// known horizon, or for 1.25 times if the best candidate is in 64 bits already. Of the four
/// references that judge candidates in 64 bits, it is here the coarsest in the first case and the
/// finest in the second.
#[test]
fn known_horizon_of_64_bits_needs_the_smallest_margin() -> Result<(), PlanError> {
    let mut search = at_a_low_rate()?;
    search.problem.duration = 120.0;
    let mut pairs = judging_pairs(&search);
    let finest = pairs.next().expect("four pairs");
    let coarsest = pairs.next_back().expect("four pairs");
    let [in_32_bits, in_64_bits] = [in_first_trial()?.stepping, search.stepping];

    // Planning pays for the coarsest of them, for 2.75 times the known 60 frames.
    let (rate, admissible) = (search.problem.rate, search.admissible);
    let shadows = Shadows::cost_of_frame(search.shadow(), admissible, rate, &search.costs);
    let cost = Trial::cost(&search.costs, in_64_bits, Judges::Reference(coarsest)) + shadows;
    search.budget.planning = search.spent + 1.001 * 2.75 * 60.0 * cost;
    for (known, expected) in [(in_32_bits, coarsest), (in_64_bits, finest)] {
        search
            .goal
            .set_best(measured(Candidate::new(known), 60, true));
        assert_eq!(search.judging_pair(in_64_bits), Some(expected), "{known:?}");
    }
    Ok(())
}

/// If planning cannot pay for any reference of a trial in 64 bits, the trial takes the coarsest
/// that judges candidates in 64 bits.
#[test]
fn trial_in_64_bits_always_has_a_reference() -> Result<(), PlanError> {
    let mut search = at_a_low_rate()?;
    search.budget.planning = search.spent;
    let coarsest = judging_pairs(&search).next_back();
    assert!(coarsest.is_some());
    assert_eq!(search.pair_within_budget(search.stepping), None);
    assert_eq!(search.affordable_reference(), coarsest);
    Ok(())
}

/// After a trial that includes 64 bits, finer steps in 32 bits are tried only if 32 bits were
/// accurate for at least half of the frames.
#[test]
fn finer_steps_follow_64_bits_if_half_of_the_frames_are_accurate() -> Result<(), PlanError> {
    let mut search = in_first_trial()?;
    let half = search.problem.frames() / 2;
    for (frames, is_tried) in [(half - 1, false), (half, true), (half + 1, true)] {
        let SearchState::Trying { trial, .. } = &mut search.state else {
            panic!("the trial is not created");
        };
        trial.tries_64_bits = true;
        trial.candidates[0] = measured(Candidate::new(search.stepping), frames, true);
        assert_eq!(search.finer(Some(2)).is_some(), is_tried, "{frames}");
    }
    Ok(())
}

/// The limit is [`Limit::Growth`] if the finest steps were tried and a frame can pay for them.
/// Otherwise another trial is possible, and the result is `None`, if planning can pay for a finer
/// pair and a frame can pay for its coarse run. If that is not so, the limit is
/// [`Limit::Planning`], or [`Limit::Budget`] if a frame cannot pay for the fine run that was tried.
/// Truncation is the larger error in all cases.
#[test]
fn limit_in_64_bits_names_growth_or_the_budget() -> Result<(), PlanError> {
    const AMPLE: f32 = 1e10;
    const NOTHING: f32 = 1e-3;
    // At a low rate a frame has many steps, so that the pairs differ.
    let mut search = in_first_trial()?;
    search.problem.rate = 5;
    let in_64_bits = search.in_64_bits().expect("a frame can pay for it");
    let least = search.least_in_64_bits.expect("64 bits accept the motion");
    let mut pairs = Pair::all(search.problem.rate, search.admissible, least, u32::MAX);
    let finest = pairs.next().expect("six pairs");
    let coarsest = pairs.next_back().expect("six pairs");

    for (tried, planning, pays_for_fine, expected) in [
        (finest, AMPLE, true, Some(Limit::Growth)),
        (finest, AMPLE, false, Some(Limit::Budget)),
        (coarsest, AMPLE, true, None),
        (coarsest, AMPLE, false, Some(Limit::Budget)),
        (coarsest, NOTHING, true, Some(Limit::Planning)),
        (coarsest, NOTHING, false, Some(Limit::Budget)),
    ] {
        let judges = Judges::Reference(tried);
        let trial = Trial::new(in_64_bits, &search.problem, judges, search.shadow());
        search.state = SearchState::Trying {
            trial,
            progress: Progress::BetweenFrames { compared: 1 },
        };
        search.budget.planning = search.spent + planning;
        let most = if pays_for_fine {
            tried.fine
        } else {
            tried.coarse
        };
        search.budget.frame = 1.001 * search.costs.of_frame(most);
        let limit = search.limit_in_64_bits(in_64_bits);
        assert_eq!(limit, expected, "{tried:?}, {planning}, {pays_for_fine}");
    }
    Ok(())
}

/// Candidates in 64 bits need a frame budget for the fewest steps: half a step more is enough, half
/// a step less is not.
#[test]
fn fewest_steps_in_64_bits_are_enough() -> Result<(), PlanError> {
    let mut search = in_first_trial()?;
    let first = Candidate::new(search.stepping);
    search.goal.set_best(measured(first, 60, true));
    let least = search.least_in_64_bits.expect("64 bits accept the motion");
    for (steps, is_enough) in [(least as f32 + 0.5, true), (least as f32 - 0.5, false)] {
        search.budget.frame = steps * search.costs.fixed64;
        assert_eq!(search.judging_pair(search.stepping).is_some(), is_enough);
    }
    Ok(())
}

/// Candidates in 64 bits make steps of at most four admissible steps. They may be longer if a rod
/// starts within 2^-20 rad of upright, to either side, and fixed point costs less than `f32`.
#[test]
fn steps_in_64_bits_may_be_longer_near_upright() -> Result<(), PlanError> {
    let mut problem = in_first_trial()?.problem;
    // At a low rate a frame has many steps.
    problem.rate = 1;
    let budget = Budget {
        frame: 1e6,
        planning: 1e10,
    };
    let near = 1.0 / (1 << 20) as f64;
    let [m3, m4f] = [Costs::CORTEX_M3, Costs::CORTEX_M4F];
    for (a1, a2, costs, is_longer) in [
        (PI + 0.999 * near, 0.0, m3, true),
        (0.0, PI - 0.999 * near, m3, true),
        (PI + 1.001 * near, 0.0, m3, false),
        (0.999 * near, 1.0, m3, false),
        (PI + 0.999 * near, 0.0, m4f, false),
    ] {
        problem.start = Motion::at_rest(a1, a2);
        let search = Search::new(&problem, &costs, &budget)?;
        let steps = search.least_in_64_bits.expect("64 bits accept the motion");
        let four = 1.0 / (4.0 * search.admissible);
        assert_eq!(f64::from(steps) < four, is_longer, "{a1} {a2}: {steps}");
    }
    Ok(())
}

/// Returns a search whose trial has this number of finer runs and no reference. Its candidate
/// has failed after 100 accurate frames.
fn without_reference(finer_runs: u8) -> Result<Search, PlanError> {
    let mut search = in_first_trial()?;
    let judges = Judges::FinerRuns(finer_runs);
    let mut trial = Trial::new(search.stepping, &search.problem, judges, search.shadow());
    trial.candidates[0] = measured(trial.candidates[0], 100, true);
    search.goal.set_best(trial.candidates[0]);
    search.state = SearchState::Trying {
        trial,
        progress: Progress::BetweenFrames { compared: 101 },
    };
    // No step count in 64 bits is accepted, so that planning can never pay for a reference.
    search.least_in_64_bits = None;
    Ok(search)
}

/// Sets the planning budget to the cost so far, plus the cost of `frames` frames of a trial
/// with this number of finer runs, plus a thousandth of the latter.
fn limit_planning(search: &mut Search, finer_runs: u8, frames: f32) {
    let judges = Judges::FinerRuns(finer_runs);
    let cost = Trial::cost(&search.costs, search.stepping, judges);
    search.budget.planning = search.spent + 1.001 * cost * frames;
}

/// A trial has as many finer runs as planning can pay for: for all 600 frames if none is known
/// to be accurate, otherwise for 2.75 times the known horizon or, if it cannot pay for any
/// number of them then, for 1.25 times. There are at least two after a measurement with two,
/// and no fewer than a repeated trial must have. The evaluation of one method always has three.
#[test]
fn trial_has_as_many_finer_runs_as_planning_pays_for() -> Result<(), PlanError> {
    let mut search = without_reference(1)?;
    let goals = [(0, 600.0), (100, 275.0), (400, 600.0)];
    for (known, frames) in goals {
        let mut best = Candidate::new(search.stepping);
        best.finer_runs = 1;
        search.goal.set_best(measured(best, known, true));
        for number in 1..=MOST_FINER_RUNS {
            limit_planning(&mut search, number, frames);
            assert_eq!(search.affordable_finer_runs(), number, "{known}");
        }
    }

    // Planning pays for 1.25 times the known 100 frames, or not even for these.
    let mut best = Candidate::new(search.stepping);
    best.finer_runs = 1;
    search.goal.set_best(measured(best, 100, true));
    limit_planning(&mut search, 2, 125.0);
    assert_eq!(search.affordable_finer_runs(), 2);
    limit_planning(&mut search, 1, 50.0);
    assert_eq!(search.affordable_finer_runs(), 1);
    search.least_finer_runs = 2;
    assert_eq!(search.affordable_finer_runs(), 2);
    search.least_finer_runs = 1;
    best.finer_runs = 2;
    search.goal.set_best(measured(best, 100, true));
    assert_eq!(search.affordable_finer_runs(), 2);

    search.goal = Goal::Evaluate { only: best };
    assert_eq!(search.affordable_finer_runs(), MOST_FINER_RUNS);
    Ok(())
}

/// A failed trial with one or two finer runs is repeated with the largest number that planning
/// can pay for, for 1.25 times its horizon. If two finer runs have shown a truncation error,
/// finer steps are tried instead, if a frame and planning can pay for them.
#[test]
fn rough_trial_is_repeated_with_more_finer_runs() -> Result<(), PlanError> {
    for number in 1..=MOST_FINER_RUNS {
        let mut search = without_reference(number)?;
        // A frame cannot pay for finer steps.
        search.budget.frame = search.costs.of_frame(search.stepping);
        for more in 1..=MOST_FINER_RUNS {
            limit_planning(&mut search, more, 125.0);
            let expected = (more > number).then_some(more);
            assert_eq!(search.more_finer_runs(), expected, "{number}");
        }

        // A frame and planning can pay for finer steps.
        search.budget.frame = 1e6;
        search.budget.planning = 1e10;
        let expected = (number == 1).then_some(MOST_FINER_RUNS);
        assert_eq!(search.more_finer_runs(), expected, "{number}");
    }

    // Rounding is the larger error of a trial with two finer runs.
    let mut search = without_reference(2)?;
    if let SearchState::Trying { trial, .. } = &mut search.state {
        let failed = trial.candidates[0];
        trial.exclude_for_rounding();
        trial.candidates[0] = failed;
    }
    search.budget.planning = 1e10;
    assert_eq!(search.more_finer_runs(), Some(MOST_FINER_RUNS));

    // Not even the first frame was accurate. Planning pays for 1.25 frames.
    let mut search = without_reference(1)?;
    search.goal = Goal::FindBest { best: None };
    limit_planning(&mut search, MOST_FINER_RUNS, 1.25);
    assert_eq!(search.more_finer_runs(), Some(MOST_FINER_RUNS));

    // Planning pays for a reference, which the repeated trial takes.
    let mut search = without_reference(1)?;
    search.least_in_64_bits = in_first_trial()?.least_in_64_bits;
    search.budget.planning = 1e10;
    assert!(search.affordable_reference().is_some());
    assert_eq!(search.more_finer_runs(), Some(2));

    // Neither the evaluation of one method is repeated, nor a trial without a failure.
    let mut search = without_reference(1)?;
    let only = Candidate::new(search.stepping);
    search.goal = Goal::Evaluate { only };
    assert_eq!(search.more_finer_runs(), None);
    let mut search = without_reference(1)?;
    if let SearchState::Trying { trial, .. } = &mut search.state {
        trial.retain(|_| false);
    }
    assert_eq!(search.more_finer_runs(), None);
    Ok(())
}

/// If a frame pays for neither finer steps nor 64 bits, the frame budget is the limit after a
/// trial with three finer runs. After one with fewer, planning is the limit, which does not pay
/// for its repetition.
#[test]
fn planning_is_the_limit_of_a_rough_trial() -> Result<(), PlanError> {
    for (number, expected) in [
        (1, Limit::Planning),
        (2, Limit::Planning),
        (3, Limit::Budget),
    ] {
        let mut search = without_reference(number)?;
        search.budget.frame = search.costs.of_frame(search.stepping);
        search.budget.planning = search.spent;
        assert_eq!(search.end_trial(), Some(expected), "{number}");

        // The same if not even the first frame was accurate by any method, and planning has ended.
        search.goal = Goal::FindBest { best: None };
        if let SearchState::Trying { trial, .. } = &mut search.state {
            let failed = trial.candidates[0];
            trial.retain(|_| false);
            trial.candidates[0] = failed;
        }
        let limit = match search.plan(Limit::Planning) {
            Err(PlanError::NoMethod { limit, .. }) => limit,
            other => panic!("{other:?}"),
        };
        assert_eq!(limit, expected, "{number}");
    }
    Ok(())
}

/// A reference that costs more than five times as much as three finer runs is not taken if
/// planning cannot pay for half of all frames, although it could pay for 2.75 times the known
/// horizon. It is taken if the same steps were measured with three finer runs before.
#[test]
fn expensive_reference_waits_until_finer_runs_have_measured() -> Result<(), PlanError> {
    let mut search = in_first_trial()?;
    let finer_runs = Judges::FinerRuns(MOST_FINER_RUNS);
    let cost = 5.0 * Trial::cost(&search.costs, search.stepping, finer_runs);
    search.budget.planning = search.spent + 300.0 * cost;
    for (factor, planning, expected) in
        [(1.01, 0.99, true), (0.99, 0.97, false), (1.01, 1.02, false)]
    {
        let mut search = search;
        search.budget.planning = search.spent + planning * 300.0 * cost;
        let is_too_expensive = search.is_too_expensive(search.stepping, factor * cost);
        assert_eq!(is_too_expensive, expected, "{factor} {planning}");
    }

    // 64 bits cost a hundred times as much as usual, and a frame was accurate.
    search.costs.fixed64 *= 100.0;
    let mut best = Candidate::new(search.stepping);
    for (finer_runs, expected) in [(1, false), (2, false), (3, true)] {
        best.finer_runs = finer_runs;
        search.goal.set_best(measured(best, 1, true));
        search.budget.planning = search.spent + 1e8;
        let is_taken = search.affordable_reference().is_some();
        assert_eq!(is_taken, expected, "{finer_runs}");
    }
    Ok(())
}

/// The first trial takes steps of at most 4 admissible steps if a frame can pay for them, and
/// planning for all 600 frames. Otherwise it takes the shortest steps that both can pay for, 2 to
/// 16 times as long. If planning cannot pay for the longest of these but a frame can, it takes
/// those. If a frame cannot, it takes steps that are 32 to 512 times as long: the shortest that
/// both can pay for, or the longest. In the faster normal mode, which limits them in small
/// oscillations, they are a radian.
#[test]
fn first_steps_are_longer_if_a_budget_is_small() -> Result<(), PlanError> {
    let mut search = in_first_trial()?;
    // The start is so fast that all ten steps are short in comparison with the normal modes.
    search.problem.start = Motion {
        a1: 0.0,
        a2: 0.0,
        w1: 1500.0,
        w2: -1500.0,
    };
    search.problem.rate = 1;
    search.problem.duration = 600.0;
    let first = |budget: &Budget| {
        let search = Search::new(&search.problem, &search.costs, budget)?;
        Ok::<_, PlanError>(search.stepping)
    };
    let rich = Budget {
        frame: f32::MAX,
        planning: f32::MAX,
    };
    let Stepping { method, steps } = first(&rich)?;
    for power in 0..10 {
        let expected = Stepping {
            method,
            steps: steps >> power,
        };
        let frame = search.costs.of_frame(expected);
        let judges = Judges::FinerRuns(MOST_FINER_RUNS);
        let planning = 1.001 * 600.0 * Trial::cost(&search.costs, expected, judges);
        assert_eq!(first(&Budget { frame, ..rich })?, expected);

        // Planning makes the steps at most 16 times as long while a frame can pay for these.
        let usual = Stepping {
            steps: steps >> power.min(4),
            ..expected
        };
        assert_eq!(first(&Budget { planning, ..rich })?, usual);
        if power > 4 {
            let frame = search.costs.of_frame(usual);
            assert_eq!(first(&Budget { frame, planning })?, usual);
            let frame = 0.99 * frame;
            assert_eq!(first(&Budget { frame, planning })?, expected);
        }
    }
    let poor = Budget {
        frame: 1.0,
        planning: 1.0,
    };
    assert_eq!(first(&poor)?.steps, steps >> 9);
    assert!(steps >> 9 > 8, "{steps} steps are too few for this test");

    // In a small oscillation of equal rods, the faster mode has 5.79 rad/s.
    search.problem.start = Motion::at_rest(0.01, 0.01);
    let small = Search::new(&search.problem, &search.costs, &poor)?;
    assert_eq!(small.stepping.steps, 8);
    Ok(())
}

/// If a frame cannot pay for the usual finer steps, the next trial takes as many as it can pay for.
/// They must be at least a quarter more than the finest steps that the last trial tried and that a
/// frame can pay for.
#[test]
fn finer_steps_are_as_many_as_a_frame_pays_for() -> Result<(), PlanError> {
    // A trial with a reference tries 1, 2 and 4 times the steps, one without only the steps
    // themselves.
    let with_reference = [
        (800, Some(800)),
        (799, Some(799)),
        (500, Some(500)),
        (499, None),
        (400, None),
        (399, Some(399)),
        (250, Some(250)),
        (249, None),
    ];
    let without = [(201, Some(200)), (125, Some(125)), (124, None)];
    for (mut search, factor, limits) in [
        (in_first_trial()?, 8, with_reference.as_slice()),
        (without_reference(MOST_FINER_RUNS)?, 2, &without),
    ] {
        search.stepping.steps = 100;
        // A frame cannot pay for 64 bits. Budgets of whole steps are not rounded at these prices.
        search.costs.fixed32 = 1.0;
        search.costs.fixed64 = 1e9;
        for &(most, expected) in limits {
            search.budget.frame = most as f32;
            let expected = expected.map(|steps| Stepping {
                steps,
                ..search.stepping
            });
            assert_eq!(search.finer(Some(factor)), expected, "{factor}: {most}");
        }
    }
    Ok(())
}

/// If 64 bits are not possible and rounding seems to be the larger error, `f32` follows fixed
/// point, also in the shadows. After `f32`, finer steps of it follow: twice as many, or 8 times
/// after a trial with a reference. If a frame cannot pay for the next one of these, or if the last
/// one has not helped, the frame budget is the limit. It is also the limit if `f32` refuses the
/// motion and a candidate is known.
#[test]
fn last_resort_is_f32() -> Result<(), PlanError> {
    let refused = without_reference(MOST_FINER_RUNS)?;
    let mut too_expensive = refused;
    too_expensive.least_in_64_bits = in_first_trial()?.least_in_64_bits;
    too_expensive.costs.fixed64 = 1e9;

    for mut search in [refused, too_expensive] {
        let state = search.state;
        let in_fixed_point = search.stepping;
        let in_f32 = search.first_in(Method::Rk4F32Direction);
        let price = search.costs.direction;
        search.costs.direction = 1e9;
        assert_eq!(search.refine(None), Some(Limit::Budget));
        assert_eq!(search.stepping, in_fixed_point);
        assert_eq!(search.shadow().method, Method::Rk4Fixed32);

        search.costs.direction = price;
        search.budget.frame = search.costs.of_frame(in_f32);
        assert_eq!(search.refine(None), None);
        assert_eq!(search.stepping, in_f32);
        assert_eq!(search.shadow().method, Method::Rk4F32Direction);

        for (state, factor) in [(state, 2), (in_first_trial()?.state, 8)] {
            search.state = state;
            search.stepping = in_f32;
            let finer = Stepping {
                steps: factor * in_f32.steps,
                ..in_f32
            };
            search.budget.frame = search.costs.of_frame(finer);
            assert_eq!(search.refine(None), None);
            assert_eq!(search.stepping, finer);

            search.state = state;
            assert_eq!(search.refine(None), Some(Limit::Budget));
            assert_eq!(search.stepping, finer);
        }

        // Finer steps are not refined further if they have not helped.
        search.state = state;
        search.stepping.steps = 2 * in_f32.steps;
        search.budget.frame = 8.0 * search.costs.of_frame(in_f32);
        let best = Candidate::new(in_f32);
        search.goal.set_best(measured(best, 100, true));
        assert_eq!(search.refine(None), Some(Limit::Budget));

        let error = Error::OutOfRange {
            parameter: Parameter::M1,
            value: 1e39,
        };
        assert_eq!(search.after_refusal(error), Ok(Some(Limit::Budget)));
        search.goal = Goal::FindBest { best: None };
        assert_eq!(search.after_refusal(error), Err(error));
    }
    Ok(())
}

/// If a frame can pay for `f32` but not for the steps that fixed point accepts, `f32` is tried
/// first, and fixed point after the last steps of `f32`. Its steps are doubled while they are
/// refused, also if a candidate is known. After that, the frame budget is the limit. Fixed point is
/// not tried again if the motion is out of its range.
#[test]
fn fixed_point_waits_if_a_frame_cannot_pay_for_it() -> Result<(), PlanError> {
    let too_long = Error::TooLarge {
        parameter: Parameter::Dt,
        value: 1.0,
        limit: 0.5,
    };
    let out_of_range = Error::OutOfRange {
        parameter: Parameter::M1,
        value: 1e39,
    };
    for (error, is_postponed) in [(too_long, true), (out_of_range, false)] {
        let mut search = without_reference(MOST_FINER_RUNS)?;
        let state = search.state;
        let first = search.stepping;
        let in_f32 = search.first_in(Method::Rk4F32Direction);
        search.stepping.steps = 1000;
        search.budget.frame = search.costs.of_frame(in_f32);
        assert!(search.can_only_pay_for_f32());
        assert_eq!(search.after_refusal(error), Ok(None));
        assert_eq!(search.stepping, in_f32);

        // Finer steps of `f32` come before fixed point.
        search.state = state;
        search.budget.frame *= 2.0;
        assert_eq!(search.refine(None), None);
        assert_eq!(search.stepping.method, Method::Rk4F32Direction);
        assert_eq!(search.stepping.steps, 2 * in_f32.steps);

        if is_postponed {
            search.state = state;
            assert_eq!(search.refine(None), None);
            assert_eq!(search.stepping, first);
            // A frame cannot pay for any of its steps.
            search.costs.fixed32 = 1e9;
            for times in [2, 4] {
                assert_eq!(search.after_refusal(too_long), Ok(None));
                assert_eq!(search.stepping.method, first.method);
                assert_eq!(search.stepping.steps, times * first.steps);
            }
        }
        search.state = state;
        assert_eq!(search.refine(None), Some(Limit::Budget));
    }
    Ok(())
}

/// A rough trial in fixed point after `f32` measures only the closed form. Planning, which ends it
/// or does not pay for its repetition, is its limit, but not that of a plan in `f32`. The
/// evaluation of one method has no such trial.
#[test]
fn postponed_trial_is_no_limit_of_another_method() -> Result<(), PlanError> {
    let mut search = without_reference(1)?;
    search.method_in_32_bits = Method::Rk4F32Direction;
    search.budget.frame = search.costs.of_frame(search.stepping);
    search.budget.planning = search.spent;
    for (method, expected) in [
        (Method::Rk4F32Direction, Limit::Budget),
        (Method::ClosedFormF32, Limit::Planning),
    ] {
        let mut search = search;
        let best = Candidate::new(Stepping { method, steps: 8 });
        search.goal.set_best(measured(best, 200, true));
        assert_eq!(search.piece(1.0), Ok(Some(expected)), "{method:?}");
        assert_eq!(search.end_trial(), Some(expected), "{method:?}");
    }
    let only = Candidate::new(search.stepping);
    search.goal = Goal::Evaluate { only };
    assert_eq!(search.piece(1.0), Ok(Some(Limit::Planning)));
    Ok(())
}

/// A search that has reached the end of a calm motion is extended by 2 s. Its second plan lasts
/// that much longer.
#[test]
fn extension_is_added_to_the_duration() -> Result<(), PlanError> {
    let problem = Problem {
        start: Motion::at_rest(0.3, 0.3),
        duration: 3.0,
        ..in_first_trial()?.problem
    };
    let budget = Budget {
        frame: 1e6,
        planning: 1e10,
    };
    let mut search = Search::new(&problem, &Costs::CORTEX_M4F, &budget)?;
    let finish = |search: &mut Search| loop {
        if let Some(plan) = search.advance(f32::INFINITY)? {
            return Ok::<_, PlanError>((plan.limit, plan.horizon));
        }
    };
    assert_eq!(finish(&mut search)?, (Limit::End, 3.0));
    search.extend(2.0);
    assert_eq!(finish(&mut search)?, (Limit::End, 5.0));
    Ok(())
}

/// Returns the trial in progress.
fn on_trial(search: &mut Search) -> &mut Trial {
    match &mut search.state {
        SearchState::Trying { trial, .. } => trial,
        SearchState::NoTrial => panic!("the trial is not created"),
    }
}

/// Returns a search before its first trial, without a planning budget.
fn before_first_trial() -> Result<Search, PlanError> {
    let mut search = in_first_trial()?;
    search.begin_trial(search.stepping);
    search.spent = 0.0;
    search.budget.planning = 0.0;
    Ok(search)
}

/// Returns the costs of all frames of three trials: with the finest reference, with the coarsest
/// one, and with three finer runs.
fn costs_of_first_trials(search: &Search) -> [f32; 3] {
    let mut pairs = search.pairs().expect("64 bits accept the motion");
    let (Some(finest), Some(coarsest)) = (pairs.next(), pairs.next_back()) else {
        panic!("there are several pairs");
    };
    let frames = search.problem.frames() as f32;
    [
        Judges::Reference(finest),
        Judges::Reference(coarsest),
        Judges::FinerRuns(MOST_FINER_RUNS),
    ]
    .map(|judges| frames * Trial::cost(&search.costs, search.stepping, judges))
}

/// Returns true if the first trial measures the growth of errors, with this planning budget and the
/// coarsest reference.
fn measures_growth(search: &Search, planning: f32) -> bool {
    let mut search = *search;
    search.budget.planning = planning;
    let coarsest = search.pairs().and_then(Iterator::last).expect("pairs");
    search.must_measure_growth(coarsest)
}

/// The growth of errors is measured if planning can pay for three finer runs to the middle of the
/// problem and for the reference to its end, but not for the finest reference to the end.
#[test]
fn growth_is_measured_if_the_finest_reference_is_not_affordable() -> Result<(), PlanError> {
    let search = before_first_trial()?;
    let [finest, coarsest, finer_runs] = costs_of_first_trials(&search);
    let least = coarsest + 0.5 * finer_runs;
    for (planning, expected) in [
        (0.99 * least, false),
        (1.01 * least, true),
        (0.99 * finest, true),
        (1.01 * finest, false),
    ] {
        assert_eq!(measures_growth(&search, planning), expected, "{planning}");
    }

    // A candidate is known; one method is evaluated; the trial is repeated.
    let candidate = Candidate::new(search.stepping);
    let changes: [fn(&mut Search, Candidate); 3] = [
        |search, best| search.goal = Goal::FindBest { best: Some(best) },
        |search, only| search.goal = Goal::Evaluate { only },
        |search, _| search.purpose = Purpose::HorizonAfterGrowth,
    ];
    for (i, change) in changes.into_iter().enumerate() {
        let mut search = search;
        change(&mut search, candidate);
        assert!(!measures_growth(&search, 0.99 * finest), "change {i}");
    }
    Ok(())
}

/// The growth of errors is measured only if a trial with the finest reference costs more than 5
/// times as much as one with three finer runs, and if a frame can pay for 64 bits.
#[test]
fn growth_is_measured_before_expensive_references_only() -> Result<(), PlanError> {
    let search = before_first_trial()?;
    let measures = |change: fn(&mut Search)| {
        let mut search = search;
        change(&mut search);
        let [finest, coarsest, finer_runs] = costs_of_first_trials(&search);
        let planning = 0.99 * finest;
        assert!(coarsest + 0.5 * finer_runs < planning);
        (finest / finer_runs, measures_growth(&search, planning))
    };

    let (ratio, is_measured) = measures(|_| ());
    assert!(ratio > 5.0 && is_measured, "{ratio}");

    // Four times the price of 32 bits makes the finest reference cheap by comparison.
    let (ratio, is_measured) = measures(|search| search.costs.fixed32 *= 4.0);
    assert!(ratio < 5.0 && !is_measured, "{ratio}");

    // A frame cannot pay for a single step in 64 bits.
    let (ratio, is_measured) = measures(|search| {
        search.costs.fixed64 *= 10.0;
        search.budget.frame = 0.5 * search.costs.fixed64;
    });
    assert!(ratio > 5.0 && !is_measured, "{ratio}");
    Ok(())
}

/// Returns a search in a first trial that measures the growth of errors, after `frames` accurate
/// frames of 600. In the first `small` ones the bound was small. If `fails` is true, the next frame
/// was inaccurate.
fn measuring_growth(frames: u32, small: u32, fails: bool) -> Result<Search, PlanError> {
    let mut search = before_first_trial()?;
    let [finest, ..] = costs_of_first_trials(&search);
    search.budget.planning = 0.99 * finest;
    search.create_trial();
    assert_eq!(search.purpose, Purpose::Growth);
    let trial = on_trial(&mut search);
    assert_eq!(trial.finer_runs(), MOST_FINER_RUNS);
    trial.retain(|candidate| candidate.stepping.method == Method::Rk4Fixed32);
    trial.candidates[0] = measured(trial.candidates[0], frames, fails);
    trial.small_frames = small;
    Ok(search)
}

/// A trial that measures the growth of errors is over when the candidate fails, when errors have
/// grown slowly, or in the middle of the problem. After fast growth 64 bits follow, if 32 bits have
/// failed between 1/16 and 1/2 of the problem. Otherwise the trial is repeated with a reference.
#[test]
fn sixty_four_bits_follow_fast_growth() -> Result<(), PlanError> {
    for (frames, small, fails, is_decided, is_fast) in [
        (100, 26, false, false, false),
        (100, 26, true, true, true),
        (100, 25, false, true, false),
        (100, 25, true, true, false),
        (299, 299, false, false, false),
        (300, 300, false, true, false),
        (299, 100, true, true, true),
        (300, 100, true, true, false),
        (38, 30, true, true, true),
        (37, 30, true, true, false),
    ] {
        let mut search = measuring_growth(frames, small, fails)?;
        let context = (frames, small, fails);
        assert_eq!(search.is_decided(), is_decided, "{context:?}");
        if !is_decided {
            continue;
        }

        let first = search.stepping;
        assert_eq!(search.end_trial(), None);
        if is_fast {
            assert_eq!(Some(search.stepping), search.in_64_bits(), "{context:?}");
        } else {
            assert_eq!(search.stepping, first, "{context:?}");
            assert!(search.known().is_none() && !search.is_refined());
            search.create_trial();
            let trial = on_trial(&mut search);
            assert!(trial.has_reference() && !trial.tries_64_bits);
        }
    }
    Ok(())
}

/// The end of a trial that was repeated with a reference makes its horizon known.
#[test]
fn repeated_trial_makes_the_horizon_known() -> Result<(), PlanError> {
    let mut search = measuring_growth(100, 0, false)?;
    assert_eq!(search.end_trial(), None);
    search.create_trial();
    on_trial(&mut search).candidates[0].accurate_frames = 60;
    assert_eq!(search.purpose, Purpose::HorizonAfterGrowth);
    assert_eq!(search.end_trial(), None);
    assert_eq!(search.purpose, Purpose::Horizon);
    assert!(search.is_refined());
    Ok(())
}

/// A problem of one frame may end with the trial that measures the growth of errors. The purpose is
/// then the horizon, so that the search may be extended.
#[test]
fn growth_is_not_measured_beyond_the_end() -> Result<(), PlanError> {
    let mut search = measuring_growth(1, 0, false)?;
    search.problem.duration = search.problem.time(1);
    assert_eq!(search.end_trial(), Some(Limit::End));
    assert_eq!(search.purpose, Purpose::Horizon);
    Ok(())
}

/// 64 bits do not follow fast growth at once if planning cannot pay for 2.75 times the known
/// horizon, with fewer than three finer runs, or in the evaluation of one method.
#[test]
fn sixty_four_bits_wait_if_planning_cannot_pay_for_them() -> Result<(), PlanError> {
    let mut search = measuring_growth(100, 50, true)?;
    search.keep_best();
    assert!(search.in_64_bits_after_growth().is_some());

    // The coarsest pair that judges 64 bits, and the shadows.
    let in_64_bits = search.in_64_bits().expect("a frame can pay for it");
    let pair = judging_pairs(&search).next_back().expect("a pair");
    let (rate, admissible) = (search.problem.rate, search.admissible);
    let cost = Trial::cost(&search.costs, in_64_bits, Judges::Reference(pair))
        + Shadows::cost_of_frame(search.shadow(), admissible, rate, &search.costs);
    for (share, expected) in [(0.999, false), (1.001, true)] {
        search.budget.planning = search.spent + share * 2.75 * 100.0 * cost;
        assert_eq!(
            search.in_64_bits_after_growth().is_some(),
            expected,
            "{share}"
        );
    }

    let mut evaluation = search;
    let only = *search.goal.best().expect("a candidate");
    evaluation.goal = Goal::Evaluate { only };
    assert_eq!(evaluation.in_64_bits_after_growth(), None);

    let judges = Judges::FinerRuns(2);
    let mut with_two = search;
    let mut trial = Trial::new(search.stepping, &search.problem, judges, search.shadow());
    trial.candidates = on_trial(&mut search).candidates;
    trial.small_frames = 50;
    *on_trial(&mut with_two) = trial;
    assert_eq!(with_two.in_64_bits_after_growth(), None);
    Ok(())
}

/// The first trial in 64 bits has the finest reference that is affordable for 6 times the known
/// horizon of 32 bits. The next trial has the finest one that is affordable for 1.25 times the
/// horizon of 64 bits.
#[test]
fn first_trial_in_64_bits_may_last_six_times_as_long() -> Result<(), PlanError> {
    const FRAMES: u32 = 5;
    let mut search = at_a_low_rate()?;
    let in_64_bits = search.stepping;
    let finest = judging_pairs(&search).next().expect("a pair");
    let cost = Trial::cost(&search.costs, in_64_bits, Judges::Reference(finest));
    let method = search.method_in_32_bits;
    for (method, margin) in [(method, 6.0), (in_64_bits.method, 1.25)] {
        let best = Candidate::new(Stepping { method, steps: 1 });
        search.goal.set_best(measured(best, FRAMES, true));
        for (factor, expected) in [(0.95, false), (1.1, true)] {
            search.budget.planning = search.spent + factor * margin * FRAMES as f32 * cost;
            let pair = search.pair_within_budget(in_64_bits);
            assert_eq!(pair == Some(finest), expected, "{method:?}, {factor}");
        }
    }
    Ok(())
}

/// A trial in 32 bits has the finest reference that is affordable for 2.75 times the known horizon,
/// even if 6 times are affordable with a coarser one.
#[test]
fn trial_in_32_bits_may_last_2_75_times_as_long() -> Result<(), PlanError> {
    const FRAMES: u32 = 5;
    let mut search = at_a_low_rate()?;
    let in_32_bits = in_first_trial()?.stepping;
    let best = measured(Candidate::new(in_32_bits), FRAMES, true);
    search.goal.set_best(best);
    let mut pairs = judging_pairs(&search);
    let finest = pairs.next().expect("several pairs");
    let coarsest = pairs.next_back().expect("several pairs");
    let (rate, admissible) = (search.problem.rate, search.admissible);
    let shadows = Shadows::cost_of_frame(search.shadow(), admissible, rate, &search.costs);
    let [finest_costs, coarsest_costs] = [finest, coarsest].map(|pair| {
        let cost = Trial::cost(&search.costs, in_32_bits, Judges::Reference(pair)) + shadows;
        FRAMES as f32 * cost
    });

    let enough = search.spent + f32::max(1.001 * 2.75 * finest_costs, 6.001 * coarsest_costs);
    let too_little = search.spent + 0.999 * 2.75 * finest_costs;
    assert!(enough < search.spent + 6.0 * finest_costs);
    for (planning, expected) in [(too_little, false), (enough, true)] {
        search.budget.planning = planning;
        let pair = search.judging_pair(in_32_bits);
        assert_eq!(pair == Some(finest), expected, "{planning}");
    }
    Ok(())
}
