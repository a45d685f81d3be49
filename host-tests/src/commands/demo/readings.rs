//! What a board has sent: the latest numbers, a little of their past for the terminal, and whether all was well.

use std::time::{Duration, Instant};

use double_pendulum::Method;
use double_pendulum::plan::Stepping;
use firmware::config::{PROCESSOR, PROCESSORS, TICK_RATE};
use firmware::display::PanelReport;
use firmware::protocol::{Frame, Status};
use firmware::scenes::{Report, SceneName};

use super::comparison::Comparison;
use super::options::usable;
use crate::emulator::qemu::LogLine;
use crate::link::{self, Counts};

/// Frames whose past is kept, 12 s of them: no more is shown.
const KEPT: usize = 12 * TICK_RATE as usize;
/// The time over which frames per second are counted.
const RATE_SPAN: Duration = Duration::from_secs(1);

/// What is shown of the help.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Help {
    #[default]
    Hidden,
    Keys,
    Numbers,
}

impl Help {
    /// The page that the key `?` leads to.
    pub fn next(self) -> Self {
        match self {
            Self::Hidden => Self::Keys,
            Self::Keys => Self::Numbers,
            Self::Numbers => Self::Hidden,
        }
    }
}

/// A line of the host's own in the log.
pub fn warning(text: String) -> LogLine {
    LogLine {
        level: Some("warn".to_owned()),
        text,
        place: String::new(),
    }
}

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
    /// The page of the help that is shown in their place.
    pub help: Help,
    /// Simulated time per real time, as the board has reported it or as it was set since.
    pub speed: Option<f32>,
    /// The latest scene of which it was said that it does not use the requested method.
    unusable: Option<(SceneName, Method)>,
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
        self.note_method(status);
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

    /// Says once in a scene that it does not use the requested method.
    fn note_method(&mut self, status: &Status) {
        let Some(method) = status.method else {
            self.unusable = None;
            return;
        };
        let processor = PROCESSORS
            .get(usize::from(status.processor))
            .copied()
            .unwrap_or(PROCESSOR);
        let Err(reason) = usable(method, status.scene, &status.settings, processor) else {
            self.unusable = None;
            return;
        };
        let unusable = Some((status.scene, method));
        if self.unusable != unusable {
            self.unusable = unusable;
            self.lines
                .push(warning(format!("{method} is not used here: {reason}")));
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
            stepping(&last),
            counts.damaged,
            counts.lost,
            last.dropped
        )
    }
}

/// Returns how a frame is computed, and how long such frames are accurate, in one line.
pub fn stepping(frame: &Frame) -> String {
    let Report {
        horizon,
        is_looking,
        time,
        ..
    } = frame.report;
    let computed = computed(frame);
    if horizon.is_infinite() {
        return computed;
    }
    let accuracy = if is_looking && horizon <= 0.0 {
        "accuracy not known yet".to_owned()
    } else if is_looking {
        format!("accurate to half a pixel until at least {horizon:.1} s")
    } else if is_linear(frame) {
        format!("leaves the exact motion at {horizon:.2} s")
    } else if time > f64::from(horizon) {
        format!("was accurate to half a pixel until {horizon:.1} s")
    } else {
        format!("accurate to half a pixel until {horizon:.1} s")
    };
    format!("{computed} · {accuracy}")
}

/// Returns the method, with its number of steps.
fn computed(frame: &Frame) -> String {
    match frame.report.stepping {
        None => "no planning in this scene".to_owned(),
        Some(Stepping { method, .. }) if is_linear(frame) => method.to_string(),
        Some(Stepping { method, steps: 1 }) => format!("{method} · 1 step per frame"),
        Some(Stepping { method, steps }) => format!("{method} · {steps} steps per frame"),
    }
}

fn is_linear(frame: &Frame) -> bool {
    let method = frame.report.stepping.map(|stepping| stepping.method);
    method == Some(Method::ClosedFormF32)
}

#[cfg(test)]
mod tests {
    use firmware::scenes::SceneName;

    use super::*;

    #[test]
    fn a_method_that_a_scene_does_not_use_is_said_once() {
        let mut readings = Readings::default();
        let status = |scene: SceneName, method| Status {
            scene,
            settings: scene.first_settings(),
            method,
            processor: PROCESSOR.code,
            paused: false,
            steps: 0,
            speed: 1.0,
            panel: PanelReport::default(),
        };
        let method = Method::Rk4Fixed32;
        let scenes = [
            SceneName::Page,
            SceneName::SmallEqual,
            SceneName::Flips,
            SceneName::Page,
            SceneName::Flips,
        ];
        for scene in scenes {
            // Restarts say nothing new.
            readings.status(&status(scene, Some(method)));
            readings.status(&status(scene, Some(method)));
        }
        let said: Vec<_> = readings.lines.iter().map(ToString::to_string).collect();
        let small = "warn  rk4-fixed32 is not used here: scene small-1 always uses closed-form-f32";
        let flips = "warn  rk4-fixed32 is not used here: scene flips has no choice of methods";
        assert_eq!(said, [small, flips, flips]);
    }

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
