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

const SINGLE_STEP: [&str; 2] = ["one-insn-per-tb", "singlestep"];

impl Machine {
    /// While the board runs, it may be a mixture of two frames.
    pub fn screenshot(&mut self) -> anyhow::Result<Screenshot> {
        self.execute("screendump", json!({ "filename": "panel.ppm" }))?;
        Screenshot::from_ppm(&std::fs::read(self.folder.path().join("panel.ppm"))?)
    }

    pub fn read(&mut self, addresses: Range<u32>) -> anyhow::Result<Vec<u8>> {
        let range =
            json!({ "val": addresses.start, "size": addresses.len(), "filename": "memory" });
        self.execute("memsave", range)?;
        Ok(std::fs::read(self.folder.path().join("memory"))?)
    }

    /// [`Self::wake_keys`] must have been called once.
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

    /// Presses and releases every button, too quickly for the firmware to see a command. The
    /// emulated hardware distinguishes a released button from a pressed one only after that.
    pub fn wake_keys(&mut self) -> anyhow::Result<()> {
        Key::ALL.iter().try_for_each(|&key| {
            [true, false]
                .into_iter()
                .try_for_each(|down| self.set_key(key, down))
        })
    }

    pub(super) fn single_step(&mut self, switch: &str) -> anyhow::Result<()> {
        let [name, name_before] = SINGLE_STEP.map(|name| format!("{name} {switch}"));
        // An old QEMU refuses the new name.
        self.console(&name).or_else(|_| self.console(&name_before))
    }

    /// Any text that the console replies is an error.
    pub(super) fn console(&mut self, line: &str) -> anyhow::Result<()> {
        let said = self.execute("human-monitor-command", json!({ "command-line": line }))?;
        let reason = said.as_str().unwrap_or_default().trim();
        if reason.is_empty() {
            Ok(())
        } else {
            bail!("QEMU refuses console: {reason}")
        }
    }

    pub(super) fn execute(&mut self, command: &str, arguments: Value) -> anyhow::Result<Value> {
        writeln!(
            self.monitor.sender,
            "{}",
            json!({ "execute": command, "arguments": arguments })
        )?;
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
