//! Commands over the serial link, answered by the application that runs on the boards.

use std::f64::consts::PI;

use boards::link::refusal;
use double_pendulum::parts::Advance;
use double_pendulum::plan::Stepping;
use double_pendulum::{Error, Method, Parameters};
use fastrand::Rng;
use firmware::app::{Event, Instruments, PlannerEvent};
use firmware::config::{
    MOST_MEASURED_STEPS, MOST_MESSAGES_PER_TICK, PLANNED, PROCESSOR, RECEIVE_QUEUE, TICK_RATE,
};
use firmware::display::Controller;
use firmware::graphics::{Anchor, Format, text};
use firmware::job::{BoardMotion, Request};
use firmware::motion::{Horizon, Planned, Settings};
use firmware::protocol::{
    Answer, BoardName, Command, Field, Frame, Identity, MAX_WIRE, PlayState, Status, ToHost,
    encode, frame,
};
use firmware::scenes::SceneName;

use crate::bench::{Plain, answers, app, blank, frames, starting_with, wire};

fn answer(app: &mut Plain, command: Command) -> Answer {
    let sent = app.link.len();
    app.receive(wire(9, command), |_| ());
    last(&app.link[sent..], 9)
}

fn last(link: &[u8], request: u16) -> Answer {
    let (to, answer) = answers(link).pop().expect("an answer");
    assert_eq!(to, request);
    answer
}

fn status(app: &mut Plain) -> Status {
    let Answer::Status(status) = answer(app, Command::Ask) else {
        panic!("no status")
    };
    status
}

fn set(field: Field, value: f64) -> Command {
    Command::Set { field, value }
}

#[test]
fn every_parameter_is_set_exactly() {
    for (field, value, read, expected) in [
        (
            Field::M1,
            2.0,
            (|s| s.settings.parameters.m1) as fn(&Status) -> f64,
            2.0,
        ),
        (Field::M2, 0.5, |s| s.settings.parameters.m2, 0.5),
        (Field::L1, 0.8, |s| s.settings.parameters.l1, 0.8),
        (Field::L2, 0.7, |s| s.settings.parameters.l2, 0.7),
        (Field::G, 1.62, |s| s.settings.parameters.g, 1.62),
        (Field::A1, 90.0, |s| s.settings.degrees[0], 90.0),
        (Field::A2, -180.0, |s| s.settings.degrees[1], -180.0),
        (Field::Angle, 171.1, |s| s.settings.degrees[0], 171.1),
        (Field::W1, PI, |s| s.settings.velocities[0], PI),
        (Field::W2, -1.5, |s| s.settings.velocities[1], -1.5),
        (Field::MassRatio, 2.75, |s| s.settings.parameters.m2, 2.75),
        (Field::Speed, 0.5, |s| s.speed.into(), 0.5),
    ] {
        let mut app = app();
        assert_eq!(
            answer(&mut app, set(field, value)),
            Answer::Done,
            "{field:?}"
        );
        assert_eq!(read(&status(&mut app)), expected, "{field:?}");
    }
}

#[test]
fn every_command_of_a_burst_is_obeyed() {
    let mut app = app();
    let before = app.player.settings;
    let right = Command::TurnRight;
    let left = Command::TurnLeft;
    let commands = [
        right,
        right,
        Command::Heavier,
        left,
        right,
        Command::Restart,
        Command::Lighter,
        right,
        right,
    ];
    // The application may take only some of the bytes.
    let mut bytes = commands
        .iter()
        .flat_map(|&command| wire(1, command))
        .collect::<Vec<_>>()
        .into_iter();
    while !bytes.as_slice().is_empty() {
        app.receive(bytes.by_ref(), |_| ());
    }
    assert_eq!(
        app.player.settings,
        before.turned(1).turned(1).turned(1).turned(1)
    );
    assert_eq!(answers(&app.link), [(1, Answer::Done); 9]);
}

