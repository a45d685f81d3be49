//! The application as a board in a browser: a WebAssembly module that imports nothing.
//!
//! An instance of the module is a board. [`start`] switches it on, [`run_to`] is its clock, and
//! [`canvas`] is its panel. The module is also the host at the other end of the link: it encodes
//! each command as for any board, and decodes the numbers of the page from the board's messages.
#![no_std]
#![no_main]

use core::cell::UnsafeCell;

use double_pendulum::{Method, Parameters};
use firmware::app::{App, NoButtons};
use firmware::config::{CORTEX_M3, PROCESSORS};
use firmware::display::NoDisplay;
use firmware::graphics::FrameBuffers;
use firmware::motion::Settings;
use firmware::protocol::{
    Answer, Command, Decoder, Field, MAX_WIRE, PlayState, ToHost, encode_command, read,
};
use firmware::scenes::SceneName;
use heapless::Vec;

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    core::arch::wasm32::unreachable()
}

/// A value that the only thread of an instance uses.
struct Single<T>(UnsafeCell<T>);

// SAFETY: an instance has one thread.
unsafe impl<T> Sync for Single<T> {}

static PARTS: Single<(FrameBuffers, NoDisplay)> =
    Single(UnsafeCell::new((FrameBuffers::BLANK, NoDisplay)));
static BOARD: Single<Option<Board>> = Single(UnsafeCell::new(None));

/// The application, with room for the bytes that it sends in one call.
type Application = App<'static, NoDisplay, Vec<u8, 1024>, NoButtons>;

/// The application with the host's end of its link.
struct Board {
    app: Application,
    decoder: Decoder,
    readings: Readings,
}

/// The numbers for the page, which reads them in this order. Choices are indices of their tables,
/// and an absent choice is NaN. All are 0 until the board has started.
#[repr(C)]
#[derive(Default)]
struct Readings {
    /// Of the last frame: the time (s), angle 1 and angle 2 (rad), the energy error (of the energy
    /// above rest), the horizon (s; 0 if unknown, infinity if always accurate), 1 if planning may
    /// raise it, the method ([`Method::ALL`]), its steps per frame (0 without a method).
    frame: [f64; 8],
    /// The scene ([`SceneName::ALL`]), its state ([`PlayState::ALL`]), the speed (1 is full speed),
    /// the requested method ([`Method::DRAWN`]; NaN if the plan chooses).
    status: [f64; 4],
    /// m1, m2 (kg), l1, l2 (m), g (m/s^2), the initial angles (degrees) and angular velocities
    /// (rad/s).
    settings: [f64; 9],
    /// The field that is wrong in the command of the last call ([`Field::ALL`]); NaN if none is, or
    /// if that call was no command.
    refused: f64,
}

impl Readings {
    /// Takes the numbers of a message.
    fn take(&mut self, message: &ToHost) {
        match message {
            ToHost::Frame(frame) => {
                let report = &frame.report;
                let stepping = report.stepping;
                self.frame = [
                    report.time,
                    report.state.a1.into(),
                    report.state.a2.into(),
                    report.energy_error.into(),
                    report.horizon.verified().into(),
                    u8::from(report.horizon.is_open()).into(),
                    index_of(stepping.map(|one| one.method), Method::ALL),
                    stepping.map_or(0, |one| one.steps).into(),
                ];
            }
            ToHost::Answer(_, Answer::Status(status)) => {
                self.status = [
                    index_of(Some(status.scene), SceneName::ALL),
                    index_of(Some(status.state), PlayState::ALL),
                    status.speed.into(),
                    index_of(status.method, Method::DRAWN),
                ];
                let Parameters { m1, m2, l1, l2, g } = status.settings.parameters;
                let [a1, a2] = status.settings.degrees;
                let [w1, w2] = status.settings.velocities;
                self.settings = [m1, m2, l1, l2, g, a1, a2, w1, w2].map(f64::from);
            }
            ToHost::Answer(_, Answer::Refused(field)) => {
                self.refused = index_of(Some(*field), Field::ALL);
            }
            ToHost::Answer(..) | ToHost::Restarted(_) => {}
        }
    }
}

/// Returns the index of a choice in the table of all; NaN for `None`.
fn index_of<T: PartialEq>(choice: Option<T>, all: &[T]) -> f64 {
    choice
        .and_then(|choice| all.iter().position(|one| *one == choice))
        .map_or(f64::NAN, |index| index as f64)
}

/// Passes a command to the application, in the bytes of the link.
fn pass(app: &mut Application, command: Command) {
    let mut wire = [0; MAX_WIRE];
    let bytes = encode_command(0, command, &mut wire).iter().copied();
    app.receive(bytes, |_| ());
}

/// Calls `act` with the board and returns its result; 0 if the board has not started.
fn with(act: impl FnOnce(&mut Board) -> usize) -> usize {
    // SAFETY: there is one thread, and `act` does not call this, so this is the only reference.
    let board = unsafe { &mut *BOARD.0.get() };
    board.as_mut().map_or(0, act)
}

