//! The application of every board: its parts, its main loop and its log.

use core::fmt;
use core::iter::from_fn;
use core::mem::MaybeUninit;

use defmt::Display2Format;
use double_pendulum::Parameters;
use double_pendulum::plan::{Plan, PlanError, Stepping};
use embedded_io::{Error, ErrorKind, Write};

use super::cortex_m::clock::{ticks, wait_after};
use super::cortex_m::retained;
use super::cortex_m::watchdog::Watchdog;
use super::serial;
use crate::app::{App, Buttons, Event, Instruments, Journal, MOST_RESTARTS, PlannerEvent, Record};
use crate::config::{HALF_PIXEL, Processor};
use crate::display::{Display, Found};
use crate::graphics::Canvas;
use crate::motion::Settings;
use crate::protocol::{Cause, Field, Restarted};
use crate::scenes::SceneName;

pub struct Board<Panel, Link, Keys, Dog> {
    pub panel: Panel,
    pub link: Link,
    pub keys: Keys,
    pub instruments: Instruments,
    /// It runs, and must be fed from the start of the board on.
    pub watchdog: Dog,
    /// True if the board's own register indicates that the watchdog caused the last reset.
    pub reset_by_watchdog: bool,
}

pub trait Plays {
    type Panel;
    type Application;
}

impl<Panel: 'static, Link: 'static, Keys: 'static, Dog> Plays for Board<Panel, Link, Keys, Dog> {
    type Panel = Panel;
    type Application = App<'static, Panel, Link, Keys>;
}

/// Defines the program of a board, `main`, with the statics of its application:
/// `program!(pico::Pico on PROCESSOR);` names the module of the board, its type there, and the
/// class of its processor.
#[macro_export]
macro_rules! program {
    ($module:ident::$board:ident on $processor:ident) => {
        #[cortex_m_rt::entry]
        fn main() -> ! {
            static mut BUFFERS: $crate::graphics::FrameBuffers<
                { $crate::board::$module::FORMAT.words() },
                { $crate::board::$module::FORMAT.height as usize },
            > = $crate::graphics::FrameBuffers::BLANK;
            static mut PANEL: core::mem::MaybeUninit<
                <$crate::board::$module::$board as $crate::board::Plays>::Panel,
            > = core::mem::MaybeUninit::uninit();
            static mut APP: core::mem::MaybeUninit<
                <$crate::board::$module::$board as $crate::board::Plays>::Application,
            > = core::mem::MaybeUninit::uninit();
            let Some(board) = $crate::board::$module::take() else {
                panic!("the board was taken before")
            };
            board.play(
                APP,
                PANEL,
                BUFFERS.canvas($crate::board::$module::FORMAT),
                $crate::config::$processor,
            )
        }
    };
}

impl<Panel: Display<Error: fmt::Display> + 'static, Link: Write, Keys: Buttons, Dog: Watchdog>
    Board<Panel, Link, Keys, Dog>
{
    /// Runs the application for ever. The application and the driver of the panel are put at the
    /// given places.
    ///
    /// The scene is the first of the catalogue or, after a warm restart, the scene from before it,
    /// at most [`MOST_RESTARTS`] times in a row. The choices for the panel outlast every reset that
    /// leaves memory powered.
    pub fn play(
        self,
        place: &'static mut MaybeUninit<App<'static, Panel, Link, Keys>>,
        panel_place: &'static mut MaybeUninit<Panel>,
        canvas: Canvas<'static>,
        processor: Processor,
    ) -> ! {
        let Self {
            panel,
            link,
            keys,
            instruments,
            watchdog,
            reset_by_watchdog,
        } = self;
        defmt::info!(
            "boot: {=str}, {} Hz",
            instruments.identity.board.name(),
            instruments.identity.hertz
        );

        let panel = panel_place.write(panel);
        let app = application(place, canvas, panel, link, keys, processor);
        app.instruments = instruments;
        run(app, watchdog, reset_by_watchdog)
    }
}

