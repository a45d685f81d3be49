//! QEMU's control channel (QMP), with a line of JSON in each direction: the screenshot, the
//! buttons, and QEMU's own console.
//!
//! Source: QEMU, docs/interop/qmp-spec.rst. The protocol has a greeting, `qmp_capabilities`, and
//! then commands, each answered by `return` or `error`. Events can arrive at any time.

use std::io::Write;
use std::ops::Range;

use anyhow::bail;
use firmware::app::Key;
use serde_json::{Value, json};

use super::{Machine, Screenshot};

/// QEMU's names for one instruction per translation block: since version 8.1, and before.
const SINGLE_STEP: [&str; 2] = ["one-insn-per-tb", "singlestep"];

impl Machine {
    /// Returns the panel's picture, also while the machine is stopped. While the board runs, it may
    /// be a mixture of two frames. An error means that QEMU has ended, or that the machine has no
    /// panel of 128 x 64 pixels.
    pub fn screenshot(&mut self) -> anyhow::Result<Screenshot> {
        self.execute("screendump", json!({ "filename": "panel.ppm" }))?;
        Screenshot::from_ppm(&std::fs::read(self.folder.path().join("panel.ppm"))?)
    }

    /// Returns the bytes of memory or registers at these addresses, as the processor sees them. The
    /// board may be running. To read a register has the same effects as a read by the program, such
    /// as the removal of a received byte. An error means that QEMU has ended or that there is
    /// nothing at one of the addresses. An empty or reversed range gives no bytes.
    pub fn read(&mut self, addresses: Range<u32>) -> anyhow::Result<Vec<u8>> {
        let range =
            json!({ "val": addresses.start, "size": addresses.len(), "filename": "memory" });
        self.execute("memsave", range)?;
        Ok(std::fs::read(self.folder.path().join("memory"))?)
    }

    /// Presses (`down`) or releases a button, without waiting until the firmware has seen it. To
    /// repeat the same has no effect. Call [`Self::wake_keys`] once before the first call, because
    /// the emulated buttons work only after that; this is not checked. While the machine is
    /// stopped, and on a board without buttons
    /// ([`Board::has_panel`](crate::boards::Board::has_panel)), QEMU refuses the event, which is an
    /// error.
    pub fn set_key(&mut self, key: Key, down: bool) -> anyhow::Result<()> {
        // QEMU knows the board's select as the left control key.
        let code = if key == Key::Select {
            "ctrl"
        } else {
            key.name()
        };
        let key = json!({ "type": "qcode", "data": code });
        let event = json!({ "type": "key", "data": { "down": down, "key": key } });
        self.execute("input-send-event", json!({ "events": [event] }))
            .map(drop)
    }

    /// Presses and releases every button once, so quickly that the firmware, which debounces them,
    /// sees no command, unless the host is delayed. It is called after the start, before the first
    /// [`Self::set_key`], because the emulated hardware of the LM3S6965 distinguishes a released
    /// button from a pressed one only after that. A machine that is stopped or has no buttons is an
    /// error, as for [`Self::set_key`].
    pub fn wake_keys(&mut self) -> anyhow::Result<()> {
        Key::ALL.iter().try_for_each(|&key| {
            [true, false]
                .into_iter()
                .try_for_each(|down| self.set_key(key, down))
        })
    }

    /// Switches QEMU's mode of one instruction per translation block; `switch` is `on` or `off`. An
    /// error means that QEMU refuses it, or has ended.
    pub(super) fn single_step(&mut self, switch: &str) -> anyhow::Result<()> {
        let [name, name_before] = SINGLE_STEP.map(|name| format!("{name} {switch}"));
        // An old QEMU refuses the new name.
        self.console(&name).or_else(|_| self.console(&name_before))
    }

    /// Sends a line to QEMU's own console and waits until it is executed. Any text that it replies
    /// is an error, so a command that prints something cannot be used. The error contains the text.
    pub(super) fn console(&mut self, line: &str) -> anyhow::Result<()> {
        let said = self.execute("human-monitor-command", json!({ "command-line": line }))?;
        let reason = said.as_str().unwrap_or_default().trim();
        if reason.is_empty() {
            Ok(())
        } else {
            bail!("QEMU refuses console: {reason}")
        }
    }

    /// Executes a command of QMP, waits for its result and returns it, such as `{}`. An error means
    /// that QEMU refuses the command, and has its reason, or that QEMU has ended. Events before the
    /// result are dropped.
    pub(super) fn execute(&mut self, command: &str, arguments: Value) -> anyhow::Result<Value> {
        writeln!(
            self.monitor.sender,
            "{}",
            json!({ "execute": command, "arguments": arguments })
        )?;
        // Lines that are neither a result nor an error are events.
        loop {
            let line = self.wait_until(|machine| machine.monitor.stream.line())?;
            let mut answer: Value = serde_json::from_str(&line)?;
            if let Some(result) = answer.get_mut("return") {
                return Ok(result.take());
            }
            if let Some(reason) = answer.pointer("/error/desc").and_then(Value::as_str) {
                bail!("QEMU refuses {command}: {reason}");
            }
        }
    }
}
