//! QEMU's control channel (QMP): the screenshot, the buttons, the end.

use std::io::{BufRead, BufReader};
use std::os::unix::net::UnixStream;
use std::path::Path;

use firmware::app::controls::Key;
use qapi::qmp::{InputEvent, InputKeyEvent, KeyValue, QKeyCode};
use qapi::{Command, ExecuteError, Qmp, Stream, qmp};

use super::{QemuError, Screenshot};

/// The key that QEMU knows a button of the board as; select is the left control key.
fn code(key: Key) -> QKeyCode {
    match key {
        Key::Up => QKeyCode::up,
        Key::Down => QKeyCode::down,
        Key::Left => QKeyCode::left,
        Key::Right => QKeyCode::right,
        Key::Select => QKeyCode::ctrl,
    }
}

/// The control channel of a running QEMU.
pub(super) struct Monitor {
    channel: Qmp<Stream<BufReader<UnixStream>, UnixStream>>,
}

impl Monitor {
    pub(super) fn new(socket: UnixStream) -> Result<Self, QemuError> {
        let broken = QemuError::connection("control channel");
        let reader = BufReader::new(socket.try_clone().map_err(&broken)?);
        let mut channel = Qmp::new(Stream::new(reader, socket));
        if channel.inner_mut().fill_buf().map_err(&broken)?.is_empty() {
            return Err(broken(std::io::ErrorKind::UnexpectedEof.into()));
        }
        channel.handshake().map_err(refused("the control channel"))?;
        Ok(Self { channel })
    }

    /// The panel's screenshot, by way of a file in `folder`.
    pub(super) fn screenshot(&mut self, folder: &Path) -> Result<Screenshot, QemuError> {
        let path = folder.join("panel.ppm");
        let filename = path.to_string_lossy().into_owned();
        self.execute(qmp::screendump { device: None, format: None, head: None, filename })?;
        let file = std::fs::read(path).map_err(QemuError::connection("screenshot"))?;
        Screenshot::from_ppm(&file)
    }

    /// Presses a button, or lets go of it. Lost while the machine stands still.
    pub(super) fn set_key(&mut self, key: Key, down: bool) -> Result<(), QemuError> {
        let key = KeyValue::qcode(code(key).into());
        let events = vec![InputEvent::key(InputKeyEvent { down, key }.into())];
        self.execute(qmp::input_send_event { device: None, head: None, events })
    }

    /// Gives QEMU's own console a line; what it says to that.
    pub(super) fn console(&mut self, line: &str) -> Result<String, QemuError> {
        let command = qmp::human_monitor_command { command_line: line.to_owned(), cpu_index: None };
        let said = self.channel.execute(&command).map_err(refused("human-monitor-command"))?;
        self.channel.events();
        Ok(said)
    }

    /// Lets the machine run.
    pub(super) fn resume(&mut self) -> Result<(), QemuError> {
        self.execute(qmp::cont {})
    }

    /// Asks QEMU to end.
    pub(super) fn quit(&mut self) -> Result<(), QemuError> {
        self.execute(qmp::quit {})
    }

    fn execute<C: Command>(&mut self, command: C) -> Result<(), QemuError> {
        let result = self.channel.execute(&command).map_err(refused(C::NAME));
        self.channel.events();
        result.map(drop)
    }
}

fn refused(command: &'static str) -> impl Fn(ExecuteError) -> QemuError {
    move |error| match error {
        ExecuteError::Qapi(error) => QemuError::Refused { command, reason: error.desc },
        ExecuteError::Io(source) => QemuError::Connection { name: "control channel", source },
    }
}
