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

const WAIT: Duration = Duration::from_millis(1);
/// The board takes a message within a tick.
const ACCEPTANCE: Duration = Duration::from_millis(500);
const RETRY: Duration = Duration::from_millis(250);
/// A board that was just flashed enumerates within a second, and its device node gets its group a
/// little later.
const ARRIVAL: Duration = Duration::from_secs(3);
const PATIENCE: Duration = Duration::from_secs(2);
/// A foreign device may send without end.
const MOST_BYTES: usize = 1 << 16;
const QUESTION: u16 = u16::MAX - 1;
/// The speed that restarts a board in its boot loader: the convention of Arduino's boards. The Pico
/// obeys when the port is closed at this speed.
pub const BAUD_OF_BOOT_LOADER: u32 = 1200;

/// A serial port, opened once. Dropping it closes the port.
pub struct Port {
    pub name: String,
    port: Box<dyn SerialPort>,
    pub inbox: Inbox,
    /// The last restart, which may be a restart before the connection.
    pub restarted: Option<Restarted>,
    /// Problems, recoveries and restarts of the board, one line each. The caller drains them.
    pub notices: Vec<String>,
    lost: Option<String>,
    has_asked: bool,
    since: Instant,
    bytes: usize,
    complained: bool,
}

impl Port {
    /// Opens the port of this name. `auto` is the board with its own USB port, or else the only
    /// port over USB.
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

    /// Returns the messages since the last call. After the first one it asks the board once for its
    /// last restart, because a restart ends a USB connection and with it the board's own message.
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

    pub fn send(&mut self, request: u16, command: Command) {
        self.send_bytes(encode_command(request, command, &mut [0; MAX_WIRE]));
    }

    /// A port that takes no bytes is gone, which the next call of [`Self::messages`] reports.
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

    fn note(&mut self, messages: &[ToHost]) {
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

/// Over USB, a board's restart looks like an unplugged cable.
fn gone(name: &str, why: &str) -> String {
    format!("{name} is gone ({why}): the cable is unplugged, or the board has restarted")
}

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

fn ports() -> Vec<SerialPortInfo> {
    serialport::available_ports().unwrap_or_default()
}

/// Makes a board at this port restart in its boot loader. Does not wait for the restart.
pub fn touch(name: &str) -> Result<(), String> {
    let mut port = serialport::new(name, BAUD_OF_BOOT_LOADER)
        .open()
        .map_err(|error| reason(name, &error))?;

    // A quick board is gone before it has answered. Closing the port has the same effect.
    let _ = port.write_data_terminal_ready(false);
    Ok(())
}

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

fn denied(name: &str, group: Option<&str>) -> String {
    let remedy = match group {
        Some(group) => format!("as root: usermod -aG {group} USER, then log in again"),
        None => format!("only root has access; as root: chmod a+rw {name}"),
    };
    format!("{name}: permission denied; {remedy}")
}

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
