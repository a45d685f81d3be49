//! Builds of the firmware.
//!
//! A build writes below `firmware` in the target folder, shows its progress on stderr, and ignores
//! variables such as `RUSTFLAGS`.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use std::{env, fs};

use anyhow::{anyhow, ensure};

use super::run::quick_output;
use super::{TARGETS, Toolchain, WASM, remap, set_up_for, target, workspace};

use crate::board::{Board, PICO, every_board};
use crate::console::progress::Progress;
use crate::process::run_watched;

/// The environment variable with the images that the parent process has built, separated like the
/// folders of `PATH`.
pub const BUILT_IMAGES: &str = "BUILT_IMAGES";

/// The images that are up to date. Calling cargo for one again would take half a second.
fn built() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    static BUILT: LazyLock<Mutex<BTreeSet<PathBuf>>> = LazyLock::new(|| {
        let before = env::var_os(BUILT_IMAGES).unwrap_or_default();
        Mutex::new(env::split_paths(&before).collect())
    });
    BUILT.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns the value of [`BUILT_IMAGES`] for child processes.
pub fn built_images() -> Result<OsString, env::JoinPathsError> {
    env::join_paths(built().iter())
}

/// Returns the image, which it builds unless that has been done.
fn once(
    image: PathBuf,
    build: impl FnOnce(&Path) -> anyhow::Result<()>,
) -> anyhow::Result<PathBuf> {
    let is_built = built().contains(&image);
    if !is_built {
        build(&image)?;
        built().insert(image.clone());
    }
    Ok(image)
}

/// The binaries that run on every target.
const AHEAD: [&str; 2] = ["lm3s6965evb", "measure"];

/// For a slow, busy machine, including downloads.
const LIMIT: Duration = Duration::from_secs(1800);

/// The time for which the name of a crate is shown.
const SILENCE: Duration = Duration::from_secs(5);

/// The prefixes of environment variables that are removed for the firmware's build. `cargo run` and
/// `cargo test` set such variables, and a user may have set them for host programs.
const FOREIGN: [&str; 5] = ["CARGO", "RUST", "LD_LIBRARY_PATH", "DYLD_", "OUT_DIR"];
const OURS: [&str; 5] = [
    "CARGO_HOME",
    "CARGO_HTTP_",
    "CARGO_NET_",
    "CARGO_REGISTR",
    "RUSTUP_",
];

/// An image of the golden bits: its target, and the processor's name if the image is built with the
/// kernel's feature `double-fpu`.
pub type CoreImage = (&'static str, Option<&'static str>);

/// The images of the golden bits on cores that no board has. The first runs on the boards' QEMU.
/// The next two need the core library of their target, and the last three another emulator, too.
pub const CORE_IMAGES: [CoreImage; 6] = [
    ("thumbv7em-none-eabihf", Some("cortex-m7")),
    ("thumbv8m.main-none-eabihf", None),
    ("thumbv8m.main-none-eabihf", Some("cortex-m55")),
    ("wasm32-unknown-unknown", None),
    ("riscv32imac-unknown-none-elf", None),
    ("aarch64-unknown-none", None),
];

impl Toolchain {
    fn cargo(&self) -> Command {
        let mut command = Command::new("cargo");
        // The variables of the surrounding cargo would change the flags of this build.
        for (name, _) in env::vars_os().filter(|(name, _)| is_foreign(name)) {
            command.env_remove(name);
        }
        command
            .current_dir(workspace())
            .env("RUSTUP_AUTO_INSTALL", "0");
        command
    }

    /// The folder is separate from that of the host's programs, so that neither build waits for the
    /// other.
    fn folder() -> PathBuf {
        target().join("firmware")
    }

    pub fn build_for(&self, board: &Board) -> anyhow::Result<PathBuf> {
        if board.binary != PICO.binary {
            return self.build(board.binary, board.target);
        }

        // Cargo gives the Pico's images for all panels the same name. Each is copied before the
        // next build replaces it.
        static TURN: Mutex<()> = Mutex::new(());
        let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        let name = board.panel.name();
        let copy = format!("{}-{name}", board.binary);
        once(Self::image(board.target, &copy), |copy| {
            let mut command = self.for_targets("build", &[board.target])?;
            command.args(["--bin", board.binary, "--features", board.feature]);
            command.env("PANEL", name);
            self.finish(
                command,
                &format!("building {}-{name} for {}", board.binary, board.target),
            )?;
            fs::copy(Self::image(board.target, board.binary), copy)?;
            Ok(())
        })
    }

