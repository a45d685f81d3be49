//! One line for each thing that is missing: why, and what to type.

use super::TARGETS;
use super::detect::{CORE_PACKAGES, QEMU, find};

/// The package managers whose commands are known; only the first is ever run.
const MANAGERS: [(&str, &str); 4] = [
    ("apt-get", "sudo apt-get install --no-install-recommends"),
    ("dnf", "sudo dnf install"),
    ("pacman", "sudo pacman -S"),
    ("brew", "brew install"),
];
/// What brings anything that is missing, unless it has been tried.
pub(super) const SET_UP: &str = "cargo setup, or ";

/// What the firmware needs from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    /// The core library for all targets.
    ArmCore,
    /// The emulator.
    Qemu,
    /// What runs the emulator of the Pico, and fetches it.
    Node,
    /// The emulator of the Pico.
    Rp2040js,
}

/// What is missing, a line each.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct SetupError(pub(super) String);

impl SetupError {
    /// The parts that are missing, each with the reason, and what comes `first` of what brings it.
    pub(super) fn missing(parts: impl IntoIterator<Item = (Part, String)>, first: &str) -> Self {
        let manager = MANAGERS.into_iter().find(|(program, _)| find(program).is_some());
        let lines = parts.into_iter().map(|(part, why)| {
            let (name, by_hand) = part.told(manager);
            format!("{name} is missing: {why}; what brings it: {first}{by_hand}")
        });
        Self(lines.collect::<Vec<_>>().join("\n"))
    }
}

impl Part {
    /// Its name, and what to type on a system with this package manager, if it is known.
    fn told(self, manager: Option<(&str, &str)>) -> (&'static str, String) {
        let (program, install) = manager.unwrap_or(("", "this system's packages like"));
        let of_brew = |its, others| if program == "brew" { its } else { others };
        match self {
            Part::ArmCore => {
                let packages = format!(", or {install} {}", CORE_PACKAGES.join(" "));
                let or_packages = if program == "apt-get" { packages } else { String::new() };
                ("the ARM core library", format!("rustup target add {}{or_packages}", TARGETS.join(" ")))
            }
            Part::Qemu => (QEMU, format!("{install} {}", of_brew("qemu", QEMU))),
            Part::Node => ("Node.js, of 18 or newer, with npm", format!("{install} {}", of_brew("node", "nodejs npm"))),
            Part::Rp2040js => ("the emulator of the Raspberry Pi Pico", "npm ci --prefix host-tests/rp2040".to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_system_is_told_its_own_command() {
        let told = |part: Part| MANAGERS.map(|manager| part.told(Some(manager)).1);
        assert_eq!(
            told(Part::Qemu),
            [
                "sudo apt-get install --no-install-recommends qemu-system-arm",
                "sudo dnf install qemu-system-arm",
                "sudo pacman -S qemu-system-arm",
                "brew install qemu"
            ]
        );
        let [debian, fedora, ..] = told(Part::ArmCore);
        assert_eq!(fedora, "rustup target add thumbv6m-none-eabi thumbv7m-none-eabi thumbv7em-none-eabihf");
        let packages = "sudo apt-get install --no-install-recommends rustc-web cargo-web rust-web-src";
        assert_eq!(debian, format!("{fedora}, or {packages}"));
        assert_eq!(Part::Node.told(None).1, "this system's packages like nodejs npm");
    }

    #[test]
    fn each_missing_part_has_one_line_with_its_reason() {
        let missing = [(Part::Qemu, "no network".to_owned()), (Part::Rp2040js, "no npm".to_owned())];
        let text = SetupError::missing(missing, SET_UP).to_string();
        let [qemu, pico] = text.lines().collect::<Vec<_>>()[..] else { panic!("{text}") };
        assert!(qemu.starts_with("qemu-system-arm is missing: no network; what brings it: cargo setup, or "), "{qemu}");
        assert!(pico.ends_with("no npm; what brings it: cargo setup, or npm ci --prefix host-tests/rp2040"), "{pico}");
    }
}
