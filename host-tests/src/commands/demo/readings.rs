//! What a board has sent: the latest numbers, a little of their past for the terminal, and whether all was well.

use std::time::{Duration, Instant};

use double_pendulum::plan::Stepping;
use firmware::config::TICK_RATE;
use firmware::display::PanelReport;
use firmware::protocol::{Frame, Status};
use firmware::scenes::Report;

use super::comparison::Comparison;
use crate::emulator::qemu::LogLine;
use crate::link::{self, Counts};

/// Frames whose past is kept, 12 s of them: no more is shown.
const KEPT: usize = 12 * TICK_RATE as usize;
/// The time over which frames per second are counted.
const RATE_SPAN: Duration = Duration::from_secs(1);

#[derive(Debug, Default)]
pub struct Readings {
    pub frame: Option<Frame>,
    /// The angles that the motion started from, degrees; `None` until the board has told.
    pub start: Option<[f32; 2]>,
    pub counts: Counts,
    /// The state of the panel when the board was last asked.
    pub panel: Option<PanelReport>,
    /// What was told since the motion began, oldest first; empty where none is shown.
    pub past: Vec<Report>,
    pub lines: Vec<LogLine>,
    pub comparison: Comparison,
    /// Whether what they mean is shown in their place.
    pub help: bool,
    pub(super) arrivals: Vec<Instant>,
    frames: u64,
    greatest_energy_error: f32,
    /// Of all scenes and restarts together, s.
    simulated: f64,
}

impl Readings {
    /// Takes a frame that has just arrived; whether to ask the board what it plays.
    pub fn frame(&mut self, frame: Frame) -> bool {
        let last = self.frame.replace(frame);
        let report = frame.report;
        let before =
            last.filter(|last| last.scene == frame.scene && last.report.time <= report.time);
        if before.is_none() {
            self.start = None;
            self.past.clear();
        }
        self.simulated += report.time - before.map_or(0.0, |last| last.report.time);
        self.greatest_energy_error = self.greatest_energy_error.max(report.energy_error.abs());
        self.frames += 1;
        if frame.scene.has_angles() && self.past.last().is_none_or(|last| report.time > last.time) {
            self.past.push(report);
        }
        self.past.drain(..self.past.len().saturating_sub(KEPT));
        self.arrivals.push(Instant::now());
        self.arrivals
            .retain(|arrival| arrival.elapsed() <= RATE_SPAN);
        self.comparison.frame(&frame)
    }

    /// Takes what the board says that it plays: frames tell of rod 1 only.
    pub fn status(&mut self, status: &Status) {
        self.start = Some(status.settings.degrees);
        self.comparison.status(status);
    }

    /// Takes the state of the panel. It is told in the log when it becomes another.
    pub fn panel(&mut self, report: &PanelReport) {
        let before = self.panel.replace(*report);
        let is_news = before.is_none_or(|before| {
            before.state != report.state || link::is_well(&before) != link::is_well(report)
        });
        if let Some(text) = link::panel(report).filter(|_| is_news) {
            let level = if link::is_well(report) {
                "info"
            } else {
                "warn"
            };
            self.lines.push(LogLine {
                level: Some(level.to_owned()),
                text: format!("panel: {text}"),
                place: String::new(),
            });
        }
    }

    pub fn rate(&self) -> usize {
        self.arrivals
            .iter()
            .filter(|arrival| arrival.elapsed() <= RATE_SPAN)
            .count()
    }

    /// What is not well of an emulated board; empty if all is.
    pub fn faults(&self) -> Vec<String> {
        let Counts { damaged, lost, .. } = self.counts;
        let dropped = self.frame.map_or(0, |last| last.dropped);
        let findings = [
            (damaged > 0, format!("{damaged} messages arrived damaged")),
            (lost > 0, format!("{lost} frames were lost on the way")),
            (dropped > 0, format!("{dropped} frames were dropped")),
        ];
        let findings = findings
            .into_iter()
            .filter_map(|(found, text)| found.then_some(text));
        findings
            .chain(
                self.lines
                    .iter()
                    .filter(|line| line.is_bad())
                    .map(LogLine::to_string),
            )
            .collect()
    }

    pub fn report(&self) -> String {
        let Self {
            frames,
            simulated,
            greatest_energy_error,
            counts,
            comparison,
            ..
        } = self;
        let last = self.frame.unwrap_or_default();
        let panel = self
            .panel
            .as_ref()
            .and_then(link::panel)
            .map_or(String::new(), |panel| {
                format!("panel                 {panel}\n")
            });
        format!(
            "frames                {frames}\n\
             simulated time        {simulated:.3} s\n\
             shown                 {}\n\
             largest energy error  {greatest_energy_error:.1e}\n\
             CRC errors            {}\n\
             lost frames           {}\n\
             dropped frames        {}\n\
             {panel}\
             bits                  {comparison}",
            stepping(&last.report),
            counts.damaged,
            counts.lost,
            last.dropped
        )
    }
}

/// How a frame is computed and until when such frames are right, in one line.
pub fn stepping(
    &Report {
        stepping,
        horizon,
        is_looking,
        ..
    }: &Report,
) -> String {
    let stepping = match stepping {
        None => "nothing to plan".to_owned(),
        Some(Stepping { method, steps: 0 }) => method.to_string(),
        Some(Stepping { method, steps: 1 }) => format!("{method}, a step to a frame"),
        Some(Stepping { method, steps }) => format!("{method}, {steps} steps to a frame"),
    };
    if horizon.is_infinite() {
        return stepping;
    }
    let at_least = if is_looking { "at least " } else { "" };
    format!("{stepping}, right to half a pixel until {at_least}{horizon:.1} s")
}

#[cfg(test)]
mod tests {
    use firmware::scenes::SceneName;

    use super::*;

    #[test]
    fn the_simulated_time_is_that_of_all_restarts_and_scenes() {
        let mut readings = Readings::default();
        let [page, butterfly] = [SceneName::Page, SceneName::Butterfly];
        for (scene, times) in [
            (page, &[0.25, 0.5, 0.5, 0.125, 0.75][..]),
            (butterfly, &[0.875, 1.0]),
        ] {
            for &time in times {
                readings.frame(Frame {
                    scene,
                    report: Report {
                        time,
                        ..Report::default()
                    },
                    ..Frame::default()
                });
            }
        }
        assert!(
            readings.report().contains("simulated time        2.250 s"),
            "{}",
            readings.report()
        );
    }
}
