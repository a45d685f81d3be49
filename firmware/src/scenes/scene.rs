//! What every scene is, and the accuracy clock on its frame.

use double_pendulum::plan::Way;
use double_pendulum::{Error, State};

use crate::config::TICK_RATE;
use crate::graphics::{Anchor, Canvas, FadeLayer, Fading, label, text};
use crate::motion::{Means, Settings, Simulation};

/// Something to watch: it starts from settings, moves tick by tick and is drawn when there is time for it.
pub trait Scene: Sized {
    const FADING: Fading = Fading::TRACE;

    /// At the start; the kernel's error if the settings describe no pendulum, or none that this scene can show.
    fn new(settings: &Settings, means: &Means) -> Result<Self, Error>;

    /// Advances by one tick and adds to the ink what stays. The frame after n ticks does not depend on which of
    /// them were drawn.
    fn tick(&mut self, ink: &mut FadeLayer);

    /// Draws over the ink; `report` is what it has just been told in numbers, which need not be found twice.
    fn draw(&self, report: &Report, canvas: &mut Canvas);

    fn report(&self) -> Report;

    /// The height of a display, pixels, on which two rods as long as those shown reach from the middle to the edge; where angles
    /// are shown as curves, a rod is a radian long. `None` if nothing is shown that can be planned.
    fn height(&self) -> Option<f32> {
        None
    }

    /// The motion whose way the plan may change.
    fn planned(&mut self) -> Option<&mut Simulation> {
        None
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Report {
    /// Ticks of 1/60 s since the start.
    pub step: u64,
    /// Simulated time since the start, s.
    pub time: f64,
    /// The canonical state of the first pendulum shown, turns counted; zeros where none moves.
    pub state: State<f32>,
    /// (E - E0)/(E0 - Emin) of that pendulum: its energy error relative to the energy at the start above hanging at rest.
    pub energy_error: f32,
    /// Until when the frame is known to be right to [half a pixel](crate::config::HALF_PIXEL) about the exact motion, s after
    /// the start; infinity where nothing can be wrong.
    pub horizon: f32,
    /// Whether that may yet turn out to be later.
    pub is_looking: bool,
    /// The way that it is computed; `None` where no motion is.
    pub way: Option<Way>,
}

impl Report {
    /// Of a figure in which no pendulum moves.
    pub fn of_figure(ticks: u64) -> Self {
        let (state, horizon) = (State::default(), f32::INFINITY);
        Self { step: ticks, time: time(ticks), state, energy_error: 0.0, horizon, is_looking: false, way: None }
    }

    /// Of a scene whose first pendulum is `simulation`.
    #[inline(never)] // no second copy
    pub fn of(simulation: &Simulation) -> Self {
        let state = simulation.motion.rounded_state();
        let (energy_error, way) =
            (simulation.energy.error(simulation.motion.directions(), &state), Some(simulation.motion.way()));
        Self { state, energy_error, way, ..Self::of_figure(simulation.motion.frame()) }
    }
}

/// The simulated time after so many ticks, s.
pub fn time(ticks: u64) -> f64 {
    ticks as f64 / f64::from(TICK_RATE)
}

/// Writes the time and until when the frame can be trusted; the time stands out once it is known that it no longer can.
pub fn draw_clock(canvas: &mut Canvas, report: &Report, time_at: Anchor, trust_at: Anchor) {
    let &Report { time, horizon: until, is_looking, .. } = report;
    let passed = !is_looking && time > f64::from(until);
    let write = if passed { text::write_marked } else { text::write };
    write(canvas, &label::time(time), time_at);
    text::write(canvas, &label::trust(until, is_looking), trust_at);
}
