//! Figure 2: the two frequencies of small oscillations over the mass ratio.

use anyhow::Result;
use double_pendulum::{Error, Modes, Parameters};
use plotters::prelude::*;

use super::sheet::{BLUE, ORANGE, TEXT, axes, line, svg, text, units};

/// The figure's mass ratios are 0 to this; at 0 itself there are no modes.
const GREATEST_MASS_RATIO: f64 = 5.0;
const POINTS: u32 = 500;
/// The mass ratios of figures 3 to 5, which are marked.
const MARKED: [f64; 3] = [0.2, 1.0, 5.0];

/// A mass ratio and both frequencies there, fast and slow, of equal rods in sqrt(g/l).
fn point(mass_ratio: f64) -> Result<[f64; 3], Error> {
    let modes = Modes::new(&Parameters::equal_rods(mass_ratio, 1.0, 1.0))?;
    Ok([mass_ratio, modes.fast.frequency, modes.slow.frequency])
}

pub fn figure() -> Result<String> {
    // Denser towards 0, where the curves are steep.
    let ratios = (1..=POINTS).map(|i| GREATEST_MASS_RATIO * (f64::from(i) / f64::from(POINTS)).powi(2));
    let points = ratios.map(point).collect::<Result<Vec<_>, _>>()?;
    let marks = MARKED.into_iter().map(point).collect::<Result<Vec<_>, _>>()?;
    svg([640, 400], ["Figure 2: both frequencies of small oscillations of equal rods"], |area| {
        let across = ("mass ratio μ = m₂/m₁", [0.0, GREATEST_MASS_RATIO]);
        let mut chart = axes(area, across, ("frequency, √(g/l)", [0.0, 3.5]), [11, 8])?;
        let curves = [
            (1, BLUE, "ω₁ fast: the rods swing against each other", (0.45, 2.85)),
            (2, ORANGE, "ω₂ slow: the rods swing together", (2.0, 1.0)),
        ];
        for (curve, colour, name, place) in curves {
            let places = points.iter().map(|point| (point[0], point[curve]));
            chart.draw_series(LineSeries::new(places, line(colour, 20)))?;
            chart.draw_series([Text::new(name, place, text(13).color(&colour))])?;
            let marks = marks.iter().map(|mark| (mark[0], mark[curve]));
            chart.draw_series(marks.map(|mark| Circle::new(mark, units(4), TEXT.filled())))?;
        }
        chart.draw_series([Text::new("●  figures 3, 4 and 5", (2.0, 0.3), text(12))])?;
        Ok(())
    })
}