/// Creates the application at its place, and starts the first scene.
// Its stack frame has 7,168 bytes (M3). Test `no_panic` permits it to panic, by its name.
#[inline(never)]
fn application<'a, Panel: Display, Link: Write, Keys: Buttons>(
    place: &'a mut MaybeUninit<App<'a, Panel, Link, Keys>>,
    canvas: Canvas<'a>,
    panel: &'a mut Panel,
    link: Link,
    keys: Keys,
    processor: Processor,
) -> &'a mut App<'a, Panel, Link, Keys> {
    let app = place.write(App::new(processor, canvas, panel, link, keys));
    if let Err(error) = app.player.play(SceneName::Page, Settings::default()) {
        defmt::error!("{}", error);
        panic!("the first settings describe no pendulum")
    }
    app
}

/// Between ticks it works for the host, plans, or sleeps.
#[inline(never)] // Unlike the start-up code, this must not panic (test `no_panic`).
fn run<Panel: Display<Error: fmt::Display>, Link: Write, Keys: Buttons>(
    app: &'static mut App<Panel, Link, Keys>,
    mut watchdog: impl Watchdog,
    reset_by_watchdog: bool,
) -> ! {
    let mut journal = resume(app, reset_by_watchdog);
    let mut now = ticks();
    app.count_from(now, 0);
    loop {
        let mut is_late = true;
        while is_late {
            let before = app.frames;
            is_late = !app.run_to(now, log);
            // A finished frame, drawn and sent, is recorded. Only such a frame feeds the watchdog.
            if app.frames != before {
                retained::keep(&journal.note(app.status(), app.player.report.step));
                watchdog.feed();
                app.keep_pace(log);
            }

            // Execute the commands of the host, also while the board is late.
            app.receive(from_fn(serial::received), log);
            app.note_lost(serial::lost(), log);
        }

        // Use the rest of the tick: for the job of the host, for planning, for the panel.
        while ticks() == now && app.work(log) {
            app.catch_up();
        }
        while ticks() == now && app.player.look_ahead() {
            app.catch_up();
        }
        while ticks() == now && app.catch_up() {}

        now = wait_after(now);
    }
}

/// The restart is counted before its scene is played, because the scene may end the board again.
fn resume<Panel: Display<Error: fmt::Display>, Link: Write, Keys: Buttons>(
    app: &mut App<Panel, Link, Keys>,
    reset_by_watchdog: bool,
) -> Journal {
    // The choices for the panel outlast resets.
    if let Some(chosen) = retained::chosen_panel() {
        app.choose_panel(chosen);
    }

    let restart = retained::recall(reset_by_watchdog);
    if let Some(restart) = &restart {
        retained::keep(&Record {
            end: Restarted {
                cause: None,
                ..restart.end
            },
            ..*restart
        });
        app.resume(restart, log);
    }

    let mut journal = Journal::new(restart.as_ref());
    retained::keep(&journal.note(app.status(), app.player.report.step));
    journal
}

