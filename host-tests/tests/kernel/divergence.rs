//! Steps that are too long for a motion: the error has a type, the last good state is kept, and no
//! result is NaN.

use boards::host::canvas;
use boards::qemu::Screenshot;
use double_pendulum::{Error, Integrator, Method, Parameter, Parameters, State};
use exact::trials;
use firmware::app::{App, NoButtons};
use firmware::config::PROCESSOR;
use firmware::display::NoDisplay;
use firmware::graphics::Format;
use firmware::job::{BoardMotion, Job, Reading, Request};
use firmware::motion::Settings;
use firmware::protocol::{Command, Field, PlayState};
use firmware::scenes::SceneName;

/// A step below the stability limit of 0.49 s, but far too long for a motion of 300 rad/s.
const TOO_LONG: f64 = 0.3;
/// A start with rates of some 300 rad/s.
const FAST: State<f64> = State {
    a1: 3.0,
    a2: 1.0,
    p1: 300.0,
    p2: -300.0,
};
/// A step of the closed form. It has no such limit, but the time must be finite.
const AGES: f64 = 1e307;
const MANY: u32 = 100_000;

const EVEN: Parameters<f64> = Parameters {
    m1: 1.0,
    m2: 1.0,
    l1: 1.0,
    l2: 1.0,
    g: 9.8,
};

/// Fixed point may refuse such steps at the start instead.
#[test]
fn diverged_run_keeps_its_last_good_state_in_every_method() -> Result<(), Error> {
    for &method in Method::ALL {
        let dt = if method.integrator() == Integrator::ClosedForm {
            AGES
        } else {
            TOO_LONG
        };

        let mut run = match trials::run(method, &EVEN, &FAST, dt) {
            Err(Error::TooLarge {
                parameter: Parameter::Dt,
                ..
            }) if method.is_fixed_point() => continue,
            run => run?,
        };

        let stopped = (0..MANY).find_map(|_| {
            let before = run.state();
            run.advance(1).err().map(|error| (error, before))
        });
        let Some((Error::Diverged { .. }, before)) = stopped else {
            panic!("{stopped:?} of {method}")
        };
        assert_eq!(run.state(), before, "{method}: the run stays as it was");
        assert_eq!(before.check(), Ok(()), "{method}");
    }

    Ok(())
}

/// The step is within the limit of small motions, the only one that can be checked before.
#[test]
fn failure_of_a_diverged_job_names_the_step_size() {
    let parameters = Parameters { m2: 100.0, ..EVEN };
    let request = Request {
        method: Method::Rk4F32,
        parameters,
        angles: [3.0, 1.0],
        velocities: [3000.0, -3000.0],
        dt: 0.06,
        stride: 1,
        samples: MANY,
    };

    let run = BoardMotion::start(&request).expect("within the limit");
    let mut job = Job::new(run, &request).expect("a pendulum");

    let answers: Vec<_> =
        std::iter::from_fn(|| (!job.is_finished()).then(|| job.advance())).collect();
    let (last, readings) = answers.split_last().expect("answers");
    assert_eq!(
        last.map_err(Field::from),
        Err(Field::Dt),
        "after {} readings",
        readings.len()
    );

    let is_finite = |answer: &Result<Option<Reading>, Error>| {
        let reading = answer.unwrap_or_default().unwrap_or_default();
        answer.is_ok()
            && reading
                .state
                .iter()
                .chain(&reading.velocities)
                .all(|number| number.is_finite())
    };
    assert!(!readings.is_empty() && readings.iter().all(is_finite));
}

#[test]
fn too_fast_motion_is_stopped_before_it_diverges() {
    let parameters = Parameters {
        m1: 1.0,
        m2: 1.0,
        l1: 1e-4,
        l2: 1e-4,
        g: 9.8,
    };

    let settings = Settings {
        parameters,
        degrees: [179.0, 60.0],
        velocities: [3e8, -3e8],
    };

    let mut panel = NoDisplay;
    let mut app = App::new(
        PROCESSOR,
        canvas(Format::OLED),
        &mut panel,
        Vec::new(),
        NoButtons,
    );
    app.player
        .play(SceneName::Page, Settings::default())
        .unwrap_or_else(|error| panic!("{error}"));
    app.player
        .execute(Command::Method(Some(Method::Rk4F32Direction)))
        .unwrap_or_else(|field| panic!("{field:?}"));
    app.player
        .play(SceneName::Page, settings)
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(app.player.state(), PlayState::Stopped);

    app.run_to(1, |_| ());
    let frame = Screenshot::from(&app.player.canvas);
    for tick in 2..=600 {
        app.run_to(tick, |event| panic!("{event:?}"));
        assert_eq!(app.player.report.state.check(), Ok(()), "at tick {tick}");
    }
    assert_eq!(Screenshot::from(&app.player.canvas), frame);

    app.player
        .play(SceneName::Page, Settings::default())
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(app.player.state(), PlayState::Playing);
}
