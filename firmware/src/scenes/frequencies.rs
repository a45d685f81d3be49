//! Figure 2 of the page: the two frequencies of small oscillations over the mass ratio. The current
//! mass ratio is marked.

use double_pendulum::{Error, Modes, Parameters};

use crate::graphics::{Anchor, Canvas, Disc, Fading, Format, Height, Spot, label, plot, text};
use crate::motion::{Resources, Settings};
use crate::scenes::{Report, Scene, Shows};

/// The smallest range of mass ratios across the plot, as in the figure. A heavier bob 2 widens it.
const LEAST_RANGE: f32 = 5.0;
/// The largest position of the mark, as a fraction of the width of the plot.
const FARTHEST_MARK: f32 = 0.8;
/// The approximate largest number of labels above 0.
const NUMBERS: f32 = 4.0;
/// The width of the curves that is drawn in a tick, units.
const COLUMNS_PER_TICK: i32 = 2;
/// The radius of the mark and its gap, subpixels of a unit.
const MARK_RADIUS: i32 = 56;
const CURVE: u8 = 200;

/// The plot on a panel.
#[derive(Clone, Copy, Debug)]
struct Layout {
    /// The first column, right of the numbers of the scale, and the number of columns.
    left: i32,
    columns: i32,
    /// The row of frequency 0, and the height of the largest frequency above it, pixels.
    zero: i32,
    rise: i32,
}

impl Layout {
    fn of(format: Format) -> Self {
        let left = format.units(12);
        let zero = format.bottom() - format.units(11);
        Self {
            left,
            columns: format.right() - left,
            zero,
            rise: zero - format.units(10),
        }
    }
}

/// The two angular frequencies of equal rods in units of sqrt(g/l), so that they depend only on the
/// mass ratio: ω₁ is the fast one, ω₂ the slow one. The curves grow from the left, by two columns
/// in a tick, and are complete in a second. The plot begins at the mass ratio 0, and ends at 5 or,
/// for a mass ratio above 4, at 1.25 times it.
///
/// Of the settings only the mass ratio matters. It is refused if it is not positive and finite, or
/// above 6.8e37. A requested method is ignored. The default is an empty figure, whose labels mean
/// nothing.
#[derive(Clone, Debug, Default)]
pub struct Frequencies {
    /// The mass ratio at the right edge of the plot.
    range: f32,
    /// Pixels per sqrt(g/l).
    scale: f32,
    mass_ratio: f32,
    /// The frequencies at the current mass ratio.
    marked: [f32; 2],
    /// The number of columns of the curves that are drawn, and the heights of their ends.
    drawn: i32,
    ends: Option<[Height; 2]>,
}

/// Returns the fast and the slow frequency of equal rods, in units of sqrt(g/l). Refuses a mass
/// ratio that is not positive and finite.
fn frequencies(mass_ratio: f32) -> Result<[f32; 2], Error> {
    let modes = Modes::new(&Parameters::equal_rods(mass_ratio, 1.0, 1.0))?;
    Ok([modes.fast.frequency, modes.slow.frequency])
}

impl Scene for Frequencies {
    const SHOWS: Shows = Shows::Figure;
    const FADING: Fading = Fading::NEVER;

    fn new(settings: &Settings, resources: &Resources) -> Result<(Self, Option<f32>), Error> {
        let mass_ratio = settings.mass_ratio();
        let marked = frequencies(mass_ratio)?;
        let range = (mass_ratio / FARTHEST_MARK).max(LEAST_RANGE);
        let [greatest, _] = frequencies(range)?;
        Ok((
            Self {
                range,
                scale: Layout::of(resources.format).rise as f32 / greatest,
                mass_ratio,
                marked,
                drawn: 0,
                ends: None,
            },
            None,
        ))
    }

    fn tick(&mut self, _: u64, ink: &mut Canvas) {
        let Layout {
            left,
            columns,
            zero,
            ..
        } = Layout::of(ink.format);
        let count = ink.format.units(COLUMNS_PER_TICK);
        for _ in 0..count.min(columns - self.drawn) {
            // The mass ratio in the middle of the column. Mass ratio 0 has no modes.
            let mass_ratio = (self.drawn as f32 + 0.5) * self.range / columns as f32;
            let Ok(frequencies) = frequencies(mass_ratio) else {
                return;
            };
            let heights =
                frequencies.map(|frequency| plot::height(frequency, zero as f32, self.scale));
            for (before, now) in self.ends.unwrap_or(heights).into_iter().zip(heights) {
                plot::column(ink, left + self.drawn, before, now, CURVE);
            }
            self.drawn += 1;
            self.ends = Some(heights);
        }
    }

    fn draw(&self, _: &Report, canvas: &mut Canvas) {
        let format = canvas.format;
        let lowest = format.lowest();
        let Layout {
            left,
            columns,
            zero,
            rise,
        } = Layout::of(format);

        // The scale.
        let step = plot::scale_step(rise as f32 / self.scale / NUMBERS);
        // An empty figure has no scale, and all numbers would be in the same row.
        for frequency in (0..=rise as u16).map(|number| f32::from(number) * step) {
            let row = (zero as f32 - self.scale * frequency) as i32;
            if row < zero - rise {
                break;
            }
            plot::axis(canvas, left, format.right(), row);
            let at = Anchor::EndingAt(left, row - format.line() / 2);
            text::write(canvas, &label::tick(frequency, ""), at);
        }

        // The marks.
        let x = left as f32 + self.mass_ratio / self.range * columns as f32;
        plot::upright_axis(canvas, x as i32, zero - rise, zero);
        for frequency in self.marked {
            let centre = Spot::at(x, zero as f32 - self.scale * frequency, format);
            let radius = format.units(MARK_RADIUS) as u16;
            Disc {
                centre,
                radius,
                gap: radius,
            }
            .draw(canvas, u8::MAX);
        }

        // The labels.
        let [fast, slow] = self.marked;
        text::write(canvas, &label::label("ω₁ ", fast, 3, ""), Anchor::Left(0));
        text::write(canvas, &label::label("ω₂ ", slow, 3, ""), Anchor::Middle(0));
        text::write(
            canvas,
            &label::mass_ratio(self.mass_ratio),
            Anchor::Right(0),
        );
        text::write(canvas, "ω in √(g/l)", Anchor::At(left + 1, lowest));
        text::write(
            canvas,
            &label::mass_ratio(self.range),
            Anchor::Right(lowest),
        );
    }
}
