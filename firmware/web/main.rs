//! The application as a board in a browser: a WebAssembly module that imports nothing.
//!
//! An instance of the module is a board. [`start`] switches it on, [`run_to`] is its clock, and
//! [`canvas`] is its panel. The module is also the host at the other end of the link: it encodes
//! each command as for any board, and decodes the board's messages. For the page, commands and
//! messages are JSON in the bytes at [`text`].
#![no_std]
#![no_main]

use double_pendulum::State;
use firmware::app::{App, NoButtons};
use firmware::config::{CORTEX_M3, PROCESSORS};
use firmware::display::NoDisplay;
use firmware::graphics::{Format, FrameBuffers, PanelName, View};
use firmware::protocol::{
    Answer, Command, Decoder, Frame, MAX_WIRE, Status, ToHost, encode_command, read,
};
use firmware::scenes::SceneName;
use heapless::Vec;
use serde::Serialize;

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    core::arch::wasm32::unreachable()
}

/// The largest format of a panel.
const LARGEST: Format = PanelName::Lcd2.format();

/// The board of this instance; `None` before [`start`].
static mut BOARD: Option<Board> = None;

/// The application, with room for the bytes that it sends in one call.
type Application = App<'static, NoDisplay, Vec<u8, 1024>, NoButtons>;

/// The application with the host's end of its link.
struct Board {
    app: Application,
    decoder: Decoder,
    readings: Readings,
    /// A command of the page, or the readings for it. Both fit.
    text: [u8; 2048],
}

/// The last messages of the board, which the page shows.
#[derive(Default, Serialize)]
struct Readings {
    frame: Frame,
    status: Option<Status>,
    /// The name of the field that is wrong in the command of the last call; `None` if none is.
    refused: Option<&'static str>,
    /// The pivot and both bobs of the first pendulum on the canvas, pixels; `None` without one.
    joints: Option<[(f32, f32); 3]>,
}

impl Readings {
    /// Returns the joints of the last frame, with the parameters of the last status.
    fn joints(&self, format: Format) -> Option<[(f32, f32); 3]> {
        let place = self.frame.scene.place(format)?;
        let State { a1, a2, .. } = self.frame.report.state;
        let directions = [a1, a2].map(|angle| [libm::sinf(angle), libm::cosf(angle)]);
        let view = View::new(&self.status?.settings.parameters, place, directions);
        let [bob1, bob2] = view.bobs(directions);
        Some([place.pivot, bob1, bob2])
    }
}

/// Calls `act` with the board and returns its result; the default if the board has not started.
fn with<T: Default>(act: impl FnOnce(&mut Board) -> T) -> T {
    let board = &raw mut BOARD;
    // SAFETY: there is one thread, and `act` does not call this, so this is the only reference.
    let board = unsafe { &mut *board };
    board.as_mut().map_or_else(T::default, act)
}

/// Passes a command to the application, in the bytes of the link.
fn pass(app: &mut Application, command: Command) {
    let mut wire = [0; MAX_WIRE];
    let bytes = encode_command(0, command, &mut wire).iter().copied();
    app.receive(bytes, |_| ());
}

/// Lets the application act, requests its status, and reads its messages. Returns the number of
/// bytes of the readings.
fn run(act: impl FnOnce(&mut Application)) -> usize {
    with(|board| {
        board.app.link.clear();
        act(&mut board.app);
        pass(&mut board.app, Command::Ask);

        // The host's end of the link.
        board.readings.refused = None;
        for &byte in &board.app.link {
            let message = board.decoder.push(byte).and_then(Result::ok);
            match message.and_then(read) {
                Some(ToHost::Frame(frame)) => board.readings.frame = frame,
                Some(ToHost::Answer(_, Answer::Status(status))) => {
                    board.readings.status = Some(status);
                }
                Some(ToHost::Answer(_, Answer::Refused(field))) => {
                    board.readings.refused = Some(field.name());
                }
                _ => {}
            }
        }
        board.readings.joints = board.readings.joints(board.app.player.canvas.format);
        serde_json_core::to_slice(&board.readings, &mut board.text).unwrap_or_default()
    })
}

