//! A real serial port, with a board at its other end or not: it says what is the matter, and goes on when the board is back.

use std::io::{ErrorKind, Read, Write};
use std::time::{Duration, Instant};

use firmware::config::BAUD;
use firmware::protocol::{Cause, Command, LinkError, MAX_WIRE, ToHost, VERSION, encode_command};
use serialport::SerialPort;

use super::{AUTO, Inbox, choose};

/// How long bytes are waited for: they are looked for often enough.
const WAIT: Duration = Duration::from_millis(1);
/// How long the port may take to accept a message, which the board takes within a tick.
const ACCEPTANCE: Duration = Duration::from_millis(500);
const RETRY: Duration = Duration::from_millis(250);
/// A board that plays sends 60 messages a second: without one for so long, something is the matter.
const PATIENCE: Duration = Duration::from_secs(2);
/// Bytes looked at in one go at most; a foreign device may send without end.
const MOST_BYTES: usize = 1 << 16;

pub struct Port {
    pub name: String,
    open: Option<Box<dyn SerialPort>>,
    pub inbox: Inbox,
    /// What is the matter, or is well again: a line each, said once. To be drained.
    pub notices: Vec<String>,
    /// When an intact message came last, or the port was opened, or last tried.
    since: Instant,
    bytes: usize,
    complained: bool,
}

impl Port {
    /// Opens the port of this name, or the only one over USB; what is wrong in one line.
    pub fn open(name: &str) -> Result<Self, String> {
        let name = match name {
            AUTO => choose(&serialport::available_ports().unwrap_or_default())?,
            name => name.to_owned(),
        };
        let open = Some(open(&name).map_err(|error| reason(&name, &error))?);
        let (inbox, notices, since) = (Inbox::default(), Vec::new(), Instant::now());
        let mut port = Self {
            name,
            open,
            inbox,
            notices,
            since,
            bytes: 0,
            complained: false,
        };
        port.inbox.join();
        Ok(port)
    }

    /// The messages that have come since the last call. A port that is gone is opened again once it is back.
    pub fn messages(&mut self) -> Vec<ToHost> {
        if self.open.is_none() {
            self.reopen();
        }
        let restarts = self.inbox.counts.restarts;
        let bytes = self.read();
        let messages: Vec<_> = bytes
            .into_iter()
            .filter_map(|byte| self.inbox.take(byte))
            .collect();
        if self.inbox.counts.restarts > restarts {
            self.notices.push(restart(&messages));
        }
        self.note(&messages);
        messages
    }

    /// Sends a command; while the port is gone it goes nowhere.
    pub fn send(&mut self, request: u16, command: Command) {
        self.send_bytes(encode_command(request, command, &mut [0; MAX_WIRE]));
    }

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

    fn read(&mut self) -> Vec<u8> {
        let (mut bytes, mut buffer) = (Vec::new(), [0; 4096]);
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

    fn gone(&mut self, why: &str) {
        self.open = None;
        self.since = Instant::now();
        self.notices.push(format!(
            "{} is gone ({why}): is the cable out? Waiting for it",
            self.name
        ));
    }

    fn reopen(&mut self) {
        if self.since.elapsed() < RETRY {
            return;
        }
        (self.since, self.bytes, self.complained) = (Instant::now(), 0, false);
        self.open = open(&self.name).ok();
        if self.open.is_some() {
            self.inbox.join();
            self.notices.push(format!("{} is back", self.name));
        }
    }

    /// What the messages, or their absence, say of the other end.
    fn note(&mut self, messages: &[ToHost]) {
        if !messages.is_empty() {
            if self.complained {
                self.notices
                    .push(format!("{}: the board sends again", self.name));
            }
            (self.since, self.bytes, self.complained) = (Instant::now(), 0, false);
        } else if self.open.is_some() && !self.complained && self.since.elapsed() >= PATIENCE {
            self.complained = true;
            self.notices.push(self.silence());
        }
    }

    fn silence(&self) -> String {
        let Self { name, bytes, .. } = self;
        match self.inbox.damage {
            _ if *bytes == 0 => {
                format!(
                    "{name}: no data; is the board powered, and (with an adapter) its TX wired to RX?"
                )
            }
            Some(LinkError::Version(version)) => {
                format!(
                    "{name}: the board speaks version {version} of the protocol, this program {VERSION}; flash it anew"
                )
            }
            _ => format!(
                "{name}: {bytes} bytes and no message: another device, or its link at another speed"
            ),
        }
    }
}

/// What the board says of its restart, if it has not just been switched on.
fn restart(messages: &[ToHost]) -> String {
    let Some(end) = messages.iter().rev().copied().find_map(ToHost::restarted) else {
        return "the board has been switched on or reset".to_owned();
    };
    let cause = end.cause.map_or("reset", Cause::name);
    format!("the board has restarted after a {cause} in {end}")
}

fn open(name: &str) -> serialport::Result<Box<dyn SerialPort>> {
    serialport::new(name, BAUD).timeout(WAIT).open()
}

/// Why a port does not open, in one line.
fn reason(name: &str, error: &serialport::Error) -> String {
    use serialport::ErrorKind::{Io, NoDevice};
    match error.kind() {
        NoDevice => format!("{name}: another program has it open"),
        Io(ErrorKind::PermissionDenied) => {
            format!(
                "{name}: permission denied; as root: usermod -aG dialout USER, then log in again"
            )
        }
        Io(ErrorKind::NotFound) => format!("{name}: there is no such port{}", present()),
        _ => format!("{name}: it cannot be used as a serial port: {error}"),
    }
}

fn present() -> String {
    let ports = serialport::available_ports().unwrap_or_default();
    let names: Vec<_> = ports.into_iter().map(|port| port.port_name).collect();
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
    fn a_port_that_does_not_open_is_told_with_the_remedy() {
        let refused = |kind| {
            reason(
                "/dev/ttyX",
                &serialport::Error::new(kind, "Not a typewriter"),
            )
        };
        let told = refused(serialport::ErrorKind::Io(ErrorKind::PermissionDenied));
        assert!(
            told.contains("permission denied") && told.contains("dialout"),
            "{told}"
        );
        assert!(refused(serialport::ErrorKind::NoDevice).contains("another program"));
        assert!(refused(serialport::ErrorKind::Unknown).contains("Not a typewriter"));
        let error = Port::open("/nowhere/tty").err();
        assert!(error.is_some_and(|told| told.starts_with("/nowhere/tty: there is no such port")));
        assert!(
            Port::open("/dev/null")
                .err()
                .is_some_and(|told| told.contains("cannot be used as a serial port"))
        );
    }
}
