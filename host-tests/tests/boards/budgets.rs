//! What every board's application takes of its memory, and what it leaves of its processor's time.
//!
//! The board's clock counts instructions; how many cycles one takes is estimated on a frame of the first scene that QEMU
//! logs whole. The table in the README is what `cargo test -p host-tests --test boards budgets:: -- --nocapture` prints.

use std::path::Path;

use crate::support::{LIMIT, application, settings, toolchain};
use cycles::{Cost, Image};
use double_pendulum::Parameters;
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
use host_tests::link::Received;
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

/// A board that goes from frame to frame.
trait Stepped {
    fn next(&mut self) -> anyhow::Result<Frame>;
    fn say(&mut self, bytes: &[u8]) -> anyhow::Result<()>;
}

impl Stepped for Lockstep {
    fn next(&mut self) -> anyhow::Result<Frame> {
        self.next_frame()
    }

    fn say(&mut self, bytes: &[u8]) -> anyhow::Result<()> {
        self.machine().serial.send_bytes(bytes)
    }
}

impl Stepped for PicoMachine {
    fn next(&mut self) -> anyhow::Result<Frame> {
        Ok(self.run_to_frame()?.iter().rev().find_map(Received::read).expect("it ends with one"))
    }

    fn say(&mut self, bytes: &[u8]) -> anyhow::Result<()> {
        self.send_bytes(bytes)
    }
}

/// Lets so many frames be drawn; the highest one's cost, counts of the board's clock.
fn play(board: &mut impl Stepped, frames: usize) -> anyhow::Result<u32> {
    (0..frames).try_fold(0, |highest, _| Ok(highest.max(board.next()?.busy_cycles)))
}

fn send<M: Message>(board: &mut impl Stepped, message: M) -> anyhow::Result<()> {
    board.say(encode(&message, &mut [0; MAX_WIRE]))
}

/// Plays every scene and sends every command, good and bad, requests of every kind, and garbage; what the highest frame
/// of a scene's own start cost, counts of the board's clock.
fn exercise(board: &mut impl Stepped) -> anyhow::Result<u32> {
    let mut highest = 0;
    for &name in SceneName::ALL {
        send(board, Choose { request: 1, scene: name.code() })?;
        play(board, SETTLING)?;
        highest = highest.max(play(board, FRAMES)?);
    }
    for field in Field::ALL {
        for value in [0.75, f64::NAN, -1e30] {
            send(board, Set { request: 2, field: field.code(), value })?;
            play(board, 1)?;
        }
    }
    send(board, Set { request: 3, field: Field::Speed.code(), value: 1.0 })?;
    send(board, Choose { request: 4, scene: u8::MAX })?;
    play(board, 1)?;
    send(board, Pause { request: 5, paused: 1 })?;
    send(board, Step { request: 6, ticks: 2 })?;
    send(board, Ask { request: 7 })?;
    play(board, FRAMES)?;
    send(board, Restart { request: 8 })?;
    send(board, Pause { request: 9, paused: 0 })?;
    for &method in ON_BOARDS {
        for dt in [1.0 / 256.0, 0.5, 0.0] {
            let parameters = Parameters { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: 9.81 };
            let (angles, velocities) = ([2.0, 1.0], [0.5, -0.5]);
            let (stride, samples) = (4, 20);
            let request = Request { method, parameters, angles, velocities, dt, stride, samples };
            send(board, request.message(10))?;
            play(board, COMPUTING)?;
        }
    }
    board.say(&[0x55; 300])?;
    play(board, FRAMES)?;
    board.say(&[0; 2])?;
    // A line of the log says that frames were dropped, if any were.
    play(board, TICK_RATE as usize)?;
    Ok(highest)
}

fn measure(board: &'static Board) -> anyhow::Result<(Memory, f64)> {
    let (toolchain, elf) = (toolchain(), application(board));
    let image = Image::read(&elf)?;
    let stack = Stack::of(&elf)?;
    let mut machine = Lockstep::start(&settings(&toolchain, board, &elf))?;
    stack.paint(&mut machine)?;
    play(&mut machine, FRAMES)?;
    let (_, profile) = FrameProfile::of_next(&mut machine, &image, board.core())?;
    let Cost { instructions, cycles, .. } = profile.whole;
    let highest = exercise(&mut machine)?;
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
    play(&mut board, FRAMES)?;
    let idle = 1.0 - f64::from(exercise(&mut board)? * TICK_RATE) / f64::from(PICO.hertz);
    let stack = Stack::depth(&board.read(stack)?);
    let too_much = beyond(PICO.name, (Memory { stack, ..sections(&elf) }, idle), &budgets::PICO);
    assert!(too_much.is_empty(), "{too_much:#?}");
    Ok(())
}
