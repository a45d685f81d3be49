//! The conversation with the emulator: a line of words each way, bytes as hexadecimal digits; see `host-tests/rp2040/main.js`.

use std::io::{self, BufRead, BufReader, Write};
use std::process::{ChildStdin, ChildStdout};

use anyhow::anyhow;

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Said {
    pub word: String,
    pub bytes: Vec<u8>,
}

#[derive(Debug)]
pub(super) struct Talk {
    pub input: ChildStdin,
    pub output: BufReader<ChildStdout>,
}

impl Talk {
    pub fn ask(&mut self, line: &str) -> anyhow::Result<Vec<Said>> {
        self.exchange(line).map_err(|error| anyhow!("the emulator of the Pico no longer answers: {error}"))
    }

    fn exchange(&mut self, line: &str) -> io::Result<Vec<Said>> {
        writeln!(self.input, "{line}")?;
        self.input.flush()?;
        let mut answers = Vec::new();
        loop {
            let mut answer = String::new();
            if self.output.read_line(&mut answer)? == 0 {
                return Err(io::ErrorKind::UnexpectedEof.into());
            }
            let (word, digits) = answer.trim_end().split_once(' ').unwrap_or((answer.trim_end(), ""));
            if word == "done" {
                return Ok(answers);
            }
            answers.push(Said { word: word.to_owned(), bytes: bytes(digits).ok_or(io::ErrorKind::InvalidData)? });
        }
    }
}

/// Bytes as the emulator takes them.
pub(super) fn digits(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn bytes(digits: &str) -> Option<Vec<u8>> {
    let byte = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok();
    digits.as_bytes().chunks(2).map(byte).collect()
}
