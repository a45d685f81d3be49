//! Pipes from and to child processes, read by the waiting thread itself; no other threads are used.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;

use nix::fcntl::{FcntlArg, OFlag, fcntl};
use nix::poll::{PollFd, PollFlags, poll};
use nix::sys::stat::Mode;
use nix::unistd::mkfifo;

const TICK: u8 = 100;

#[derive(Debug)]
pub struct Stream {
    pipe: File,
    pub bytes: Vec<u8>,
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

    pub fn take_in(&mut self) -> &[u8] {
        let before = self.bytes.len();
        let read = self.pipe.read_to_end(&mut self.bytes);
        self.is_open = read.is_err_and(|error| error.kind() == ErrorKind::WouldBlock);
        &self.bytes[before..]
    }

    pub fn line(&mut self) -> Option<String> {
        // The end of a stream also ends its last line.
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

pub fn wait<'a>(streams: impl Iterator<Item = &'a Stream>) {
    let open = streams.filter(|stream| stream.is_open);
    let mut polled: Vec<_> = open
        .map(|stream| PollFd::new(stream.pipe.as_fd(), PollFlags::POLLIN))
        .collect();

    // A signal ends the wait early, which does no harm.
    let _ = poll(&mut polled, TICK);
}

/// A channel to QEMU: a pair of named pipes.
///
/// Pipes are used because they hold a second of single bytes, while a socket holds only a few
/// frames. Not every emulated board waits while its bytes are not read.
#[derive(Debug)]
pub struct Channel {
    /// A write that does not fit is an error of kind `WouldBlock`.
    pub sender: File,
    /// The stream stays open after QEMU's end, so its `is_open` does not show the end.
    pub stream: Stream,
}

impl Channel {
    pub fn make(path: &Path) -> io::Result<Self> {
        let pipe = |end| {
            let path = path.with_extension(end);
            mkfifo(&path, Mode::S_IRUSR | Mode::S_IWUSR)?;

            // A pipe that is opened for both directions does not wait for its other end.
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
