//! A session with a board, with or without a terminal: it receives messages, chooses the scene and
//! records the panel.

use anyhow::bail;
use firmware::config::TICK_RATE;
use firmware::motion::Settings;
use firmware::protocol::{Answer, Command, Field, Frame, Status, ToHost};

use super::DemoOptions;
use super::options::PanelChoice;
use super::panel::Recording;
use super::readings::{Readings, warning};
use boards::console::cli::Refused;
use boards::link::{Counts, Port, refusal};
use boards::pico::PicoMachine;
use boards::qemu::{LogLine, Machine, Screenshot};

pub enum Source {
    /// A board in QEMU, by the host's clock.
    Live(Machine),
    /// A board in QEMU, from frame to frame.
    Lockstep(Machine),
    Pico(Box<PicoMachine>),
    Port(Port),
}

impl Source {
    /// Returns the messages since the last call, after a run to the next frame in lockstep.
    fn messages(&mut self) -> anyhow::Result<Vec<ToHost>> {
        match self {
            Self::Live(machine) => machine.messages(),
            Self::Lockstep(machine) => machine.run_to_frame(),
            Self::Pico(machine) => machine.run_to_frame(),
            Self::Port(port) => port.messages(),
        }
    }

    /// A port never fails here; it reports by its notices.
    fn send(&mut self, request: u16, command: Command) -> anyhow::Result<()> {
        match self {
            Self::Live(machine) | Self::Lockstep(machine) => machine.send(request, command)?,
            Self::Pico(machine) => machine.send(request, command)?,
            Self::Port(port) => port.send(request, command),
        }
        Ok(())
    }

    /// The notices of a port are shown as warnings, because a board at a port sends no log.
    pub fn log_and_counts(&mut self) -> (Vec<LogLine>, Counts) {
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

const KEY: u16 = 0;
const SETUP: u16 = 1;

pub const SPEEDS: [f32; 9] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 4.0];

pub fn faster(now: f32) -> Option<f32> {
    SPEEDS.into_iter().find(|speed| *speed > now)
}

pub fn slower(now: f32) -> Option<f32> {
    SPEEDS.into_iter().rev().find(|speed| *speed < now)
}

/// A session with one board, which gets the user's options after its first frame and whose panel is
/// recorded from the first frame of the requested scene on. If the user gives a motion, the
/// requested scene begins when the board has reported that motion.
pub struct Session<'a> {
    options: &'a DemoOptions,
    pub source: Source,
    pub readings: Readings,
    pub screenshot: Screenshot,
    recording: Option<Recording>,
    now: Option<i64>,
    begun: Option<i64>,
    before: i64,
    awaited: Option<Settings>,
    question: u16,
}

