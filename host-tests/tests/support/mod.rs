//! Functions shared by the tests on emulated boards. Not every test uses all of this module.
#![allow(dead_code)]

pub mod bench;
pub mod code;
pub mod snapshot;

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Duration;

use boards::Board;
use boards::host::Show;
use boards::qemu::{Clock, MachineSettings};
use boards::toolchain::{self, Toolchain};
use firmware::scenes::SceneName;
use host_tests::count::Target;
use object::{Object, ObjectSymbol};

/// The time limit against hanging: many times the duration of any run, on a slow and busy machine
/// too.
pub const LIMIT: Duration = Duration::from_secs(900);

/// A test without the tools fails with the command that installs them.
pub fn toolchain() -> Toolchain {
    toolchain::ready().unwrap_or_else(|missing| panic!("{missing}"))
}

pub fn targets() -> Vec<Target> {
    Target::build_all(&toolchain()).unwrap_or_else(|error| panic!("{error}"))
}

pub fn application(board: &Board) -> PathBuf {
    toolchain()
        .build_for(board)
        .unwrap_or_else(|error| panic!("{error}"))
}

/// The clock counts instructions, so that runs are bit-identical.
pub fn settings<'a>(
    toolchain: &'a Toolchain,
    board: &'a Board,
    elf: &'a Path,
) -> MachineSettings<'a> {
    MachineSettings {
        qemu: &toolchain.qemu,
        board,
        elf,
        clock: Clock::Counted,
        debugger: true,
        limit: LIMIT,
    }
}

pub fn on<M>(
    board: &Board,
    start: impl FnOnce(&MachineSettings) -> anyhow::Result<M>,
) -> anyhow::Result<M> {
    let toolchain = toolchain();
    let elf = application(board);
    start(&settings(&toolchain, board, &elf))
}

/// A byte that is rare in memory. Where it is gone, the stack has been used.
pub const PAINT: u8 = 0xA5;

pub fn stack(elf: &Path) -> Range<u32> {
    address(elf, "_stack_end")..address(elf, "_stack_start")
}

/// `memory` is the content of [`stack`], painted with [`PAINT`].
pub fn depth(memory: &[u8]) -> u32 {
    memory.iter().skip_while(|byte| **byte == PAINT).count() as u32
}

pub fn show(board: &Board, name: SceneName) -> Show {
    Show::on(board.processor(), name, &name.first_settings()).expect("a scene of the catalogue")
}

/// Returns the address of a symbol. Versions of the compiler name it in different ways:
/// `firmware::app::player::Player::execute` or `<firmware::app::player::Player>::execute`.
pub fn address(elf: &Path, name: &str) -> u32 {
    let bytes = std::fs::read(elf).unwrap_or_else(|error| panic!("{}: {error}", elf.display()));
    let file =
        object::File::parse(&*bytes).unwrap_or_else(|error| panic!("{}: {error}", elf.display()));
    let is_it = |mangled: &str| {
        let whole = format!("{:#}", rustc_demangle::demangle(mangled)).replace(['<', '>'], "");
        whole == name || whole.ends_with(&format!("::{name}"))
    };
    let symbol = file.symbols().find(|symbol| symbol.name().is_ok_and(is_it));
    symbol.map_or_else(
        || panic!("no {name} in {}", elf.display()),
        |symbol| symbol.address() as u32 & !1,
    )
}
