//! Commands over the serial link, answered by the very application that runs on the boards.

use std::f64::consts::PI;

use double_pendulum::Method;
use double_pendulum::plan::Way;
use fastrand::Rng;
use firmware::app::{AUTO, Event, Instruments, Key, News};
use firmware::config::{MOST_MEASURED_STEPS, MOST_MESSAGES_PER_TICK, PLANNED, RECEIVE_QUEUE, TICK_RATE};
use firmware::job::{OnBoards, Request, Run};
use firmware::protocol::{
    Ask, AskPlan, Choose, Done, Field, Frame, Identify, Identity, MAX_WIRE, Measure, Measured, Message, Pause, Planned,
    Press, Refused, Restart, Sample, Set, Status, Step, TO_CHIP, frame, method_code,
};
use firmware::scenes::SceneName;

use crate::bench::{Plain, all, app, messages, wire};

fn last<M: Message>(app: &Plain) -> M {
    let (kind, fields) = messages(&app.link).pop().expect("an answer").expect("undamaged");
    assert_eq!(kind, M::KIND);
    M::read(&fields).expect("all fields")
}

/// The answer to a command.
fn answer<A: Message>(app: &mut Plain, command: &impl Message) -> A {
    app.receive(wire(command), |_| ());
    last(app)
}

fn status(app: &mut Plain) -> Status {
    answer(app, &Ask { request: 0 })
}

fn set(field: Field, value: f64) -> Set {
    Set { request: 9, field: field.code(), value }
}

#[test]
fn every_parameter_is_set_in_si_units() {
    for (field, value, read, expected) in [
        (Field::M1, 2.0, (|s| s.parameters[0]) as fn(&Status) -> f32, 2.0),
        (Field::M2, 0.5, |s| s.parameters[1], 0.5),
        (Field::L1, 0.8, |s| s.parameters[2], 0.8),
        (Field::L2, 0.7, |s| s.parameters[3], 0.7),
        (Field::G, 1.62, |s| s.parameters[4], 1.62),
        (Field::A1, PI / 2.0, |s| s.degrees[0], 90.0),
        (Field::A2, -PI, |s| s.degrees[1], -180.0),
        (Field::Angle, 171_f64.to_radians(), |s| s.degrees[0], 171.0),
        (Field::W1, PI, |s| s.velocities[0], PI as f32),
        (Field::W2, -1.5, |s| s.velocities[1], -1.5),
        (Field::MassRatio, 2.75, |s| s.parameters[1], 2.75),
        (Field::Speed, 0.5, |s| s.speed, 0.5),
    ] {
        let mut app = app();
        assert_eq!(answer::<Done>(&mut app, &set(field, value)), Done { request: 9 }, "{field:?}");
        assert_eq!(read(&status(&mut app)), expected, "{field:?}");
    }
}

/// Taps that come all at once are all executed, in their order, as the board's own buttons are.
#[test]
fn no_tap_is_lost_however_quick() {
    let mut app = app();
    let before = *app.player.settings();
    let taps = [Key::Right, Key::Right, Key::Up, Key::Left, Key::Right, Key::Select, Key::Down, Key::Right, Key::Right];
    let mut bytes =
        taps.iter().flat_map(|key| wire(&Press { request: 1, key: key.code() })).collect::<Vec<_>>().into_iter();
    while !bytes.as_slice().is_empty() {
        app.receive(bytes.by_ref(), |_| ());
    }
    assert_eq!(*app.player.settings(), before.turned(1).turned(1).turned(1).turned(1));
    assert_eq!(all::<Done>(&app.link).len(), taps.len());
    let refused: Refused = answer(&mut app, &Press { request: 2, key: 0xEE });
    assert_eq!(refused, Refused { request: 2, field: Field::Key.code() });
}

