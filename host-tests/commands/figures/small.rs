//! Figures 2 to 5, small oscillations: both frequencies over the mass ratio, and both angles over
//! time within their envelopes.

use std::f64::consts::{FRAC_PI_6, TAU};

use anyhow::Result;
use double_pendulum::{Error, Modes, Motion, Parameters, SmallOscillations};
use firmware::config::PAGE_GRAVITY;
use plotters::prelude::*;

use super::sheet::{BLUE, ORANGE, TEXT, axes, line, svg, text, units};

const ROD: f64 = 0.25;
const DURATION: f64 = 5.0;
const POINTS: u32 = 1500;

#[derive(Clone, Copy, Debug)]
pub struct CurvePoint {
    pub time: f64,
    pub angles: [f64; 2],
    /// While the modes beat, the angle swings between plus and minus this.
    pub envelopes: [f64; 2],
}

pub fn modes(mass_ratio: f64) -> Result<Modes<f64>, Error> {
    Modes::new(&Parameters::equal_rods(mass_ratio, ROD, PAGE_GRAVITY))
}

/// Each angle is A1 cos (w1 t + f1) + A2 cos (w2 t + f2), the sum of both modes. Its envelope is
/// sqrt(A1^2 + A2^2 + 2 A1 A2 cos ((w1 - w2) t + f1 - f2)).
pub fn points(modes: Modes<f64>) -> Vec<CurvePoint> {
    let motion = SmallOscillations::new(modes, &Motion::at_rest(0.0, FRAC_PI_6));
    let [fast, slow] = motion.amplitudes();
    let [fast_phase, slow_phase] = motion.phases();
    let point = |i: u32| {
        let time = DURATION * f64::from(i) / f64::from(POINTS);
        let cos = libm::cos(modes.exchange() * time + fast_phase - slow_phase);
        let amplitude =
            |a1: f64, a2: f64| (a1 * a1 + a2 * a2 + 2.0 * a1 * a2 * cos).max(0.0).sqrt();
        let envelopes = [
            amplitude(fast, slow),
            amplitude(modes.fast.shape * fast, modes.slow.shape * slow),
        ];
        let angles = motion.at(time).angles();
        CurvePoint {
            time,
            angles: angles.map(f64::to_degrees),
            envelopes: envelopes.map(f64::to_degrees),
        }
    };
    (0..=POINTS).map(point).collect()
}

pub fn figure(number: u32, mass_ratio: f64) -> Result<String> {
    let modes = modes(mass_ratio)?;
    let points = points(modes);
    let title = format!("Figure {number}: small oscillations, mass ratio {mass_ratio}");
    let start = "let go at rest at α₁ = 0°, α₂ = 30°; line: the angle; shade: how far it can \
                 swing while the modes beat";
    let particulars = format!(
        "l = {ROD} m, g = {PAGE_GRAVITY} m/s²; ω₁ = {:.3} rad/s, ω₂ = {:.3} rad/s; the envelope \
         repeats every {:.3} s",
        modes.fast.frequency,
        modes.slow.frequency,
        TAU / modes.exchange()
    );
    svg([720, 503], [&title, start, &particulars], |area| {
        let (upper, lower) = area.split_vertically((area.dim_in_pixel().1 - units(20)) / 2);
        let rods = [
            (upper, "", "angle α₁, degrees", BLUE),
            (lower, "time, s", "angle α₂, degrees", ORANGE),
        ];
        for (rod, (area, across, upwards, colour)) in rods.into_iter().enumerate() {
            let mut chart = axes(
                &area,
                (across, [0.0, DURATION]),
                (upwards, [-32.0, 32.0]),
                [11, 7],
            )?;

            let edge = |sign: f64| {
                points
                    .iter()
                    .map(move |point| (point.time, sign * point.envelopes[rod]))
            };
            let band: Vec<_> = edge(1.0).chain(edge(-1.0).rev()).collect();
            chart.draw_series([Polygon::new(band, colour.mix(0.15))])?;
            let curve = points.iter().map(|point| (point.time, point.angles[rod]));
            chart.draw_series(LineSeries::new(curve, line(colour, 16)))?;
        }
        Ok(())
    })
}

pub const MASS_RATIOS: [f64; 3] = [0.2, 1.0, 5.0];
const RATIOS: u32 = 500;

fn at_ratio(mass_ratio: f64) -> Result<[f64; 3], Error> {
    let modes = Modes::new(&Parameters::equal_rods(mass_ratio, 1.0, 1.0))?;
    Ok([mass_ratio, modes.fast.frequency, modes.slow.frequency])
}

/// The curves begin at 2e-5, because there are no modes at 0.
pub fn frequencies() -> Result<String> {
    // The points are denser towards 0, where the curves are steep.
    let [.., greatest] = MASS_RATIOS;
    let ratios = (1..=RATIOS).map(|i| greatest * (f64::from(i) / f64::from(RATIOS)).powi(2));
    let points = ratios.map(at_ratio).collect::<Result<Vec<_>, _>>()?;

    let marks = MASS_RATIOS
        .into_iter()
        .map(at_ratio)
        .collect::<Result<Vec<_>, _>>()?;
    svg(
        [640, 400],
        ["Figure 2: both frequencies of small oscillations of equal rods"],
        |area| {
            let across = ("mass ratio μ = m₂/m₁", [0.0, greatest]);
            let mut chart = axes(area, across, ("frequency, √(g/l)", [0.0, 3.5]), [11, 8])?;
            let curves = [
                (
                    1,
                    BLUE,
                    "ω₁ fast: the rods swing against each other",
                    (0.45, 2.85),
                ),
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
        },
    )
}
