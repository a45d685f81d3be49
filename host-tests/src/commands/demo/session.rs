//! A board being watched, with a terminal or without: its messages are taken, its scene chosen, its panel recorded.

use anyhow::bail;
use firmware::config::TICK_RATE;
use firmware::protocol::{Answer, Command, Field, Frame, ToHost};

use super::DemoOptions;
use super::panel::Recording;
use super::readings::Readings;
use crate::emulator::pico::PicoMachine;
use crate::emulator::qemu::{LogLine, Machine, Screenshot};
use crate::link::{Counts, Port, refusal};

/// Where the stream comes from.
pub enum Source {
    /// Emulated by QEMU, its clock the host's.
    Live(Machine),
    /// Emulated by QEMU, run from frame to frame.
    Lockstep(Machine),
    Pico(Box<PicoMachine>),
    Port(Port),
}

impl Source {
    /// The messages since the last call; of one that goes frame by frame those up to the next.
    fn messages(&mut self) -> anyhow::Result<Vec<ToHost>> {
        match self {
            Self::Live(machine) => machine.messages(),
            Self::Lockstep(machine) => machine.run_to_frame(),
            Self::Pico(machine) => machine.run_to_frame(),
            Self::Port(port) => Ok(port.messages()),
        }
    }

    pub fn send(&mut self, command: Command) -> anyhow::Result<()> {
        match self {
            Self::Live(machine) | Self::Lockstep(machine) => machine.send(0, command)?,
            Self::Pico(machine) => machine.send(0, command)?,
            Self::Port(port) => port.send(0, command),
        }
        Ok(())
    }

    /// The lines of the log since the last call, of a port what has become of it; and what the link has been through.
    pub fn told(&mut self) -> (Vec<LogLine>, Counts) {
        let notice = |text: String| LogLine {
            level: Some("warn".to_owned()),
            text,
            place: String::new(),
        };
        match self {
            Self::Live(machine) | Self::Lockstep(machine) => (machine.lines(), machine.counts()),
            Self::Pico(machine) => (machine.lines(), machine.counts()[0]),
            Self::Port(port) => (
                port.notices.drain(..).map(notice).collect(),
                port.inbox.counts,
            ),
        }
    }

    pub fn is_port(&self) -> bool {
        matches!(self, Self::Port(_))
    }
}

pub struct Session<'a> {
    options: &'a DemoOptions,
    pub source: Source,
    pub readings: Readings,
    pub screenshot: Screenshot,
    recording: Option<Recording>,
    /// The latest tick, and that of the first frame of the scene that was asked for.
    now: Option<i64>,
    begun: Option<i64>,
    /// What the ticks of the board's clock lack since it was last restarted.
    before: i64,
}

impl<'a> Session<'a> {
    pub fn new(options: &'a DemoOptions, source: Source, recording: Option<Recording>) -> Self {
        let (readings, screenshot) = (Readings::default(), Screenshot::from_pages(&[]));
        Self {
            options,
            source,
            readings,
            screenshot,
            recording,
            now: None,
            begun: None,
            before: 0,
        }
    }

    pub fn name(&self) -> &str {
        if let Source::Port(port) = &self.source {
            &port.name
        } else {
            self.options.board.name
        }
    }

    /// Takes what the board has sent. The host asks what it plays as often as the comparison wants to know.
    pub fn hear(&mut self) -> anyhow::Result<()> {
        for message in self.source.messages()? {
            match message {
                ToHost::Answer(_, Answer::Status(status)) => {
                    self.readings.status(&status);
                    // An emulated panel is seen itself.
                    if self.source.is_port() {
                        self.readings.panel(&status.panel);
                    }
                }
                ToHost::Answer(_, Answer::Refused(Field::Panel)) => {
                    bail!("--panel: the board refuses: {}", refusal(Field::Panel))
                }
                ToHost::Frame(frame) => self.frame(&frame)?,
                _ => {}
            }
        }
        while let Some(frame) = self.readings.comparison.follow() {
            if !self.has_panel() {
                self.screenshot = self.readings.comparison.panel(&frame);
                self.record(self.tick(&frame))?;
            }
        }
        let (lines, counts) = self.source.told();
        self.readings.lines.extend(lines);
        self.readings.counts = counts;
        Ok(())
    }

    fn frame(&mut self, frame: &Frame) -> anyhow::Result<()> {
        match self.now {
            None => self.begin(frame)?,
            // The board counts from 0 again.
            Some(now) if self.tick(frame) < now => self.before += now + 1 - self.tick(frame),
            Some(_) => {}
        }
        let now = *self.now.insert(self.tick(frame));
        if self.options.scene.is_none_or(|scene| scene == frame.scene) {
            self.begun.get_or_insert(now);
        }
        // A real board is asked once a second for its panel.
        let is_time = self.source.is_port() && frame.sequence.is_multiple_of(TICK_RATE);
        if self.readings.frame(*frame) || is_time {
            self.source.send(Command::Ask)
        } else {
            Ok(())
        }
    }

    /// Has the board play what was asked for, by the method asked for.
    fn begin(&mut self, first: &Frame) -> anyhow::Result<()> {
        if let Some(scene) = self.options.scene.filter(|scene| *scene != first.scene) {
            self.source.send(Command::Choose(scene))?;
        }
        if let Some(controller) = self.options.panel {
            self.source.send(Command::Panel(controller))?;
        }
        self.options
            .check_method(self.options.scene.unwrap_or(first.scene))?;
        self.options
            .method
            .map_or(Ok(()), |method| self.source.send(Command::Method(method)))
    }

    /// Whether the host can see a panel; else it draws one.
    fn has_panel(&self) -> bool {
        self.options.board.has_panel && !self.source.is_port()
    }

    pub fn look(&mut self) -> anyhow::Result<()> {
        if self.has_panel() {
            self.screenshot = match &mut self.source {
                Source::Live(machine) | Source::Lockstep(machine) => machine.screenshot()?,
                Source::Pico(machine) => machine.screenshot()?,
                Source::Port(_) => return Ok(()),
            };
            self.now.map_or(Ok(()), |now| self.record(now))?;
        }
        Ok(())
    }

    /// Whether the animation wants a screenshot of the latest tick.
    pub fn is_recording_due(&self) -> bool {
        self.begun
            .and(self.now)
            .zip(self.recording.as_ref())
            .is_some_and(|(now, recording)| recording.is_due(now))
    }

    fn record(&mut self, tick: i64) -> anyhow::Result<()> {
        let recording = self
            .recording
            .as_mut()
            .filter(|_| self.begun.is_some_and(|begun| tick >= begun));
        recording.map_or(Ok(()), |recording| recording.add(&self.screenshot, tick))
    }

    /// The tick of the board's clock that a frame belongs to, those before its restarts included.
    fn tick(&self, frame: &Frame) -> i64 {
        self.before + i64::from(frame.sequence) + i64::from(frame.dropped)
    }

    /// Seconds since the first frame of the scene that was asked for, that one included.
    pub fn seconds(&self) -> f64 {
        self.begun.zip(self.now).map_or(0.0, |(begun, now)| {
            (now - begun + 1) as f64 / f64::from(TICK_RATE)
        })
    }
}
