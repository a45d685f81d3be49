//! The serial link: UART0's bytes to messages, and bytes the other way.

use std::fs::File;
use std::io::{ErrorKind, Read, Write};
use std::os::fd::AsFd;
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

use anyhow::anyhow;
use firmware::protocol::{Command, Frame, MAX_WIRE, ToHost, encode_command};
use nix::errno::Errno;
use nix::fcntl::OFlag;
use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
use nix::sys::stat::Mode;
use nix::unistd::mkfifo;

use crate::link::{Counts, Inbox};

/// The host's end of UART0. A thread of its own always reads, for QEMU stands still while no one does.
///
/// It is a pair of named pipes: they hold a second's worth of single bytes, where a socket holds a few frames, and not
/// every emulated board stands still by itself when its bytes are not taken.
#[derive(Debug)]
pub struct Serial {
    sender: File,
    messages: Receiver<ToHost>,
    reader: Arc<Mutex<Reader>>,
}

/// The pipes, made and ready to receive before QEMU runs.
pub(super) struct Pipes {
    receiver: File,
    sender: PathBuf,
}

impl Pipes {
    /// For QEMU's `-chardev pipe` of this path: QEMU reads `path.in` and writes `path.out`.
    pub(super) fn make(path: &Path) -> anyhow::Result<Self> {
        let (sender, receiver) = (path.with_extension("in"), path.with_extension("out"));
        for pipe in [&sender, &receiver] {
            mkfifo(pipe, Mode::S_IRUSR | Mode::S_IWUSR)?;
        }
        let receiver = File::options().read(true).custom_flags(OFlag::O_NONBLOCK.bits()).open(receiver)?;
        Ok(Self { receiver, sender })
    }
}

impl Serial {
    /// To be called once QEMU has opened its ends.
    pub(super) fn new(pipes: Pipes) -> anyhow::Result<Self> {
        let sender = File::options().write(true).open(pipes.sender)?;
        let watched = pipes.receiver.try_clone()?;
        let (channel, messages) = mpsc::channel();
        let reader = Reader { pipe: pipes.receiver, inbox: Inbox::default(), channel: Some(channel) };
        let reader = Arc::new(Mutex::new(reader));
        let shared = Arc::downgrade(&reader);
        thread::spawn(move || {
            let mut open = true;
            while open && is_readable(&watched) {
                open = shared.upgrade().is_some_and(|reader| lock(&reader).read());
            }
        });
        Ok(Self { sender, messages, reader })
    }

    /// The next message; `None` once QEMU has ended.
    pub(super) fn receive(&self) -> Option<ToHost> {
        self.messages.recv().ok()
    }

    /// The messages that QEMU has sent since the last call, without waiting.
    pub fn all_arrived(&self) -> impl Iterator<Item = ToHost> {
        lock(&self.reader).read();
        self.messages.try_iter()
    }

    pub fn frames_arrived(&self) -> impl Iterator<Item = Frame> {
        self.all_arrived().filter_map(ToHost::frame)
    }

    pub fn counts(&self) -> Counts {
        lock(&self.reader).inbox.counts()
    }

    /// Reads nothing until the result is dropped: what the board sends fills the pipe, and then its port.
    pub fn stop_reading(&self) -> impl Drop {
        lock(&self.reader)
    }

    pub fn send(&mut self, request: u16, command: Command) -> anyhow::Result<()> {
        self.send_bytes(encode_command(request, command, &mut [0; MAX_WIRE]))
    }

    pub fn send_bytes(&mut self, bytes: &[u8]) -> anyhow::Result<()> {
        // Not as it is: a broken pipe would be taken for a closed output, which is no failure.
        self.sender.write_all(bytes).map_err(|error| anyhow!("QEMU's serial port: {error}"))
    }
}

#[derive(Debug)]
struct Reader {
    pipe: File,
    inbox: Inbox,
    /// Gone once QEMU has ended, which ends the messages.
    channel: Option<Sender<ToHost>>,
}

impl Reader {
    /// Takes all that is there, without waiting; whether the connection is still open.
    fn read(&mut self) -> bool {
        let mut buffer = [0; 4096];
        loop {
            match self.pipe.read(&mut buffer) {
                Ok(count @ 1..) => {
                    for message in buffer[..count].iter().filter_map(|&byte| self.inbox.take(byte)) {
                        if let Some(channel) = &self.channel {
                            // Fails only while the machine is being dropped.
                            let _ = channel.send(message);
                        }
                    }
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => return true,
                Ok(_) | Err(_) => {
                    self.channel = None;
                    return false;
                }
            }
        }
    }
}

/// Waits until there is something to read, or the end of the connection.
fn is_readable(pipe: &File) -> bool {
    loop {
        match poll(&mut [PollFd::new(pipe.as_fd(), PollFlags::POLLIN)], PollTimeout::NONE) {
            Err(Errno::EINTR) => {}
            result => return result.is_ok(),
        }
    }
}

/// A panic elsewhere must not stop the reading, so a poisoned lock is as good as any.
fn lock(reader: &Mutex<Reader>) -> MutexGuard<'_, Reader> {
    reader.lock().unwrap_or_else(PoisonError::into_inner)
}
