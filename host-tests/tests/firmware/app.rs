//! The application that runs on the boards, with a panel in memory, a byte vector as its link, and
//! scripted buttons.

use std::convert::Infallible;
use std::sync::atomic::{AtomicU32, Ordering};

use boards::host::Show;
use boards::link::Inbox;
use boards::qemu::Screenshot;
use double_pendulum::plan::Stepping;
use double_pendulum::{Method, Parameters, Pendulum, State, radians};
use embedded_io::{ErrorKind, ErrorType, Write};
use firmware::app::{Buttons, Event, MOST_RESTARTS, NoButtons, Pressed, Record};
use firmware::config::{DIM_TICKS, GRAVITY, MOST_TICKS_PER_FRAME, ROD, TICK_RATE};
use firmware::display::{Controller, Display, NoDisplay, PanelOptions, PanelReport};
use firmware::graphics::{Canvas, Format, Place, RodDirections, View};
use firmware::motion::Settings;
use firmware::protocol::{Answer, Cause, Command, Field, LinkError, Restarted, Status, ToHost};
use firmware::scenes::{Report, SceneName};

use crate::bench::{Plain, app, frames, messages, of, starting_with, wire};

/// The relative error of an energy: some roundings of `f64`. The rounded numbers are three times as
/// large as the energy above rest, and the difference is relative to that energy.
const ENERGY_SHOWN: f64 = 1e-14;

fn run(clock: impl IntoIterator<Item = u32>) -> Plain {
    let mut app = app();
    for now in clock {
        while !app.run_to(now, |_| ()) {}
    }
    app
}

#[test]
fn the_state_and_the_picture_after_n_ticks_are_the_same_at_any_frame_rate() {
    let steady = run(1..=600);
    for (name, other) in [
        ("every third", run((1..=200).map(|n| 3 * n))),
        (
            "uneven",
            run((0..600).filter(|n| n * n % 7 < 2).chain([600])),
        ),
        ("all at once", run([600])),
    ] {
        assert_eq!(other.player.report, steady.player.report, "{name}");
        assert_eq!(other.player.canvas, steady.player.canvas, "{name}");
    }
}

#[test]
fn every_frame_carries_the_kernels_state_bit_identically() {
    let app = run(1..=600);
    let frames = frames(&app.link);
    assert_eq!(frames.len(), 600);

    let parameters = Parameters::equal_rods(1.0, ROD, GRAVITY);
    let pendulum = Pendulum::new(&parameters).expect("good");
    let start_angle = radians(120.0);
    let start = State::at_rest(start_angle, start_angle);
    let start_energy = pendulum.energy(&start);
    let scale = start_energy - pendulum.least_energy();
    let stepping = Stepping {
        method: Method::Extrapolation10Fixed64,
        steps: 3,
    };
    let mut expected = Settings::default().run(0.0, stepping).expect("good");

    for (sequence, frame) in (0..).zip(frames) {
        expected.advance(1).expect("a finite motion");
        let Report {
            step,
            time,
            state,
            energy_error,
            ..
        } = frame.report;
        let bits = |state: State<f32>| <[f32; 4]>::from(state).map(f32::to_bits);
        assert_eq!(
            bits(state),
            bits(expected.rounded_state()),
            "frame {sequence}"
        );
        assert_eq!(
            (frame.sequence, frame.dropped, step),
            (sequence, 0, u64::from(sequence) + 1)
        );
        assert_eq!(time, f64::from(sequence + 1) / 60.0);
        assert_eq!(
            (frame.mass_ratio, frame.start_angle),
            (1.0, start_angle as f32)
        );

        // The state in the frame, rounded to f32, has an error of some 1e-7; this is the error of
        // the computed motion.
        let error = (pendulum.energy(&expected.state()) - start_energy) / scale;
        assert!(
            (f64::from(energy_error) - error).abs() <= ENERGY_SHOWN,
            "frame {sequence}: {energy_error} {error}"
        );
    }
}