    fn image(target: &str, binary: &str) -> PathBuf {
        Self::folder().join(target).join("release").join(binary)
    }

    pub fn build(&self, binary: &str, target: &str) -> anyhow::Result<PathBuf> {
        once(Self::image(target, binary), |_| {
            let feature = every_board()
                .find(|board| board.binary == binary)
                .map_or("", |board| board.feature);
            let mut command = self.for_targets("build", &[target])?;
            command.args(["--bin", binary, "--features", feature]);
            self.finish(command, &format!("building {binary} for {target}"))
        })
    }

    pub fn build_cores(&self, target: &str, double: Option<&str>) -> anyhow::Result<PathBuf> {
        // Cargo gives both kinds of image the same name. Each is copied before the next build
        // replaces it.
        static TURN: Mutex<()> = Mutex::new(());
        let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        let extension = if target == WASM { ".wasm" } else { "" };
        let binary = format!("cores{extension}");
        let copy = format!("{}-{binary}", double.unwrap_or("any"));
        once(Self::image(target, &copy), |copy| {
            let mut command = self.for_targets("build", &[target])?;
            command
                .args(["--bin", "cores", "--no-default-features"])
                .args(["--features", "cores"])
                // Only the results of these images matter, not their speed or debug information. So
                // they compile in two thirds of the time.
                .env("CARGO_PROFILE_RELEASE_DEBUG", "false")
                .env("CARGO_PROFILE_RELEASE_LTO", "off")
                .env("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "16");
            if let Some(cpu) = double {
                // These flags replace the flags of the configuration, which are for a Cortex-M4F.
                command.args(["--features", "double-pendulum-kernel/double-fpu"]);
                command.env("RUSTFLAGS", format!("-Ctarget-cpu={cpu}"));
            }
            let name = double.unwrap_or(target);
            self.finish(command, &format!("building cores for {name}"))?;
            fs::copy(Self::image(target, &binary), copy)?;
            Ok(())
        })
    }

    /// Builds the [`CORE_IMAGES`] ahead. It stops before the first target whose tools cannot be
    /// provided: without a network, each further one would wait for it.
    pub fn build_cores_ahead(&self) -> anyhow::Result<()> {
        CORE_IMAGES
            .into_iter()
            .take_while(|(target, _)| set_up_for(target).is_ok())
            .try_for_each(|(target, double)| self.build_cores(target, double).map(drop))
    }

    /// Builds the programs of `kernel/minimal` as a user of the kernel would: in an empty folder,
    /// so that the settings of this repository do not apply.
    pub fn build_minimal(&self, target: &str) -> anyhow::Result<PathBuf> {
        // A folder of their own: where the firmware's flags differ, cargo would compile the common
        // crates anew for either, and link all images again.
        let folder = Self::folder().join("minimal");
        once(folder.join(target).join("release"), |_| {
            self.compile_minimal(target, &folder)
        })
    }

    fn compile_minimal(&self, target: &str, folder: &Path) -> anyhow::Result<()> {
        let nowhere = tempfile::tempdir()?;
        let package = workspace().join("kernel/minimal");
        let flags = remap::flags().map_err(|error| anyhow!(error))?;

        let mut sysroot = Command::new("rustc");
        sysroot
            .args(["--print", "sysroot"])
            .current_dir(workspace());
        let sysroot = quick_output(&mut sysroot).map_err(|error| anyhow!(error))?;
        let suffix = env::consts::EXE_SUFFIX;
        let rustc = PathBuf::from(sysroot.trim()).join(format!("bin/rustc{suffix}"));
        let mut command = self.cargo();
        command.env("RUSTC", rustc);
        command
            .current_dir(&nowhere)
            .args(["build", "--release", "--locked", "--target", target])
            .arg("--manifest-path")
            .arg(package.join("Cargo.toml"))
            .arg("--config")
            .arg(package.join(".cargo/config.toml"))
            .args(["--config", &format!("target.{target}.rustflags={flags:?}")])
            .env("CARGO_TARGET_DIR", folder);
        self.finish(
            command,
            &format!("building the minimal programs for {target}"),
        )
    }

    pub fn build_web(&self) -> anyhow::Result<PathBuf> {
        once(Self::image(WASM, "web.wasm"), |_| {
            let mut command = self.for_targets("build", &[WASM])?;
            command
                .args(["--bin", "web", "--features", "web"])
                .env("CARGO_PROFILE_RELEASE_DEBUG", "false")
                .env("CARGO_PROFILE_RELEASE_STRIP", "symbols");
            self.finish(command, "building the application for the browser")
        })
    }

    pub fn build_ahead(&self) -> anyhow::Result<()> {
        let mut command = self.for_targets("build", &TARGETS)?;
        command.args(AHEAD.iter().flat_map(|binary| ["--bin", binary]));
        self.finish(command, "building the firmware for all targets")?;
        let all = TARGETS.map(|target| AHEAD.map(|binary| Self::image(target, binary)));
        built().extend(all.into_iter().flatten());
        Ok(())
    }

    pub fn build_applications_ahead(&self) -> anyhow::Result<()> {
        every_board().try_for_each(|board| self.build_for(board).map(drop))
    }

    pub fn build_minimal_ahead(&self) -> anyhow::Result<()> {
        TARGETS
            .iter()
            .try_for_each(|target| self.build_minimal(target).map(drop))
    }

    pub fn check(&self) -> anyhow::Result<()> {
        for target in TARGETS {
            // All boards of a target are checked at once, with the features of all.
            let features = every_board()
                .filter(|board| board.target == target)
                .map(|board| board.feature);
            let features = features.collect::<Vec<_>>().join(",");

            let mut command = self.for_targets("clippy", &[target])?;
            command.args(["--bins", "--features", &features]);
            command.args(["--", "--deny", "warnings"]);
            self.finish(command, &format!("checking the firmware for {target}"))?;
        }
        Ok(())
    }

    fn for_targets(&self, what: &str, targets: &[&str]) -> anyhow::Result<Command> {
        let flags = remap::flags().map_err(|error| anyhow!(error))?;
        let mut command = self.cargo();
        command
            .args([what, "--release", "--package", "firmware"])
            .env("CARGO_TARGET_DIR", Self::folder());
        for target in targets {
            // These flags are added to the configured flags. A TOML string has the same escapes as
            // a Rust string. The name of a target may contain a dot; cargo does not find the flags
            // if it is quoted.
            let flags = format!("target.{target}.rustflags={flags:?}");
            command.args(["--target", target, "--config", &flags]);
        }
        Ok(command)
    }

    fn finish(&self, mut command: Command, doing: &str) -> anyhow::Result<()> {
        // Cargo names each crate when it begins, so a name soon says nothing about the present.
        let progress = Progress::start(doing);
        let mut named = Instant::now();
        let output = run_watched(&mut command, LIMIT, |line| {
            let name = line.and_then(crate_of);
            if name.is_some() {
                named = Instant::now();
            }
            let is_old = named.elapsed() > SILENCE;
            progress.alive(name.or(is_old.then_some("the last crate takes longest")));
        })?;
        ensure!(
            output.status.success(),
            "the firmware does not build\n{}",
            output.stderr
        );
        Ok(())
    }
}

/// Returns the crate that this line of Cargo names.
fn crate_of(line: &str) -> Option<&str> {
    let mut words = line.split_whitespace();
    let is_named = matches!(words.next(), Some("Compiling" | "Checking"));
    let name = words.next().filter(|_| is_named)?;
    words.next().map(|_version| name)
}

fn is_foreign(name: &OsString) -> bool {
    let begins = |with: &&str| name.as_encoded_bytes().starts_with(with.as_bytes());
    FOREIGN.iter().any(begins) && !OURS.iter().any(begins)
}
