//! What comes from children through pipes, read by whoever waits for it: no thread stands between.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;

use nix::fcntl::{FcntlArg, OFlag, fcntl};
use nix::poll::{PollFd, PollFlags, poll};
use nix::sys::stat::Mode;
use nix::unistd::mkfifo;

/// The longest wait for something to read, ms.
const TICK: u8 = 100;

/// The host's end of a pipe from a child, read without waiting.
#[derive(Debug)]
pub struct Stream {
    pipe: File,
    /// What has come, and nobody has taken away.
    pub bytes: Vec<u8>,
    /// Whether more may come.
    pub is_open: bool,
}

impl Stream {
    pub fn of(pipe: impl Into<OwnedFd>) -> io::Result<Self> {
        let pipe = File::from(pipe.into());
        fcntl(&pipe, FcntlArg::F_SETFL(OFlag::O_NONBLOCK))?;
        Ok(Self {
            pipe,
            bytes: Vec::new(),
            is_open: true,
        })
    }

    /// Takes all that is there; what is new.
    pub fn take_in(&mut self) -> &[u8] {
        let before = self.bytes.len();
        let read = self.pipe.read_to_end(&mut self.bytes);
        self.is_open = read.is_err_and(|error| error.kind() == ErrorKind::WouldBlock);
        &self.bytes[before..]
    }

    /// The next line that is complete, or the last.
    pub fn line(&mut self) -> Option<String> {
        let last = (!self.is_open && !self.bytes.is_empty()).then_some(self.bytes.len());
        let end = self
            .bytes
            .iter()
            .position(|byte| *byte == b'\n')
            .map(|place| place + 1)
            .or(last)?;
        let line: Vec<u8> = self.bytes.drain(..end).collect();
        Some(String::from_utf8_lossy(line.trim_ascii_end()).into_owned())
    }
}

/// Waits until something has come in one of the streams, or its end, or for a moment.
pub fn wait<'a>(streams: impl Iterator<Item = &'a Stream>) {
    let open = streams.filter(|stream| stream.is_open);
    let mut polled: Vec<_> = open
        .map(|stream| PollFd::new(stream.pipe.as_fd(), PollFlags::POLLIN))
        .collect();
    // A signal ends it early.
    let _ = poll(&mut polled, TICK);
}

/// A channel to QEMU: a pair of named pipes. They hold a second's worth of single bytes, where a socket holds a few frames, and not
/// every emulated board stands still by itself when its bytes are not taken.
#[derive(Debug)]
pub struct Channel {
    pub sender: File,
    pub stream: Stream,
}

impl Channel {
    /// For QEMU's `-chardev pipe` of this path: QEMU reads `path.in` and writes `path.out`.
    pub fn make(path: &Path) -> io::Result<Self> {
        let pipe = |end| {
            let path = path.with_extension(end);
            mkfifo(&path, Mode::S_IRUSR | Mode::S_IWUSR)?;
            // Open for both, it waits for nobody at the other end.
            File::options()
                .read(true)
                .write(true)
                .custom_flags(OFlag::O_NONBLOCK.bits())
                .open(path)
        };
        Ok(Self {
            sender: pipe("in")?,
            stream: Stream::of(pipe("out")?)?,
        })
    }
}