#[test]
fn dropped_pictures_are_counted_and_no_tick_is_lost() {
    let mut app = app();
    let mut events = Vec::new();
    let late = MOST_TICKS_PER_FRAME * 2 + 1;
    assert!(!app.run_to(late, |event| events.push(event)));
    assert!(!app.run_to(late, |event| events.push(event)));
    assert!(app.run_to(late, |event| events.push(event)), "caught up");
    assert!(
        app.run_to(late, |event| events.push(event)),
        "nothing to do"
    );
    assert_eq!(events, [], "at most one line a second");
    assert!(app.run_to(late + 2, |event| events.push(event)));

    while !app.run_to(90, |event| events.push(event)) {}

    let frames = frames(&app.link);
    let shown: Vec<_> = frames
        .iter()
        .map(|frame| (frame.report.step, frame.dropped))
        .collect();
    let most = MOST_TICKS_PER_FRAME - 1;
    assert_eq!(
        shown,
        [
            (15, most),
            (30, 2 * most),
            (31, 2 * most),
            (33, 29),
            (48, 43),
            (63, 57),
            (78, 71),
            (90, 82)
        ]
    );
    assert_eq!(
        events,
        [Event::Dropped {
            ticks: 57,
            total: 57
        }]
    );
}

#[test]
fn a_speed_that_the_board_cannot_keep_is_lowered() {
    for (drops_every, expected) in [(1, &[2.0, 1.0][..]), (20, &[])] {
        let mut app = app();
        app.player
            .execute(Command::Set {
                field: Field::Speed,
                value: 4.0,
            })
            .expect("a possible speed");
        let mut slowed = Vec::new();
        let mut now = 0;
        while now < 10 * TICK_RATE {
            now += 1 + u32::from(now.is_multiple_of(drops_every));
            assert!(app.run_to(now, |_| ()));
            app.keep_pace(|event| slowed.push(event));
        }
        let expected: Vec<_> = expected.iter().map(|&speed| Event::Slowed(speed)).collect();
        assert_eq!(slowed, expected);
        assert_eq!(
            app.player.status().speed,
            if expected.is_empty() { 4.0 } else { 1.0 }
        );

        let before = app.player.report.step;
        app.run_to(now + 1000, |_| ());
        assert!(app.player.report.step - before <= MOST_TICKS_PER_FRAME.into());
    }
}

#[test]
fn losses_are_logged_once_a_second_and_sent_with_each_frame() {
    let mut app = app();
    let mut events = Vec::new();

    for tick in 1..=2 * TICK_RATE {
        app.run_to(tick, |_| ());
        app.note_lost(tick, |event| events.push((tick, event)));
        app.receive([1, 0], |event| events.push((tick, event)));
    }
    let logged = |tick| {
        let grown = TICK_RATE;
        let last = LinkError::Malformed;
        [
            Event::Lost {
                bytes: grown,
                total: tick,
            },
            Event::Damaged {
                messages: grown,
                total: tick,
                last,
            },
        ]
        .map(|event| (tick, event))
    };
    assert_eq!(events, [TICK_RATE, 2 * TICK_RATE].map(logged).concat());
    let counts = frames(&app.link)
        .iter()
        .map(|frame| frame.lost)
        .collect::<Vec<_>>();
    assert_eq!(counts, (0..2 * TICK_RATE).collect::<Vec<_>>());
}

