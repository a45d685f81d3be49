//! The tools that build and run the firmware: the ARM core library, `qemu-system-arm` and, for the
//! Raspberry Pi Pico, rp2040js. This module finds or installs them.
//!
//! [`ready`] only searches for the tools. [`set_up`] provides the missing ones and changes nothing
//! on the system. It gets the core library by `rustup target add`, or else it unpacks Debian's
//! compiler and sources into `rust` in the target folder. It unpacks QEMU from Debian's packages
//! into `qemu` there. Both ways build the same firmware with the same flags. Only Node.js, which
//! runs rp2040js, is installed on the system, and only after the user has agreed ([`Consent`]).
//!
//! All functions but [`find`] may end the process if the project's folder is not found, as
//! [`workspace`] does.

mod bring;
mod build;
mod remap;
mod tools;

use std::panic::resume_unwind;
use std::path::{Path, PathBuf, absolute};
use std::process::exit;
use std::sync::OnceLock;
use std::{env, fmt, thread};

use bring::turn;
pub use bring::{Consent, QUICK};
pub use build::CORE_IMAGES;
pub use tools::find;
use tools::{CORE_PACKAGES, Emulator, FromSource, QEMU, QEMU_AARCH64, QEMU_RISCV};

use crate::boards::Board;
use console::cli::{REFUSED, Refused, complain};

/// The compiler's targets, one for each kind of core: Cortex-M0+, Cortex-M3 and Cortex-M4F.
pub const TARGETS: [&str; 3] = [
    "thumbv6m-none-eabi",
    "thumbv7m-none-eabi",
    "thumbv7em-none-eabihf",
];

/// The compiler's target for the application in a web page.
pub const WASM: &str = "wasm32-unknown-unknown";

/// The tools that build and run programs for a target.
///
/// Its builds show progress on stderr, and write below `firmware` in the target folder. Cargo may
/// load crates from the network. A build that takes more than 30 minutes is stopped, which is an
/// error.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Toolchain {
    /// Debian's compiler. It is used if rustup has no ready-made core library.
    from_source: Option<FromSource>,
    /// The emulator of the core: QEMU, or Node.js for WebAssembly. It is empty after
    /// [`set_up_web`].
    pub qemu: PathBuf,
}

/// Returns the error of a command that lacks a tool: a line with the reason and the remedy. The
/// command `setup` is omitted from the remedy if it `is_tried` already.
fn missing(is_tried: bool, what: &str, why: &str, setup: &str, by_hand: &str) -> Refused {
    let setup = if is_tried {
        String::new()
    } else {
        format!("run {setup}, or ")
    };
    Refused::because(format_args!("{what} is missing: {why}; {setup}{by_hand}"))
}

/// Returns the tools for the boards in QEMU, the core library of all [`TARGETS`] and QEMU 6.0 or
/// newer, if both are present. Installs nothing, and searches once per process: a later call
/// repeats the first result, even after [`set_up`]. The refusal has a line for each missing tool,
/// with the remedy.
pub fn ready() -> Result<Toolchain, Refused> {
    static READY: OnceLock<Result<Toolchain, Refused>> = OnceLock::new();
    READY.get_or_init(|| both(false, &TARGETS, arm)).clone()
}

/// Returns the tools of [`ready`] and provides the missing ones, with a report of each on stderr.
/// This loads packages from the network, each tool within about 20 minutes, and writes to the
/// target folder. Two set-ups at the same time take turns: the second one waits without a limit. A
/// later call finds the tools and loads nothing again.
///
/// Refused if the folder for temporary files (`TMPDIR`, or else `/tmp`) is not writable, or if a
/// tool is missing and cannot be provided; the refusal has a line for each, with the remedy. While
/// a tool is missing, it is also refused if the target folder cannot be made or locked.
pub fn set_up() -> Result<Toolchain, Refused> {
    check_temporary_folder()?;
    ready().or_else(|_| {
        let _turn = turn()?;
        both(true, &TARGETS, arm)
    })
}

