//! The accuracy clock against the exact motion, and the plan against both: until when a frame really is right to half a pixel.

use std::thread;

use double_pendulum::plan::{self, Budget, Limit, Search};
use double_pendulum::{Parameters, Pendulum};
use firmware::config::{CORTEX_M4F, HALF_PIXEL, MASS_RATIOS, REACH, TICK_RATE};
use firmware::graphics::view::Place;
use firmware::motion::planner::problem;
use firmware::motion::settings::Settings;
use firmware::scenes::{AnyScene, SceneName};
use host_tests::commands::plan::median;
use host_tests::emulator::host::Show;
use host_tests::oracle::reference::Reference;
use host_tests::oracle::tolerances::{CLOCK_LATE, CLOCK_TYPICAL, PLAN_AND_CLOCK, PLAN_AND_CLOCK_EACH, PLAN_SHARE};

/// How long each motion is followed, s. Of those that are still right then, the clock must say so, too.
const FOLLOWED: f64 = 20.0;

/// Ticks from one comparison with the exact motion to the next.
const EVERY: u32 = 2;

#[derive(Clone, Debug)]
struct Case {
    name: SceneName,
    settings: Settings,
    /// How far both rods reach on the frame, pixels.
    reach: f32,
}

/// Until when the clock says that the frame is right, and until when it really is, s.
#[derive(Clone, Debug)]
struct Horizon {
    case: Case,
    shown: f64,
    exact: f64,
    /// Until when the plan, looking ahead, promises it.
    promised: f64,
}

/// The page at 54 settings from calm to wild, rods of other lengths, and the other scenes that integrate.
fn cases() -> Vec<Case> {
    let page = |settings| Case { name: SceneName::Page, settings, reach: REACH };
    let ratios = MASS_RATIOS.into_iter().step_by(5);
    let angles = [60.0, 90.0, 105.0, 120.0, 150.0, 171.0];
    let grid = ratios.flat_map(|ratio| angles.map(|angle| page(Settings::equal_rods(ratio, angle))));
    let unequal = [(0.3, 1.0), (1.0, 0.3), (0.1, 0.1), (3.0, 3.0)].map(|(l1, l2)| {
        let settings = Settings::equal_rods(1.0, 130.0);
        page(Settings { parameters: Parameters { l1, l2, ..settings.parameters }, ..settings })
    });
    let half = |name: SceneName| Case { name, settings: name.first_settings(), reach: Place::HALVES[0].reach };
    let others = [SceneName::Figure7, SceneName::Butterfly, SceneName::Upright].map(half);
    grid.chain(unequal).chain(others).collect()
}

fn horizon(case: &Case) -> Horizon {
    let widened = |x: f32| f64::from(x);
    let parameters = case.settings.parameters.cast();
    let motion = case.settings.motion().cast();
    let pendulum = Pendulum::new(parameters).expect("the scene took it");
    let mut reference = Reference::new(&parameters, &motion);
    let mut scene = Show::new(case.name, &case.settings).expect("good settings");
    let scale = widened(case.reach) / (parameters.l1 + parameters.l2);

    let mut exact = f64::INFINITY;
    for tick in 1..=(FOLLOWED * f64::from(TICK_RATE)) as u32 {
        scene.tick();
        let time = f64::from(tick) / f64::from(TICK_RATE);
        let report = scene.report();
        if exact.is_infinite() && tick % EVERY == 0 {
            reference.advance_to(time);
            let truth = reference.motion();
            let bobs = pendulum.positions(truth.angles());
            let shown = pendulum.positions(report.state.angles().map(widened));
            let distance = |i: usize| scale * (bobs[i].x - shown[i].x).hypot(bobs[i].y - shown[i].y);
            let is_right = distance(0).max(distance(1)) <= widened(HALF_PIXEL);
            if !is_right {
                exact = f64::from(tick - EVERY) / f64::from(TICK_RATE);
            }
        } else if exact.is_finite() && (report.horizon.is_finite() || time > CLOCK_LATE * exact) {
            break;
        }
    }
    Horizon {
        case: case.clone(),
        shown: scene.report().horizon.into(),
        exact,
        promised: promised(case.name, &case.settings),
    }
}