/// The counts begin again at 0 after 828 days.
#[test]
fn counts_wrap_unnoticed() {
    const AHEAD: u32 = 60;
    let run = |begin: u32| {
        let mut app = app();
        let mut events = Vec::new();
        app.count_from(begin, begin);
        for tick in (1..=2 * AHEAD).filter(|tick| tick % 3 != 0) {
            while !app.run_to(begin.wrapping_add(tick), |event| events.push(event)) {}
        }
        (
            frames(&app.link),
            Screenshot::from(&app.player.canvas),
            events,
        )
    };

    let begin = 0_u32.wrapping_sub(AHEAD / 3);
    let plain = run(0);
    let wrapped = run(begin);
    assert_eq!((&plain.1, plain.0.len()), (&wrapped.1, wrapped.0.len()));
    for (mut plain, wrapped) in plain.0.into_iter().zip(wrapped.0) {
        plain.sequence = plain.sequence.wrapping_add(begin);
        plain.dropped = plain.dropped.wrapping_add(begin);
        assert_eq!(plain, wrapped);
    }
    assert_eq!(
        plain.2,
        [Event::Dropped {
            ticks: 20,
            total: 20
        }]
    );
    assert_eq!(
        wrapped.2,
        [Event::Dropped {
            ticks: 20,
            total: begin.wrapping_add(20)
        }]
    );
}

/// The scale of the error of a pendulum at rest is zero.
#[test]
fn hanging_at_rest_has_no_energy_error() {
    let mut app = starting_with(Settings::equal_rods(1.0, 0.0));
    app.run_to(10, |_| ());
    assert_eq!(
        frames(&app.link)
            .iter()
            .map(|frame| frame.report.energy_error)
            .collect::<Vec<_>>(),
        [0.0]
    );
}

#[derive(Default)]
struct Script(u32);

impl Buttons for Script {
    fn read(&mut self) -> Pressed {
        self.0 += 1;
        Pressed {
            up: (10..13).contains(&self.0),
            select: (50..53).contains(&self.0),
            ..Pressed::default()
        }
    }
}

/// The button up counts when it is pressed, select when it is released.
#[test]
fn buttons_restart_with_the_new_settings() {
    let mut app = of(NoDisplay, Vec::new(), Script::default());
    let mut started = Vec::new();
    for now in 1..=60 {
        app.run_to(now, |event| {
            if matches!(event, Event::Started(..)) {
                started.push((now, event));
            }
        });
    }
    let heavier = Settings::equal_rods(1.25, 120.0);
    assert_eq!(
        started,
        [11, 54].map(|now| (now, Event::Started(SceneName::Page, heavier)))
    );
    let frames = frames(&app.link);
    assert_eq!(frames[9].mass_ratio, 1.0);
    assert_eq!((frames[10].mass_ratio, frames[10].report.step), (1.25, 1));
    assert_eq!((frames[53].report.step, frames[53].sequence), (1, 53));
}

#[derive(Default)]
struct BrokenPanel(u32);

impl Display for BrokenPanel {
    type Error = &'static str;

    fn flush(&mut self, _: &Canvas) -> Result<(), &'static str> {
        self.0 += 1;
        if self.0 == 1 || (10..20).contains(&self.0) {
            Err("bus")
        } else {
            Ok(())
        }
    }
}

#[derive(Default)]
struct ReportingPanel(u8);

impl Display for ReportingPanel {
    type Error = Infallible;

    fn flush(&mut self, _: &Canvas) -> Result<(), Infallible> {
        self.0 += 1;
        Ok(())
    }

    fn report(&self) -> PanelReport {
        PanelReport {
            shown: self.0,
            ..PanelReport::default()
        }
    }
}

#[test]
fn status_contains_the_scene_and_the_panel_report() {
    let mut app = of(ReportingPanel::default(), Vec::new(), NoButtons);
    for now in 1..=7 {
        app.run_to(now, |_| ());
    }
    let status = app.status();
    assert_eq!((status.scene, status.panel.shown), (SceneName::Page, 7));
}

const DIM: u8 = 1;
const BRIGHT: u8 = 2;

#[derive(Default)]
struct BusyPanel {
    chosen: PanelOptions,
    waits: u8,
    shown: u8,
}

impl Display for BusyPanel {
    type Error = Infallible;

