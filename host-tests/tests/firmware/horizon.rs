//! What the frames show against the exact motion: right to half a pixel until the time that the panel predicts, and hardly
//! longer, before and after the way they are computed changes.

use double_pendulum::{Parameters, Pendulum};
use firmware::config::{CORTEX_M3, CORTEX_M4F, HALF_PIXEL, MASS_RATIOS, Processor, REACH, TICK_RATE};
use firmware::graphics::Place;
use firmware::motion::Settings;
use firmware::scenes::SceneName;
use host_tests::commands::plan::median;
use host_tests::emulator::host::Show;
use host_tests::oracle::tolerances::PLAN_SHARE;
use rayon::prelude::*;
use reference::taylor::Reference;

/// How long each motion is followed, s.
const FOLLOWED: f64 = 25.0;

/// Ticks from one comparison with the exact motion to the next.
const EVERY: u32 = 2;

#[derive(Clone, Debug)]
struct Case {
    processor: Processor,
    name: SceneName,
    settings: Settings,
    /// How far both rods reach on the frame, pixels.
    reach: f32,
}

/// Until when the panel says that the frames are right, and until when they really are, s.
#[derive(Clone, Debug)]
struct Horizon {
    case: Case,
    predicted: f64,
    exact: f64,
    /// Whether the first wrong frame was shown as a right one.
    violated: bool,
    /// Whether the way changed.
    changed: bool,
}

/// The page from calm to wild, rods of other lengths, and the other scenes that follow a plan, on both cores.
fn cases() -> Vec<Case> {
    let page = |processor, settings| Case { processor, name: SceneName::Page, settings, reach: REACH };
    let both = |settings: Settings| [CORTEX_M3, CORTEX_M4F].map(|processor| page(processor, settings));
    let ratios = MASS_RATIOS.into_iter().skip(5).step_by(10);
    let angles = [20.0, 60.0, 90.0, 105.0, 120.0, 171.0];
    let grid = ratios.flat_map(|ratio| angles.map(|angle| both(Settings::equal_rods(ratio, angle))));
    let own = both(SceneName::Page.first_settings());
    let unequal = [(0.3, 1.0), (1.0, 0.3), (0.1, 0.1), (3.0, 3.0)].map(|(l1, l2)| {
        let settings = Settings::equal_rods(1.0, 130.0);
        both(Settings { parameters: Parameters { l1, l2, ..settings.parameters }, ..settings })
    });
    let half = |name: SceneName| {
        let (settings, reach) = (name.first_settings(), Place::HALVES[0].reach);
        [CORTEX_M3, CORTEX_M4F].map(|processor| Case { processor, name, settings, reach })
    };
    let others = [SceneName::Figure7, SceneName::Butterfly].map(half);
    grid.chain([own]).chain(unequal).chain(others).flatten().collect()
}

fn horizon(case: &Case) -> Horizon {
    let widened = |x: f32| f64::from(x);
    let parameters = case.settings.parameters.cast();
    let motion = case.settings.motion().cast();
    let pendulum = Pendulum::new(&parameters).expect("the scene took it");
    let mut reference = Reference::new(&parameters, &motion);
    let mut scene = Show::on(case.processor, case.name, &case.settings).expect("good settings");
    let first = scene.report().way;
    let scale = widened(case.reach) / (parameters.l1 + parameters.l2);

    let (mut exact, mut violated) = (f64::INFINITY, false);
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
                violated = f64::from(report.horizon) >= time;
            }
        }
    }
    let report = scene.report();
    Horizon { case: case.clone(), predicted: report.horizon.into(), exact, violated, changed: report.way != first }
}

#[test]
fn half_a_pixel_is_kept_until_the_time_on_the_panel_and_hardly_longer() {
    let horizons: Vec<Horizon> = cases().into_par_iter().map(|case| horizon(&case)).collect();
    let (mut late, mut shares, mut changes) = (Vec::new(), Vec::new(), 0);
    for Horizon { case, predicted, exact, violated, changed } in &horizons {
        println!(
            "{:10} predicted {predicted:8.3} exact {exact:8.3} {}  {:?} {:?}",
            case.name.name(),
            if *changed { "changed" } else { "" },
            case.settings.mass_ratio(),
            case.settings.degrees
        );
        if *violated {
            late.push(format!("{case:?}: predicted {predicted}, exact {exact}"));
        }
        if exact.is_finite() {
            shares.push(predicted / exact);
        }
        changes += usize::from(*changed);
    }
    assert!(late.is_empty(), "{late:#?}");
    println!("{} motions, {} end early, {changes} changed their way", horizons.len(), shares.len());
    assert!(shares.len() >= LEAST_ENDING && changes >= LEAST_CHANGES, "{} {changes}", shares.len());
    let share = median(shares.into_iter());
    println!("predicted over exact: {share:.2}");
    assert!(share >= PLAN_SHARE, "{share}");
}

/// How many of the motions must cease to be right, and change their way, so that there is something to test.
const LEAST_ENDING: usize = 10;
const LEAST_CHANGES: usize = 10;

/// What the page and figure 7 bring on every class of processors: goals, s.
#[test]
fn the_page_and_figure_7_are_right_for_as_long_as_they_should() {
    for (name, least, most) in [(SceneName::Page, 19.0, 30_000.0), (SceneName::Figure7, 16.0, f32::INFINITY)] {
        for processor in [CORTEX_M3, CORTEX_M4F] {
            let mut show = Show::on(processor, name, &name.first_settings()).expect("a scene of the catalogue");
            let ticks = 40 * TICK_RATE;
            (0..ticks).for_each(|_| show.tick());
            let report = show.report();
            let way = report.way.expect("it moves");
            let cost = show.player.cost(way);
            println!("{} {way:?} {cost} cycles, {} s", name.name(), report.horizon);
            assert!(f64::from(report.horizon) >= least && cost <= most, "{}: {report:?} {cost}", name.name());
        }
    }
}
