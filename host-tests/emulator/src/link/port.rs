//! A real serial port, with or without a board at its other end. It reports problems and reconnects
//! when the board is back.

use std::fs;
use std::io::{ErrorKind, Read, Write};
use std::os::unix::fs::MetadataExt;
use std::thread::sleep;
use std::time::{Duration, Instant};

use firmware::config::BAUD;
use firmware::protocol::{Command, LinkError, MAX_WIRE, ToHost, VERSION, encode_command};
use nix::unistd::{Gid, Group};
use serialport::{SerialPort, SerialPortInfo};

use super::{AUTO, Device, Inbox, Restarts, choose};

/// The time to wait for bytes in one read. It is short because reads are frequent.
const WAIT: Duration = Duration::from_millis(1);
/// The time limit for the port to accept a message. The board takes it within a tick.
const ACCEPTANCE: Duration = Duration::from_millis(500);
/// The time between two attempts to open a port.
const RETRY: Duration = Duration::from_millis(250);
/// The time that `auto` waits for a port. A board that was just flashed enumerates within a second,
/// and its device node gets its group a little later.
const ARRIVAL: Duration = Duration::from_secs(3);
/// The time without a message after which a problem is reported. A board that plays sends 60
/// messages a second.
const PATIENCE: Duration = Duration::from_secs(2);
/// The largest number of bytes read in one call, because a foreign device may send without end.
const MOST_BYTES: usize = 1 << 16;
/// The request number of the question about restarts. The answer is recognised by its kind.
const QUESTION: u16 = u16::MAX - 1;
/// The speed that restarts a board in its boot loader, bits per second: the convention of Arduino's
/// boards. The Pico obeys when the port is closed at this speed.
pub const BAUD_OF_BOOT_LOADER: u32 = 1200;

/// A serial port that [`messages`](Port::messages) opens again when it is back: under its name or,
/// if it is a USB device, under a new one. Without calls of `messages` nothing is received, and a
/// port that has gone stays closed. Problems of a port that was once open are no errors but
/// [`notices`](Port::notices). Dropping it closes the port.
pub struct Port {
    /// The path of the port, which changes if a USB device returns under another name.
    pub name: String,
    /// The open port; `None` while it is gone.
    open: Option<Box<dyn SerialPort>>,
    /// The USB device at the port. By it, the device is found under another name.
    device: Option<Device>,
    /// The decoder of the received bytes, with the counts of the link since [`Port::open`], over
    /// all connections.
    pub inbox: Inbox,
    /// The restarts of the board.
    pub restarts: Restarts,
    /// Reports of problems, recoveries and restarts of the board, oldest first, one line each
    /// without a newline, reported once, such as 2 s without a message. The caller drains them;
    /// they are not limited.
    pub notices: Vec<String>,
    /// The time of the last intact message, of the opening of the port, or of the last attempt to
    /// open it.
    since: Instant,
    /// The number of bytes since the last intact message or the opening of the port.
    bytes: usize,
    /// True if the present silence has been reported.
    complained: bool,
}

impl Port {
    /// Opens the port of this name at [`BAUD`] (460,800) bits per second. Nothing is sent. Not
    /// checked: that a board is at its other end.
    ///
    /// `auto` means the only port over USB. If there is none yet, this waits up to 3 s until one
    /// has appeared and can be opened. A port that is there at the call and cannot be opened is an
    /// error at once. So are several ports, even if one of them is a board.
    ///
    /// The error is the reason in one line: the port is missing, in use, not accessible, no serial
    /// port or, with `auto`, ambiguous.
    pub fn open(name: &str) -> Result<Self, String> {
        // A port without a name may take a moment to appear.
        let (name, open) = if name == AUTO {
            let since = Instant::now();
            only_one(ports, open, || {
                let is_time_left = since.elapsed() < ARRIVAL;
                if is_time_left {
                    sleep(RETRY);
                }
                is_time_left
            })?
        } else {
            let open = open(name).map_err(|error| reason(name, &error))?;
            (name.to_owned(), open)
        };

        let mut port = Self {
            device: Device::at(&node(&name), &ports()),
            name,
            open: Some(open),
            inbox: Inbox::default(),
            restarts: Restarts::default(),
            notices: Vec::new(),
            since: Instant::now(),
            bytes: 0,
            complained: false,
        };
        port.inbox.join();
        Ok(port)
    }

