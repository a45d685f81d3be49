//! `cargo prove`: until when the frames of a chip are right, as a theorem.

use std::process::ExitCode;
use std::sync::atomic::Ordering;

use host_tests::commands::prove::{HEADING, Options, Proof, horizons, known_answers, moving, row, words};
use host_tests::console::cli::{self, Refused, say};
use host_tests::console::progress::Bar;
use host_tests::emulator::process::{interrupted, interrupted_by};

fn main() -> ExitCode {
    cli::main(run)
}

fn run(options: &Options) -> anyhow::Result<ExitCode> {
    if options.table {
        let bar = Bar::start("proving", moving().count() as u64);
        let table = horizons(moving(), || bar.advance(1))?;
        drop(bar);
        say(table.markdown_rows().trim_end())?;
        return Ok(ExitCode::SUCCESS);
    }
    if options.known_answers {
        known_answers(|_| true, say)?;
        return Ok(ExitCode::SUCCESS);
    }
    let (scene, start, plan) = options.scene().map_err(Refused::because)?;
    let Some(way) = options.way(&plan) else {
        say("nothing that the chip can afford is right in any frame")?;
        return Ok(ExitCode::SUCCESS);
    };
    let stopped = interrupted()?;
    if options.csv {
        say(HEADING)?;
    }
    let bar = Bar::start("proving", scene.frames().into());
    let proof = Proof::of(&scene, &start, way, |frame, set, is_right| {
        bar.advance(1);
        if options.csv {
            say(row(&scene, frame, set, is_right))?;
        }
        Ok(stopped.load(Ordering::Relaxed) == 0)
    })?;
    drop(bar);
    if !options.csv {
        words(&scene, &plan, &proof).iter().try_for_each(say)?;
    }
    match stopped.load(Ordering::Relaxed) {
        0 => Ok(ExitCode::SUCCESS),
        signal => Ok(ExitCode::from(interrupted_by(signal as i32) as u8)),
    }
}
