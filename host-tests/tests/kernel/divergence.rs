//! A step that is too long for a motion: a typed error, and the last good state is kept. Never NaN.

use std::fmt::Debug;

use double_pendulum::{
    DirectionF32, DirectionF64, Error, ExtrapolationF64, Form, HamiltonF32, HamiltonF64, Method, Parameters, Pendulum,
    Real, State,
};
use firmware::app::{App, Event, NoButtons, Service};
use firmware::display::NoDisplay;
use firmware::job::Request;
use firmware::motion::Settings;
use firmware::protocol::{Field, Refused, Sample};
use host_tests::emulator::host::sheets;

/// Far beyond the stability limit of 0.5 s; it leads out of the finite numbers within a few hundred steps.
const TOO_LONG: f64 = 50.0;
/// More than enough of them.
const MANY: usize = 100_000;

fn parameters<R: Real>() -> Parameters<R> {
    Parameters { m1: R::ONE, m2: R::ONE, l1: R::ONE, l2: R::ONE, g: R::from_f64(9.8) }
}

fn start<R: Real>() -> State<R> {
    State::at_rest(R::from_f64(3.0), R::from_f64(1.0))
}

fn plain_steps_stop<R: Real>() {
    let pendulum = Pendulum::new(&parameters::<R>()).unwrap_or_else(|error| panic!("{error}"));
    let mut state = start();
    let stopped = (0..MANY).find_map(|_| match pendulum.step(&state, R::from_f64(TOO_LONG)).finite() {
        Ok(next) => {
            state = next;
            None
        }
        Err(error) => Some(error),
    });
    assert!(matches!(stopped, Some(Error::Diverged { .. })), "{stopped:?}");
    assert_eq!(state.check(), Ok(()), "the last good state is kept");
}

fn form_stops<F: Form>() -> Result<(), Error> {
    let mut run = Pendulum::new(&parameters::<f64>())?.run::<F>(&start(), TOO_LONG)?;
    let mut before = run;
    let stopped = (0..MANY).find_map(|_| {
        let advanced = run.advance(1);
        if advanced.is_ok() {
            before = run;
        }
        advanced.err()
    });
    assert!(matches!(stopped, Some(Error::Diverged { .. })), "{stopped:?} of {}", std::any::type_name::<F>());
    assert_eq!(run, before, "the run stays as it was");
    assert_eq!(run.state().check(), Ok(()));
    Ok(())
}

#[test]
fn every_stepper_stops_at_its_last_good_state() -> Result<(), Error> {
    plain_steps_stop::<f32>();
    plain_steps_stop::<f64>();
    form_stops::<HamiltonF32>()?;
    form_stops::<HamiltonF64>()?;
    form_stops::<DirectionF32>()?;
    form_stops::<DirectionF64>()?;
    form_stops::<ExtrapolationF64<12>>()
}

/// Within the limit for small motions, which is all that can be known beforehand, but too long for this one.
fn too_quick() -> Request {
    let parameters = Parameters { m1: 1.0, m2: 100.0, ..parameters() };
    let (angles, velocities) = ([3.0, 1.0], [3000.0, -3000.0]);
    Request { method: Method::Rk4F32, parameters, angles, velocities, dt: 0.06, stride: 1, samples: MANY as u32 }
}

#[test]
fn a_job_is_refused_when_its_motion_is_lost() {
    let mut service = Service::default();
    let mut wire = [0; firmware::protocol::MAX_WIRE];
    for byte in firmware::protocol::encode(&too_quick().message(5), &mut wire) {
        service.receive(*byte);
    }
    let answers: Vec<Result<Sample, Refused>> =
        std::iter::from_fn(|| service.is_busy().then(|| service.work())).flatten().collect();
    let (last, samples) = answers.split_last().expect("answers");
    assert_eq!(*last, Err(Refused { request: 5, field: Field::Dt.code() }), "after {} samples", samples.len());
    let is_finite = |answer: &Result<Sample, Refused>| {
        answer.is_ok_and(|sample| sample.state.iter().chain(&sample.velocities).all(|number| number.is_finite()))
    };
    assert!(!samples.is_empty() && samples.iter().all(is_finite));
    assert!(!service.is_busy());
}

/// A pendulum so short that the scenes' step only just suits its small motions.
fn too_short() -> Settings {
    let parameters = Parameters { m1: 1.0, m2: 1.0, l1: 1e-4, l2: 1e-4, g: 9.8 };
    Settings { parameters, degrees: [179.0, 60.0], velocities: [3e4, -3e4] }
}

#[test]
fn a_scene_stands_at_its_last_good_frame() {
    let mut app =
        App::new(too_short(), sheets(), NoDisplay, Vec::new(), NoButtons).unwrap_or_else(|error| panic!("{error}"));
    let mut stops = Vec::new();
    let mut last_good = None;
    for tick in 1..=600 {
        let report = app.player.report();
        app.run_to(tick, |event| {
            if let Event::Stopped(error) = event {
                stops.push(error);
                last_good = Some(report);
            }
        });
        assert_eq!(app.player.report().state.check(), Ok(()), "at tick {tick}");
    }
    assert!(matches!(*stops, [Error::Diverged { .. }]), "said once: {stops:?}");
    assert_eq!(Some(app.player.report()), last_good);
    assert!(app.player.is_paused());
    let frame = app.canvas.clone();
    app.run_to(601, |event: Event<_, _>| no_news(event));
    assert_eq!(*app.canvas, frame);
}

fn no_news<Panel: Debug, Link: Debug>(event: Event<Panel, Link>) {
    panic!("{event:?}");
}