#[test]
fn a_board_reports_its_identity_and_the_cycles_of_steps() {
    let mut app = app();
    let identity = Identity {
        board: BoardName::Pico,
        hertz: 1_000_000,
        chip: [1, 2, 3, 4],
        ..Identity::default()
    };
    let timed = |motion: &mut BoardMotion, steps| {
        motion.advance(steps);
        1600
    };
    app.instruments = Instruments {
        identity,
        timed,
        image: || b"123456789",
        ..Instruments::default()
    };

    let expected = Identity {
        image: 0xCBF4_3926,
        image_bytes: 9,
        ..identity
    };
    assert_eq!(
        answer(&mut app, Command::Identify),
        Answer::Identity(expected)
    );

    let measure = Command::Measure(u32::MAX);
    assert_eq!(
        answer(&mut app, measure),
        Answer::Refused(Field::Message),
        "no motion was requested"
    );
    let request = Request {
        samples: 1,
        ..Request::on_any_core(Method::Rk4F32)
    };
    app.receive(wire(3, Command::Simulate(request)), |_| ());

    while app.work(|_| ()) {}
    assert!(matches!(
        last(&app.link, 3),
        Answer::Sample { index: 1, .. }
    ));

    for _ in 0..2 {
        assert_eq!(
            answer(&mut app, measure),
            Answer::Measured {
                steps: MOST_MEASURED_STEPS,
                cycles: 1600
            }
        );
    }

    assert!(!app.work(|_| ()), "and no sample follows");
}

#[test]
fn a_bad_command_is_answered_with_the_field_and_changes_nothing() {
    let mut app = app();
    app.run_to(30, |_| ());
    let before = (status(&mut app), app.player.report);

    for (message, field) in [
        (set(Field::M1, 0.0), Field::M1),
        (set(Field::M2, -1.0), Field::M2),
        (set(Field::M2, 1e300), Field::M2),
        (set(Field::L1, f64::NAN), Field::L1),
        (set(Field::L2, f64::INFINITY), Field::L2),
        (set(Field::L1, 1e-30), Field::L1), // no step is short enough
        (set(Field::G, -9.81), Field::G),
        (set(Field::A1, 181.0), Field::A1),
        (set(Field::A2, -180.1), Field::A2),
        (set(Field::Angle, f64::NAN), Field::Angle),
        (set(Field::W1, f64::INFINITY), Field::W1),
        (set(Field::MassRatio, 0.0), Field::MassRatio),
        (set(Field::Speed, 0.0), Field::Speed),
        (set(Field::Speed, 0.004), Field::Speed),
        (set(Field::Speed, 4.006), Field::Speed),
        (set(Field::Speed, f64::NAN), Field::Speed),
        (set(Field::Dt, 1.0), Field::Field),
        (set(Field::Method, 1.0), Field::Field),
        (Command::Method(Some(Method::Rk4F64)), Field::Method),
    ] {
        assert_eq!(
            answer(&mut app, message),
            Answer::Refused(field),
            "{message:?}"
        );
    }

    assert_eq!((status(&mut app), app.player.report), before);
}

/// The check is of the angle that a command sets, so an angle beyond straight up that the program
/// has set stays.
#[test]
fn an_angle_beyond_straight_up_does_not_refuse_another_field() {
    let degrees = [200.0, -181.0];
    for (field, value, expected) in [
        (Field::M1, 2.0, degrees),
        (Field::MassRatio, 0.5, degrees),
        (Field::W2, 1.0, degrees),
        (Field::A1, 90.0, [90.0, -181.0]),
        (Field::A2, 90.0, [200.0, 90.0]),
        (Field::Angle, 90.0, [90.0, 90.0]),
    ] {
        let mut app = starting_with(Settings {
            degrees,
            ..Settings::default()
        });
        assert_eq!(
            answer(&mut app, set(field, value)),
            Answer::Done,
            "{field:?}"
        );
        assert_eq!(app.player.settings.degrees, expected, "{field:?}");

        for field in [Field::A1, Field::A2, Field::Angle] {
            assert_eq!(answer(&mut app, set(field, 180.1)), Answer::Refused(field));
        }
    }
}

#[test]
fn an_error_about_the_method_names_the_method() {
    let method = Method::Rk4F64;
    assert_eq!(Field::from(Error::NotDrawn { method }), Field::Method);
}

