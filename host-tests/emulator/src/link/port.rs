//! A real serial port, with or without a board at its other end.

use std::fs;
use std::io::{ErrorKind, Read, Write};
use std::os::unix::fs::MetadataExt;
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::bail;
use firmware::config::BAUD;
use firmware::protocol::{
    Answer, Command, LinkError, MAX_WIRE, Restarted, ToHost, VERSION, encode_command,
};
use nix::unistd::{Gid, Group};
use serialport::{SerialPort, SerialPortInfo};

use super::{AUTO, Inbox, choose, describe_restart};

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
/// The request number of the question about restarts.
const QUESTION: u16 = u16::MAX - 1;
/// The speed that restarts a board in its boot loader, bits per second: the convention of Arduino's
/// boards. The Pico obeys when the port is closed at this speed.
pub const BAUD_OF_BOOT_LOADER: u32 = 1200;

/// A serial port, opened once. Dropping it closes the port.
pub struct Port {
    /// The path of the port.
    pub name: String,
    port: Box<dyn SerialPort>,
    /// The decoder of the received bytes, with the counts of the link.
    pub inbox: Inbox,
    /// The last restart that the board has reported, which may be one before the connection.
    pub restarted: Option<Restarted>,
    /// Reports of problems, recoveries and restarts of the board, oldest first, one line each. The
    /// caller drains them.
    pub notices: Vec<String>,
    /// The reason why nothing can be sent.
    lost: Option<String>,
    /// True if the board has been asked for its last restart.
    has_asked: bool,
    /// The time of the last intact message, or of the opening.
    since: Instant,
    /// The number of bytes since the last intact message.
    bytes: usize,
    /// True if the present silence has been reported.
    complained: bool,
}

impl Port {
    /// Opens the port of this name. `auto` means the board with its own USB port, or else the only
    /// port over USB, for which this waits up to 3 s. The error is the reason in one line.
    pub fn open(name: &str) -> Result<Self, String> {
        let (name, port) = if name == AUTO {
            open_auto()?
        } else {
            (name.to_owned(), open(name)?)
        };
        let mut port = Self {
            name,
            port,
            inbox: Inbox::default(),
            restarted: None,
            notices: Vec::new(),
            lost: None,
            has_asked: false,
            since: Instant::now(),
            bytes: 0,
            complained: false,
        };
        port.inbox.join();
        Ok(port)
    }

    /// Returns the messages that have arrived since the last call, oldest first.
    ///
    /// After the first message it asks the board once for its last restart, because a restart ends
    /// a USB connection and with it the board's own message. It is an error if the port is gone.
    pub fn messages(&mut self) -> anyhow::Result<Vec<ToHost>> {
        let read = self.read();
        if let Some(why) = self.lost.take().or(read.as_ref().err().cloned()) {
            bail!(gone(&self.name, &why));
        }
        let inbox = &mut self.inbox;
        let bytes = read.unwrap_or_default();
        let messages: Vec<_> = bytes
            .into_iter()
            .filter_map(|byte| inbox.take(byte))
            .collect();
        for message in &messages {
            if let ToHost::Restarted(end) | ToHost::Answer(_, Answer::Restart(Some(end))) = message
            {
                self.restarted = Some(*end);
                self.notices.push(describe_restart(end));
            }
        }
        if !messages.is_empty() && !self.has_asked {
            self.has_asked = true;
            self.send(QUESTION, Command::AskRestart);
        }
        self.note(&messages);
        Ok(messages)
    }

    /// Sends a command as [`Self::send_bytes`] does. `request` is the number that the answer will
    /// have; 65534 is used by [`Self::messages`].
    pub fn send(&mut self, request: u16, command: Command) {
        self.send_bytes(encode_command(request, command, &mut [0; MAX_WIRE]));
    }

    /// Sends bytes and waits until the system has taken them for the port. If it takes none for
    /// 0.5 s, the port is gone, which the next call of [`Self::messages`] reports.
    pub fn send_bytes(&mut self, bytes: &[u8]) {
        let sent = self
            .port
            .set_timeout(ACCEPTANCE)
            .map_err(std::io::Error::from)
            .and_then(|()| self.port.write_all(bytes));
        if let Err(error) = sent {
            self.lost = Some(error.to_string());
        }
    }

    /// Returns the bytes that have arrived, at most about 64 KiB, or the reason why the port is
    /// gone.
    fn read(&mut self) -> Result<Vec<u8>, String> {
        self.port
            .set_timeout(WAIT)
            .map_err(|error| error.to_string())?;
        let mut bytes = Vec::new();
        let mut buffer = [0; 4096];
        while bytes.len() < MOST_BYTES {
            match self.port.read(&mut buffer) {
                Ok(0) => return Err("no more bytes".to_owned()),
                Ok(count) => bytes.extend(&buffer[..count]),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() == ErrorKind::TimedOut => break,
                Err(error) => return Err(error.to_string()),
            }
        }
        self.bytes += bytes.len();
        Ok(bytes)
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
        } else if !self.complained && self.since.elapsed() >= PATIENCE {
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

/// Returns the error of a port that has gone. Over USB, a board's restart looks like an unplugged
/// cable.
fn gone(name: &str, why: &str) -> String {
    format!("{name} is gone ({why}): the cable is unplugged, or the board has restarted")
}

/// Opens a port at the speed of the link. The error is the reason in one line.
fn open(name: &str) -> Result<Box<dyn SerialPort>, String> {
    let port = serialport::new(name, BAUD).timeout(WAIT).open();
    port.map_err(|error| reason(name, &error))
}

/// Opens the board's port, which may not exist yet or may not have its access rights yet.
fn open_auto() -> Result<(String, Box<dyn SerialPort>), String> {
    let since = Instant::now();
    loop {
        let found = choose(&ports()).and_then(|name| open(&name).map(|port| (name, port)));
        if found.is_ok() || since.elapsed() >= ARRIVAL {
            return found;
        }
        sleep(RETRY);
    }
}

/// Returns all serial ports; none if the system does not list them.
fn ports() -> Vec<SerialPortInfo> {
    serialport::available_ports().unwrap_or_default()
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
}