/// Defines functions that the page calls.
macro_rules! exports {
    ($($(#[$doc:meta])* $name:ident($($argument:ident: $type:ty),*) => $body:expr;)*) => {$(
        $(#[$doc])*
        // SAFETY: no other function has this name.
        #[unsafe(no_mangle)]
        extern "C" fn $name($($argument: $type),*) -> usize {
            $body
        }
    )*};
}

exports! {
    /// Switches the board on, with a processor of this class, an index of [`PROCESSORS`], and a
    /// panel, an index of [`PanelName::ALL`]; any other number is the first one. The scene `page` starts at tick 0; the first frame is drawn by
    /// [`run_to`]. Returns the length of the readings ([`text`]). Later calls do nothing and
    /// return 0.
    start(processor: usize, panel: usize) => if with(|_| true) { 0 } else {
        static mut BUFFERS: FrameBuffers<{ LARGEST.words() }, { LARGEST.height as usize }> =
            FrameBuffers::BLANK;
        static mut NO_PANEL: NoDisplay = NoDisplay;
        let format = PanelName::ALL.get(panel).copied().unwrap_or_default().format();
        let processor = PROCESSORS.get(processor).copied().unwrap_or(CORTEX_M3);
        let parts = (&raw mut BUFFERS, &raw mut NO_PANEL, &raw mut BOARD);
        // SAFETY: only the first call reaches this, so these are the only references.
        let (buffers, panel, board) = unsafe { (&mut *parts.0, &mut *parts.1, &mut *parts.2) };
        *board = Some(Board {
            app: App::new(processor, buffers.canvas(format), panel, Vec::new(), NoButtons),
            decoder: Decoder::default(),
            readings: Readings::default(),
            text: [0; 2048],
        });
        run(|app| pass(app, Command::Choose(SceneName::Page)))
    };
    /// Runs the board to this tick of 1/60 s since the start, at most 15 ticks of the scene at once,
    /// and draws a frame. The ticks that are left are run by the next call, also if its tick is the same; if
    /// none is left, no frame is drawn. The tick wraps at 2^32. It must not be less than that of
    /// the call before: that counts as a wrap. Returns the length of the
    /// readings ([`text`]), 0 if the board has not started.
    run_to(tick: u32) => run(|app| _ = app.run_to(tick, |_| ()));
    /// Sends the [`Command`] in the first `length` bytes at [`text`], as JSON, and replaces it by
    /// the readings. Returns their length, also for a command that the board refuses: then the
    /// readings name the field that is wrong. Returns 0, and sends nothing, if the bytes are no
    /// command or the board has not started. The samples of a [`Command::Simulate`] are never
    /// computed.
    command(length: usize) => {
        let command = with(|board| serde_json_core::from_slice(board.text.get(..length)?).ok());
        command.map_or(0, |(command, _)| run(|app| pass(app, command)))
    };

    /// Returns the address of 2,048 bytes for a command, which stays the same. The functions above
    /// write the [`Readings`] there, as JSON, and return their length, bytes. Returns 0 if the
    /// board has not started.
    text() => with(|board| board.text.as_ptr() as usize);
    /// Returns the address of the ink, row by row from the top: a byte for two pixels, the left one
    /// high. It stays the same. Returns 0 if the board has not started.
    ink() => with(|board| board.app.player.canvas.row(0)[0].as_ptr() as usize);
    /// Returns the address of the foreground, as [`ink`] does.
    foreground() => with(|board| board.app.player.canvas.row(0)[1].as_ptr() as usize);
    /// Returns the address of the 256 colours of a pixel in the present scene, as
    /// [`Palette::colours`](firmware::graphics::Palette::colours) has them. Returns 0 if the board
    /// has not started.
    colours() => with(|board| board.app.player.canvas.palette.colours().as_ptr() as usize);
    /// Returns the address of the bytes that the board has sent in the last call of [`start`],
    /// [`run_to`] or [`command`] that did not return 0: its messages, the status at the end. A
    /// message that would exceed 1,024 bytes in all is lost. Returns 0 if the board has not
    /// started.
    sent() => with(|board| board.app.link.as_ptr() as usize);
    /// Returns the number of the bytes at [`sent`]; 0 if the board has not started.
    sent_length() => with(|board| board.app.link.len());
}
