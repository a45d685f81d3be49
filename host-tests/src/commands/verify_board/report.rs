//! The report: for people as Markdown, for programs as JSON.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;
use firmware::protocol::Identity;
use serde::Serialize;

use super::bits::Bits;
use super::cycles::Cycles;
use super::program::Program;
use super::questions::Asked;
use super::scenes::Scene;
use crate::commands::table::Table;

/// Where a step's cycles would stand.
const NO_COUNTER: &str = "no cycle counter";

/// The board and its chip, as it says itself.
#[derive(Clone, Debug, Serialize)]
pub struct Chip {
    board: String,
    hertz: u32,
    /// CPUID.
    processor: String,
    /// The chip's identity and unique number; zeros where it has none.
    chip: [String; 4],
}

impl Chip {
    /// Of the board called `name`.
    pub fn new(name: &str, identity: &Identity) -> Self {
        Self {
            board: name.to_owned(),
            hertz: identity.hertz,
            processor: format!("{:08x}", identity.processor),
            chip: identity.chip.map(|word| format!("{word:08x}")),
        }
    }
}

/// All that was found.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Who.
    pub chip: Chip,
    /// What runs there.
    pub program: Program,
    /// The motions of every method.
    pub bits: Vec<Bits>,
    /// What they cost.
    pub cycles: Vec<Cycles>,
    /// The scenes.
    pub scenes: Vec<Scene>,
    /// What the person says.
    pub asked: Vec<Asked>,
}

impl Report {
    /// What is not well, a line each.
    pub fn faults(&self) -> Vec<String> {
        let bits = self.bits.iter().filter_map(|Bits { method, motion, difference, .. }| {
            difference.as_ref().map(|difference| format!("{method}, {motion}: {difference}"))
        });
        let scenes = self.scenes.iter().filter_map(|Scene { scene, difference, .. }| {
            difference.as_ref().map(|difference| format!("{scene}: {difference}"))
        });
        let asked = self.asked.iter().filter(|asked| asked.is_so == Some(false));
        bits.chain(scenes).chain(asked.map(|asked| format!("not so: {}", asked.what))).collect()
    }

    /// In a line.
    pub fn headline(&self) -> String {
        let faults = self.faults().len();
        let frames: u32 = self.scenes.iter().map(|scene| scene.frames).sum();
        let said = format!(
            "{}: {} motions of {} methods, {frames} frames of {} scenes",
            self.chip.board,
            self.bits.len(),
            self.cycles.len(),
            self.scenes.len()
        );
        if faults == 0 { format!("{said}: every bit the host's") } else { format!("{said}: {faults} not well") }
    }

    /// Writes both files.
    pub fn write(&self, path: &Path) -> anyhow::Result<(PathBuf, PathBuf)> {
        let write = |kind, text: String| {
            let path = path.with_extension(kind);
            fs::write(&path, text).with_context(|| path.display().to_string())?;
            anyhow::Ok(path)
        };
        Ok((write("md", self.markdown())?, write("json", serde_json::to_string_pretty(self)? + "\n")?))
    }

    fn markdown(&self) -> String {
        let Chip { board, hertz, processor, chip } = &self.chip;
        let Program { crc, bytes, is_this, commit, compiler } = &self.program;
        let whose = if *is_this {
            format!("built from commit {commit} by {compiler}")
        } else {
            format!("not the one that commit {commit} and {compiler} build")
        };
        let mut text = format!(
            "# {board}\n\n{}.\n\n- chip {}, processor {processor}, {hertz} Hz\n- program of {bytes} bytes, CRC {crc}: {whose}\n\n",
            self.headline(),
            chip.join(" ")
        );
        self.tables().iter().for_each(|table| text += &(table.markdown() + "\n"));
        text
    }

    fn tables(&self) -> Vec<Table> {
        let verdict = |difference: &Option<String>| difference.clone().unwrap_or_else(|| "the host's".to_owned());
        let cycles =
            |cycles: Option<f64>, none: &str| cycles.map_or_else(|| none.to_owned(), |cycles| format!("{cycles:.1}"));
        let bits = Table {
            title: "Bits".to_owned(),
            note: "Motions from rest in steps of 1/256 s, computed by the board on request.".to_owned(),
            columns: vec!["method", "motion", "steps", "bits"],
            rows: (self.bits.iter())
                .map(|row| {
                    [&row.method, row.motion, &row.steps.to_string(), &verdict(&row.difference)]
                        .map(str::to_owned)
                        .to_vec()
                })
                .collect(),
            ..Table::default()
        };
        let costs = Table {
            title: "Cycles of a step".to_owned(),
            note: "Measured by the processor's cycle counter, interrupts off, over 256 steps of the regular motion, by the code in \
                   flash and, where there is one, by its copy in RAM (constants are read from flash by both); estimated for \
                   memory without wait states, over as many steps or, of the expensive ones, fewer."
                .to_owned(),
            columns: vec!["method", "from flash", "from RAM", "estimated"],
            rows: (self.cycles.iter())
                .map(|row| {
                    let no_copy = if row.from_flash.is_some() { "-" } else { NO_COUNTER };
                    let measured = [cycles(row.from_flash, NO_COUNTER), cycles(row.from_ram, no_copy)];
                    [vec![row.method.to_string()], measured.to_vec(), vec![cycles(row.estimated, "-")]].concat()
                })
                .collect(),
            ..Table::default()
        };
        let scenes = Table {
            title: "Scenes".to_owned(),
            note: "The longest of a second's frames, by the board's tick clock.".to_owned(),
            columns: vec!["scene", "frames", "bits", "dropped", "moving and drawing (ms)", "with panel and link (ms)"],
            rows: (self.scenes.iter())
                .map(|row| {
                    let times = [row.computing, row.whole].map(|time| format!("{time:.2}"));
                    let numbers = [
                        row.scene.to_owned(),
                        row.frames.to_string(),
                        verdict(&row.difference),
                        row.dropped.to_string(),
                    ];
                    numbers.into_iter().chain(times).collect()
                })
                .collect(),
            ..Table::default()
        };
        let asked = Table {
            title: "Seen and pressed".to_owned(),
            note: "By the person at the board; empty where it has neither panel nor buttons, and with --no-questions."
                .to_owned(),
            columns: vec!["what", "is so"],
            rows: (self.asked.iter())
                .map(|row| {
                    let answer = row.is_so.map_or("not answered", |is_so| if is_so { "yes" } else { "no" });
                    vec![row.what.clone(), answer.to_owned()]
                })
                .collect(),
            ..Table::default()
        };
        vec![bits, costs, scenes, asked]
    }
}
