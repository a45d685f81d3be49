//! The tools that build and run the firmware: Rust's core library for the targets,
//! `qemu-system-arm`, Node.js with rp2040js for the Raspberry Pi Pico, and Chromium for the page.
//!
//! A function whose name begins with `ready` only searches for tools. One that begins with `set_up`
//! provides the missing ones: rustup adds the core library, npm fetches rp2040js, and all programs
//! are unpacked from Debian's packages into the target folder. Nothing is installed on the system.
//! A tool that cannot be provided is refused, in one line that says what to install.

mod build;
mod remap;
mod run;
mod tools;

use std::panic::resume_unwind;
use std::path::{Path, PathBuf, absolute};
use std::process::exit;
use std::sync::OnceLock;
use std::{env, fmt, thread};

pub use build::{BUILT_IMAGES, CORE_IMAGES, built_images};
pub use run::QUICK;
pub use tools::find;
use tools::{CHROMIUM, NODE, QEMU, QEMU_AARCH64, QEMU_RISCV};

use crate::board::Board;
use crate::console::cli::{REFUSED, Refused, complain};

pub const TARGETS: [&str; 3] = [
    "thumbv6m-none-eabi",
    "thumbv7m-none-eabi",
    "thumbv7em-none-eabihf",
];

pub const WASM: &str = "wasm32-unknown-unknown";

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Toolchain {
    pub qemu: PathBuf,
}

pub fn ready() -> Result<Toolchain, Refused> {
    static READY: OnceLock<Result<Toolchain, Refused>> = OnceLock::new();
    READY
        .get_or_init(|| both(tools::core(false, &TARGETS), QEMU.ready()))
        .clone()
}

pub fn set_up() -> Result<Toolchain, Refused> {
    check_temporary_folder()?;
    both(tools::core(true, &TARGETS), QEMU.set_up())
}

/// QEMU is fetched while the application is built, because the former waits for the network and the
/// latter for the processor.
pub fn set_up_and_build(board: &Board) -> anyhow::Result<(Toolchain, PathBuf)> {
    check_temporary_folder()?;
    tools::core(true, &TARGETS)?;
    let (elf, qemu) = thread::scope(|scope| {
        let qemu = scope.spawn(|| QEMU.set_up());
        let elf = compiler().build_for(board);
        let qemu = qemu.join().unwrap_or_else(|panic| resume_unwind(panic));
        (elf, qemu)
    });
    Ok((Toolchain { qemu: qemu? }, elf?))
}

fn compiler() -> Toolchain {
    Toolchain {
        qemu: PathBuf::new(),
    }
}

fn check_temporary_folder() -> Result<(), Refused> {
    let refused = |_| {
        Refused::because(format_args!(
            "TMPDIR={}: not a folder one can write to",
            env::temp_dir().display()
        ))
    };
    tempfile::tempdir().map_err(refused).map(drop)
}

pub fn set_up_for(target: &str) -> Result<Toolchain, Refused> {
    let emulator = match target.split('-').next() {
        Some("wasm32") => NODE,
        Some("aarch64") => QEMU_AARCH64,
        Some("riscv32imac") => QEMU_RISCV,
        _ => QEMU,
    };
    both(tools::core(true, &[target]), emulator.set_up())
}

/// Flashing a board needs no emulator.
pub fn set_up_to_flash() -> Result<Toolchain, Refused> {
    check_temporary_folder()?;
    tools::core(true, &TARGETS)?;
    Ok(compiler())
}

pub fn set_up_web() -> Result<Toolchain, Refused> {
    tools::core(true, &[WASM])?;
    Ok(compiler())
}

pub fn set_up_chromium() -> Result<PathBuf, Refused> {
    CHROMIUM.set_up()
}

fn both(core: Result<(), Refused>, qemu: Result<PathBuf, Refused>) -> Result<Toolchain, Refused> {
    match (core, qemu) {
        (Ok(()), Ok(qemu)) => Ok(Toolchain { qemu }),
        (Err(core), Err(qemu)) => Err(Refused::because(format_args!("{core}\n{qemu}"))),
        (Err(missing), _) | (_, Err(missing)) => Err(missing),
    }
}

pub fn ready_for_pico() -> Result<PathBuf, Refused> {
    let node = NODE.ready()?;
    tools::rp2040js(false, &node)?;
    Ok(node)
}

pub fn set_up_pico() -> Result<PathBuf, Refused> {
    let node = NODE.set_up()?;
    tools::rp2040js(true, &node)?;
    Ok(node)
}

impl fmt::Display for Toolchain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let targets = TARGETS.join(", ");
        let qemu = self.qemu.display();
        write!(f, "Rust's core library: {targets}\nQEMU: {qemu}")
    }
}

const MARKS: [&str; 3] = [
    "kernel/Cargo.toml",
    "firmware/Cargo.toml",
    "host-tests/Cargo.toml",
];

/// The folder is searched at run time, because a checkout may be moved or copied with its programs
/// already built: from the package that cargo runs, the current folder, and this program, upwards.
pub fn workspace() -> &'static Path {
    static FOUND: OnceLock<PathBuf> = OnceLock::new();
    FOUND.get_or_init(|| {
        let run_by_cargo = env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
        let starts = [
            run_by_cargo,
            env::current_dir().ok(),
            env::current_exe().ok(),
        ];
        starts
            .into_iter()
            .flatten()
            .find_map(|start| above(&start))
            .unwrap_or_else(|| {
                complain(
                    "error: the project was not found: run this command inside the project's \
                      folder",
                );
                exit(REFUSED.into())
            })
    })
}

fn above(start: &Path) -> Option<PathBuf> {
    let is_it = |folder: &&Path| MARKS.iter().all(|mark| folder.join(mark).is_file());
    start.ancestors().find(is_it).map(Path::to_owned)
}

pub fn target() -> PathBuf {
    let chosen = env::var_os("CARGO_TARGET_DIR").filter(|folder| !folder.is_empty());
    chosen
        .and_then(|folder| absolute(folder).ok())
        .unwrap_or_else(|| workspace().join("target"))
}