fn log<Panel: fmt::Display, Link: Error>(event: Event<Panel, Link>) {
    match event {
        Event::Restarted(end, resumed) => {
            defmt::warn!(
                "restarted after a {} (in a row: {}): pc {:#010x}, lr {:#010x}",
                end.cause.map_or("reset", Cause::name),
                end.restarts,
                end.pc,
                end.lr
            );
            if !resumed {
                let reason = if end.restarts > MOST_RESTARTS {
                    "too many restarts in a row"
                } else {
                    "the scene cannot be played"
                };
                defmt::warn!("{}: the first scene starts instead", reason);
            }
        }
        Event::Started(
            scene,
            Settings {
                parameters,
                degrees: [a1, a2],
                velocities: [w1, w2],
            },
        ) => {
            let Parameters { m1, m2, l1, l2, g } = parameters;
            if scene.has_angles() {
                defmt::info!(
                    "{=str} starts at {} and {} degrees, {} and {} rad/s",
                    scene.name(),
                    a1,
                    a2,
                    w1,
                    w2
                );
            } else {
                defmt::info!("{=str} starts", scene.name());
            }
            defmt::info!(
                "masses {} and {} kg, rods {} and {} m, g {} m/s2",
                m1,
                m2,
                l1,
                l2,
                g
            );
        }
        Event::Refused(_, field) => {
            defmt::warn!(
                "the button has no effect: this {=str} is out of range",
                field.name()
            )
        }
        Event::Dropped { ticks, total } => {
            defmt::warn!("dropped {} frames, {} since reset", ticks, total)
        }
        Event::Slowed(speed) => {
            defmt::warn!("speed lowered to {}: this board cannot keep up", speed)
        }
        Event::Panel(error) => defmt::warn!("panel: {}", Display2Format(&error)),
        Event::PanelFound(Found {
            controller,
            by,
            status,
        }) => {
            if let Some(status) = status {
                defmt::info!(
                    "panel: {=str}, {=str}, status {=u8:#04x}",
                    controller.name(),
                    by.name(),
                    status
                );
            } else {
                defmt::info!("panel: {=str}, {=str}", controller.name(), by.name());
            }
        }
        Event::Damaged {
            messages,
            total,
            last,
        } => {
            defmt::warn!(
                "{} damaged messages, {} since reset, the last: {=str}",
                messages,
                total,
                last.name()
            );
        }
        Event::Lost { bytes, total } => {
            defmt::warn!("{} received bytes lost, {} since reset", bytes, total)
        }
        Event::Stopped => defmt::warn!(
            "stopped: this motion is too fast; \
             change the masses or the angle, or choose another scene"
        ),
        Event::StepTooLong(step) => {
            defmt::warn!(
                "the requested step may be too long for the fastest motion possible \
                 at this energy; {} s is safe",
                step
            )
        }
        Event::Motion(PlannerEvent::Found(Ok(plan))) => log_plan(&plan),
        Event::Motion(PlannerEvent::Found(Err(PlanError::NoMethod { limit, .. }))) => {
            defmt::info!(
                "plan: no method is fast enough for this chip (limited by {=str})",
                limit.name()
            );
        }
        Event::Motion(PlannerEvent::Shown(Stepping { method, steps }, cost)) => {
            defmt::info!(
                "shown: {=str}, steps per frame: {}, {} cycles per frame",
                method.name(),
                steps,
                cost as u32
            );
        }
        Event::Motion(PlannerEvent::Found(Err(PlanError::Refused(error)))) => {
            defmt::warn!(
                "no plan: this {=str} is out of range",
                Field::from(error).name()
            )
        }
        Event::Motion(PlannerEvent::Found(Err(_))) => defmt::warn!("no plan"),
        Event::Asked => defmt::info!("computing a motion on request"),
        Event::Link(error) => defmt::error!("serial link: {=str}", reason(error.kind())),
    }
}

fn log_plan(
    &Plan {
        method,
        steps,
        error,
        cost,
        horizon,
        limit,
        ..
    }: &Plan,
) {
    let method = method.name();
    let seconds = horizon as u32;
    let hundredths = (100.0 * horizon) as u32 % 100;
    if steps == 0 {
        defmt::info!(
            "plan: {=str}; leaves the exact motion at {}.{:02} s",
            method,
            seconds,
            hundredths
        );
        return;
    }
    let thousandths = libm::ceilf(1e3 * HALF_PIXEL * error) as u32;
    defmt::info!(
        "plan: {=str}, steps per frame: {}; error up to {}.{:03} pixels until {}.{:02} s \
         (limited by {=str}), {} cycles per frame",
        method,
        steps,
        thousandths / 1000,
        thousandths % 1000,
        seconds,
        hundredths,
        limit.name(),
        cost as u32,
    );
}

fn reason(kind: ErrorKind) -> &'static str {
    match kind {
        ErrorKind::TimedOut => "the host does not read; frames are dropped",
        _ => "a message could not be sent",
    }
}
