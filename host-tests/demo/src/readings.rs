//! The data that a board has sent, and the faults in it.

use std::time::{Duration, Instant};

use double_pendulum::Method;
use double_pendulum::plan::Stepping;
use firmware::config::{PROCESSOR, PROCESSORS, TICK_RATE};
use firmware::display::PanelReport;
use firmware::motion::Horizon;
use firmware::protocol::{Frame, PlayState, Status};
use firmware::scenes::{LEAST_ENERGY_ERROR, Report, SceneName};

use super::comparison::Comparison;
use super::options::usable;
use boards::link::{self, Counts};
use boards::qemu::LogLine;

const KEPT: usize = 12 * TICK_RATE as usize;
/// A board whose first frame is later than this, s, has played before it was connected.
const BEFORE: f64 = 1.0;
const RATE_SPAN: Duration = Duration::from_secs(1);

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Help {
    #[default]
    Hidden,
    Keys,
    Numbers,
}

impl Help {
    pub fn next(self) -> Self {
        match self {
            Self::Hidden => Self::Keys,
            Self::Keys => Self::Numbers,
            Self::Numbers => Self::Hidden,
        }
    }
}

/// A warning of the host is shown in the board's log.
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
    /// Degrees.
    pub start: Option<[f32; 2]>,
    /// Set by the session.
    pub counts: Counts,
    /// `None` for an emulated board.
    pub panel: Option<PanelReport>,
    /// The reports since the start of the motion, for the charts. Empty in scenes without angles.
    pub past: Vec<Report>,
    /// The board's log and the warnings of the host. A run without a terminal takes a port's
    /// warnings out.
    pub lines: Vec<LogLine>,
    pub comparison: Comparison,
    pub help: Help,
    pub speed: Option<f32>,
    /// The last scene and method that were warned about.
    unusable: Option<(SceneName, Method)>,
    pub(super) arrivals: Vec<Instant>,
    frames: u64,
    /// The largest of all scenes, relative to the energy above rest.
    greatest_energy_error: f32,
    /// The simulated time of all scenes and restarts together, s.
    simulated: f64,
}

const SLOWED: &str = "speed lowered";

impl Readings {
    /// Takes a frame that has just arrived. Returns true if the host must ask for the board's scene
    /// ([`Comparison::frame`]).
    pub fn frame(&mut self, frame: Frame) -> bool {
        let last = self.frame.replace(frame);
        let report = frame.report;
        // A frame of another scene, or of an earlier time, starts a new motion.
        let before =
            last.filter(|last| last.scene == frame.scene && last.report.time <= report.time);
        if before.is_none() {
            self.start = None;
            self.past.clear();
        }

        let seen = match (before, last) {
            (Some(before), _) => before.report.time,
            (None, None) if report.time >= BEFORE => report.time,
            (None, _) => 0.0,
        };
        self.simulated += report.time - seen;
        self.greatest_energy_error = self.greatest_energy_error.max(report.energy_error.abs());
        self.frames += 1;

        // A pause repeats the same time.
        if frame.scene.has_angles() && self.past.last().is_none_or(|last| report.time > last.time) {
            self.past.push(report);
        }
        self.past.drain(..self.past.len().saturating_sub(KEPT));

        self.arrivals.push(Instant::now());
        self.arrivals
            .retain(|arrival| arrival.elapsed() <= RATE_SPAN);
        self.comparison.frame(&frame)
    }

    /// Takes the board's report of its scene, because frames contain the start angle of rod 1 only.
    pub fn status(&mut self, status: &Status) {
        self.start = Some(status.settings.degrees.map(|degrees| degrees as f32));
        self.note_method(status);
        self.comparison.status(status);
    }

