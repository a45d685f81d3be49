//! The memory use of a board's application, and the commands that exercise it.

use std::path::Path;

use boards::Board;
use boards::budgets::{self, MEMORY, Memory};
use double_pendulum::Method;
use firmware::config::TICK_RATE;
use firmware::job::{ON_BOARDS, Request};
use firmware::protocol::{Command, Field, MAX_WIRE, ToHost, encode_command, frame};
use object::elf::{SHF_ALLOC, SHF_WRITE};
use object::{Object, ObjectSection, SectionFlags, SectionKind};

/// After a command that may be expensive, and to compute a requested motion.
const FRAMES: usize = 24;
const COMPUTING: usize = 2;

pub type Next<'a> = &'a mut dyn FnMut(&[u8]) -> anyhow::Result<Vec<ToHost>>;

pub fn wire(command: Command) -> Vec<u8> {
    encode_command(1, command, &mut [0; MAX_WIRE]).to_vec()
}

pub fn exercise(next: Next) -> anyhow::Result<()> {
    let mut play = |words: &[u8], frames: usize| {
        next(words)?;
        (1..frames).try_for_each(|_| next(&[]).map(drop))
    };

    for field in Field::ALL {
        for value in [0.75, f64::NAN, -1e30] {
            play(
                &wire(Command::Set {
                    field: *field,
                    value,
                }),
                1,
            )?;
        }
    }

    let unreadable = frame(&[0x80, 1, 0xEE], &mut [0; MAX_WIRE]).to_vec();
    play(
        &[
            wire(Command::Set {
                field: Field::Speed,
                value: 1.0,
            }),
            unreadable,
        ]
        .concat(),
        1,
    )?;
    play(
        &[Command::Pause(true), Command::Step(2), Command::Ask]
            .map(wire)
            .concat(),
        FRAMES,
    )?;
    play(
        &[Command::Restart, Command::Pause(false)].map(wire).concat(),
        1,
    )?;

    for &method in ON_BOARDS {
        for dt in [1.0 / 256.0, 0.5, 0.0] {
            let request = Request {
                dt,
                stride: 4,
                samples: 20,
                ..Request::on_any_core(method)
            };
            let measure = Command::Measure(1);
            play(
                &[Command::Simulate(request), measure].map(wire).concat(),
                COMPUTING,
            )?;
        }
    }

    for &method in Method::DRAWN {
        play(
            &[
                Command::Method(Some(method)),
                Command::AskPlan,
                Command::Identify,
            ]
            .map(wire)
            .concat(),
            COMPUTING,
        )?;
    }

    let taps = [
        Command::Heavier,
        Command::Lighter,
        Command::TurnLeft,
        Command::TurnRight,
        Command::TogglePause,
    ];
    let leaving = [
        Command::TogglePause,
        Command::Method(None),
        Command::NextScene,
        Command::PreviousScene,
    ];
    taps.into_iter()
        .chain(leaving)
        .try_for_each(|command| play(&wire(command), COMPUTING))?;

    play(&[0x55; 300], FRAMES)?;

    // If frames were dropped, a line of the log reports it.
    play(&[0; 2], TICK_RATE as usize)
}

fn sections(elf: &Path) -> Memory {
    let bytes = std::fs::read(elf).unwrap_or_else(|error| panic!("{error}"));
    let file = object::File::parse(&*bytes).unwrap_or_else(|error| panic!("{error}"));
    let mut memory = Memory {
        text: 0,
        data: 0,
        bss: 0,
        stack: 0,
    };
    for section in file.sections() {
        let SectionFlags::Elf { sh_flags } = section.flags() else {
            continue;
        };
        let is_loaded = sh_flags & u64::from(SHF_ALLOC) != 0;
        let is_written = sh_flags & u64::from(SHF_WRITE) != 0;
        if !is_loaded {
            continue;
        }

        let part = if section.kind() == SectionKind::UninitializedData {
            &mut memory.bss
        } else if is_written {
            &mut memory.data
        } else {
            &mut memory.text
        };
        *part += section.size() as u32;
    }
    memory
}

pub fn beyond(board: &Board, elf: &Path, stack: u32, idle: f64) -> Vec<String> {
    let Memory {
        text, data, bss, ..
    } = sections(elf);
    let name = board.name;
    println!(
        "| `{name}` | {text} | {data} | {bss} | {stack} | {:.0} % |",
        100.0 * idle
    );

    assert!(
        stack > 0,
        "{name}: nothing is painted any more, or nothing was"
    );
    let (_, budget) = MEMORY
        .iter()
        .find(|(of, _)| *of == name)
        .expect("a row for each board");

    let parts = [
        ("text", text, budget.text),
        ("data", data, budget.data),
        ("bss", bss, budget.bss),
        ("stack", stack, budget.stack),
    ];
    let parts = parts
        .into_iter()
        .filter(|(_, bytes, most)| bytes > most)
        .map(|part| format!("{name}: {part:?}"));
    parts
        .chain((idle < budgets::IDLE).then(|| format!("{name}: idle {idle:.3}")))
        .collect()
}
