//! What the firmware needs from outside, found or brought: the ARM core library, `qemu-system-arm` and, for the Raspberry Pi
//! Pico, rp2040js.
//!
//! [`ready`] only looks. [`set_up`] brings what is missing: the core library by `rustup target add`, or else from
//! Debian's source packages; QEMU from Debian's packages, installed, or unpacked into `qemu` in the target folder where they
//! cannot be. Both ways build the same firmware with the same flags.

mod build;
mod detect;
mod install;
mod rp2040js;

use std::path::{Path, PathBuf, absolute};
use std::process::exit;
use std::sync::OnceLock;
use std::{env, fmt};

use crate::console::cli::{REFUSED, Refused, complain};
use crate::emulator::qemu;

/// The compiler's targets, one for each kind of core.
pub const TARGETS: [&str; 3] = ["thumbv6m-none-eabi", "thumbv7m-none-eabi", "thumbv7em-none-eabihf"];

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Toolchain {
    core: ArmCore,
    qemu: PathBuf,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum ArmCore {
    ReadyMade,
    /// Built from the sources that Debian's compiler carries, by that compiler.
    FromSource {
        /// The folder that holds `rust-lld`.
        linker: PathBuf,
    },
}

/// That something is missing: why, and what brings it, in a line.
fn missing(what: &str, why: &str, by_hand: &str) -> Refused {
    Refused::because(format_args!("{what} is missing: {why}; what brings it: cargo setup, or {by_hand}"))
}

/// The tools, if all are there; installs nothing. Looks once per process.
pub fn ready() -> Result<Toolchain, Refused> {
    static READY: OnceLock<Result<Toolchain, Refused>> = OnceLock::new();
    READY.get_or_init(|| both(detect::core(&TARGETS), detect::QEMU.find())).clone()
}

/// The tools, brought if need be; what was done for it is said. Two set-ups at once take turns.
pub fn set_up() -> Result<Toolchain, Refused> {
    qemu::check_folder().map_err(Refused::because)?;
    ready().or_else(|_| {
        let _turn = install::turn()?;
        both(install::core(&TARGETS), install::qemu(&detect::QEMU))
    })
}

/// Both of them, or a line for each that is missing.
fn both(core: Result<ArmCore, String>, qemu: Result<PathBuf, String>) -> Result<Toolchain, Refused> {
    let packages = format!("rustup target add {}, or Debian's {}", TARGETS.join(" "), detect::CORE_PACKAGES.join(" "));
    let core = core.map_err(|why| missing("the ARM core library", &why, &packages));
    let by_hand = "this system's package of that name (Homebrew: qemu)";
    let qemu = qemu.map_err(|why| missing(detect::QEMU.program, &why, by_hand));
    match (core, qemu) {
        (Ok(core), Ok(qemu)) => Ok(Toolchain { core, qemu }),
        (Err(core), Err(qemu)) => Err(Refused::because(format_args!("{core}\n{qemu}"))),
        (Err(missing), _) | (_, Err(missing)) => Err(missing),
    }
}

/// The tools, brought if need be, with the core library for one more target.
pub fn set_up_for(target: &str) -> Result<Toolchain, Refused> {
    let toolchain = set_up()?;
    let _turn = install::turn()?;
    let missing = |why| Refused::because(format_args!("the core library for {target} is missing: {why}"));
    Ok(Toolchain { core: install::core(&[target]).map_err(missing)?, ..toolchain })
}

/// The emulator of a RISC-V under Linux, brought if need be.
pub fn set_up_riscv() -> Result<PathBuf, Refused> {
    let _turn = install::turn()?;
    let emulator = &detect::QEMU_RISCV;
    install::qemu(emulator).map_err(|why| Refused::because(format_args!("{} is missing: {why}", emulator.program)))
}

/// Node.js with the emulator of the Raspberry Pi Pico, if it is there; installs nothing.
pub fn ready_for_pico() -> Result<PathBuf, Refused> {
    rp2040js::detect()
}

/// The same, brought if need be.
pub fn set_up_pico() -> Result<PathBuf, Refused> {
    rp2040js::detect().or_else(|_| {
        let _turn = install::turn()?;
        rp2040js::set_up()
    })
}

impl Toolchain {
    pub fn qemu(&self) -> &Path {
        &self.qemu
    }
}

impl fmt::Display for Toolchain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.core {
            ArmCore::ReadyMade => writeln!(f, "ARM core library: ready-made, for {}", TARGETS.join(", "))?,
            ArmCore::FromSource { linker } => {
                writeln!(f, "ARM core library: from Debian's sources, linked by rust-lld of {}", linker.display())?;
            }
        }
        write!(f, "QEMU: {}", self.qemu.display())
    }
}

/// What the workspace alone has, and no folder above or beside it.
const MARKS: [&str; 3] = ["kernel/Cargo.toml", "firmware/Cargo.toml", "host-tests/Cargo.toml"];

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
    chosen.and_then(|folder| absolute(folder).ok()).unwrap_or_else(|| workspace().join("target"))
}