#[test]
fn a_motion_that_is_too_fast_is_stopped_and_reported() {
    let mut app = app();
    let mut events = Vec::new();
    app.receive(wire(1, set(Field::W2, 2e4)), |event| events.push(event));
    assert_eq!(last(&app.link, 1), Answer::Done);
    for clock in 1..=10 {
        app.run_to(clock, |event| events.push(event));
    }
    let settings = app.player.settings;
    assert_eq!(
        events,
        [Event::Started(SceneName::Page, settings), Event::Stopped]
    );

    let frames = frames(&app.link);
    assert_eq!(frames.len(), 10);
    for frame in frames {
        assert_eq!(frame.state, PlayState::Stopped);
        assert_eq!((frame.report.step, frame.report.stepping), (0, None));
        assert_eq!(frame.report.horizon, Horizon::Until(0.0));
    }

    let mut expected = blank();

    for (row, text) in [
        (2, "too fast"),
        (3, "for this chip"),
        (5, "μ 1.00"),
        (6, "α 120°"),
    ] {
        text::write(
            &mut expected,
            text,
            Anchor::Middle(row * Format::OLED.line()),
        );
    }
    assert!(app.player.canvas == expected);

    app.receive(wire(2, set(Field::W2, 0.0)), |_| ());
    app.run_to(11, |_| ());
    assert_eq!(app.player.state(), PlayState::Playing);
    assert_eq!(app.player.report.step, 1);
}

#[test]
fn a_pause_outlasts_a_stop() {
    let mut app = app();
    let states = [
        (Command::Pause(true), PlayState::Paused),
        (set(Field::W2, 2e4), PlayState::Stopped),
        (set(Field::W2, 0.0), PlayState::Paused),
        (Command::Pause(false), PlayState::Playing),
    ];
    for (command, state) in states {
        assert_eq!(answer(&mut app, command), Answer::Done);
        assert_eq!((app.player.state(), status(&mut app).state), (state, state));
        assert_eq!(app.player.frame().state, state);
    }
}

#[test]
fn pause_is_toggled() {
    let mut app = app();
    assert_eq!(answer(&mut app, Command::Step(3)), Answer::Done);
    assert_eq!(status(&mut app).steps, 3);
    for state in [PlayState::Playing, PlayState::Paused, PlayState::Playing] {
        assert_eq!(answer(&mut app, Command::TogglePause), Answer::Done);
        let status = status(&mut app);
        assert_eq!((status.state, status.steps), (state, 0));
    }
}

#[test]
fn options_of_the_panel_are_refused_without_such_a_panel() {
    for command in [
        Command::Panel(None),
        Command::Panel(Some(Controller::Sh1106)),
        Command::Turn(true),
        Command::Dim(false),
    ] {
        assert_eq!(
            answer(&mut app(), command),
            Answer::Refused(Field::Panel),
            "{command:?}"
        );
    }
}

#[test]
fn an_intact_command_that_cannot_be_read_is_answered_too() {
    let mut app = app();
    for (message, request) in [
        (&[0x80, 77, 0xEE][..], 77),
        (&[0x80, 77, 10], 77),
        (&[0x80, 77, 10, 0, 0], 77),
        (&[0x80, 77, 7, 0xEE], 77),
        (&[0x80, 77, 8, 0xEE, 0, 0, 0, 0, 0, 0, 0, 0], 77),
        (&[0x80, 77, 9, 1, 0x7F], 77),
        (&[0x80], 0),
    ] {
        app.receive(frame(message, &mut [0; MAX_WIRE]).iter().copied(), |_| ());
        assert_eq!(
            last(&app.link, request),
            Answer::Refused(Field::Message),
            "{message:?}"
        );
    }
    assert!(refusal(Field::Message).ends_with("flash the board again"));
}

#[test]
fn a_message_that_is_no_command_is_not_answered() {
    let mut app = app();
    for message in [
        ToHost::Frame(Frame::default()),
        ToHost::Answer(7, Answer::Refused(Field::Message)),
    ] {
        app.receive(
            encode(&message, &mut [0; MAX_WIRE]).iter().copied(),
            |event| panic!("{event:?}"),
        );
    }

    for kind in (0..=u8::MAX).filter(|kind| *kind != 0x80) {
        app.receive(
            frame(&[kind, 7, 0, 1], &mut [0; MAX_WIRE]).iter().copied(),
            |event| panic!("{event:?}"),
        );
    }
    assert!(app.link.is_empty());
}

#[test]
fn an_endless_message_takes_one_queue_at_most() {
    let mut taken = 0;
    app().receive(
        std::iter::repeat_n(1, 1_000_000).inspect(|_| taken += 1),
        |_| (),
    );
    assert_eq!(taken, RECEIVE_QUEUE);
}