/// Until when the kernel's planner says that the method is right by which the scene is shown; infinity if all the time.
fn promised(name: SceneName, settings: &Settings) -> f64 {
    let playing = AnyScene::new(name, settings).expect("good settings");
    let shown = playing.shown().expect("it shows a motion");
    let scene = plan::Problem { duration: FOLLOWED, ..problem(settings, &shown) };
    let budget = Budget { frame: 1e9, planning: 1e12 };
    let mut search = Search::of(shown.method, shown.steps, &scene, &CORTEX_M4F, &budget).expect("a good scene");
    loop {
        if let Some(plan) = search.advance(f32::INFINITY).expect("a good scene") {
            return if plan.limit == Limit::End { f64::INFINITY } else { plan.horizon };
        }
    }
}

/// The least, the median and the greatest.
fn spread(values: impl Iterator<Item = f64> + Clone) -> [f64; 3] {
    [values.clone().fold(f64::INFINITY, f64::min), median(values.clone()), values.fold(0.0, f64::max)]
}

#[test]
fn the_clock_is_never_late_and_typically_close_and_the_planner_agrees() {
    let cases = cases();
    let workers = thread::available_parallelism().map_or(1, usize::from);
    let horizons: Vec<Horizon> = thread::scope(|scope| {
        let chunks = cases.chunks(cases.len().div_ceil(workers));
        let threads: Vec<_> =
            chunks.map(|chunk| scope.spawn(|| chunk.iter().map(horizon).collect::<Vec<_>>())).collect();
        threads.into_iter().flat_map(|thread| thread.join().expect("no panic")).collect()
    });

    let (mut passed, mut late, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
    for Horizon { case, shown, exact, promised } in &horizons {
        println!(
            "{:10} shown {shown:8.3} exact {exact:8.3} promised {promised:8.3}  {:?} {:?}",
            case.name.name(),
            case.settings.mass_ratio(),
            case.settings.degrees
        );
        if *shown > CLOCK_LATE * exact {
            late.push(format!("{case:?}: shown {shown}, exact {exact}"));
        }
        if exact.is_finite() {
            passed.push((shown / exact - 1.0).abs());
            // The clock of the scene that shows plain sums is theirs, its plan that of the compensated ones.
            if case.name != SceneName::Upright {
                ratios.push((promised / exact, promised / shown));
            }
        }
    }
    assert!(late.is_empty(), "{late:#?}");
    passed.sort_by(f64::total_cmp);
    assert!(
        horizons.len() >= 50 && passed.len() >= 40,
        "only {} of {} motions cease to be right",
        passed.len(),
        horizons.len()
    );
    let typical = passed[passed.len() / 2];
    println!(
        "{} motions; off by {:.1} % typically, {:.1} % at most",
        passed.len(),
        100.0 * typical,
        100.0 * passed[passed.len() - 1]
    );
    assert!(typical <= CLOCK_TYPICAL, "{typical}");

    let (of_exact, of_clock) = (spread(ratios.iter().map(|ratio| ratio.0)), spread(ratios.iter().map(|ratio| ratio.1)));
    println!("promised over exact {of_exact:.2?}, over the clock {of_clock:.2?} (least, median, greatest)");
    assert!(of_exact[1] >= PLAN_SHARE && of_exact[2] <= 1.0, "{of_exact:?}");
    assert!((of_clock[1] - 1.0).abs() <= PLAN_AND_CLOCK, "{of_clock:?}");
}

/// Both promise one thing: half a pixel about the exact motion, whatever the model that is shown. The clock of the scene
/// that shows plain sums is theirs, its plan that of the compensated ones, so it is left out.
#[test]
fn the_clock_and_the_plan_agree_on_every_scene() {
    let tick = 1.0 / f64::from(TICK_RATE);
    let ticks = (FOLLOWED * f64::from(TICK_RATE)) as u32;
    for &name in SceneName::ALL.iter().filter(|&&name| ![SceneName::Frequencies, SceneName::Upright].contains(&name)) {
        let settings = name.first_settings();
        let mut show = Show::new(name, &settings).expect("a scene of the catalogue");
        (0..ticks).for_each(|_| show.tick());
        let (clock, promised) = (f64::from(show.report().horizon), promised(name, &settings));
        println!("{:12} clock {clock:7.3} plan {promised:7.3}", name.name());
        let is_one = clock == promised || (clock - promised).abs() <= (PLAN_AND_CLOCK_EACH * clock).max(2.0 * tick);
        assert!(is_one, "{}: the clock says {clock} s, the plan {promised} s", name.name());
    }
}