    /// Adds a line to the log when the panel changes.
    pub fn panel(&mut self, report: &PanelReport) {
        let before = self.panel.replace(*report);
        let is_news = before.is_none_or(|before| before.state != report.state);
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

    /// Returns the frames of the last second.
    pub fn rate(&self) -> usize {
        self.arrivals
            .iter()
            .filter(|arrival| arrival.elapsed() <= RATE_SPAN)
            .count()
    }

    /// Returns the faults of an emulated board, one text each. At a port, or with the host's clock,
    /// the same numbers need not be faults. A difference of bits is counted elsewhere.
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
                    .filter(|line| line.is_bad() || line.text.starts_with(SLOWED))
                    .map(LogLine::to_string),
            )
            .collect()
    }

    /// Returns the summary of all scenes and restarts. The latest frame has the dropped frames, the
    /// method and the horizon.
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
        let error = if *greatest_energy_error == 0.0 && !last.scene.has_angles() {
            "-".to_owned()
        } else {
            energy_error(*greatest_energy_error, |error| format!("{error:.1e}"))
        };
        format!(
            "frames                {frames}\n\
             simulated time        {simulated:.3} s\n\
             shown                 {}\n\
             largest energy error  {error}\n\
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

/// Returns the method of a frame and its accuracy horizon in words, or the reason and the remedy if
/// the motion has stopped.
pub fn stepping(frame: &Frame) -> String {
    if frame.state == PlayState::Stopped {
        return "this motion is too fast for this chip: change the masses or the angle, or choose \
                another scene or method"
            .to_owned();
    }
    let computed = computed(frame);
    let accuracy = match frame.report.horizon {
        Horizon::Always => return computed,
        Horizon::Undecided => "accuracy not known yet".to_owned(),
        Horizon::AtLeast(time) => format!("accurate to half a pixel until at least {time:.1} s"),
        Horizon::Until(time) if frame.scene.is_linear() => {
            format!("leaves the exact motion by half a pixel at {time:.2} s")
        }
        Horizon::Until(0.0) => "accuracy cannot be predicted here".to_owned(),
        Horizon::Until(time) if frame.report.time > f64::from(time) => {
            format!("was accurate to half a pixel until {time:.1} s")
        }
        Horizon::Until(time) => format!("accurate to half a pixel until {time:.1} s"),
    };
    format!("{computed} · {accuracy}")
}

fn computed(frame: &Frame) -> String {
    if frame.scene.is_linear() {
        return "the linear motion on purpose".to_owned();
    }
    match frame.report.stepping {
        None => "no planning in this scene".to_owned(),
        Some(Stepping { method, steps: 0 }) => method.to_string(),
        Some(Stepping { method, steps: 1 }) => format!("{method} · 1 step per frame"),
        Some(Stepping { method, steps }) => format!("{method} · {steps} steps per frame"),
    }
}

/// Formats an energy error. Below 4e-15 it is `< 4e-15`, because `f64` cannot resolve it.
pub fn energy_error(error: f32, write: impl Fn(f32) -> String) -> String {
    if error.abs() < LEAST_ENERGY_ERROR {
        format!("< {LEAST_ENERGY_ERROR:.0e}")
    } else {
        write(error)
    }
}

#[cfg(test)]
mod tests {
    use double_pendulum::Method;
    use firmware::scenes::SceneName;

    use super::*;

    /// A warning appears once per visit of a scene, and again after another scene in between.
    #[test]
    fn a_method_that_a_scene_does_not_use_is_reported_once() {
        let mut readings = Readings::default();
        let status = |scene: SceneName, method| Status {
            scene,
            settings: scene.first_settings(),
            method,
            processor: PROCESSOR.code,
            state: PlayState::Playing,
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
            readings.status(&status(scene, Some(method)));
            readings.status(&status(scene, Some(method)));
        }
        let said: Vec<_> = readings.lines.iter().map(ToString::to_string).collect();
        let small = "warn  rk4-fixed32 is not used here: scene small-1 always uses closed-form-f32";
        let flips = "warn  rk4-fixed32 is not used here: scene flips has no choice of methods";
        assert_eq!(said, [small, flips, flips]);
    }

    #[test]
    fn horizon_and_stop_are_shown_in_words() {
        let words = |scene, state, horizon| {
            let stepping = Some(Stepping {
                method: Method::Rk4Fixed32,
                steps: 8,
            });
            stepping_of(scene, state, horizon, stepping)
        };
        let page = |horizon| words(SceneName::Page, PlayState::Playing, horizon);
        let head = "rk4-fixed32 · 8 steps per frame ·";
        assert_eq!(
            page(Horizon::Undecided),
            format!("{head} accuracy not known yet")
        );
        assert_eq!(
            page(Horizon::AtLeast(2.5)),
            format!("{head} accurate to half a pixel until at least 2.5 s")
        );
        assert_eq!(
            page(Horizon::Until(2.5)),
            format!("{head} accurate to half a pixel until 2.5 s")
        );
        // A linear scene departs from the exact motion by design.
        assert_eq!(
            words(
                SceneName::SmallHeavy,
                PlayState::Playing,
                Horizon::Until(0.017)
            ),
            "the linear motion on purpose · leaves the exact motion by half a pixel at 0.02 s"
        );
        assert!(
            words(SceneName::Page, PlayState::Stopped, Horizon::Until(0.0))
                .starts_with("this motion is too fast for this chip: change the masses")
        );
    }

    fn stepping_of(
        scene: SceneName,
        state: PlayState,
        horizon: Horizon,
        method: Option<Stepping>,
    ) -> String {
        stepping(&Frame {
            scene,
            state,
            report: Report {
                horizon,
                stepping: method,
                ..Report::default()
            },
            ..Frame::default()
        })
    }

    #[test]
    fn energy_error_below_the_resolution_of_f64_is_shown_as_a_limit() {
        let written = |error| energy_error(error, |error| format!("{error:+.1e}"));
        assert_eq!(written(2.4e-14), "+2.4e-14");
        assert_eq!(written(-1e-15), "< 4e-15");
        assert_eq!(written(0.0), "< 4e-15");
    }

    /// A scene without a motion has no energy, so the summary has a dash.
    #[test]
    fn scene_without_a_motion_reports_no_energy_error() {
        for (scene, line) in [
            (SceneName::Flips, "largest energy error  -\n"),
            (SceneName::Page, "largest energy error  < 4e-15\n"),
        ] {
            let mut readings = Readings::default();
            readings.frame(Frame {
                scene,
                ..Frame::default()
            });
            assert!(readings.report().contains(line), "{}", readings.report());
        }
    }

    /// The simulated time is the sum of all motions, and a repeated frame adds nothing.
    #[test]
    fn simulated_time_adds_up_all_restarts_and_scenes() {
        let mut readings = Readings::default();
        let [page, butterfly] = [SceneName::Page, SceneName::Butterfly];
        // The time falls: a restart.
        for (scene, times) in [
            (page, &[0.25, 0.5, 0.5, 0.125, 0.75][..]),
            (butterfly, &[0.875, 1.0]),
        ] {
            for &time in times {
                readings.frame(at(scene, time));
            }
        }
        assert!(
            readings.report().contains("simulated time        2.250 s"),
            "{}",
            readings.report()
        );
    }

    /// A board that has played for an hour before it was connected.
    #[test]
    fn simulated_time_before_the_first_frame_does_not_count() {
        let mut readings = Readings::default();
        for time in [3600.0, 3600.5, 3601.0] {
            readings.frame(at(SceneName::Page, time));
        }
        assert!(
            readings.report().contains("simulated time        1.000 s"),
            "{}",
            readings.report()
        );
    }

    fn at(scene: SceneName, time: f64) -> Frame {
        Frame {
            scene,
            report: Report {
                time,
                ..Report::default()
            },
            ..Frame::default()
        }
    }
}
