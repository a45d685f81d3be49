//! `cargo prove`: until when the frames of a chip are right, as a theorem.

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use host_tests::commands::prove::{HEADING, Options, Proof, follow, horizons, known_answers, moving, row, words};
use host_tests::console::cli::{self, Refused, say};
use host_tests::console::progress::Bar;
use host_tests::emulator::process::{INTERRUPTS, interrupted_by};
use signal_hook::flag::register_usize;

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
    let mut proof = [Proof::new(&scene, way).map_err(Refused::because)?];
    let stopped = Arc::new(AtomicUsize::new(0));
    for signal in INTERRUPTS {
        register_usize(signal, Arc::clone(&stopped), signal as usize)?;
    }
    if options.csv {
        say(HEADING)?;
    }
    let bar = Bar::start("proving", scene.frames().into());
    let mut width = 0.0;
    let frames = follow(&scene, &start, &mut proof, |frame, set, verdicts| {
        width = set.width();
        bar.advance(1);
        if options.csv {
            say(row(&scene, frame, set, verdicts[0]))?;
        }
        Ok(stopped.load(Ordering::Relaxed) == 0)
    })?;
    drop(bar);
    if !options.csv {
        words(&scene, &plan, &proof[0], frames, width).iter().try_for_each(say)?;
    }
    match stopped.load(Ordering::Relaxed) {
        0 => Ok(ExitCode::SUCCESS),
        signal => Ok(ExitCode::from(interrupted_by(signal as i32) as u8)),
    }
}