/// Lets the application act, requests its settings, and reads the messages. Returns the number of
/// bytes that it has sent.
fn run(act: impl FnOnce(&mut Application)) -> usize {
    with(|board| {
        board.app.link.clear();
        board.readings.refused = f64::NAN;
        act(&mut board.app);
        pass(&mut board.app, Command::Ask);

        // The host's end of the link.
        for &byte in &board.app.link {
            let message = board.decoder.push(byte).and_then(Result::ok);
            if let Some(message) = message.and_then(read::<ToHost>) {
                board.readings.take(&message);
            }
        }
        board.app.link.len()
    })
}

/// Passes a command to the board. Returns as [`run`].
fn send(command: Command) -> usize {
    run(|app| pass(app, command))
}

/// Defines functions that the page calls.
macro_rules! exports {
    ($($(#[$doc:meta])* $name:ident($($argument:ident: $type:ty),*) => $body:expr;)*) => {$(
        $(#[$doc])*
        // SAFETY: no other function has this name.
        #[unsafe(no_mangle)]
        #[allow(clippy::too_many_arguments, reason = "WebAssembly passes numbers only")]
        extern "C" fn $name($($argument: $type),*) -> usize {
            $body
        }
    )*};
}

exports! {
    /// Switches the board on, with a processor of this class, an index of [`PROCESSORS`]; any other
    /// number is a Cortex-M3. Later calls do nothing and return 0.
    start(processor: usize) => if with(|_| 1) == 1 { 0 } else {
        let processor = PROCESSORS.get(processor).copied().unwrap_or(CORTEX_M3);
        // SAFETY: only the first call reaches this, so these are the only references.
        let ((buffers, panel), board) = unsafe { (&mut *PARTS.0.get(), &mut *BOARD.0.get()) };
        *board = Some(Board {
            app: App::new(processor, buffers, panel, Vec::new(), NoButtons),
            decoder: Decoder::default(),
            readings: Readings::default(),
        });
        send(Command::Choose(SceneName::Page))
    };
    /// Returns the address of the canvas, 64 rows of 128 pixels from the top: two greys of 0 to 15
    /// in a byte, the left one high. Returns 0 if the board has not started.
    canvas() => with(|board| board.app.canvas.rows.as_ptr() as usize);
    /// Returns the address of the [`Readings`]; 0 if the board has not started.
    readings() => with(|board| &raw const board.readings as usize);
    /// Returns the address of the bytes that the last call has sent. Their number is the result of
    /// the functions below, and of [`start`]: the messages to the host, the status at the end.
    /// Bytes beyond 1,024 are lost.
    sent() => with(|board| board.app.link.as_ptr() as usize);

    /// Runs the board to this tick of 1/60 s since the start, at most 15 ticks at once, and draws a
    /// frame. The ticks that are left are run by the next call. The tick must not be less than that
    /// of the call before; if it is the same, nothing is done.
    run_to(tick: u32) => run(|app| _ = app.run_to(tick, |_| ()));

    // The buttons. They have the effects of the commands.
    heavier() => send(Command::Heavier);
    lighter() => send(Command::Lighter);
    turn_left() => send(Command::TurnLeft);
    turn_right() => send(Command::TurnRight);
    restart() => send(Command::Restart);
    next_scene() => send(Command::NextScene);
    previous_scene() => send(Command::PreviousScene);
    toggle_pause() => send(Command::TogglePause);
    /// Pauses the scene, or lets it continue if `paused` is 0.
    pause(paused: u32) => send(Command::Pause(paused != 0));
    /// Pauses the scene after one more tick.
    step() => send(Command::Step(1));
    /// Starts a scene of [`SceneName::ALL`] with its own settings; any other number is the first.
    choose(scene: usize) => send(Command::Choose(scene_at(scene)));
    /// Requests a method of [`Method::DRAWN`]; any other number leaves the choice to the plan.
    method(place: usize) => send(Command::Method(Method::DRAWN.get(place).copied()));
    /// Sets the speed, simulated time per real time.
    speed(value: f64) => send(Command::Set { field: Field::Speed, value });
    /// Starts a scene with these settings: kg, m, m/s^2, the angles in degrees, rad/s.
    play(scene: usize, m1: f32, m2: f32, l1: f32, l2: f32, g: f32, a1: f32, a2: f32, w1: f32,
        w2: f32) => send(Command::Play(scene_at(scene), Settings {
            parameters: Parameters { m1, m2, l1, l2, g },
            degrees: [a1, a2],
            velocities: [w1, w2],
        }));
}

/// Returns the scene with this index; for any other number the first.
fn scene_at(index: usize) -> SceneName {
    SceneName::ALL.get(index).copied().unwrap_or_default()
}
