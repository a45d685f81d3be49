//! A search for panics on the device: every place in the release images that could panic is found
//! and must be in a short list. The known panic of each image's start must be found, too, which shows
//! that the search works.
//!
//! The search goes backwards from the panic handler. It follows the branches to it, and the
//! branches to their functions in turn, through the helpers of the core library, to the places in
//! other code where a panic begins. A place belongs to its innermost function outside of the core
//! library; inlined functions count.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use addr2line::Context;
use addr2line::gimli::{self, Dwarf, EndianSlice, LittleEndian, SectionId};
use boards::{every_board, pico_with};
use firmware::graphics::PanelName;
use object::{Object, ObjectSection};

use crate::support::code::Code;

/// The code that may contain a panic, with the reason why it never happens.
const PERMITTED: [(&str, &str); 14] = [
    (
        "lm3s6965evb::__cortex_m_rt_main",
        "start-up: the board is taken once",
    ),
    ("stm32f405::__cortex_m_rt_main", "as above"),
    ("pico::__cortex_m_rt_main", "as above"),
    (
        "firmware::board::main_loop::application",
        "start-up: the default settings are a pendulum",
    ),
    (
        "stm32f4xx_hal::rcc::",
        "start-up: the clock is set up with constant numbers",
    ),
    (
        "stm32f4xx_hal::i2c::",
        "start-up: the bus is set up with constant numbers",
    ),
    (
        "usb_device::",
        "the USB device is set up with constant numbers; \
        if a host could lead it astray, the board would restart",
    ),
    ("usbd_serial::", "as above"),
    ("rp2040_hal::usb::", "as above"),
    ("rp2040_pac::usbctrl_dpram::", "as above"),
    ("firmware::board::pico::usb::", "the same, inlined"),
    (
        "firmware::board::log::into_memory",
        "start-up: the log's memory is taken once",
    ),
    (
        "defmt_semihosting::",
        "a line of the log within a line: interrupts are off from its start to its end",
    ),
    (
        "semihosting::fd::",
        "a console that could not be opened: then there is no log, and nothing is written",
    ),
];

/// Functions and lines, the innermost first.
type Frames = Vec<(String, String)>;

fn owner(frames: &Frames) -> &str {
    let is_core = |name: &&str| {
        name.starts_with("core::") || name.contains(" core::") || name.starts_with("<core::")
    };
    let mut names = frames.iter().map(|(name, _)| name.as_str());
    names
        .clone()
        .find(|name| !is_core(name))
        .or(names.next_back())
        .unwrap_or_default()
}

fn is_helper(name: &str) -> bool {
    name.starts_with("core::")
        && (name.contains("panic") || name.ends_with("_fail") || name.ends_with("_failed"))
}

fn places(elf: &Path) -> BTreeMap<u32, Frames> {
    let code = Code::read(elf).unwrap_or_else(|error| panic!("{}: {error}", elf.display()));
    let lines = lines(elf).unwrap_or_else(|error| panic!("{}: {error}", elf.display()));
    let mut panicking: Vec<_> = code
        .functions_named(|name| name.ends_with("rust_begin_unwind"))
        .collect();
    assert_eq!(panicking.len(), 1, "one panic handler in {}", elf.display());

    // The list grows while it is searched: each helper that panics has its own callers.
    let mut places = BTreeMap::new();
    let mut seen = 0;

    while let Some(&function) = panicking.get(seen) {
        seen += 1;
        for address in code.names_of(function) {
            match code.function_at(address) {
                Some((helper, name)) if is_helper(name) => {
                    if !panicking.contains(&helper) {
                        panicking.push(helper);
                    }
                }
                caller => {
                    let mut frames = frames(&lines, address);
                    frames.extend(caller.map(|(_, name)| (name.to_owned(), String::new())));
                    places.insert(address, frames);
                }
            }
        }
    }

    places
}

/// The function and line of each instruction.
type Lines = Context<EndianSlice<'static, LittleEndian>>;

fn lines(elf: &Path) -> anyhow::Result<Lines> {
    let file = object::File::parse(&*std::fs::read(elf)?.leak())?;
    let section = |id: SectionId| {
        let data = file
            .section_by_name(id.name())
            .and_then(|section| section.data().ok());
        Ok::<_, gimli::Error>(EndianSlice::new(data.unwrap_or_default(), LittleEndian))
    };
    Ok(Context::from_dwarf(Dwarf::load(section)?)?)
}

fn frames(lines: &Lines, address: u32) -> Frames {
    let mut frames = Vec::new();
    // A place may be in several functions that are inlined into each other.
    let found = lines.find_frames(address.into()).skip_all_loads();
    let mut found = found.unwrap_or_else(|error| panic!("{address:#x}: {error}"));
    while let Some(frame) = found
        .next()
        .unwrap_or_else(|error| panic!("{address:#x}: {error}"))
    {
        let name = frame
            .function
            .and_then(|function| Some(function.demangle().ok()?.into_owned()))
            .unwrap_or_default();
        let line = frame
            .location
            .and_then(|at| Some(format!("{}:{}", at.file?, at.line?)))
            .unwrap_or_default();
        frames.push((name, line));
    }
    frames
}

fn images() -> BTreeSet<PathBuf> {
    every_board()
        .map(crate::support::application)
        .chain([crate::support::application(&pico_with(PanelName::Lcd13))])
        .collect()
}

#[test]
fn only_permitted_code_can_panic() {
    let mut used = BTreeSet::new();
    let mut refused = Vec::new();

    for elf in images() {
        let places = places(&elf);
        let is_start = |frames: &Frames| owner(frames).ends_with("::__cortex_m_rt_main");
        assert!(
            places.values().any(is_start),
            "the search fails in {}",
            elf.display()
        );

        for (address, frames) in places {
            let owner = owner(&frames);
            match PERMITTED
                .iter()
                .position(|(name, _)| owner.trim_start_matches('<').starts_with(name))
            {
                Some(row) => drop(used.insert(row)),
                None => refused.push(format!(
                    "{} {address:#x} {owner} {frames:#?}",
                    elf.display()
                )),
            }
        }
    }

    assert!(
        refused.is_empty(),
        "these can panic:\n{}",
        refused.join("\n")
    );

    for (row, (name, _)) in PERMITTED.iter().enumerate() {
        assert!(
            used.contains(&row),
            "nothing of {name} can panic any more: strike it off the list"
        );
    }
}
