//! What a run has shown, and whether all was well.

use std::fmt;

use double_pendulum::Method;
use firmware::config::TICK_RATE;
use firmware::protocol::{Frame, method_of};

use crate::emulator::qemu::LogLine;
use crate::link::Counts;

/// An energy error beyond this is no rounding or step error: the motion is wrong.
const GREATEST_ENERGY_ERROR: f32 = 1e-2;

/// A run so far.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    frames: u64,
    last: Option<Frame>,
    greatest_energy_error: f32,
    /// Of all scenes and restarts together, s.
    simulated: f64,
    /// Frames whose time is not what their number and restarts allow, or whose numbers are not finite.
    implausible: u64,
    complaints: Vec<String>,
}

impl Summary {
    /// Takes a frame.
    pub fn frame(&mut self, frame: &Frame) {
        let finite = frame.time.is_finite() && frame.state.iter().all(|number| number.is_finite());
        let waits = frame.paused != 0;
        let starts = frame.time <= 1.0 / f64::from(TICK_RATE);
        let advanced = waits || starts || self.last.is_none_or(|last| frame.step > last.step);
        if !finite || !frame.energy_error.is_finite() || !advanced {
            self.implausible += 1;
        }
        self.frames += 1;
        let before = self.last.filter(|last| last.scene == frame.scene && last.time <= frame.time);
        self.simulated += frame.time - before.map_or(0.0, |last| last.time);
        self.greatest_energy_error = self.greatest_energy_error.max(frame.energy_error.abs());
        self.last = Some(*frame);
    }

    /// Takes a line of the log.
    pub fn line(&mut self, line: &LogLine) {
        if line.is_bad() {
            self.complaints.push(line.to_string());
        }
    }

    /// What is not well; empty if all is.
    pub fn faults(&self, counts: Counts) -> Vec<String> {
        let dropped = self.last.map_or(0, |last| last.dropped);
        let findings = [
            (self.frames == 0, "no frame arrived".to_owned()),
            (counts.damaged > 0, format!("{} messages arrived damaged", counts.damaged)),
            (counts.lost > 0, format!("{} frames were lost on the way", counts.lost)),
            (dropped > 0, format!("{dropped} frames were dropped")),
            (self.implausible > 0, format!("{} frames are implausible", self.implausible)),
            (
                self.greatest_energy_error > GREATEST_ENERGY_ERROR,
                format!("the energy error exceeds {GREATEST_ENERGY_ERROR}"),
            ),
        ];
        let findings = findings.into_iter().filter_map(|(found, text)| found.then_some(text));
        findings.chain(self.complaints.iter().cloned()).collect()
    }

    /// The report at the end.
    pub fn report(&self, counts: Counts) -> impl fmt::Display {
        let Self { frames, last, greatest_energy_error, simulated, .. } = self;
        let last = last.unwrap_or_default();
        let way = way(&last);
        format!(
            "frames                {frames}\n\
             simulated time        {simulated:.3} s\n\
             shown                 {way}\n\
             largest energy error  {greatest_energy_error:.1e}\n\
             CRC errors            {}\n\
             lost frames           {}\n\
             dropped frames        {}",
            counts.damaged, counts.lost, last.dropped
        )
    }
}

/// How a frame is computed and until when such frames are right, in one line.
pub fn way(&Frame { method, way_steps, horizon, is_looking, .. }: &Frame) -> String {
    let name = method_of(method).map_or("nothing to plan", Method::name);
    let steps = match way_steps {
        0 => String::new(),
        1 => ", a step to a frame".to_owned(),
        steps => format!(", {steps} steps to a frame"),
    };
    if horizon.is_infinite() {
        return format!("{name}{steps}");
    }
    let at_least = if is_looking != 0 { "at least " } else { "" };
    format!("{name}{steps}, right to half a pixel until {at_least}{horizon:.1} s")
}

#[cfg(test)]
mod tests {
    use firmware::protocol::{NO_METHOD, method_code};

    use super::*;

    #[test]
    fn what_is_computed_is_said_in_words() {
        let said = |method, way_steps, horizon| way(&Frame { method, way_steps, horizon, ..Frame::default() });
        let fixed64 = method_code(Method::Extrapolation10Fixed64);
        assert!(
            said(fixed64, 1, 20.483_334).ends_with("fixed64, a step to a frame, right to half a pixel until 20.5 s")
        );
        assert!(said(fixed64, 4, 1.0).contains(", 4 steps to a frame,"));
        assert_eq!(said(NO_METHOD, 0, f32::INFINITY), "nothing to plan");
        assert_eq!(said(NO_METHOD, 0, 9.0), "nothing to plan, right to half a pixel until 9.0 s");
    }

    #[test]
    fn the_simulated_time_is_that_of_all_restarts_and_scenes() {
        let mut summary = Summary::default();
        for (scene, time) in [(0, 0.25), (0, 0.5), (0, 0.5), (0, 0.125), (0, 0.75), (1, 0.875), (1, 1.0)] {
            summary.frame(&Frame { scene, time, ..Frame::default() });
        }
        let report = summary.report(Counts::default()).to_string();
        assert!(report.contains("simulated time        2.250 s"), "{report}");
    }
}