    fn flush(&mut self, _: &Canvas) -> Result<(), Infallible> {
        Ok(())
    }

    fn catch_up(&mut self, _: &Canvas) -> bool {
        let is_waiting = self.waits > 0;
        self.waits = self.waits.saturating_sub(1);
        is_waiting
    }

    fn report(&self) -> PanelReport {
        PanelReport {
            chosen: self.chosen,
            shown: self.shown,
            ..PanelReport::default()
        }
    }

    fn choose(&mut self, chosen: PanelOptions) -> bool {
        self.chosen = chosen;
        true
    }

    fn dim(&mut self, is_dim: bool) {
        self.shown = if is_dim { DIM } else { BRIGHT };
    }
}

#[test]
fn the_options_of_the_panel_are_chosen_by_commands() {
    let mut app = of(BusyPanel::default(), Vec::new(), NoButtons);
    let controller = Some(Controller::Sh1106);
    for command in [
        Command::Panel(controller),
        Command::Turn(true),
        Command::Dim(false),
    ] {
        app.receive(wire(5, command), |_| ());
        let answer = ToHost::Answer(5, Answer::Done);
        assert_eq!(messages(&app.link).last(), Some(&answer));
    }
    let chosen = PanelOptions {
        controller,
        is_turned: true,
        stays_bright: true,
    };
    assert_eq!(app.status().panel.chosen, chosen);
}

/// A question is not a key.
#[test]
fn the_panel_is_dimmed_after_ten_minutes_without_a_key() {
    let mut app = of(BusyPanel::default(), Vec::new(), NoButtons);
    app.receive(wire(1, Command::Pause(true)), |_| ());
    (1..DIM_TICKS).for_each(|now| _ = app.run_to(now, |_| ()));
    assert_eq!(app.status().panel.shown, BRIGHT);
    for (now, command, shown) in [
        (1, Command::Ask, DIM),
        (2, Command::Identify, DIM),
        (3, Command::Heavier, BRIGHT),
    ] {
        app.receive(wire(2, command), |_| ());
        app.run_to(DIM_TICKS + now, |_| ());
        assert_eq!(app.status().panel.shown, shown, "{command:?}");
    }
}

#[test]
fn a_frame_waits_for_the_bus_until_it_is_free() {
    let panel = BusyPanel {
        waits: 2,
        ..BusyPanel::default()
    };
    let mut app = of(panel, Vec::new(), NoButtons);
    assert_eq!([(); 3].map(|()| app.catch_up()), [true, true, false]);
}

#[test]
fn frames_report_the_cycles_of_the_stopwatch() {
    static READINGS: AtomicU32 = AtomicU32::new(0);
    let mut app = app();
    app.instruments.stopwatch = || READINGS.fetch_add(1, Ordering::Relaxed);
    for now in 1..=3 {
        app.run_to(now, |_| ());
    }
    let cycles: Vec<_> = frames(&app.link)
        .iter()
        .map(|frame| (frame.scene_cycles, frame.busy_cycles))
        .collect();
    assert_eq!(cycles, [(1, 0), (1, 2), (1, 2)]);
}

/// Each failed write has sent half of the bytes.
#[derive(Default)]
struct Faulty {
    bytes: Vec<u8>,
    writes: u32,
}

impl ErrorType for Faulty {
    type Error = ErrorKind;
}

impl Write for Faulty {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        self.writes += 1;
        let fails = (5..10).contains(&self.writes);
        let sent = if fails {
            &bytes[..bytes.len() / 2]
        } else {
            bytes
        };
        self.bytes.extend_from_slice(sent);
        if fails {
            Err(ErrorKind::TimedOut)
        } else {
            Ok(bytes.len())
        }
    }

    fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}

