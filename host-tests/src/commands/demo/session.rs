//! A board being watched, with a terminal or without: its messages are taken, its scene chosen, its panel recorded.

use std::fs;
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::Context;
use firmware::config::TICK_RATE;
use firmware::protocol::{Answer, Command, Frame, ToHost};

use super::DemoOptions;
use super::readings::Readings;
use super::record::{Recording, png};
use super::source::Source;
use crate::emulator::qemu::Screenshot;

/// How far the emulated Pico may be behind a real one before it lets that go.
const LATE: Duration = Duration::from_millis(100);

pub struct Session<'a> {
    options: &'a DemoOptions,
    pub source: Source<'a>,
    pub readings: Readings,
    pub screenshot: Screenshot,
    recording: Option<Recording>,
    /// The latest tick, and that of the first frame of the scene that was asked for.
    now: Option<i64>,
    begun: Option<i64>,
    /// What the ticks of the board's clock lack since it was last restarted.
    before: i64,
    /// When the emulated Pico's next frame is due, which in a terminal goes no faster than a real one.
    due: Option<Instant>,
}

impl<'a> Session<'a> {
    pub fn new(options: &'a DemoOptions, source: Source<'a>, recording: Option<Recording>, is_live: bool) -> Self {
        let (readings, screenshot) = (Readings::default(), Screenshot::from_pages(&[]));
        let due = (is_live && matches!(source, Source::Pico(_))).then(Instant::now);
        Self { options, source, readings, screenshot, recording, now: None, begun: None, before: 0, due }
    }

    /// Takes what the board has sent. The host asks what it plays as often as the comparison wants to know.
    pub fn hear(&mut self) -> anyhow::Result<()> {
        if let Some(due) = &mut self.due {
            sleep(due.saturating_duration_since(Instant::now()));
            // More than this late, and it is not made up for.
            *due = if due.elapsed() > LATE { Instant::now() } else { *due } + Duration::from_secs(1) / TICK_RATE;
        }
        for message in self.source.messages()? {
            match message {
                ToHost::Answer(_, Answer::Status(status)) => self.readings.status(&status),
                ToHost::Frame(frame) => self.frame(&frame)?,
                _ => {}
            }
        }
        while let Some(frame) = self.readings.comparison.follow() {
            if !self.source.has_panel() {
                self.screenshot = self.readings.comparison.panel(&frame);
                self.record(self.tick(&frame))?;
            }
        }
        self.readings.lines.extend(self.source.lines());
        self.readings.counts = self.source.counts();
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
        if self.readings.frame(*frame) { self.source.send(Command::Ask) } else { Ok(()) }
    }

    /// Has the board play, and in the way, what was asked for.
    fn begin(&mut self, first: &Frame) -> anyhow::Result<()> {
        if let Some(scene) = self.options.scene.filter(|scene| *scene != first.scene) {
            self.source.send(Command::Choose(scene))?;
        }
        self.options.check_method(self.options.scene.unwrap_or(first.scene))?;
        self.options.method.map_or(Ok(()), |method| self.source.send(Command::Method(method)))
    }

    pub fn look(&mut self) -> anyhow::Result<()> {
        if let Some(panel) = self.source.panel()? {
            self.screenshot = panel;
            self.now.map_or(Ok(()), |now| self.record(now))?;
        }
        Ok(())
    }

    /// Whether the animation wants a screenshot of the latest tick.
    pub fn is_recording_due(&self) -> bool {
        self.begun.and(self.now).zip(self.recording.as_ref()).is_some_and(|(now, recording)| recording.is_due(now))
    }

    fn record(&mut self, tick: i64) -> anyhow::Result<()> {
        let recording = self.recording.as_mut().filter(|_| self.begun.is_some_and(|begun| tick >= begun));
        recording.map_or(Ok(()), |recording| recording.add(self.screenshot.clone(), tick))
    }

    /// The tick of the board's clock that a frame belongs to, those before its restarts included.
    fn tick(&self, frame: &Frame) -> i64 {
        self.before + i64::from(frame.sequence) + i64::from(frame.dropped)
    }

    /// Seconds since the first frame of the scene that was asked for, that one included.
    pub fn seconds(&self) -> f64 {
        self.begun.zip(self.now).map_or(0.0, |(begun, now)| (now - begun + 1) as f64 / f64::from(TICK_RATE))
    }

    /// What is not well; empty if all is. A board in the hand may drop frames, and its cable may flip bits: both are told, and
    /// neither is a fault.
    pub fn faults(&self) -> Vec<String> {
        let found = if self.source.is_port() { vec![] } else { self.readings.faults() };
        let difference = self.readings.comparison.difference();
        found.into_iter().chain(difference.map(|difference| difference.to_string())).collect()
    }

    pub fn finish(&mut self) -> anyhow::Result<()> {
        self.recording.take().map_or(Ok(()), Recording::finish)?;
        let Some(path) = &self.options.screenshot else { return Ok(()) };
        fs::write(path, png(&self.screenshot)?).with_context(|| format!("cannot write {}", path.display()))
    }
}