/// A board of 1 MHz whose steps take 100 cycles, and that knows what it is.
#[test]
fn a_board_tells_what_it_is_and_how_long_steps_take() {
    let mut app = app();
    let identity = Identity { board: 1, hertz: 1_000_000, chip: [1, 2, 3, 4], ..Identity::default() };
    let timed = |motion: &mut OnBoards, steps, in_ram| {
        motion.advance(steps);
        if in_ram { 800 } else { 1600 }
    };
    app.instruments = Instruments { identity, timed, image: || b"123456789", ..Instruments::default() };
    // The check value of CRC-32/ISO-HDLC.
    let expected = Identity { request: 1, image: 0xCBF4_3926, image_bytes: 9, ..identity };
    assert_eq!(answer::<Identity>(&mut app, &Identify { request: 1 }), expected);

    let measure = |request, in_ram| Measure { request, steps: u32::MAX, in_ram };
    let refused: Refused = answer(&mut app, &measure(2, 0));
    assert_eq!(refused, Refused { request: 2, field: Field::Message.code() }, "no motion was asked for");
    let request = Request { samples: 1, ..Request::on_any_core(Method::Rk4F32) };
    app.receive(wire(&request.message(3)), |_| ());
    while app.work(|_| ()) {}
    for (request, in_ram, cycles) in [(4, 0, 1600), (5, 1, 800), (6, 0, 1600)] {
        let measured: Measured = answer(&mut app, &measure(request, in_ram));
        assert_eq!(measured, Measured { request, steps: MOST_MEASURED_STEPS, cycles });
    }
    assert!(!app.work(|_| ()), "and no sample follows");
    assert_eq!(all::<Sample>(&app.link).len(), 2);
}

#[test]
fn a_bad_command_is_answered_with_the_field_and_changes_nothing() {
    let mut app = app();
    app.run_to(30, |_| ());
    let before = (status(&mut app), app.player.report());
    for (message, field) in [
        (set(Field::M1, 0.0), Field::M1),
        (set(Field::M2, -1.0), Field::M2),
        (set(Field::M2, 1e300), Field::M2),
        (set(Field::L1, f64::NAN), Field::L1),
        (set(Field::L2, f64::INFINITY), Field::L2),
        (set(Field::L1, 1e-6), Field::L1), // too quick for the step
        (set(Field::G, -9.81), Field::G),
        (set(Field::A1, 181_f64.to_radians()), Field::A1),
        (set(Field::A2, 4.0), Field::A2),
        (set(Field::Angle, f64::NAN), Field::Angle),
        (set(Field::W1, f64::INFINITY), Field::W1),
        (set(Field::MassRatio, 0.0), Field::MassRatio),
        (set(Field::Speed, 0.0), Field::Speed),
        (set(Field::Speed, 0.004), Field::Speed),
        (set(Field::Speed, 4.006), Field::Speed),
        (set(Field::Speed, f64::NAN), Field::Speed),
        (Set { field: 0xEE, ..set(Field::M1, 1.0) }, Field::Field),
        (set(Field::Scene, 1.0), Field::Field),
    ] {
        assert_eq!(answer::<Refused>(&mut app, &message), Refused { request: 9, field: field.code() }, "{message:?}");
    }
    let refused: Refused = answer(&mut app, &Choose { request: 9, scene: 0xEE });
    assert_eq!(refused, Refused { request: 9, field: Field::Scene.code() });
    assert_eq!((status(&mut app), app.player.report()), before);
}

#[test]
fn an_intact_message_of_unknown_kind_is_answered_too() {
    let mut app = app();
    for (kind, fields, request) in
        [(0xEE, &[77, 1, 2, 3][..], 77), (Pause::KIND, &[77], 77), (Pause::KIND, &[77, 0, 0], 77), (0xEE, &[], 0)]
    {
        app.receive(frame(kind, fields, &mut [0; MAX_WIRE]).iter().copied(), |_| ());
        assert_eq!(last::<Refused>(&app), Refused { request, field: Field::Message.code() });
    }
}

/// Of a link that is looped back the board hears what it has sent.
#[test]
fn what_is_an_answer_itself_is_not_answered() {
    let mut app = app();
    for kind in 0..TO_CHIP {
        app.receive(frame(kind, &[7, 0, 1], &mut [0; MAX_WIRE]).iter().copied(), |event| panic!("{event:?}"));
    }
    assert!(app.link.is_empty());
}