#[test]
fn a_failing_panel_or_link_is_reported_once_and_only_cut_frames_are_lost() {
    let mut app = of(BrokenPanel::default(), Faulty::default(), NoButtons);
    let mut events = Vec::new();
    for now in 1..=30 {
        app.run_to(now, |event| events.push((now, event)));
    }
    let link = (5, Event::Link(ErrorKind::TimedOut));
    assert_eq!(
        events,
        [(1, Event::Panel("bus")), link, (10, Event::Panel("bus"))]
    );

    // The writes 5 to 9 are frames 4 to 8.
    let mut inbox = Inbox::default();
    let frames = app
        .link
        .bytes
        .iter()
        .filter_map(|&byte| inbox.take(byte)?.frame());
    assert!(frames.map(|frame| frame.sequence).eq((0..4).chain(9..30)));
    assert_eq!(inbox.counts.damaged, 5);
}

fn directions(app: &Plain) -> RodDirections {
    let State { a1, a2, .. } = app.player.report.state;
    [a1, a2].map(|angle| angle.sin_cos().into())
}

fn view(app: &Plain) -> View {
    View::new(
        &app.player.settings.parameters,
        Place::whole(Format::OLED),
        directions(app),
    )
}

#[test]
fn bobs_are_drawn_where_the_state_puts_them() {
    let mut app = app();
    for now in 1..=1200 {
        app.run_to(now, |_| ());
        for (x, y) in view(&app).bobs(directions(&app)) {
            let grey = app.player.canvas.get(x as i32, y as i32);
            assert_eq!(grey, Some(15), "tick {now}: ({x}, {y})");
        }
    }
}

#[test]
fn the_motion_never_touches_the_labels() {
    let mut app = starting_with(Settings::equal_rods(0.0125, -179.0));

    // The labels at their longest.
    let boxes = [(0..40, 0..8), (0..35, 56..64), (93..128, 0..8)];
    for now in 1..=3600 {
        app.run_to(now, |_| ());
        let view = view(&app);
        let radii = view.radii.map(|radius| f32::from(radius) / 64.0 + 0.5);
        for ((x, y), radius) in view.bobs(directions(&app)).into_iter().zip(radii) {
            for (columns, rows) in &boxes {
                let dx = x - x.clamp(columns.start as f32, columns.end as f32);
                let dy = y - y.clamp(rows.start as f32, rows.end as f32);
                assert!(
                    dx.hypot(dy) > radius,
                    "tick {now}: ({x}, {y}) on {columns:?} {rows:?}"
                );
            }
        }
    }
}

#[test]
fn a_restart_resumes_the_scene_if_it_can_be_played() {
    let before = Show::new(SceneName::Butterfly, &Settings::equal_rods(2.5, 90.0)).expect("good");
    let played = before.player.status();
    let cause = Some(Cause::Hang);
    let scene = SceneName::Butterfly;
    let end = Restarted {
        cause,
        restarts: 1,
        pc: 2,
        lr: 3,
        cfsr: 0,
        scene,
        step: 5,
    };
    let given_up = Restarted {
        restarts: MOST_RESTARTS + 1,
        ..end
    };
    let massless = Status {
        settings: Settings::equal_rods(0.0, 90.0),
        ..played
    };
    let timeless = Status {
        speed: f32::NAN,
        ..played
    };

    for (played, end, resumed) in [
        (played, end, true),
        (massless, end, false),
        (timeless, end, false),
        (played, given_up, false),
    ] {
        let mut app = app();
        let first = app.player.status();
        let mut events = Vec::new();
        app.resume(&Record { played, end }, |event| events.push(event));
        assert_eq!(events, [Event::Restarted(end, resumed)]);
        assert_eq!(app.player.status(), if resumed { played } else { first });
        assert_eq!(messages(&app.link), [ToHost::Restarted(end)]);

        for _ in 0..2 {
            app.receive(wire(5, Command::AskRestart), |_| ());
            let answer = ToHost::Answer(5, Answer::Restart(Some(end)));
            assert_eq!(messages(&app.link).last(), Some(&answer));
        }
    }
}
