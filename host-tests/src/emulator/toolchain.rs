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
mod workspace;

pub use workspace::{target, workspace};

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use crate::console::cli::Refused;
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
