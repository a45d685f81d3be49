//! The output of the firmware and of QEMU: decoded lines of defmt with level, file and line, and
//! plain text.

use std::fmt;
use std::path::Path;

use anyhow::Context;
use defmt_decoder::{DecodeError, Frame, Locations, StreamDecoder, Table};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogLine {
    /// `None` for plain text, which comes from QEMU or from a crash report.
    pub level: Option<String>,
    pub text: String,
    /// ` [file:line]` of the statement.
    pub place: String,
}

impl LogLine {
    pub(super) fn plain(text: &str) -> Self {
        Self {
            level: None,
            text: text.to_owned(),
            place: String::new(),
        }
    }

    pub fn is_bad(&self) -> bool {
        self.level.as_deref().is_none_or(|level| level == "error")
    }
}

impl fmt::Display for LogLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let level = self
            .level
            .as_ref()
            .map_or(String::new(), |level| format!("{level:5} "));
        write!(f, "{level}{}{}", self.text, self.place)
    }
}

pub struct LogDecoder {
    /// `None` if the program has no log, or once the stream is damaged beyond recovery.
    stream: Option<Box<dyn StreamDecoder>>,
    can_recover: bool,
    locations: Locations,
}

impl LogDecoder {
    pub fn new(elf: &Path) -> anyhow::Result<Self> {
        let program = std::fs::read(elf).with_context(|| elf.display().to_string())?;
        let Some(table) = Table::parse(&program)?.map(Box::new) else {
            return Ok(Self {
                stream: None,
                can_recover: false,
                locations: Locations::new(),
            });
        };
        let locations = table.get_locations(&program)?;
        let table: &'static Table = Box::leak(table);
        let can_recover = table.encoding().can_recover();
        Ok(Self {
            stream: Some(table.new_stream_decoder()),
            can_recover,
            locations,
        })
    }

    pub fn take(&mut self, bytes: &[u8]) -> Vec<LogLine> {
        let mut lines = Vec::new();
        let Some(stream) = &mut self.stream else {
            return lines;
        };

        // An incomplete line waits for more bytes. A damaged line is reported, and ends the
        // decoding if the stream has no marks to start again.
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
        Some(format!(
            " [{}:{}]",
            location.file.file_name()?.display(),
            location.line
        ))
    });
    let level = frame
        .level()
        .map_or_else(|| "print".to_owned(), |level| level.as_str().to_owned());
    LogLine {
        level: Some(level),
        text: frame.display_message().to_string(),
        place: place.unwrap_or_default(),
    }
}