#[test]
fn every_scene_can_be_chosen_restarts_pauses_and_steps() {
    for &name in SceneName::ALL {
        let mut app = app();
        let mut clock = 0;
        let mut run = |app: &mut Plain, ticks| {
            for _ in 0..ticks {
                clock += 1;
                app.run_to(clock, |_| ());
            }
            app.player.report
        };
        app.receive(wire(1, Command::Choose(name)), |_| ());
        assert_eq!(app.player.name, name);
        let one = run(&mut app, 1);
        let ten = run(&mut app, 9);
        app.receive(wire(2, Command::Pause(true)), |_| ());
        assert_eq!(run(&mut app, 5), ten, "{}: paused", name.name());
        app.receive(wire(3, Command::Step(2)), |_| ());
        let twelve = run(&mut app, 5);
        assert_eq!(twelve.step, 12 * one.step, "{}: two steps", name.name());
        app.receive(wire(4, Command::Restart), |_| ());
        assert_eq!(
            run(&mut app, 3).step,
            0,
            "{}: restarted, still paused",
            name.name()
        );
        app.receive(wire(5, Command::Pause(false)), |_| ());
        assert_eq!(run(&mut app, 12), twelve, "{}: the same again", name.name());
        assert_eq!(
            answers(&app.link),
            [1, 2, 3, 4, 5].map(|request| (request, Answer::Done))
        );
        assert!(frames(&app.link).iter().all(|frame| frame.scene == name));
    }
}

#[test]
fn the_plan_is_found_reported_and_followed() {
    let mut app = app();
    let plan_report = |app: &mut Plain| {
        let Answer::Planned(planned) = answer(app, Command::AskPlan) else {
            panic!("no plan")
        };
        planned
    };
    let mut events = Vec::new();
    let run = |app: &mut Plain, events: &mut Vec<_>| {
        assert!(app.run_to(app.frames + 1, |event| events.push(event)))
    };
    let search = |app: &mut Plain, events: &mut Vec<_>| loop {
        match plan_report(app).expect("a motion").found {
            None => run(app, events),
            Some(found) => break found.expect("a plan"),
        }
    };
    let plan = search(&mut app, &mut events);
    assert!(plan.horizon > 18.5, "{plan:?}");
    run(&mut app, &mut events);
    assert_eq!(events, [Event::Motion(PlannerEvent::Found(Ok(plan)))]);
    assert_eq!(app.player.report.stepping, Some(plan.stepping()));

    let before = plan_report(&mut app).expect("a motion");
    app.receive(wire(1, set(Field::Angle, 20.0)), |_| ());
    assert_eq!(
        plan_report(&mut app),
        Some(Planned {
            found: None,
            ..before
        })
    );
    let calm = search(&mut app, &mut events);
    assert!(calm.horizon >= PLANNED && calm.cost < plan.cost, "{calm:?}");
    (0..TICK_RATE).for_each(|_| run(&mut app, &mut events));
    let stepping = Stepping {
        method: Method::Rk4Fixed32,
        steps: calm.steps,
    };
    assert_eq!(
        events.last(),
        Some(&Event::Motion(PlannerEvent::Shown(stepping, calm.cost))),
        "the cheaper method is taken"
    );
    let report = app.player.report;
    assert_eq!(report.stepping, Some(calm.stepping()));
    assert!(
        matches!(report.horizon, Horizon::AtLeast(until) if f64::from(until) > PLANNED),
        "{report:?}"
    );

    app.receive(wire(1, Command::Choose(SceneName::Frequencies)), |_| ());
    assert!(!app.player.look_ahead());
    assert_eq!(plan_report(&mut app), None);
}

#[test]
fn a_method_can_be_forced() {
    let mut app = app();
    let mut go = |method| {
        assert_eq!(answer(&mut app, Command::Method(method)), Answer::Done);
        assert_eq!(status(&mut app).method, method);
        app.player.report.stepping.map(|stepping| stepping.method)
    };
    for &method in Method::DRAWN {
        assert_eq!(go(Some(method)), Some(method));
        assert_eq!(go(None), Some(Method::Extrapolation10Fixed64));
    }
}

/// A method that is too expensive for a frame of a Cortex-M3, because a short rod swings fast.
const COSTLY: Method = Method::Rk4F32DirectionPlain;

fn fast() -> Settings {
    let mut settings = Settings::equal_rods(1.0, 10.0);
    settings.parameters.l2 = 0.002;
    settings
}

