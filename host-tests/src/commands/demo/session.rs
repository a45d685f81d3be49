//! A board being watched, with a terminal or without: its messages are taken, its scene chosen, its panel recorded.

use anyhow::bail;
use firmware::config::TICK_RATE;
use firmware::motion::Settings;
use firmware::protocol::{Answer, Command, Field, Frame, Status, ToHost};

use super::DemoOptions;
use super::panel::Recording;
use super::readings::{Readings, warning};
use crate::console::cli::Refused;
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

    fn send(&mut self, request: u16, command: Command) -> anyhow::Result<()> {
        match self {
            Self::Live(machine) | Self::Lockstep(machine) => machine.send(request, command)?,
            Self::Pico(machine) => machine.send(request, command)?,
            Self::Port(port) => port.send(request, command),
        }
        Ok(())
    }

    /// The lines of the log since the last call, of a port what has become of it; and what the link has been through.
    pub fn told(&mut self) -> (Vec<LogLine>, Counts) {
        match self {
            Self::Live(machine) | Self::Lockstep(machine) => (machine.lines(), machine.counts()),
            Self::Pico(machine) => (machine.lines(), machine.counts()[0]),
            Self::Port(port) => (
                port.notices.drain(..).map(warning).collect(),
                port.inbox.counts,
            ),
        }
    }

    pub fn is_port(&self) -> bool {
        matches!(self, Self::Port(_))
    }
}

/// The number of a command that comes from a key.
const KEY: u16 = 0;
/// The number of the commands by which the board is set up. A refusal of one of them ends the
/// session.
const SETUP: u16 = 1;

/// The speeds that the keys step through, simulated time per real time: from the least to the
/// greatest there is.
const SPEEDS: [f32; 9] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 4.0];

/// Returns the next greater speed; `None` at the greatest.
pub fn faster(now: f32) -> Option<f32> {
    SPEEDS.into_iter().find(|speed| *speed > now)
}

/// Returns the next smaller speed; `None` at the least.
pub fn slower(now: f32) -> Option<f32> {
    SPEEDS.into_iter().rev().find(|speed| *speed < now)
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
    /// The start that the user has given, until the board reports that it shows it.
    awaited: Option<Settings>,
    /// The number of the latest question for the board's status.
    question: u16,
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
            awaited: None,
            question: 0,
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
                ToHost::Answer(question, Answer::Status(status)) => self.status(question, &status),
                ToHost::Answer(SETUP, Answer::Refused(field)) => bail!(self.refused(field)),
                ToHost::Answer(_, Answer::Refused(field)) => self.readings.lines.push(warning(
                    format!("no effect here: the board refuses this {}", refusal(field)),
                )),
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
        let is_scene = self.options.scene.is_none_or(|scene| scene == frame.scene);
        if is_scene && self.awaited.is_none() {
            self.begun.get_or_insert(now);
        }
        // A real board is asked once a second for its panel.
        let is_time = self.source.is_port() && frame.sequence.is_multiple_of(TICK_RATE);
        if self.readings.frame(*frame) || is_time {
            self.ask()
        } else {
            Ok(())
        }
    }

    fn ask(&mut self) -> anyhow::Result<()> {
        self.source.send(self.question, Command::Ask)
    }

    /// Takes the answer to a question. Only the latest one knows the speed that was set last.
    fn status(&mut self, question: u16, status: &Status) {
        self.awaited.take_if(|start| *start == status.settings);
        if question == self.question {
            self.readings.speed = Some(status.speed);
        }
        self.readings.status(status);
        // An emulated panel is visible itself.
        if self.source.is_port() {
            self.readings.panel(&status.panel);
        }
    }

    /// Returns why the board cannot be set up as the options say.
    fn refused(&self, field: Field) -> Refused {
        let option = match field {
            Field::Method => "--method",
            Field::Speed => "--speed",
            Field::M1 | Field::M2 => "--masses",
            Field::L1 | Field::L2 => "--lengths",
            Field::G => "--gravity",
            Field::A1 | Field::A2 => "--angles",
            Field::W1 | Field::W2 => "--velocities",
            Field::Panel => "--panel",
            _ => "--scene",
        };
        let (name, field) = (self.name(), refusal(field));
        Refused::because(format_args!(
            "{name}: the board refuses this {field}; change {option}"
        ))
    }

    /// Sends the command of a key.
    pub fn command(&mut self, command: Command) -> anyhow::Result<()> {
        self.source.send(KEY, command)
    }

    /// Sets another speed, which `next` returns for the present one, once the board has reported
    /// that.
    pub fn change_speed(&mut self, next: fn(f32) -> Option<f32>) -> anyhow::Result<()> {
        let Some(speed) = self.readings.speed.and_then(next) else {
            return Ok(());
        };
        self.readings.speed = Some(speed);
        self.question = self.question.wrapping_add(1);
        self.command(Command::Set {
            field: Field::Speed,
            value: speed.into(),
        })?;
        self.ask()
    }

    /// Sets the board up as the options say.
    fn begin(&mut self, first: &Frame) -> anyhow::Result<()> {
        let scene = self.options.scene.unwrap_or(first.scene);
        self.awaited = self.options.start(scene)?;
        let play = match self.awaited {
            Some(settings) => Some(Command::Play(scene, settings)),
            None => (scene != first.scene).then_some(Command::Choose(scene)),
        };
        let panel = self.options.panel.map(Command::Panel);
        let method = self.options.method.map(Command::Method);
        let speed = self.options.speed()?.map(|value| Command::Set {
            field: Field::Speed,
            value,
        });
        for command in [panel, play, method, speed].into_iter().flatten() {
            self.source.send(SETUP, command)?;
        }
        Ok(())
    }

    /// Whether the host can see a panel; else it draws one.
    pub fn has_panel(&self) -> bool {
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

    /// Returns the animation, which is complete.
    pub fn take_recording(&mut self) -> Option<Recording> {
        self.recording.take()
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

#[cfg(test)]
mod tests {
    use firmware::config::GREATEST_SPEED;

    use super::*;

    #[test]
    fn the_speed_keys_step_from_the_least_to_the_greatest_and_back() {
        let steps = |from, next: fn(f32) -> Option<f32>| {
            let mut speeds = vec![from];
            while let Some(speed) = next(speeds[speeds.len() - 1]) {
                speeds.push(speed);
            }
            speeds
        };
        let up = steps(0.01, faster);
        assert_eq!(up, SPEEDS);
        assert_eq!(up.last(), Some(&(GREATEST_SPEED as f32)));
        let mut down = steps(GREATEST_SPEED as f32, slower);
        down.reverse();
        assert_eq!(down, SPEEDS);
        // From a speed of the user's own.
        assert_eq!([faster(0.25), slower(0.25)], [Some(0.5), Some(0.2)]);
    }
}