    /// Returns the messages that have arrived since the last call, oldest first. It reads until no
    /// byte has arrived for a millisecond, or about 64 KiB have; the next call reads on. A port
    /// that has gone is opened again when it is back, with at most four attempts a second. The
    /// result is empty while the port is gone.
    ///
    /// It also asks the board for its last restart when [`Restarts`] requires it. That question has
    /// the request number 65534, and its answer is among the messages. It is sent as by
    /// [`Self::send`], which may wait.
    pub fn messages(&mut self) -> Vec<ToHost> {
        if self.open.is_none() {
            self.reopen();
        }
        let mut messages = Vec::new();

        // Each message can show a restart, and then causes a question to the board.
        for byte in self.read() {
            let restarts = self.inbox.counts.restarts;
            let Some(message) = self.inbox.take(byte) else {
                continue;
            };
            let recounted = self.inbox.counts.restarts > restarts;
            self.notices.extend(self.restarts.take(&message, recounted));
            if self.restarts.is_question_due() {
                self.send(QUESTION, Command::AskRestart);
            }
            messages.push(message);
        }
        self.note(&messages);
        messages
    }

    /// Sends a command as [`Self::send_bytes`] does; while the port is gone, it is dropped.
    /// `request` is the number that the answer will have; 65534 is used by [`Self::messages`].
    pub fn send(&mut self, request: u16, command: Command) {
        self.send_bytes(encode_command(request, command, &mut [0; MAX_WIRE]));
    }

    /// Sends bytes and waits until the system has taken them for the port. While the port is gone,
    /// they are dropped without a notice. If the system takes none for 0.5 s, the port counts as
    /// gone, which is a notice, and the rest is dropped. Not checked: that the bytes fit into the
    /// system's buffer, as a command does. The wait for more bytes has no limit if the port stops.
    pub fn send_bytes(&mut self, bytes: &[u8]) {
        let Some(port) = &mut self.open else { return };
        let sent = port
            .set_timeout(ACCEPTANCE)
            .map_err(std::io::Error::from)
            .and_then(|()| port.write_all(bytes));
        if let Err(error) = sent {
            self.gone(&error.to_string());
        }
    }

    /// Returns the bytes that have arrived, at most about 64 KiB.
    fn read(&mut self) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut buffer = [0; 4096];
        // The loop ends when no byte arrives in time, or the port is gone.
        while bytes.len() < MOST_BYTES
            && let Some(port) = &mut self.open
        {
            match port
                .set_timeout(WAIT)
                .map_err(std::io::Error::from)
                .and_then(|()| port.read(&mut buffer))
            {
                Ok(count @ 1..) => bytes.extend(&buffer[..count]),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() == ErrorKind::TimedOut => break,
                Ok(_) => self.gone("no more bytes"),
                Err(error) => self.gone(&error.to_string()),
            }
        }
        self.bytes += bytes.len();
        bytes
    }

    /// Notes that the port is gone, for this reason.
    fn gone(&mut self, why: &str) {
        self.open = None;
        self.since = Instant::now();
        if let Some(device) = &mut self.device {
            device.gone(&node(&self.name), ports());
        }
        self.notices.push(gone(&self.name, why));
    }

    /// Opens the port again if it is back, not more often than [`RETRY`] allows.
    fn reopen(&mut self) {
        if self.since.elapsed() < RETRY {
            return;
        }

        self.since = Instant::now();
        self.bytes = 0;
        self.complained = false;
        self.open = open(&self.name).ok();
        let mut notice = format!("{} is back", self.name);
        // A USB device may return under another name.
        if self.open.is_none()
            && let Some(device) = &self.device
            && let Some(name) = device.back(&ports())
        {
            self.open = open(name).ok();
            if self.open.is_some() {
                notice += &format!(" as {name}");
                self.name = name.to_owned();
            }
        }

        // A connection begins in the middle of a message.
        if self.open.is_some() {
            self.inbox.join();
            self.restarts.join();
            self.notices.push(notice);
        }
    }

    /// Reports a problem of the other end, or its recovery, by the messages or their absence.
    fn note(&mut self, messages: &[ToHost]) {
        // Every message ends a silence.
        if !messages.is_empty() {
            if self.complained {
                self.notices
                    .push(format!("{}: the board sends again", self.name));
            }
            self.since = Instant::now();
            self.bytes = 0;
            self.complained = false;
        } else if self.open.is_some() && !self.complained && self.since.elapsed() >= PATIENCE {
            self.complained = true;
            self.notices.push(self.silence());
        }
    }

    /// Returns the likely reason why no message arrives.
    fn silence(&self) -> String {
        let Self { name, bytes, .. } = self;
        match self.inbox.damage {
            _ if *bytes == 0 => {
                format!(
                    "{name}: no data; is the board powered, and (with an adapter) its TX wired to \
                     RX? A Pico behind a hub may need its cable pulled and plugged in again"
                )
            }
            Some(LinkError::Version(version)) => {
                format!(
                    "{name}: the board uses version {version} of the protocol, this program \
                     version {VERSION}; flash the board again"
                )
            }
            _ => format!(
                "{name}: {bytes} bytes received, but no message; is it another device, or another \
                 baud rate?"
            ),
        }
    }
}

