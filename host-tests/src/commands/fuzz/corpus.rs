//! Where inputs are kept: a text file for each target, an outcome and an input a line, both in hexadecimal.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::io::{self, ErrorKind};
use std::path::PathBuf;
use std::{fs, iter};

use super::{Outcome, Target};
use crate::emulator::toolchain::workspace;

impl Target {
    /// Its corpus.
    pub fn file(&self) -> PathBuf {
        workspace().join("host-tests/corpus").join(self.name).with_extension("txt")
    }

    /// The inputs kept for it, each with what it comes to.
    pub fn corpus(&self) -> io::Result<Vec<(Outcome, Vec<u8>)>> {
        match fs::read_to_string(self.file()) {
            Ok(text) => text.lines().map(|line| entry(line).ok_or(ErrorKind::InvalidData.into())).collect(),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(Vec::new()),
            Err(error) => Err(error),
        }
    }

    /// Replaces the inputs kept.
    pub(super) fn keep(&self, corpus: &BTreeMap<Outcome, Vec<u8>>) -> io::Result<()> {
        let lines: String = corpus.iter().map(|(outcome, input)| line(*outcome, input)).collect();
        fs::create_dir_all(self.file().parent().unwrap_or(&self.file()))?;
        fs::write(self.file(), lines)
    }
}

fn line(outcome: Outcome, input: &[u8]) -> String {
    let mut line = format!("{outcome:x} ");
    for byte in input {
        // Writing into a string cannot fail.
        let _ = write!(line, "{byte:02x}");
    }
    line + "\n"
}

fn entry(line: &str) -> Option<(Outcome, Vec<u8>)> {
    let (outcome, hex) = line.split_once(' ')?;
    let bytes = iter::successors(Some(hex), |rest| rest.get(2..)).take_while(|rest| !rest.is_empty());
    let input = bytes.map(|rest| u8::from_str_radix(rest.get(..2)?, 16).ok()).collect::<Option<_>>()?;
    Some((Outcome::from_str_radix(outcome, 16).ok()?, input))
}
