//! Figure 2: the two frequencies of small oscillations over the mass ratio, with the present one marked.

use double_pendulum::{Error, Modes, Parameters};

use crate::graphics::{
    Anchor, Canvas, Disc, FadeLayer, Fading, Height, LINE, LOWEST, Spot, WIDTH, label, plot, text,
};
use crate::motion::{Resources, Settings};
use crate::scenes::{Report, Scene};

/// The least range of mass ratios across the frame, that of the figure; a heavier bob 2 widens it.
const LEAST_RANGE: f32 = 5.0;
/// The mark is at most this far across.
const FARTHEST_MARK: f32 = 0.8;
/// The plot begins right of the scale's numbers.
const LEFT: i32 = 12;
const COLUMNS: usize = WIDTH - LEFT as usize;
/// The row of frequency 0 and how far the greatest is above it, pixels.
const ZERO_ROW: f32 = 53.0;
const RISE: f32 = 43.0;
/// The scale has at most about so many numbers above 0.
const NUMBERS: f32 = 4.0;
const COLUMNS_PER_TICK: u32 = 2;
const MARK_RADIUS: u8 = 112;
const CURVE: u8 = 200;

/// Both frequencies in sqrt(g/l), so that the mass ratio is all that matters; the curves grow from the left.
#[derive(Clone, Debug, Default)]
pub struct Frequencies {
    /// The mass ratio across the whole plot.
    range: f32,
    /// Pixels per sqrt(g/l).
    scale: f32,
    mass_ratio: f32,
    marked: [f32; 2],
    /// Columns of the curves drawn so far, and where they end.
    drawn: u32,
    ends: Option<[Height; 2]>,
}

/// The fast and the slow frequency of equal rods, in sqrt(g/l).
fn frequencies(mass_ratio: f32) -> Result<[f32; 2], Error> {
    let modes = Modes::new(&Parameters::equal_rods(mass_ratio, 1.0, 1.0))?;
    Ok([modes.fast.frequency, modes.slow.frequency])
}

impl Scene for Frequencies {
    const FADING: Fading = Fading::NEVER;

    fn new(settings: &Settings, _: &Resources) -> Result<(Self, Option<f32>), Error> {
        let mass_ratio = settings.mass_ratio();
        let marked = frequencies(mass_ratio)?;
        let range = (mass_ratio / FARTHEST_MARK).max(LEAST_RANGE);
        let [greatest, _] = frequencies(range)?;
        Ok((
            Self {
                range,
                scale: RISE / greatest,
                mass_ratio,
                marked,
                drawn: 0,
                ends: None,
            },
            None,
        ))
    }

    fn tick(&mut self, _: u64, ink: &mut FadeLayer) {
        for _ in 0..COLUMNS_PER_TICK.min(COLUMNS as u32 - self.drawn) {
            // The middle of the column; mass ratio 0 itself has no modes.
            let mass_ratio = (self.drawn as f32 + 0.5) * self.range / COLUMNS as f32;
            let Ok(frequencies) = frequencies(mass_ratio) else {
                return;
            };
            let heights =
                frequencies.map(|frequency| plot::height(frequency, ZERO_ROW, self.scale));
            for (before, now) in self.ends.unwrap_or(heights).into_iter().zip(heights) {
                plot::column(&mut ink.frame, LEFT + self.drawn as i32, before, now, CURVE);
            }
            (self.drawn, self.ends) = (self.drawn + 1, Some(heights));
        }
    }

    fn draw(&self, _: &Report, canvas: &mut Canvas) {
        let (width, zero) = (WIDTH as i32, ZERO_ROW as i32);
        let step = plot::scale_step(RISE / self.scale / NUMBERS);
        for frequency in (0..).map(|number| number as f32 * step) {
            let row = (ZERO_ROW - self.scale * frequency) as i32;
            if row < zero - RISE as i32 {
                break;
            }
            plot::axis(canvas, LEFT, width, row);
            text::write(
                canvas,
                &label::tick(frequency, ""),
                Anchor::EndingAt(LEFT, row - LINE / 2),
            );
        }
        let x = LEFT as f32 + self.mass_ratio / self.range * COLUMNS as f32;
        plot::upright_axis(canvas, x as i32, zero - RISE as i32, zero);
        for frequency in self.marked {
            let centre = Spot::at(x, ZERO_ROW - self.scale * frequency);
            Disc {
                centre,
                radius: MARK_RADIUS,
                gap: MARK_RADIUS,
            }
            .draw(canvas, u8::MAX);
        }
        let [fast, slow] = self.marked;
        text::write(canvas, &label::label("ω₁ ", fast, 3, ""), Anchor::Left(0));
        text::write(canvas, &label::label("ω₂ ", slow, 3, ""), Anchor::Middle(0));
        text::write(
            canvas,
            &label::mass_ratio(self.mass_ratio),
            Anchor::Right(0),
        );
        text::write(canvas, "ω in √(g/l)", Anchor::At(LEFT + 1, LOWEST));
        text::write(
            canvas,
            &label::mass_ratio(self.range),
            Anchor::Right(LOWEST),
        );
    }
}