/// Returns the notice of a port that has gone. Over USB, a board's restart looks like an unplugged
/// cable; the board reports the cause when it is back.
fn gone(name: &str, why: &str) -> String {
    format!("{name} is gone ({why}): the cable is unplugged, or the board restarts; waiting for it")
}

/// Opens a port at the speed of the link.
fn open(name: &str) -> serialport::Result<Box<dyn SerialPort>> {
    serialport::new(name, BAUD).timeout(WAIT).open()
}

/// Returns all serial ports; none if the system does not list them.
fn ports() -> Vec<SerialPortInfo> {
    serialport::available_ports().unwrap_or_default()
}

/// Returns the device node of a name, which may be a symbolic link made by udev.
fn node(name: &str) -> String {
    fs::canonicalize(name).map_or(name.to_owned(), |path| path.display().to_string())
}

/// Opens the only port over USB. While `waits` returns true, this waits for a port that does not
/// exist yet, and for the access rights of a new port.
fn only_one<P>(
    mut ports: impl FnMut() -> Vec<SerialPortInfo>,
    mut open: impl FnMut(&str) -> serialport::Result<P>,
    mut waits: impl FnMut() -> bool,
) -> Result<(String, P), String> {
    let mut has_waited = false;
    loop {
        // The only port, opened; or the reason why it is not open yet.
        let found = ports();
        let missing = match choose(&found) {
            Ok(name) => match open(&name) {
                Ok(port) => return Ok((name, port)),
                Err(error) if has_waited => reason(&name, &error),
                Err(error) => return Err(reason(&name, &error)),
            },
            // Several ports are ambiguous, and waiting does not help.
            Err(several) if found.iter().any(|port| super::usb(port).is_some()) => {
                return Err(several);
            }
            Err(none) => none,
        };
        has_waited = true;
        if !waits() {
            return Err(missing);
        }
    }
}

/// Makes a board at the port of this name restart in its boot loader, by opening the port at
/// [`BAUD_OF_BOOT_LOADER`] and closing it. Does not wait for the restart. `auto` is no name here.
/// Not checked: that a board is there and obeys.
///
/// # Errors
///
/// The port does not open, also because this process has it open; the reason in one line.
pub fn touch(name: &str) -> Result<(), String> {
    let mut port = serialport::new(name, BAUD_OF_BOOT_LOADER)
        .open()
        .map_err(|error| reason(name, &error))?;

    // A quick board is gone before it has answered. Closing the port has the same effect.
    let _ = port.write_data_terminal_ready(false);
    Ok(())
}

/// Returns the reason why a port does not open, in one line.
fn reason(name: &str, error: &serialport::Error) -> String {
    use serialport::ErrorKind::{Io, NoDevice};
    match error.kind() {
        NoDevice => format!(
            "{name}: another program uses this port; close it, or wait some seconds if it is \
             ModemManager"
        ),
        Io(ErrorKind::PermissionDenied) => denied(name, group(name).as_deref()),
        Io(ErrorKind::NotFound) => format!("{name}: there is no such port{}", present()),
        _ => format!("{name}: not usable as a serial port: {error}"),
    }
}

/// Returns the group whose members may open the port. Returns `None` if it is root's group or has
/// no access either.
fn group(name: &str) -> Option<String> {
    const GROUP_READS_AND_WRITES: u32 = 0o060;
    let node = fs::metadata(name).ok()?;
    let has_rights = node.mode() & GROUP_READS_AND_WRITES == GROUP_READS_AND_WRITES;
    if !has_rights || node.gid() == 0 {
        return None;
    }
    let group = Group::from_gid(Gid::from_raw(node.gid())).ok()??;
    Some(group.name)
}

/// Returns the reason that the right to open the port is missing, with the remedy.
fn denied(name: &str, group: Option<&str>) -> String {
    let remedy = match group {
        Some(group) => format!("as root: usermod -aG {group} USER, then log in again"),
        None => format!("only root has access; as root: chmod a+rw {name}"),
    };
    format!("{name}: permission denied; {remedy}")
}