/// Bytes without a zero end no message.
#[test]
fn an_endless_message_holds_up_nothing() {
    let mut taken = 0;
    app().receive(std::iter::repeat_n(1, 1_000_000).inspect(|_| taken += 1), |_| ());
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
            app.player.report()
        };
        app.receive(wire(&Choose { request: 1, scene: name.code() }), |_| ());
        assert_eq!(app.player.name(), name);
        let one = run(&mut app, 1);
        let ten = run(&mut app, 9);
        app.receive(wire(&Pause { request: 2, paused: 1 }), |_| ());
        assert_eq!(run(&mut app, 5), ten, "{}: paused", name.name());
        app.receive(wire(&Step { request: 3, ticks: 2 }), |_| ());
        let twelve = run(&mut app, 5);
        assert_eq!(twelve.step, 12 * one.step, "{}: two steps", name.name());
        app.receive(wire(&Restart { request: 4 }), |_| ());
        assert_eq!(run(&mut app, 3).step, 0, "{}: restarted, still paused", name.name());
        app.receive(wire(&Pause { request: 5, paused: 0 }), |_| ());
        assert_eq!(run(&mut app, 12), twelve, "{}: the same again", name.name());
        assert_eq!(all::<Done>(&app.link).iter().map(|done| done.request).collect::<Vec<_>>(), [1, 2, 3, 4, 5]);
        assert!(all::<Frame>(&app.link).iter().all(|frame| frame.scene == name.code()));
    }
}

/// What an answer says has been found: nothing to plan, nothing yet, the plan.
const NOTHING: u8 = 0;
const NOT_YET: u8 = 1;
const FOUND: u8 = 2;

#[test]
fn the_plan_is_found_in_some_tick_told_when_asked_and_followed() {
    let mut app = app();
    let asked = |app: &mut Plain| {
        let answer: Planned = answer(app, &AskPlan { request: 3 });
        assert_eq!(answer.request, 3);
        answer
    };
    let (mut news, mut tick) = (Vec::new(), 0);
    let mut run = |app: &mut Plain, news: &mut Vec<_>| {
        tick += 1;
        app.run_to(tick, |event| news.push(event));
    };
    assert_eq!(asked(&mut app).found, NOT_YET);
    while asked(&mut app).found == NOT_YET {
        run(&mut app, &mut news);
    }
    run(&mut app, &mut news);
    let [Event::Motion(News::Found(Ok(plan)))] = news[..] else { panic!("{news:?}") };
    let answer = asked(&mut app);
    assert_eq!((answer.found, answer.horizon), (FOUND, plan.horizon));
    assert!(answer.horizon > 19.0, "{answer:?}");
    let frame = app.player.frame();
    assert_eq!((frame.method, u32::from(frame.way_steps)), (answer.method, answer.steps));

    app.receive(wire(&set(Field::Angle, 20_f64.to_radians())), |_| ());
    assert_eq!(asked(&mut app), Planned { request: 3, found: NOT_YET, ..blank(&answer) });
    news.clear();
    while asked(&mut app).found == NOT_YET {
        run(&mut app, &mut news);
    }
    let calm = asked(&mut app);
    assert!(calm.found == FOUND && calm.horizon >= PLANNED, "{calm:?}");
    (0..TICK_RATE).for_each(|_| run(&mut app, &mut news));
    let way = Way { method: Method::Rk4Fixed32, steps: calm.steps };
    assert_eq!(news.last(), Some(&Event::Motion(News::Shown(way, calm.cycles))), "the cheaper way is taken");
    let status = status(&mut app);
    assert_eq!((status.method, status.way_steps, status.cycles), (calm.method, calm.steps, calm.cycles));
    assert!(
        status.cycles < answer.cycles && f64::from(status.horizon) > PLANNED && status.is_looking == 1,
        "{status:?}"
    );

    app.receive(wire(&Choose { request: 1, scene: SceneName::Frequencies.code() }), |_| ());
    assert!(!app.player.look_ahead());
    assert_eq!(asked(&mut app), Planned { request: 3, found: NOTHING, ..Planned::default() });
}

/// What an answer says before anything is found.
fn blank(answer: &Planned) -> Planned {
    let &Planned { height, duration, frame_budget, planning_budget, .. } = answer;
    Planned { height, duration, frame_budget, planning_budget, ..Planned::default() }
}

