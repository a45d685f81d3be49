//! QEMU's control channel (QMP), a line of JSON each way: the screenshot, the buttons, the end.
//!
//! Source: QEMU, docs/interop/qmp-spec.rst: a greeting, `qmp_capabilities`, then commands, each answered by `return` or `error`;
//! events come at any time.

use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;

use anyhow::{anyhow, bail, ensure};
use firmware::app::Key;
use serde_json::{Value, json};

use super::Screenshot;

#[derive(Debug)]
pub(super) struct Monitor(BufReader<UnixStream>);

impl Monitor {
    pub(super) fn new(socket: UnixStream) -> anyhow::Result<Self> {
        let mut monitor = Self(BufReader::new(socket));
        monitor.heard()?;
        monitor.execute("qmp_capabilities", json!({}))?;
        Ok(monitor)
    }

    /// The panel's screenshot, by way of a file in `folder`.
    pub(super) fn screenshot(&mut self, folder: &Path) -> anyhow::Result<Screenshot> {
        let path = folder.join("panel.ppm");
        self.execute("screendump", json!({ "filename": path.to_string_lossy() }))?;
        Screenshot::from_ppm(&std::fs::read(path)?)
    }

    /// Presses a button, or lets go of it. Lost while the machine stands still.
    pub(super) fn set_key(&mut self, key: Key, down: bool) -> anyhow::Result<()> {
        // QEMU knows the board's select as the left control key.
        let code = if key == Key::Select { "ctrl" } else { key.name() };
        let event = json!({ "type": "key", "data": { "down": down, "key": { "type": "qcode", "data": code } } });
        self.execute("input-send-event", json!({ "events": [event] })).map(drop)
    }

    /// Gives QEMU's own console a line; what it says to that.
    pub(super) fn console(&mut self, line: &str) -> anyhow::Result<String> {
        let said = self.execute("human-monitor-command", json!({ "command-line": line }))?;
        Ok(said.as_str().unwrap_or_default().to_owned())
    }

    pub(super) fn resume(&mut self) -> anyhow::Result<()> {
        self.execute("cont", json!({})).map(drop)
    }

    fn execute(&mut self, command: &'static str, arguments: Value) -> anyhow::Result<Value> {
        let line = json!({ "execute": command, "arguments": arguments });
        // Not as it is: a broken pipe would be taken for a closed output, which is no failure.
        writeln!(self.0.get_mut(), "{line}").map_err(|error| anyhow!("QEMU's control channel: {error}"))?;
        loop {
            let mut answer = self.heard()?;
            if let Some(result) = answer.get_mut("return") {
                return Ok(result.take());
            }
            if let Some(reason) = answer.pointer("/error/desc").and_then(Value::as_str) {
                bail!("QEMU refuses {command}: {reason}");
            }
        }
    }

    fn heard(&mut self) -> anyhow::Result<Value> {
        let mut line = String::new();
        ensure!(self.0.read_line(&mut line)? > 0, "QEMU's control channel is closed");
        Ok(serde_json::from_str(&line)?)
    }
}
