//! What the firmware and QEMU say: defmt's lines decoded with level, file and line, and plain text as it is.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{ChildStderr, ChildStdout};
use std::sync::mpsc::{self, Receiver, Sender};
use std::{fmt, thread};

use anyhow::Context;
use defmt_decoder::{DecodeError, Frame, Locations, StreamDecoder, Table};

/// What QEMU says at every start of this machine and no one needs to read.
const CHATTER: [&str; 2] = ["Timer with period zero, disabling", "has no peer"];

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogLine {
    /// defmt's level in lower case; `None` for plain text, in which QEMU speaks and the firmware reports a crash.
    pub level: Option<String>,
    pub text: String,
    /// The file name and line number of the statement, where they are known.
    pub place: Option<(String, u64)>,
}

impl LogLine {
    fn plain(text: &str) -> Self {
        Self { level: None, text: text.to_owned(), place: None }
    }

    /// Whether something went wrong: a defmt error, or a crash report or complaint in plain text.
    pub fn is_bad(&self) -> bool {
        self.level.as_deref().is_none_or(|level| level == "error")
    }
}

impl fmt::Display for LogLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(level) = &self.level {
            write!(f, "{level:5} ")?;
        }
        write!(f, "{}", self.text)?;
        match &self.place {
            Some((file, line)) => write!(f, " [{file}:{line}]"),
            None => Ok(()),
        }
    }
}

/// The lines as they come. Threads of its own always read, for QEMU stands still while no one does.
#[derive(Debug)]
pub struct Log {
    lines: Receiver<LogLine>,
}

impl Log {
    /// Of the firmware in the file `elf`: defmt on `stdout`, plain text on `stderr`.
    pub(super) fn new(elf: &Path, stdout: Option<ChildStdout>, stderr: Option<ChildStderr>) -> anyhow::Result<Self> {
        let table = table(elf)?;
        let (sender, lines) = mpsc::channel();
        if let Some(stdout) = stdout {
            let sender = sender.clone();
            thread::spawn(move || decode(LogDecoder::of(table), stdout, &sender));
        }
        if let Some(stderr) = stderr {
            thread::spawn(move || {
                for line in BufReader::new(stderr).lines().map_while(Result::ok) {
                    if !CHATTER.iter().any(|chatter| line.contains(chatter)) {
                        // No one listens any more; still read on, or QEMU would stand still.
                        let _ = sender.send(LogLine::plain(&line));
                    }
                }
            });
        }
        Ok(Self { lines })
    }

    pub fn arrived(&self) -> impl Iterator<Item = LogLine> {
        self.lines.try_iter()
    }

    /// The lines up to QEMU's end, waiting for it.
    pub fn rest(&self) -> impl Iterator<Item = LogLine> {
        self.lines.iter()
    }
}

fn decode(mut decoder: LogDecoder, mut stream: impl Read, lines: &Sender<LogLine>) {
    let mut buffer = [0; 4096];
    while let Ok(count @ 1..) = stream.read(&mut buffer) {
        for line in decoder.take(&buffer[..count]) {
            let _ = lines.send(line);
        }
    }
}

/// The format strings in a program and where each stands in the source, if it has a log; in memory for good.
fn table(elf: &Path) -> anyhow::Result<Option<(&'static Table, Locations)>> {
    let program = std::fs::read(elf).with_context(|| elf.display().to_string())?;
    let Some(table) = Table::parse(&program)? else { return Ok(None) };
    let locations = table.get_locations(&program)?;
    Ok(Some((Box::leak(Box::new(table)), locations)))
}

/// Makes lines of defmt's stream.
pub struct LogDecoder {
    /// None, once the stream is damaged for good, or if the program has no log.
    stream: Option<Box<dyn StreamDecoder>>,
    can_recover: bool,
    locations: Locations,
}

impl LogDecoder {
    /// Of the firmware in the file `elf`.
    pub fn new(elf: &Path) -> anyhow::Result<Self> {
        Ok(Self::of(table(elf)?))
    }

    fn of(table: Option<(&'static Table, Locations)>) -> Self {
        let can_recover = table.as_ref().is_some_and(|(table, _)| table.encoding().can_recover());
        let (stream, locations) = table.map(|(table, locations)| (table.new_stream_decoder(), locations)).unzip();
        Self { stream, can_recover, locations: locations.unwrap_or_default() }
    }

    /// Takes the next bytes; the lines that they complete.
    pub fn take(&mut self, bytes: &[u8]) -> Vec<LogLine> {
        let mut lines = Vec::new();
        let Some(stream) = &mut self.stream else { return lines };
        stream.received(bytes);
        loop {
            match stream.decode() {
                Ok(frame) => lines.push(line(&frame, &self.locations)),
                Err(DecodeError::UnexpectedEof) => return lines,
                Err(DecodeError::Malformed) => {
                    lines.push(LogLine::plain("a line of the log was damaged"));
                    if !self.can_recover {
                        self.stream = None;
                        return lines;
                    }
                }
            }
        }
    }
}

fn line(frame: &Frame, locations: &Locations) -> LogLine {
    let place = locations.get(&frame.index()).and_then(|location| {
        let file = location.file.file_name()?.to_string_lossy().into_owned();
        Some((file, location.line))
    });
    let level = frame.level().map_or_else(|| "print".to_owned(), |level| level.as_str().to_owned());
    LogLine { level: Some(level), text: frame.display_message().to_string(), place }
}
