//! Why the tools are not there, and the command that brings them.

use std::fmt;

use super::TARGETS;

/// What the firmware needs from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    /// The core library for both targets.
    ArmCore,
    /// The emulator.
    Qemu,
    /// What runs the emulator of the Pico.
    Node,
    /// The emulator of the Pico.
    Rp2040js,
}

/// The Debian packages that build the ARM core library.
pub(super) const CORE_PACKAGES: [&str; 3] = ["rustc-web", "cargo-web", "rust-web-src"];
/// The Debian package of the emulator.
pub(super) const QEMU_PACKAGE: &str = "qemu-system-arm";

/// The Debian packages that run the emulator of the Pico, and fetch it.
pub(super) const NODE_PACKAGES: [&str; 2] = ["nodejs", "npm"];

/// A system's package manager: its program, and the commands that bring QEMU and Node.js.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Manager {
    pub(super) program: &'static str,
    qemu: &'static str,
    node: &'static str,
}

/// The package managers known by name; only the first is ever run.
pub(super) const MANAGERS: [Manager; 4] = [
    Manager {
        program: "apt-get",
        qemu: "sudo apt-get install --no-install-recommends qemu-system-arm",
        node: "sudo apt-get install --no-install-recommends nodejs npm",
    },
    Manager { program: "dnf", qemu: "sudo dnf install qemu-system-arm", node: "sudo dnf install nodejs npm" },
    Manager { program: "pacman", qemu: "sudo pacman -S qemu-system-arm", node: "sudo pacman -S nodejs npm" },
    Manager { program: "brew", qemu: "brew install qemu", node: "brew install node" },
];

/// What is missing, why it could not be had, and what to type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SetupError {
    pub(super) missing: Vec<Part>,
    pub(super) reason: String,
    pub(super) manager: Option<Manager>,
    /// Whether the set-up has already done what it can.
    pub(super) tried: bool,
}

impl SetupError {
    /// For a reason that nothing brought would change.
    pub(super) fn of(reason: String) -> Self {
        Self { missing: Vec::new(), reason, manager: None, tried: true }
    }
}

impl fmt::Display for SetupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<_> = self.missing.iter().map(|part| part.name()).collect();
        if names.is_empty() {
            return write!(f, "cannot set up: {}", self.reason);
        }
        let verb = if names.len() == 1 { "is" } else { "are" };
        write!(f, "{} {verb} missing: {}. What brings it:", names.join(" and "), self.reason)?;
        if !self.tried {
            write!(f, "\n  cargo setup   or else by hand:")?;
        }
        for part in &self.missing {
            for command in part.commands(self.manager) {
                write!(f, "\n  {command}")?;
            }
        }
        Ok(())
    }
}

impl std::error::Error for SetupError {}

impl Part {
    fn name(self) -> &'static str {
        match self {
            Part::ArmCore => "the ARM core library",
            Part::Qemu => "qemu-system-arm",
            Part::Node => "Node.js, of 18 or newer, with npm",
            Part::Rp2040js => "the emulator of the Raspberry Pi Pico",
        }
    }

    /// What to type on this system; on an unknown one, the choice.
    fn commands(self, manager: Option<Manager>) -> Vec<String> {
        match (self, manager) {
            (Part::Qemu, Some(manager)) => vec![manager.qemu.to_owned()],
            (Part::Qemu, None) => MANAGERS.iter().map(|manager| manager.qemu.to_owned()).collect(),
            (Part::Node, Some(manager)) => vec![manager.node.to_owned()],
            (Part::Node, None) => MANAGERS.iter().map(|manager| manager.node.to_owned()).collect(),
            (Part::Rp2040js, _) => vec!["npm ci --prefix host-tests/rp2040".to_owned()],
            (Part::ArmCore, manager) => {
                let rustup = format!("rustup target add {}", TARGETS.join(" "));
                let apt = format!("sudo apt-get install --no-install-recommends {}", CORE_PACKAGES.join(" "));
                match manager {
                    Some(manager) if manager == MANAGERS[0] => vec![format!("{rustup}   or   {apt}")],
                    _ => vec![rustup],
                }
            }
        }
    }
}