/// A method that is asked for by its code is taken, and stays; no other number is a method.
#[test]
fn a_way_can_be_forced() {
    let mut app = app();
    let mut go = |value: f64| {
        app.receive(wire(&set(Field::Method, value)), |_| ());
        status(&mut app).method
    };
    let fixed64 = method_code(Method::Extrapolation10Fixed64);
    for method in Method::DRAWN.iter().map(|&method| method_code(method)) {
        assert_eq!(go(method.into()), method);
        assert_eq!(go(AUTO), fixed64);
    }
    for wrong in [-1.0, 0.5, method_code(Method::Rk4F64).into(), 99.0, 256.0, f64::NAN] {
        assert_eq!(go(wrong), fixed64, "{wrong}");
    }
}

#[test]
fn speed_is_exact_in_the_long_run() {
    for (speed, ticks) in [(0.01, 6), (0.25, 150), (0.99, 594), (1.0, 600), (2.5, 1500), (4.0, 2400)] {
        let mut app = app();
        app.receive(wire(&set(Field::Speed, speed)), |_| ());
        (1..=600).for_each(|clock| assert!(app.run_to(clock, |_| ())));
        assert_eq!(app.player.report().time, f64::from(ticks) / f64::from(TICK_RATE), "{speed}");
    }
}

/// What arrives in one tick at most: 460,800 bits per second.
const BYTES_PER_TICK: usize = 768;

/// Feeds `bytes` as fast as the link can bring them, one frame per tick; checks that every tick has its intact frame
/// and that the log stays short. The application afterwards.
fn flood(mut bytes: impl Iterator<Item = u8>, seconds: u32) -> Plain {
    let mut app = app();
    let mut lines = 0;
    let mut waiting = std::collections::VecDeque::new();
    for clock in 1..=seconds * TICK_RATE {
        assert!(app.run_to(clock, |event| lines += u32::from(!matches!(event, Event::Motion(_)))));
        waiting.extend(bytes.by_ref().take(BYTES_PER_TICK));
        waiting.truncate(RECEIVE_QUEUE); // the queue of the boards
        let is_asked_for = |event: &Event<_, _>| matches!(event, Event::Started(..) | Event::Motion(_) | Event::Asked);
        let mut counted = |event: Event<_, _>| lines += u32::from(!is_asked_for(&event));
        app.receive(std::iter::from_fn(|| waiting.pop_front()), &mut counted);
    }
    let frames = all::<Frame>(&app.link);
    assert_eq!(frames.len(), (seconds * TICK_RATE) as usize);
    assert!((0..).zip(&frames).all(|(sequence, frame)| frame.sequence == sequence && frame.dropped == 0));
    assert!(lines <= seconds, "{lines} lines of log in {seconds} s");
    app
}

#[test]
fn noise_half_commands_and_floods_do_not_disturb_the_stream() {
    let mut rng = Rng::with_seed(5);
    let noise = flood(std::iter::repeat_with(move || rng.u8(..)), 60);
    assert_eq!(all::<Done>(&noise.link), [], "noise is executed");
    assert_eq!(noise.player.report(), flood(std::iter::empty(), 60).player.report(), "and changes nothing");

    flood(std::iter::repeat(0), 10);
    flood(std::iter::repeat(1), 10); // one line without an end
    let half = wire(&set(Field::Angle, 0.1));
    let half = half[..half.len() / 2].to_vec();
    let halves = flood(half.into_iter().chain([0]).collect::<Vec<_>>().into_iter().cycle(), 10);
    assert_eq!(all::<Done>(&halves.link), []);

    let restarts = flood(wire(&Restart { request: 6 }).into_iter().cycle(), 10);
    let (answered, most) = (all::<Done>(&restarts.link).len(), MOST_MESSAGES_PER_TICK * (10 * TICK_RATE) as usize);
    assert!((most / 2..=most).contains(&answered), "{answered}: of more than can wait, the rest is lost");
}

#[test]
fn a_command_after_noise_is_executed() {
    let mut app = app();
    let mut rng = Rng::with_seed(6);
    app.receive(std::iter::repeat_with(|| rng.u8(1..)).take(5000), |_| ());
    let done: Done = answer(&mut app, &Choose { request: 3, scene: SceneName::Figure7.code() });
    assert_eq!((done, app.player.name()), (Done { request: 3 }, SceneName::Figure7));
}
