//! What the tests on emulated boards share. Not every test uses all of it.
#![allow(dead_code)]

pub mod bench;
pub mod code;

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Duration;

use firmware::scenes::SceneName;
use host_tests::commands::count::Target;
use host_tests::emulator::boards::Board;
use host_tests::emulator::host::Show;
use host_tests::emulator::qemu::{Clock, Settings};
use host_tests::emulator::toolchain::{self, Toolchain};
use object::{Object, ObjectSymbol};

/// Guards against hanging, nothing else: many times what any of these runs takes, on a slow and busy machine too.
pub const LIMIT: Duration = Duration::from_secs(900);

/// The tools; a test without them fails and says what brings them.
pub fn toolchain() -> Toolchain {
    toolchain::ready().unwrap_or_else(|missing| panic!("{missing}"))
}

/// The program that measures, on a board for each kind of core.
pub fn targets() -> Vec<Target> {
    Target::build_all(&toolchain()).unwrap_or_else(|error| panic!("{error}"))
}

/// A board's application.
pub fn application(board: &Board) -> PathBuf {
    toolchain()
        .build_for(board)
        .unwrap_or_else(|error| panic!("{error}"))
}

/// Repeatable bit for bit.
pub fn settings<'a>(toolchain: &'a Toolchain, board: &'a Board, elf: &'a Path) -> Settings<'a> {
    Settings {
        qemu: &toolchain.qemu,
        board,
        elf,
        clock: Clock::Counted,
        debugger: true,
        limit: LIMIT,
    }
}

/// What `start` makes of a board with its application: a machine that runs, or one in lockstep.
pub fn on<M>(
    board: &Board,
    start: impl FnOnce(&Settings) -> anyhow::Result<M>,
) -> anyhow::Result<M> {
    let (toolchain, elf) = (toolchain(), application(board));
    start(&settings(&toolchain, board, &elf))
}

/// The stack's share of memory, from its top (`board/cortex_m/stack.rs`).
const STACK: u32 = 32 * 1024;
/// No byte that is common in memory: where it is gone, the stack has been.
pub const PAINT: u8 = 0xA5;

/// The addresses of a program's stack.
pub fn stack(elf: &Path) -> Range<u32> {
    let top = address(elf, "_stack_start");
    top - STACK..top
}

/// The most bytes that a stack has held since it was painted, by what stands there now.
pub fn depth(memory: &[u8]) -> u32 {
    STACK - memory.iter().take_while(|byte| **byte == PAINT).count() as u32
}

/// A scene of the host's, as this board plays it from its start.
pub fn show(board: &Board, name: SceneName) -> Show {
    Show::on(board.processor(), name, &name.first_settings()).expect("a scene of the catalogue")
}

/// The address of a symbol, by its name without the path before it: `Player::execute`, which one version of the compiler calls
/// `firmware::app::player::Player::execute` and the next `<firmware::app::player::Player>::execute`.
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