/// Returns the tools and the application of a board, and provides what is missing.
///
/// QEMU is fetched while the application is built, because the former waits for the network and the
/// latter for the processor. It is provided for the Pico, too, which does not run in it. The second
/// element is the ELF file, as of [`Toolchain::build_for`]. Errors are refusals as in [`set_up`],
/// and a build that fails.
pub fn set_up_and_build(board: &Board) -> anyhow::Result<(Toolchain, PathBuf)> {
    check_temporary_folder()?;
    if let Ok(toolchain) = ready() {
        let elf = toolchain.build_for(board)?;
        return Ok((toolchain, elf));
    }

    // QEMU is fetched in a thread of its own; its result is needed only after the build.
    let _turn = turn()?;
    let (core, elf, qemu) = thread::scope(|scope| {
        let qemu = scope.spawn(|| arm(true));
        let core = core(true, &TARGETS);
        let elf = core.clone().map(|from_source| {
            let compiler = Toolchain {
                from_source,
                qemu: PathBuf::new(),
            };
            compiler.build_for(board)
        });
        let qemu = qemu.join().unwrap_or_else(|panic| resume_unwind(panic));
        (core, elf, qemu)
    });
    Ok((joined(core, qemu)?, elf??))
}

/// Refuses a folder for temporary files that does not exist or is not writable.
fn check_temporary_folder() -> Result<(), Refused> {
    let refused = |_| {
        Refused::because(format_args!(
            "TMPDIR={}: not a folder one can write to",
            env::temp_dir().display()
        ))
    };
    tempfile::tempdir().map_err(refused).map(drop)
}

/// Returns the core library and the emulator for another target, and provides them if necessary.
///
/// QEMU emulates Linux for targets `riscv32imac-*` and `aarch64-*`. Node.js runs `wasm32-*`; if it
/// is missing, the user is asked ([`Consent::Ask`]). Any other target, also another RISC-V, counts
/// as an ARM microcontroller, and QEMU emulates a board for it. A target that does not exist may be
/// noticed by the build only.
///
/// Refusals are as in [`set_up`], but the folder for temporary files is not checked, and the target
/// folder is always made and locked, which waits for any other set-up.
pub fn set_up_for(target: &str) -> Result<Toolchain, Refused> {
    let emulator = match target.split('-').next() {
        Some("wasm32") => |installs: bool| tools::node(installs.then_some(Consent::Ask)),
        Some("aarch64") => |installs| qemu(installs, &QEMU_AARCH64),
        Some("riscv32imac") => |installs| qemu(installs, &QEMU_RISCV),
        _ => arm,
    };
    let _turn = turn()?;
    both(true, &[target], emulator)
}

/// Returns the core library for the application in a web page ([`WASM`]), and provides it if
/// necessary. The page needs no emulator, and the field `qemu` is empty. Refusals are as in
/// [`set_up_for`].
pub fn set_up_web() -> Result<Toolchain, Refused> {
    let _turn = turn()?;
    both(true, &[WASM], |_| Ok(PathBuf::new()))
}

/// Returns the program of a Chromium that prints its version: `chromium`, `google-chrome` or
/// `chromium-headless-shell` from `PATH`, or the one in the target folder. If there is none,
/// Debian's is unpacked into the target folder, within 3 minutes. Waits for any other set-up
/// without a limit. Refused if there is none then, or the target folder cannot be made or locked.
pub fn set_up_chromium() -> Result<PathBuf, Refused> {
    let _turn = turn()?;
    let by_hand = "install this system's package chromium";
    tools::chromium().map_err(|why| missing(true, "Chromium", &why, SETUP, by_hand))
}

/// Returns the core library of these targets and an emulator, or a line for each that is missing.
fn both(
    installs: bool,
    targets: &[&str],
    emulator: fn(bool) -> Result<PathBuf, Refused>,
) -> Result<Toolchain, Refused> {
    joined(core(installs, targets), emulator(installs))
}

/// Returns the compiler that builds the core library, or `None` if the library is ready-made.
fn core(installs: bool, targets: &[&str]) -> Result<Option<FromSource>, Refused> {
    let packages = format!(
        "run rustup target add {}, or as root apt-get install {}",
        targets.join(" "),
        CORE_PACKAGES.join(" ")
    );
    tools::core(installs, targets)
        .map_err(|why| missing(installs, "Rust's core library", &why, SETUP, &packages))
}

