//! Figures 3 to 5: both angles of small oscillations over time, within their envelopes.

use std::f64::consts::{FRAC_PI_6, TAU};

use anyhow::Result;
use double_pendulum::{Error, Modes, Motion, Parameters, SmallOscillations};
use firmware::config::PAGE_GRAVITY;
use plotters::prelude::*;

use super::sheet::{BLUE, ORANGE, axes, line, svg, units};

/// The book's rods, m.
const ROD: f64 = 0.25;
/// How long the motion is shown, s, and how finely.
const DURATION: f64 = 5.0;
const POINTS: u32 = 1500;

#[derive(Clone, Copy, Debug)]
pub struct CurvePoint {
    pub time: f64,
    /// Both angles, degrees.
    pub angles: [f64; 2],
    /// How far each could swing now while the modes go in and out of step, degrees.
    pub envelopes: [f64; 2],
}

pub fn modes(mass_ratio: f64) -> Result<Modes<f64>, Error> {
    Modes::new(&Parameters::equal_rods(mass_ratio, ROD, PAGE_GRAVITY))
}

/// The motion from a1 = 0, a2 = 30 degrees, let go from rest.
///
/// The amplitudes of C1 cos w1 t + C2 cos w2 t in either angle: sqrt(C1^2 + C2^2 + 2 C1 C2 cos (w1 - w2) t), rad.
pub fn points(modes: Modes<f64>) -> Vec<CurvePoint> {
    let motion = SmallOscillations::new(modes, &Motion::at_rest(0.0, FRAC_PI_6));
    let [fast, slow] = [motion.fast.cosine, motion.slow.cosine];
    let point = |i: u32| {
        let time = DURATION * f64::from(i) / f64::from(POINTS);
        let cos = libm::cos(modes.exchange() * time);
        let amplitude = |c1: f64, c2: f64| (c1 * c1 + c2 * c2 + 2.0 * c1 * c2 * cos).max(0.0).sqrt();
        let envelopes = [amplitude(fast, slow), amplitude(modes.fast.shape * fast, modes.slow.shape * slow)];
        let angles = motion.at(time).angles();
        CurvePoint { time, angles: angles.map(f64::to_degrees), envelopes: envelopes.map(f64::to_degrees) }
    };
    (0..=POINTS).map(point).collect()
}

pub fn figure(number: u32, mass_ratio: f64) -> Result<String> {
    let modes = modes(mass_ratio)?;
    let points = points(modes);
    let title = format!("Figure {number}: small oscillations, mass ratio {mass_ratio}");
    let start =
        "let go at rest at α₁ = 0°, α₂ = 30°; line: the angle; shade: how far it can swing while the modes beat";
    let particulars = format!(
        "l = {ROD} m, g = {PAGE_GRAVITY} m/s²; ω₁ = {:.3} rad/s, ω₂ = {:.3} rad/s; the envelope repeats every {:.3} s",
        modes.fast.frequency,
        modes.slow.frequency,
        TAU / modes.exchange()
    );
    svg([720, 503], [&title, start, &particulars], |area| {
        let (upper, lower) = area.split_vertically((area.dim_in_pixel().1 - units(20)) / 2);
        let rods = [(upper, "", "angle α₁, degrees", BLUE), (lower, "time, s", "angle α₂, degrees", ORANGE)];
        for (rod, (area, across, upwards, colour)) in rods.into_iter().enumerate() {
            let mut chart = axes(&area, (across, [0.0, DURATION]), (upwards, [-32.0, 32.0]), [11, 7])?;
            let edge = |sign: f64| points.iter().map(move |point| (point.time, sign * point.envelopes[rod]));
            let band: Vec<_> = edge(1.0).chain(edge(-1.0).rev()).collect();
            chart.draw_series([Polygon::new(band, colour.mix(0.15))])?;
            let curve = points.iter().map(|point| (point.time, point.angles[rod]));
            chart.draw_series(LineSeries::new(curve, line(colour, 16)))?;
        }
        Ok(())
    })
}