/// The requested method is remembered in the status, and used again with other settings. A host
/// that replays the status has the same scene.
#[test]
fn a_scene_that_cannot_use_the_requested_method_follows_its_plan() {
    let mut app = app();
    let requested = Some(COSTLY);
    let shown = |app: &Plain| app.player.report.stepping.map(|stepping| stepping.method);
    let play = |app: &mut Plain, settings| {
        let command = Command::Play(SceneName::Page, settings);
        assert_eq!(answer(app, command), Answer::Done);
    };
    assert_eq!(answer(&mut app, Command::Method(requested)), Answer::Done);
    assert_eq!(shown(&app), requested);

    play(&mut app, fast());
    assert_ne!(shown(&app), requested, "not possible here");
    assert_eq!(status(&mut app).method, requested, "but not forgotten");
    let fallen_back = status(&mut app);
    assert_eq!(
        answer(&mut app, Command::Method(requested)),
        Answer::Refused(Field::Method),
        "refused if requested again"
    );
    assert_eq!(status(&mut app), fallen_back, "and changes nothing");

    let mut replayed = self::app();
    assert_eq!(replayed.player.resume(&fallen_back), Ok(()));
    assert_eq!(replayed.player.report, app.player.report);
    assert_eq!(replayed.player.status(), fallen_back);

    play(&mut app, Settings::default());
    assert_eq!(
        shown(&app),
        requested,
        "where it is possible, it is used again"
    );
}

#[test]
fn every_scene_is_reached_with_any_requested_method() {
    for &method in Method::DRAWN {
        let mut app = app();
        assert_eq!(
            answer(&mut app, Command::Method(Some(method))),
            Answer::Done
        );
        for (command, turned) in [
            (
                Command::NextScene,
                SceneName::next as fn(SceneName) -> SceneName,
            ),
            (Command::PreviousScene, SceneName::previous),
        ] {
            for _ in SceneName::ALL {
                let name = turned(app.player.name);
                assert_eq!(answer(&mut app, command), Answer::Done, "{method}");
                assert_eq!(app.player.name, name, "{method}");
            }
        }
    }
}

/// A scene that has fallen back from the requested method is planned: a result is found in 60 s, and
/// a plan is in use at the end.
#[test]
fn a_scene_that_has_fallen_back_follows_its_plan() {
    let mut app = app();
    app.receive(wire(1, Command::Method(Some(Method::Rk4Fixed32))), |_| ());
    app.receive(wire(1, Command::Play(SceneName::Page, fast())), |_| ());
    let initial = app.player.report.stepping;
    let mut found = None;
    for clock in 1..=60 * TICK_RATE {
        app.run_to(clock, |event| {
            if let Event::Motion(PlannerEvent::Found(result)) = event {
                found = Some(result.map(|plan| plan.stepping()).ok());
            }
        });
    }
    let found = found.expect("a result");
    assert_eq!(app.player.report.stepping, found.or(initial));
}

/// Many steps of a slow method would delay the board's frames, and the watchdog would restart it.
#[test]
fn a_requested_method_that_a_frame_cannot_pay_for_is_not_used() {
    let mut app = app();
    let requested = Some(Method::Rk4F32Direction);
    app.receive(wire(1, Command::Method(requested)), |_| ());
    for _ in 0..20 {
        app.receive(wire(1, Command::Heavier), |_| ());
        let stepping = app.player.report.stepping.expect("a motion");
        assert!(
            app.player.cost(stepping) <= PROCESSOR.frame,
            "{stepping:?} at {}",
            app.player.settings.mass_ratio()
        );
    }
    assert_eq!(app.player.settings.mass_ratio(), 100.0);
}