/// Returns the names of all ports, as the end of an error.
fn present() -> String {
    let names: Vec<_> = ports().into_iter().map(|port| port.port_name).collect();
    if names.is_empty() {
        String::new()
    } else {
        format!("; there are: {}", names.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A denied port, one in use, a missing one and a file that is no port each have their own
    /// reason. The reason of a denied port includes the remedy.
    #[test]
    fn a_port_that_does_not_open_is_reported_with_the_remedy() {
        let refused = |kind| {
            reason(
                "/dev/ttyX",
                &serialport::Error::new(kind, "Not a typewriter"),
            )
        };
        let denied = refused(serialport::ErrorKind::Io(ErrorKind::PermissionDenied));
        assert!(
            denied.contains("permission denied") && denied.contains("chmod"),
            "{denied}"
        );
        assert!(refused(serialport::ErrorKind::NoDevice).contains("another program"));
        assert!(refused(serialport::ErrorKind::Unknown).contains("Not a typewriter"));

        // Names that are no serial port.
        let error = Port::open("/nowhere/tty").err();
        assert!(
            error.is_some_and(|reason| reason.starts_with("/nowhere/tty: there is no such port"))
        );
        assert!(
            Port::open("/dev/null")
                .err()
                .is_some_and(|reason| reason.contains("not usable as a serial port"))
        );
    }

    /// The remedy for a denied port names the group that may open it. A missing port and one of the
    /// group root have no such group.
    #[test]
    fn the_remedy_names_the_group_of_the_port() {
        assert!(denied("/dev/ttyX", Some("uucp")).contains("usermod -aG uucp USER"));

        // The group of a terminal may write to it but not read it, and root is the group of these
        // two.
        for name in ["/dev/null", "/nowhere/tty"] {
            assert_eq!(group(name), None, "{name}");
        }
    }

    fn usb_port(name: &str) -> SerialPortInfo {
        SerialPortInfo {
            port_name: name.to_owned(),
            port_type: serialport::SerialPortType::UsbPort(serialport::UsbPortInfo {
                vid: 0x16c0,
                pid: 0x27dd,
                serial_number: None,
                manufacturer: None,
                product: None,
            }),
        }
    }

    fn denial() -> serialport::Error {
        let kind = serialport::ErrorKind::Io(ErrorKind::PermissionDenied);
        serialport::Error::new(kind, "denied")
    }

    /// The port appears in the third search, and its access rights in the fifth.
    #[test]
    fn auto_waits_for_a_port_that_comes_and_for_its_rights() {
        let mut looks = 0;
        let mut tries = 0;
        let mut waits = 0;
        // No port is found in the first two searches, and the first two attempts to open it fail.
        let ports = || {
            looks += 1;
            Vec::from_iter((looks > 2).then(|| usb_port("/dev/ttyACM0")))
        };
        let open = |_: &str| {
            tries += 1;
            if tries > 2 { Ok(7) } else { Err(denial()) }
        };
        let found = only_one(ports, open, || {
            waits += 1;
            waits < 9
        });
        assert_eq!((found, waits), (Ok(("/dev/ttyACM0".to_owned(), 7)), 4));
    }

    /// Without a port `auto` waits until its time is over and then fails. It fails without waiting
    /// if the first port found is denied, or if two ports are there.
    #[test]
    fn auto_does_not_wait_for_ever_nor_after_a_final_error() {
        // No port appears until the time is over.
        let mut waits = 0;
        let nothing = only_one(
            Vec::new,
            |_| Ok(()),
            || {
                waits += 1;
                waits < 9
            },
        );
        assert!(nothing.is_err_and(|reason| reason.contains("no board and no serial adapter")));
        assert_eq!(waits, 9);

        // A port without rights at the first attempt, and an ambiguous choice, are final.
        for ports in [vec!["/dev/ttyACM0"], vec!["/dev/ttyACM0", "/dev/ttyACM1"]] {
            let list = || ports.iter().map(|name| usb_port(name)).collect();
            let refused = only_one(list, |_| Err::<(), _>(denial()), || panic!("it waits"));
            assert!(refused.is_err());
        }
    }

    /// The notice of a port that is gone names a restart of the board as a possible cause.
    #[test]
    fn a_port_that_ends_may_be_a_cable_or_a_restart() {
        let notice = gone("/dev/ttyACM0", "Broken pipe");
        assert!(notice.contains("or the board restarts"), "{notice}");
    }
}