impl<'a> Session<'a> {
    pub fn new(options: &'a DemoOptions, source: Source, recording: Option<Recording>) -> Self {
        let readings = Readings::default();
        let screenshot = Screenshot::from_pages(&[]);
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

    /// The path of a port is also known if it was found by `auto`.
    pub fn name(&self) -> &str {
        if let Source::Port(port) = &self.source {
            &port.name
        } else {
            self.options.board.name
        }
    }

    /// Receives the board's messages, and draws the panel of a board whose panel cannot be read. A
    /// port that is gone or silent is no error: it is opened again when it is back.
    pub fn hear(&mut self) -> anyhow::Result<()> {
        for message in self.source.messages()? {
            match message {
                ToHost::Answer(question, Answer::Status(status)) => self.status(question, &status),
                ToHost::Answer(SETUP, Answer::Refused(field)) => bail!(self.refused(field)),
                ToHost::Answer(_, Answer::Refused(field)) => self.readings.lines.push(warning(
                    format!("no effect here: the board refuses {}", key_refusal(field)),
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
        let (lines, counts) = self.source.log_and_counts();
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

        // The time counts from the first frame of the user's scene.
        let is_scene = self.options.scene.is_none_or(|scene| scene == frame.scene);
        if is_scene && self.awaited.is_none() {
            self.begun.get_or_insert(now);
        }

        // Once a second the state of a real board's panel is requested, and the speed of a board
        // that is late, which may have lowered it.
        let is_asked = self.source.is_port() || frame.dropped > 0;
        let is_time = is_asked && frame.sequence.is_multiple_of(TICK_RATE);
        if self.readings.frame(*frame) || is_time {
            self.ask()
        } else {
            Ok(())
        }
    }

    /// Asks the board for its status.
    fn ask(&mut self) -> anyhow::Result<()> {
        self.source.send(self.question, Command::Ask)
    }

    /// The answer to the latest question alone contains the speed that was set last.
    fn status(&mut self, question: u16, status: &Status) {
        self.awaited.take_if(|start| *start == status.settings);
        if question == self.question {
            self.readings.speed = Some(status.speed);
        }
        self.readings.status(status);

        if self.source.is_port() {
            self.readings.panel(&status.panel);
        }
    }

    fn refused(&self, field: Field) -> Refused {
        let option = match field {
            Field::Method => "--method",
            Field::Speed => "--speed",
            Field::M1 | Field::M2 => "--masses",
            Field::L1 | Field::L2 => "--lengths",
            Field::G => "--gravity",
            Field::A1 | Field::A2 => "--angles",
            Field::W1 | Field::W2 => "--velocities",
            Field::Panel => "--panel, --turn or --dim",
            _ => "--scene",
        };
        let name = self.name();
        let field = refusal(field);
        Refused::because(format_args!(
            "{name}: the board refuses this {field}; change {option}"
        ))
    }

    /// Sends the command of a key.
    pub fn command(&mut self, command: Command) -> anyhow::Result<()> {
        self.source.send(KEY, command)
    }

    /// Sets the speed that `next` returns. It counts at once; the board's answer corrects it if the
    /// board refuses.
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

    fn begin(&mut self, first: &Frame) -> anyhow::Result<()> {
        // The board restarts its scene only if the user's options require it.
        let scene = self.options.scene.unwrap_or(first.scene);
        self.awaited = self.options.start(scene)?;
        let play = match self.awaited {
            Some(settings) => Some(Command::Play(scene, settings)),
            None => (scene != first.scene).then_some(Command::Choose(scene)),
        };

        let panel = match self.options.panel {
            Some(PanelChoice::Oled(controller)) => Some(Command::Panel(controller)),
            _ => None,
        };
        let turn = self.options.turn.map(Command::Turn);
        let dim = self.options.dim.map(Command::Dim);
        let method = self.options.method.map(Command::Method);
        let speed = self.options.speed()?.map(|value| Command::Set {
            field: Field::Speed,
            value,
        });
        for command in [panel, turn, dim, play, method, speed]
            .into_iter()
            .flatten()
        {
            self.source.send(SETUP, command)?;
        }
        Ok(())
    }

    pub fn has_panel(&self) -> bool {
        self.options.board.has_panel && !self.source.is_port()
    }

    /// Takes a screenshot of an emulated panel, and records it if a picture is due.
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

    pub fn take_recording(&mut self) -> Option<Recording> {
        self.recording.take()
    }

    fn tick(&self, frame: &Frame) -> i64 {
        self.before + i64::from(frame.sequence) + i64::from(frame.dropped)
    }

    /// Returns the seconds of the board's clock since the requested scene began, also across
    /// restarts of the board.
    pub fn seconds(&self) -> f64 {
        self.begun.zip(self.now).map_or(0.0, |(begun, now)| {
            (now - begun + 1) as f64 / f64::from(TICK_RATE)
        })
    }
}

fn key_refusal(field: Field) -> String {
    match field {
        Field::M1 | Field::M2 | Field::Dt => {
            "a motion so fast; the mass ratio shown is the limit here".to_owned()
        }
        Field::A1 | Field::A2 => "an angle beyond the one shown".to_owned(),
        field => format!("this {}", refusal(field)),
    }
}

#[cfg(test)]
mod tests {
    use firmware::config::GREATEST_SPEED;

    use super::*;

    /// The keys go from a speed in between to its neighbours.
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

        assert_eq!([faster(0.25), slower(0.25)], [Some(0.5), Some(0.2)]);
    }
}
