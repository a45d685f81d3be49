//! What every board's application takes of its memory, and what it leaves of its processor's time.
//!
//! The board's clock counts instructions; how many cycles one takes is estimated on a frame of the first scene that QEMU
//! logs whole. The table in the README is what `cargo test -p host-tests --test boards budgets:: -- --nocapture` prints.

use std::path::Path;

use crate::support::{LIMIT, application, settings, toolchain};
use cycles::{Cost, Image};
use firmware::config::TICK_RATE;
use firmware::job::{ON_BOARDS, Request};
use firmware::protocol::{Ask, Choose, Field, Frame, MAX_WIRE, Message, Pause, Restart, Set, Step, encode};
use firmware::scenes::SceneName;
use host_tests::commands::count::FrameProfile;
use host_tests::emulator::boards::{BOARDS, Board, PICO};
use host_tests::emulator::budgets::{self, Memory};
use host_tests::emulator::pico::PicoMachine;
use host_tests::emulator::qemu::{Lockstep, PAINT, Stack};
use host_tests::emulator::toolchain;
use object::elf::{SHF_ALLOC, SHF_WRITE};
use object::{Object, ObjectSection, SectionFlags, SectionKind};
use rayon::prelude::*;

/// Frames that pay for the start of a scene, or catch up with what it cost.
const SETTLING: usize = 6;
/// Frames of each scene after those, and frames in which a motion asked for is computed.
const FRAMES: usize = 24;
const COMPUTING: usize = 2;

/// Text, data and bss as the linker left them.
fn sections(elf: &Path) -> Memory {
    let bytes = std::fs::read(elf).unwrap_or_else(|error| panic!("{error}"));
    let file = object::File::parse(&*bytes).unwrap_or_else(|error| panic!("{error}"));
    let mut memory = Memory { text: 0, data: 0, bss: 0, stack: 0 };
    for section in file.sections() {
        let SectionFlags::Elf { sh_flags } = section.flags() else { continue };
        let (is_loaded, is_written) = (sh_flags & u64::from(SHF_ALLOC) != 0, sh_flags & u64::from(SHF_WRITE) != 0);
        let part = match (is_loaded, is_written, section.kind()) {
            (false, ..) => continue,
            (_, _, SectionKind::UninitializedData) => &mut memory.bss,
            (_, true, _) => &mut memory.data,
            _ => &mut memory.text,
        };
        *part += section.size() as u32;
    }
    memory
}

/// What a board sends as its next frame when it has been told this.
type Next<'a> = &'a mut dyn FnMut(&[u8]) -> anyhow::Result<Frame>;

/// The highest cost of the so many frames that follow this command, counts of the board's clock.
fn play(next: Next, words: &[u8], frames: usize) -> anyhow::Result<u32> {
    let first = next(words)?.busy_cycles;
    (1..frames).try_fold(first, |highest, _| Ok(highest.max(next(&[])?.busy_cycles)))
}

fn wire(message: impl Message) -> Vec<u8> {
    encode(&message, &mut [0; MAX_WIRE]).to_vec()
}

/// Plays every scene and sends every command, good and bad, requests of every kind, and garbage; what the highest frame
/// of a scene's own start cost, counts of the board's clock.
fn exercise(next: Next) -> anyhow::Result<u32> {
    let mut highest = 0;
    for &name in SceneName::ALL {
        play(next, &wire(Choose { request: 1, scene: name.code() }), SETTLING)?;
        highest = highest.max(play(next, &[], FRAMES)?);
    }
    for field in Field::ALL {
        for value in [0.75, f64::NAN, -1e30] {
            play(next, &wire(Set { request: 2, field: field.code(), value }), 1)?;
        }
    }
    let [speed, none] =
        [wire(Set { request: 3, field: Field::Speed.code(), value: 1.0 }), wire(Choose { request: 4, scene: u8::MAX })];
    play(next, &[speed, none].concat(), 1)?;
    let stepped =
        [wire(Pause { request: 5, paused: 1 }), wire(Step { request: 6, ticks: 2 }), wire(Ask { request: 7 })];
    play(next, &stepped.concat(), FRAMES)?;
    next(&[wire(Restart { request: 8 }), wire(Pause { request: 9, paused: 0 })].concat())?;
    for &method in ON_BOARDS {
        for dt in [1.0 / 256.0, 0.5, 0.0] {
            let request = Request { dt, stride: 4, samples: 20, ..Request::on_any_core(method) };
            play(next, &wire(request.message(10)), COMPUTING)?;
        }
    }
    play(next, &[0x55; 300], FRAMES)?;
    // A line of the log says that frames were dropped, if any were.
    play(next, &[0; 2], TICK_RATE as usize)?;
    Ok(highest)
}

