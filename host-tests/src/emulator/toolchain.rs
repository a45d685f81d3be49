//! What the firmware needs from outside, found or brought: the ARM core library, `qemu-system-arm` and, for the Raspberry Pi
//! Pico, rp2040js.
//!
//! [`ready`] only looks. [`set_up`] brings what is missing: the core library by `rustup target add`, or else from
//! Debian's source packages; QEMU from Debian's packages, installed, or unpacked into `qemu` in the target folder where they
//! cannot be. Both ways build the same firmware with the same flags.

mod bring;
mod build;
mod tools;

use std::path::{Path, PathBuf, absolute};
use std::process::exit;
use std::sync::OnceLock;
use std::{env, fmt};

pub use bring::QUICK;
use bring::turn;
pub use tools::find;
use tools::{CORE_PACKAGES, Emulator, QEMU, QEMU_RISCV};

use crate::console::cli::{REFUSED, Refused, complain};

/// The compiler's targets, one for each kind of core.
pub const TARGETS: [&str; 3] = [
    "thumbv6m-none-eabi",
    "thumbv7m-none-eabi",
    "thumbv7em-none-eabihf",
];

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Toolchain {
    /// Where the core library is not ready-made but built from the sources that Debian's compiler carries, by that compiler: the
    /// folder that holds `rust-lld`.
    linker: Option<PathBuf>,
    pub qemu: PathBuf,
}

/// That something is missing: why, and what brings it, in a line.
fn missing(installs: bool, what: &str, why: &str, by_hand: &str) -> Refused {
    let setup = if installs { "" } else { "cargo setup, or " };
    Refused::because(format_args!(
        "{what} is missing: {why}; what brings it: {setup}{by_hand}"
    ))
}

/// The tools, if all are there; installs nothing. Looks once per process.
pub fn ready() -> Result<Toolchain, Refused> {
    static READY: OnceLock<Result<Toolchain, Refused>> = OnceLock::new();
    READY.get_or_init(|| both(false, &TARGETS, &QEMU)).clone()
}

/// The tools, brought if need be; what was done for it is said. Two set-ups at once take turns.
pub fn set_up() -> Result<Toolchain, Refused> {
    let refused = |error| {
        Refused::because(format_args!(
            "QEMU's pipes: TMPDIR={}: {error}",
            env::temp_dir().display()
        ))
    };
    tempfile::tempdir().map_err(refused)?;
    ready().or_else(|_| {
        let _turn = turn()?;
        both(true, &TARGETS, &QEMU)
    })
}

/// The same for another target: its core library and its emulator, which for a RISC-V is that of its programs under Linux.
pub fn set_up_for(target: &str) -> Result<Toolchain, Refused> {
    let _turn = turn()?;
    both(
        true,
        &[target],
        if target.starts_with("riscv") {
            &QEMU_RISCV
        } else {
            &QEMU
        },
    )
}

/// Both of them, or a line for each that is missing.
fn both(installs: bool, targets: &[&str], emulator: &Emulator) -> Result<Toolchain, Refused> {
    let packages = format!(
        "rustup target add {}, or Debian's {}",
        targets.join(" "),
        CORE_PACKAGES.join(" ")
    );
    let core = tools::core(installs, targets)
        .map_err(|why| missing(installs, "the core library", &why, &packages));
    let by_hand = format!(
        "this system's package {} (Homebrew: qemu)",
        emulator.package
    );
    let qemu = tools::qemu(installs, emulator)
        .map_err(|why| missing(installs, emulator.program, &why, &by_hand));
    match (core, qemu) {
        (Ok(linker), Ok(qemu)) => Ok(Toolchain { linker, qemu }),
        (Err(core), Err(qemu)) => Err(Refused::because(format_args!("{core}\n{qemu}"))),
        (Err(missing), _) | (_, Err(missing)) => Err(missing),
    }
}

/// Node.js with the emulator of the Raspberry Pi Pico, if it is there; installs nothing.
pub fn ready_for_pico() -> Result<PathBuf, Refused> {
    tools::rp2040js(false)
}

/// The same, brought if need be.
pub fn set_up_pico() -> Result<PathBuf, Refused> {
    ready_for_pico().or_else(|_| {
        let _turn = turn()?;
        tools::rp2040js(true)
    })
}

impl fmt::Display for Toolchain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.linker {
            None => writeln!(
                f,
                "ARM core library: ready-made, for {}",
                TARGETS.join(", ")
            )?,
            Some(folder) => {
                writeln!(
                    f,
                    "ARM core library: from Debian's sources, linked by rust-lld of {}",
                    folder.display()
                )?;
            }
        }
        write!(f, "QEMU: {}", self.qemu.display())
    }
}

/// What the workspace alone has, and no folder above or beside it.
const MARKS: [&str; 3] = [
    "kernel/Cargo.toml",
    "firmware/Cargo.toml",
    "host-tests/Cargo.toml",
];

/// The project's folder, found as a command runs, for a checkout may be moved or copied with its programs already built: above the package that cargo runs, else above the current folder, else above this program.
/// Where there is none the process ends as any command does that cannot be served: one line, exit code 2.
pub fn workspace() -> &'static Path {
    static FOUND: OnceLock<PathBuf> = OnceLock::new();
    FOUND.get_or_init(|| {
        let run_by_cargo = env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
        let starts = [run_by_cargo, env::current_dir().ok(), env::current_exe().ok()];
        starts.into_iter().flatten().find_map(|start| above(&start)).unwrap_or_else(|| {
            complain("error: the project's folder is neither above this one nor above the program: run it from there");
            exit(REFUSED.into())
        })
    })
}

/// The workspace that `start` is in.
fn above(start: &Path) -> Option<PathBuf> {
    let is_it = |folder: &&Path| MARKS.iter().all(|mark| folder.join(mark).is_file());
    start.ancestors().find(is_it).map(Path::to_owned)
}

/// Where everything built goes: `CARGO_TARGET_DIR`, as cargo has it, or else the workspace's own folder.
pub fn target() -> PathBuf {
    let chosen = env::var_os("CARGO_TARGET_DIR").filter(|folder| !folder.is_empty());
    chosen
        .and_then(|folder| absolute(folder).ok())
        .unwrap_or_else(|| workspace().join("target"))
}