/// Returns both, or the lines that name the missing ones.
fn joined(
    core: Result<Option<FromSource>, Refused>,
    emulator: Result<PathBuf, Refused>,
) -> Result<Toolchain, Refused> {
    match (core, emulator) {
        (Ok(from_source), Ok(qemu)) => Ok(Toolchain { from_source, qemu }),
        (Err(core), Err(qemu)) => Err(Refused::because(format_args!("{core}\n{qemu}"))),
        (Err(missing), _) | (_, Err(missing)) => Err(missing),
    }
}

/// The command that provides the tools.
const SETUP: &str = "cargo setup";

/// Finds or provides QEMU for the boards.
fn arm(installs: bool) -> Result<PathBuf, Refused> {
    qemu(installs, &QEMU)
}

/// Finds or provides an emulator of the QEMU project.
fn qemu(installs: bool, emulator: &Emulator) -> Result<PathBuf, Refused> {
    let by_hand = format!(
        "install this system's package {} (Homebrew: qemu)",
        emulator.package
    );
    tools::qemu(installs, emulator)
        .map_err(|why| missing(installs, emulator.program, &why, SETUP, &by_hand))
}

/// Returns the program Node.js, version 18 or newer, if it and the emulator of the Raspberry Pi
/// Pico are present. Installs nothing, and searches in every call. A missing or old tool is
/// refused, with the remedy.
pub fn ready_for_pico() -> Result<PathBuf, Refused> {
    tools::rp2040js(None)
}

/// Returns the program Node.js and provides it and the emulator of the Pico if necessary. Asks the
/// user on the terminal before Node.js or npm is installed on the system; without a terminal, or if
/// the answer is no, they are not. The emulator is fetched without a question. Refusals are as in
/// [`set_up_pico_with`].
pub fn set_up_pico() -> Result<PathBuf, Refused> {
    set_up_pico_with(Consent::Ask)
}

/// Returns the program Node.js and provides it and the emulator of the Pico if necessary, with this
/// consent of the user. Node.js and npm are installed on the system by apt-get, as root only. npm
/// then fetches the emulator into `host-tests/emulator/rp2040`, for which no consent is needed,
/// within 2 minutes. If something is missing, this waits for any other set-up without a limit. A
/// tool that cannot be provided is refused, and so is a target folder that cannot be made or
/// locked.
pub fn set_up_pico_with(consent: Consent) -> Result<PathBuf, Refused> {
    ready_for_pico().or_else(|_| {
        let _turn = turn()?;
        tools::rp2040js(Some(consent))
    })
}

impl fmt::Display for Toolchain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.from_source {
            None => writeln!(
                f,
                "ARM core library: ready-made, for {}",
                TARGETS.join(", ")
            )?,
            Some(FromSource { rustc, linker, .. }) => {
                writeln!(
                    f,
                    "ARM core library: built from source by {}, linked by rust-lld of {}",
                    rustc.display(),
                    linker.display()
                )?;
            }
        }
        write!(f, "QEMU: {}", self.qemu.display())
    }
}

/// The files that identify the workspace. No folder above or next to it has all of them.
const MARKS: [&str; 3] = [
    "kernel/Cargo.toml",
    "firmware/Cargo.toml",
    "host-tests/Cargo.toml",
];

/// Returns the project's folder, which contains `kernel`, `firmware` and `host-tests`.
///
/// The folder is searched at run time, because a checkout may be moved or copied with its programs
/// already built. The search starts at the package that cargo runs (`CARGO_MANIFEST_DIR`), then at
/// the current folder, then at this program, and proceeds upwards. A later call returns the same.
/// If it finds no folder, the process prints one line and ends with exit code 2.
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

/// Returns the workspace that contains `start`.
fn above(start: &Path) -> Option<PathBuf> {
    let is_it = |folder: &&Path| MARKS.iter().all(|mark| folder.join(mark).is_file());
    start.ancestors().find(is_it).map(Path::to_owned)
}

/// Returns the absolute path of the folder of everything built: `CARGO_TARGET_DIR` as for cargo,
/// relative to the current folder, or, if that is unset or empty, `target` in the workspace. It
/// need not exist yet. Without the variable it may end the process as [`workspace`] does.
pub fn target() -> PathBuf {
    let chosen = env::var_os("CARGO_TARGET_DIR").filter(|folder| !folder.is_empty());
    chosen
        .and_then(|folder| absolute(folder).ok())
        .unwrap_or_else(|| workspace().join("target"))
}
