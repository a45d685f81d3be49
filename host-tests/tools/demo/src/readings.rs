//! The data that a board has sent: the latest numbers, some past ones for the terminal, and the
//! faults.

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
use emulator::link::{self, Counts};
use emulator::qemu::LogLine;

/// The number of past frames that are kept, for 12 s; no more are shown.
const KEPT: usize = 12 * TICK_RATE as usize;
/// The time of a first frame, s, from which on the board has played before it was connected.
const BEFORE: f64 = 1.0;
/// The time over which frames are counted for their rate.
const RATE_SPAN: Duration = Duration::from_secs(1);

/// The page of the help that is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Help {
    /// No page.
    #[default]
    Hidden,
    /// The keys and the scenes.
    Keys,
    /// The meanings of the numbers.
    Numbers,
}

impl Help {
    /// Returns the page after the key `?`: after no page the keys, then the numbers, then no page
    /// again.
    pub fn next(self) -> Self {
        match self {
            Self::Hidden => Self::Keys,
            Self::Keys => Self::Numbers,
            Self::Numbers => Self::Hidden,
        }
    }
}

/// Returns a warning of the host, as a line of the board's log: with the level `warn`, the text as
/// it is, and no place.
pub fn warning(text: String) -> LogLine {
    LogLine {
        level: Some("warn".to_owned()),
        text,
        place: String::new(),
    }
}

/// The data that a board has sent since the start of the session. The default is empty: no message
/// has arrived.
#[derive(Debug, Default)]
pub struct Readings {
    /// The latest frame; `None` before the first.
    pub frame: Option<Frame>,
    /// The angles at the start of the motion, degrees; `None` until the board has reported them.
    pub start: Option<[f32; 2]>,
    /// The counts of the link since it was opened, set by the session.
    pub counts: Counts,
    /// The state of the panel when the board was last asked. It is `None` before, and for an
    /// emulated board.
    pub panel: Option<PanelReport>,
    /// The reports since the start of the motion, oldest first. It is empty in scenes without
    /// angles. At most the latest 720 are kept, which last 12 s if no frame is dropped.
    pub past: Vec<Report>,
    /// All lines of the log, with the warnings of the host, oldest first. They are kept without a
    /// limit, except that a run without a terminal takes those of a port.
    pub lines: Vec<LogLine>,
    /// The comparison of the frames with the host's.
    pub comparison: Comparison,
    /// The page of the help that is shown instead of the readings.
    pub help: Help,
    /// The simulated time per real time, as last reported by the board or set by the user. `None`
    /// before either.
    pub speed: Option<f32>,
    /// The last scene and method of a warning that the scene does not use the requested method.
    unusable: Option<(SceneName, Method)>,
    /// The times when frames arrived, oldest first. Those older than a second are removed when the
    /// next frame arrives.
    pub(super) arrivals: Vec<Instant>,
    /// The number of all frames.
    frames: u64,
    /// The size of the largest energy error of all scenes together, relative to the energy above
    /// rest.
    greatest_energy_error: f32,
    /// The simulated time of all scenes and restarts together, s.
    simulated: f64,
}

/// The beginning of the log line of a board that could not keep the speed.
const SLOWED: &str = "speed lowered";

impl Readings {
    /// Takes a frame that has just arrived, and passes it to the comparison. A frame of another
    /// scene, or of an earlier time, begins a new motion: `start` and `past` are emptied. A frame
    /// of the same time, as in a pause, is not added to `past`. Returns true if the host must send
    /// a request for the board's scene ([`Comparison::frame`]).
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

        // These figures are of all motions together. The time before the first frame is not seen.
        let seen = match (before, last) {
            (Some(before), _) => before.report.time,
            (None, None) if report.time >= BEFORE => report.time,
            (None, _) => 0.0,
        };
        self.simulated += report.time - seen;
        self.greatest_energy_error = self.greatest_energy_error.max(report.energy_error.abs());
        self.frames += 1;

        // The chart shows the frames of this motion, but none twice while the scene is paused.
        if frame.scene.has_angles() && self.past.last().is_none_or(|last| report.time > last.time) {
            self.past.push(report);
        }
        self.past.drain(..self.past.len().saturating_sub(KEPT));