/// All settings are sent at once, because some of them alone may be impossible.
#[test]
fn a_scene_is_played_with_settings_of_the_user() {
    let mut app = app();
    let own = Settings {
        parameters: Parameters {
            m1: 3.0,
            m2: 0.5,
            l1: 0.7,
            l2: 1.1,
            g: 1.62,
        },
        degrees: [90.0, -45.0],
        velocities: [0.5, -2.0],
    };
    let before = status(&mut app);
    let play = Command::Play(SceneName::Butterfly, own);

    assert_eq!(answer(&mut app, play), Answer::Done);
    let played = Status {
        scene: SceneName::Butterfly,
        settings: own,
        ..before
    };
    assert_eq!(status(&mut app), played);
    assert_eq!(app.player.report.step, 0);

    let with = |change: fn(&mut Settings)| {
        let mut settings = own;
        change(&mut settings);
        settings
    };

    for (scene, settings, field) in [
        (
            SceneName::Page,
            with(|own| own.degrees[0] = 180.5),
            Field::A1,
        ),
        (
            SceneName::Page,
            with(|own| own.degrees[1] = -181.0),
            Field::A2,
        ),
        (
            SceneName::Page,
            with(|own| own.degrees[1] = f64::NAN),
            Field::A2,
        ),
        (
            SceneName::Page,
            with(|own| own.parameters.m1 = 0.0),
            Field::M1,
        ),
        (
            SceneName::Flips,
            with(|own| own.parameters.m2 = -1.0),
            Field::M2,
        ),
        (
            SceneName::Upright,
            with(|own| own.parameters.l1 = f64::INFINITY),
            Field::L1,
        ),
        (
            SceneName::Page,
            with(|own| own.velocities[1] = f64::NAN),
            Field::W2,
        ),
        (SceneName::Figure7, own, Field::L2), // its rods are equal
    ] {
        assert_eq!(
            answer(&mut app, Command::Play(scene, settings)),
            Answer::Refused(field),
            "{settings:?}"
        );
        assert_eq!(status(&mut app), played);
    }
}

#[test]
fn speed_is_exact_in_the_long_run() {
    for (speed, ticks) in [
        (0.01, 6),
        (0.25, 150),
        (0.99, 594),
        (1.0, 600),
        (2.5, 1500),
        (4.0, 2400),
    ] {
        let mut app = app();
        app.receive(wire(1, set(Field::Speed, speed)), |_| ());
        (1..=600).for_each(|clock| assert!(app.run_to(clock, |_| ())));
        assert_eq!(
            app.player.report.time,
            f64::from(ticks) / f64::from(TICK_RATE),
            "{speed}"
        );
    }
}

/// The largest number of bytes that arrive in a tick, at 460,800 bits per second.
const BYTES_PER_TICK: usize = 768;

/// Feeds `bytes` as fast as the link can deliver them. Every tick has its intact frame, and the log
/// at most one line a second, without those about executed commands.
fn flood(mut bytes: impl Iterator<Item = u8>, seconds: u32) -> Plain {
    let mut app = app();
    let mut lines = 0;
    let mut waiting = std::collections::VecDeque::new();
    for clock in 1..=seconds * TICK_RATE {
        assert!(app.run_to(clock, |event| lines +=
            u32::from(!matches!(event, Event::Motion(_)))));
        waiting.extend(bytes.by_ref().take(BYTES_PER_TICK));
        waiting.truncate(RECEIVE_QUEUE); // the queue of the boards
        let is_requested = |event: &Event<_, _>| {
            matches!(event, Event::Started(..) | Event::Motion(_) | Event::Asked)
        };
        let mut counted = |event: Event<_, _>| lines += u32::from(!is_requested(&event));
        app.receive(std::iter::from_fn(|| waiting.pop_front()), &mut counted);
    }

    let frames = frames(&app.link);
    assert_eq!(frames.len(), (seconds * TICK_RATE) as usize);
    assert!(
        (0..)
            .zip(&frames)
            .all(|(sequence, frame)| frame.sequence == sequence && frame.dropped == 0)
    );
    assert!(lines <= seconds, "{lines} lines of log in {seconds} s");
    app
}

#[test]
fn noise_half_commands_and_floods_do_not_disturb_the_stream() {
    let mut rng = Rng::with_seed(5);
    let noise = flood(std::iter::repeat_with(move || rng.u8(..)), 60);
    assert_eq!(answers(&noise.link), [], "noise is executed");
    assert_eq!(
        noise.player.report,
        flood(std::iter::empty(), 60).player.report,
        "and changes nothing"
    );

    flood(std::iter::repeat(0), 10);
    flood(std::iter::repeat(1), 10); // one line without an end
    let half = wire(1, set(Field::Angle, 0.1));
    let half = half[..half.len() / 2].to_vec();
    let halves = flood(
        half.into_iter()
            .chain([0])
            .collect::<Vec<_>>()
            .into_iter()
            .cycle(),
        10,
    );
    assert_eq!(answers(&halves.link), []);

    // The queue and the ticks limit the number of commands that are executed.
    let restarts = flood(wire(6, Command::Restart).into_iter().cycle(), 10);
    let answered = answers(&restarts.link).len();
    let most = MOST_MESSAGES_PER_TICK * (10 * TICK_RATE) as usize;
    assert!(
        (most / 2..=most).contains(&answered),
        "{answered}: commands that do not fit into the queue are lost"
    );
}