fn measure(board: &'static Board) -> anyhow::Result<(Memory, f64)> {
    let (toolchain, elf) = (toolchain(), application(board));
    let image = Image::read(&elf)?;
    let stack = Stack::of(&elf)?;
    let mut machine = Lockstep::start(&settings(&toolchain, board, &elf))?;
    stack.paint(&mut machine)?;
    (0..FRAMES).try_for_each(|_| machine.next_frame().map(drop))?;
    let (_, profile) = FrameProfile::of_next(&mut machine, &image, board.core())?;
    let Cost { instructions, cycles, .. } = profile.whole;
    let highest = exercise(&mut |words| {
        machine.machine().serial.send_bytes(words)?;
        machine.next_frame()
    })?;
    let stack = stack.reached(&mut machine)?;
    let executed = f64::from(highest) / f64::from(board.hertz) / board.instruction();
    let cycles = executed * cycles as f64 / instructions as f64;
    let idle = 1.0 - cycles * f64::from(TICK_RATE) / f64::from(board.processor_hertz());
    Ok((Memory { stack, ..sections(&elf) }, idle))
}

/// Prints the README's row; what is beyond its budget.
fn beyond(name: &str, (memory, idle): (Memory, f64), budget: &Memory) -> Vec<String> {
    let Memory { text, data, bss, stack } = memory;
    println!("| `{name}` | {text} | {data} | {bss} | {stack} | {:.0} % |", 100.0 * idle);
    assert!(stack > 0, "{name}: nothing is painted any more, or nothing was");
    let parts = [
        ("text", text, budget.text),
        ("data", data, budget.data),
        ("bss", bss, budget.bss),
        ("stack", stack, budget.stack),
    ];
    let parts = parts.into_iter().filter(|(_, bytes, most)| bytes > most).map(|part| format!("{name}: {part:?}"));
    parts.chain((idle < budgets::IDLE).then(|| format!("{name}: idle {idle:.3}"))).collect()
}

#[test]
fn every_board_keeps_within_its_memory_and_its_time() -> anyhow::Result<()> {
    let mut too_much = Vec::new();
    println!("| board | text | data | bss | stack | idle (estimated) |\n| --- | ---: | ---: | ---: | ---: | ---: |");
    let measured: Vec<_> = BOARDS.par_iter().map(measure).collect();
    for ((board, measured), (name, budget)) in BOARDS.iter().zip(measured).zip(&budgets::MEMORY) {
        assert_eq!(board.name, *name, "a row for each board");
        too_much.extend(beyond(name, measured?, budget));
    }
    assert!(too_much.is_empty(), "{too_much:#?}");
    Ok(())
}

/// Its emulator counts cycles itself, by the processor's manual; it knows of no waiting for the flash.
#[test]
fn the_pico_keeps_within_its_memory_and_its_time() -> anyhow::Result<()> {
    let emulator = toolchain::ready_for_pico().unwrap_or_else(|missing| panic!("{missing}"));
    let elf = application(&PICO);
    let stack = Stack::of(&elf)?.addresses();
    let mut board = PicoMachine::start(&emulator, &elf, LIMIT)?;
    board.fill(stack.clone(), PAINT)?;
    (0..FRAMES).try_for_each(|_| board.next_frame().map(drop))?;
    let highest = exercise(&mut |words| {
        (!words.is_empty()).then(|| board.send_bytes(words)).transpose()?;
        board.next_frame()
    })?;
    let idle = 1.0 - f64::from(highest * TICK_RATE) / f64::from(PICO.hertz);
    let stack = Stack::depth(&board.read(stack)?);
    let too_much = beyond(PICO.name, (Memory { stack, ..sections(&elf) }, idle), &budgets::PICO);
    assert!(too_much.is_empty(), "{too_much:#?}");
    Ok(())
}