        // The arrivals of the last second give the frame rate.
        self.arrivals.push(Instant::now());
        self.arrivals
            .retain(|arrival| arrival.elapsed() <= RATE_SPAN);
        self.comparison.frame(&frame)
    }

    /// Takes the board's report of its scene: sets `start` and passes the report to
    /// [`Comparison::status`]. It is needed because frames contain the start angle of rod 1 only.
    /// `speed` and `panel` are not changed.
    ///
    /// If the scene does not use the method that the report says is requested, a warning is added
    /// to the lines, once until the scene or the method changes.
    pub fn status(&mut self, status: &Status) {
        self.start = Some(status.settings.degrees.map(|degrees| degrees as f32));
        self.note_method(status);
        self.comparison.status(status);
    }

    /// Takes the state of the panel, and adds a line if it has changed: at the first report, or if
    /// the panel is found, lost or identified as another one. A board without a panel that reports
    /// its state causes no line.
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

    /// Warns once in a scene that it does not use the requested method.
    fn note_method(&mut self, status: &Status) {
        // Nothing is requested, so nothing can be unusable.
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

        // A restart of the same scene causes no second warning.
        if self.unusable != unusable {
            self.unusable = unusable;
            self.lines
                .push(warning(format!("{method} is not used here: {reason}")));
        }
    }

    /// Returns the number of frames that have arrived in the second of the host's clock before this
    /// call. It is 0 if the board is silent.
    pub fn rate(&self) -> usize {
        self.arrivals
            .iter()
            .filter(|arrival| arrival.elapsed() <= RATE_SPAN)
            .count()
    }

    /// Returns the faults of an emulated board, a text for each kind or line; empty if all is well.
    /// Faults are damaged messages, frames that were sent and not received (lost) or not drawn in
    /// time (dropped), a speed that the board has lowered, errors in the log, and plain text in the
    /// log, which is a crash report or a complaint of QEMU. A difference of bits is not among them. For a board at a port or with the
    /// host's clock the same numbers need not be faults.
    pub fn faults(&self) -> Vec<String> {
        // Everything that goes wrong between an emulated board and the host is a fault of the
        // program.
        let Counts { damaged, lost, .. } = self.counts;
        let dropped = self.frame.map_or(0, |last| last.dropped);
        let findings = [
            (damaged > 0, format!("{damaged} messages arrived damaged")),
            (lost > 0, format!("{lost} frames were lost on the way")),
            (dropped > 0, format!("{dropped} frames were dropped")),
        ];
        // Errors in the log are faults as well, and so is plain text ([`LogLine::is_bad`]).
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

    /// Returns the summary, a line for each number and no newline at the end, of all scenes and
    /// restarts together: frames, simulated time (s), method and horizon, largest energy error
    /// (relative to the energy above rest), damaged messages, lost and dropped frames, panel, and
    /// the comparison. The dropped frames, the method and the horizon are taken from the latest
    /// frame; without a frame they are those of an empty one.
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
        // A scene without a motion has no energy.
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

/// Returns the method of a frame, with its steps per frame, and the accuracy horizon, in one line
/// without a newline. The horizon is in s of simulated time since the motion began; the words say
/// if it is not known yet, may still grow, or has passed, and nothing if it is infinite. A scene
/// without a method has words instead of it. For a stopped scene it returns the reason and the
/// remedy.
pub fn stepping(frame: &Frame) -> String {
    if frame.state == PlayState::Stopped {
        return "this motion is too fast for this chip: change the masses or the angle, or choose \
                another scene or method"
            .to_owned();
    }
    let computed = computed(frame);
    // The wording also depends on whether the horizon has passed.
    let accuracy = match frame.report.horizon {
        Horizon::Always => return computed,
        Horizon::Undecided => "accuracy not known yet".to_owned(),
        Horizon::AtLeast(time) => format!("accurate to half a pixel until at least {time:.1} s"),
        Horizon::Until(time) if frame.scene.is_linear() => {
            format!("leaves the exact motion by half a pixel at {time:.2} s")
        }
        Horizon::Until(time) if frame.report.time > f64::from(time) => {
            format!("was accurate to half a pixel until {time:.1} s")
        }
        Horizon::Until(time) => format!("accurate to half a pixel until {time:.1} s"),
    };
    format!("{computed} · {accuracy}")
}

/// Returns the method, with its number of steps.
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

/// Returns an energy error, relative to the energy above rest, as text, formatted by `write`. If
/// its size is below 4e-15, also if it is 0, the result is `< 4e-15` without a sign, because `f64`
/// cannot resolve it. NaN and infinity are passed to `write`.
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

    /// A warning appears once per visit of a scene that does not use the requested method: not
    /// again at a restart, but again after another scene in between. A scene that uses the method
    /// causes none.
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
            // A restart causes no new warning.
            readings.status(&status(scene, Some(method)));
            readings.status(&status(scene, Some(method)));
        }
        let said: Vec<_> = readings.lines.iter().map(ToString::to_string).collect();
        let small = "warn  rk4-fixed32 is not used here: scene small-1 always uses closed-form-f32";
        let flips = "warn  rk4-fixed32 is not used here: scene flips has no choice of methods";
        assert_eq!(said, [small, flips, flips]);
    }

    /// Each kind of horizon, a linear scene and a motion that is too fast have their own words,
    /// next to the method and its steps.
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
        // A linear scene departs from the exact motion by design, so it is not called inaccurate.
        assert_eq!(
            words(
                SceneName::SmallHeavy,
                PlayState::Playing,
                Horizon::Until(0.017)
            ),
            "the linear motion on purpose · leaves the exact motion by half a pixel at 0.02 s"
        );
        // A motion that has stopped has a remedy instead of a horizon.
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

    /// An error of 2.4e-14 is shown with its digits. An error below 4e-15 in size, or zero, is
    /// shown as "< 4e-15".
    #[test]
    fn energy_error_below_the_resolution_of_f64_is_shown_as_a_limit() {
        let written = |error| energy_error(error, |error| format!("{error:+.1e}"));
        assert_eq!(written(2.4e-14), "+2.4e-14");
        assert_eq!(written(-1e-15), "< 4e-15");
        assert_eq!(written(0.0), "< 4e-15");
    }

    /// After a frame with an energy error of 0, the summary has a dash in a scene without a motion,
    /// and the limit of `f64` in a scene with one.
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

    /// Two scenes are shown, the first with a restart. The simulated time of the summary is the sum
    /// of the three motions, and a repeated frame adds nothing.
    #[test]
    fn simulated_time_adds_up_all_restarts_and_scenes() {
        let mut readings = Readings::default();
        let [page, butterfly] = [SceneName::Page, SceneName::Butterfly];
        // In the first scene the time falls from 0.5 s to 0.125 s: a restart.
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

    /// A board that has played for an hour is connected. The summary counts from its first frame.
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

    /// Returns a frame of a scene at this time, s.
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
