//! `cargo verify-board`: a verification of real hardware against the results of the emulators and
//! the host, with a report to send in.

mod check_list;
mod compare;
mod talk;

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::Context;
use clap::Parser;
use firmware::job::CRC;
use firmware::protocol::{self, Answer, Identity};
use object::{Object, ObjectSymbol};

use crate::table::Table;
use boards::console::cli::{complain, say};
use boards::console::progress::Progress;
use boards::flash::image::{ERASED, flash_image_over};
use boards::link;
use boards::out_file::OutFile;
use boards::process;
use boards::toolchain::{self, QUICK, workspace};
use boards::{Board, every_board};
use talk::Talk;

/// Verifies a board at a serial port and writes a report. Compares the bits of every method and
/// scene with the host's, measures the cycles of every method and the frame time of every scene,
/// and asks about buttons and panel.
#[derive(Clone, Debug, Parser)]
#[command(
    name = "cargo verify-board",
    after_help = "Example: cargo verify-board --port auto --report feather"
)]
pub struct VerifyOptions {
    /// The serial port; `auto` takes the only one over USB
    #[arg(long, value_name = "PATH")]
    pub port: String,
    /// Do not ask about buttons and panel
    #[arg(long)]
    pub no_questions: bool,
    /// The file of the report, written as FILE.md
    #[arg(long, value_name = "FILE", default_value = "board-report")]
    pub report: PathBuf,
}

#[derive(Debug, Default)]
struct Section {
    head: [&'static str; 2],
    table: Table,
    faults: Vec<String>,
}

impl Section {
    fn new(title: &'static str, note: &'static str, columns: &'static [&'static str]) -> Self {
        Self {
            head: [title, note],
            table: Table {
                columns: columns.to_vec(),
                rows: Vec::new(),
            },
            faults: Vec::new(),
        }
    }

    fn add(&mut self, row: Vec<String>, fault: Option<String>) {
        self.table.rows.push(row);
        self.faults.extend(fault);
    }
}

fn verdict(difference: Option<String>) -> String {
    difference.unwrap_or_else(|| "identical".to_owned())
}

/// Verifies the board, asks the person at it unless `no_questions` is set, and writes the report.
/// Returns true if there was no fault. Another program in flash than this workspace builds is
/// reported, but is no fault.
pub fn run(options: &VerifyOptions) -> anyhow::Result<bool> {
    // Refuse before the measurements.
    let path = options.report.with_extension("md");
    let report = OutFile::create("--report", &path)?;
    let mut talk = Talk::new(demo::port(&options.port)?)?;
    let identity = talk.ask(protocol::Command::Identify, |answer| {
        if let Answer::Identity(identity) = answer {
            Some(identity)
        } else {
            None
        }
    })?;
    let name = identity.board.name();
    let board = every_board().find(|board| board.name == name);
    // The tools build the board's program, after the measurements.
    if board.is_some() {
        toolchain::ready()?;
    }

    let progress = Progress::start(&format!("verifying {name} at {}", talk.port.name));
    let methods = compare::methods(&mut talk)?;
    let scenes = compare::scenes(&mut talk, identity.hertz)?;
    let panel = talk.ask(protocol::Command::Ask, |answer| {
        if let Answer::Status(status) = answer {
            Some(link::panel(&status.panel))
        } else {
            None
        }
    })?;
    let measured = compare::measured(&mut talk)?;
    let restarts = talk.port.inbox.counts.restarts;
    drop(progress);

    // The person is asked after the long measurements.
    let asked = if options.no_questions {
        Section::default()
    } else {
        talk::ask_person(&mut talk, name)?
    };
    let checks = check_list::section(&talk.port, name, restarts);

    // All questions to the board come before the builds, because the board continues to send.
    let cycles = compare::cycles(&measured, board)?;
    let program = program(board, &identity)?;
    let sections = [methods, cycles, scenes, asked, checks];

    let faults: Vec<&String> = sections
        .iter()
        .flat_map(|section| &section.faults)
        .collect();
    let verdict = if faults.is_empty() {
        "all bit-identical to the host".into()
    } else {
        format!("problems: {}", faults.len())
    };
    let [motions, methods, scenes, ..] =
        sections.each_ref().map(|section| section.table.rows.len());
    let headline =
        format!("{name}: {motions} motions of {methods} methods, {scenes} scenes: {verdict}");

    let chip = identity.chip.map(|word| format!("{word:08x}")).join(" ");
    let mut text = format!("# {name}\n\n{headline}.\n\n");
    text += &format!(
        "- chip {chip}, processor {:08x}, {} Hz\n- {program}\n",
        identity.processor, identity.hertz
    );
    if let Some(panel) = &panel {
        text += &format!("- panel: {panel}\n");
    }
    let filled = sections
        .iter()
        .filter(|section| !section.table.rows.is_empty());
    filled.for_each(
        |Section {
             head: [title, note],
             table,
             ..
         }| {
            text += &format!("\n## {title}\n\n{note}\n\n{}", table.markdown());
        },
    );

    report.write_whole(text.as_bytes())?;
    faults
        .iter()
        .for_each(|fault| complain(format_args!("problem: {fault}")));
    let panel = panel.map_or(String::new(), |panel| format!("panel: {panel}\n"));
    let said = say(format_args!(
        "{headline}\n{panel}report: {}",
        path.display()
    ));

    if faults.is_empty() {
        said?;
    }
    Ok(faults.is_empty())
}

/// Returns a line about the program in the board's flash.
fn program(board: Option<&Board>, identity: &Identity) -> anyhow::Result<String> {
    let output_of = |program: &str, arguments: &[&str]| {
        let output = process::run(
            Command::new(program)
                .args(arguments)
                .current_dir(workspace()),
            QUICK,
        );
        output.map_or_else(
            |_| "unknown".to_owned(),
            |output| output.stdout.trim().to_owned(),
        )
    };

    // A plus marks files that have changed since the commit.
    let changed = if output_of("git", &["status", "--porcelain"]).is_empty() {
        ""
    } else {
        "+"
    };
    let commit = output_of("git", &["rev-parse", "--short=12", "HEAD"]);
    let compiler = output_of("rustc", &["--version"]);
    let Identity {
        image, image_bytes, ..
    } = *identity;
    let whose = if board.map_or(Ok(false), |board| is_built(board, identity))? {
        format!("built from commit {commit}{changed} by {compiler}")
    } else {
        format!("not the one that commit {commit}{changed} and {compiler} build")
    };
    Ok(format!(
        "program of {image_bytes} bytes, CRC {image:08x}: {whose}"
    ))
}

fn is_built(board: &Board, identity: &Identity) -> anyhow::Result<bool> {
    let elf = fs::read(toolchain::ready()?.build_for(board)?)?;
    let file = object::File::parse(&*elf)?;
    let address = |name: &str| {
        let symbol = file
            .symbols()
            .find(|symbol| symbol.name() == Ok(name))
            .context("a program without its names")?;
        anyhow::Ok(symbol.address() as usize)
    };
    let start = address("__vector_table")?;
    let end = address("__erodata")?;
    // Flash that the program does not use is erased, or was filled with zeros by the flashing
    // program.
    let is_at = |unused: u8| {
        let (first, flash) = flash_image_over(&elf, unused)?;
        let image = flash
            .get(start - first as usize..end - first as usize)
            .context("a program beside its flash")?;
        anyhow::Ok(
            (CRC.checksum(image), image.len() as u32) == (identity.image, identity.image_bytes),
        )
    };
    Ok(is_at(ERASED)? || is_at(0)?)
}
