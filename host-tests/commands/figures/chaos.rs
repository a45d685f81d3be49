//! Figure 7: the path of bob 2 by the right equations, and by the misprinted equations of the book.

use anyhow::Result;
use double_pendulum::{Error, Parameters, Pendulum, State, rk4};
use firmware::config::PAGE_GRAVITY;
use plotters::prelude::*;

use super::sheet::{Axes, BLUE, ORANGE, TEXT, axes, headed, line, pale, svg, text, units};
use exact::textbook::misprinted_equal_rods;

const MASS_RATIO: f64 = 2.75;
const START: f64 = 171.0;
const ROD: f64 = 1.0;
/// The seconds in which the path by the right equations follows the exact motion (test `figures`).
pub const DURATION: u32 = 10;
const STEPS: u32 = 8192;
const STEPS_PER_POINT: u32 = 32;

const REACH: f64 = 2.1;

pub struct Path {
    /// The points, m right of the pivot and above it.
    pub points: Vec<(f64, f64)>,
    /// The smallest and the largest energy, J, by the right equations.
    pub energies: [f64; 2],
}

/// The page has g = 9.8 m/s^2.
pub fn pendulum() -> Result<Pendulum<f64>, Error> {
    Pendulum::new(&Parameters::equal_rods(MASS_RATIO, ROD, PAGE_GRAVITY))
}

pub fn start() -> State<f64> {
    State::at_rest(START.to_radians(), START.to_radians())
}

/// Returns the paths by the right equations and by the misprinted ones, by RK4 with `refinement`
/// times the figure's steps.
pub fn paths(refinement: u32) -> Result<[Path; 2], Error> {
    let pendulum = pendulum()?;
    let right = path(&pendulum, refinement, |z| pendulum.derivatives(z));
    let printed = path(&pendulum, refinement, |z| {
        misprinted_equal_rods(MASS_RATIO, ROD, PAGE_GRAVITY, z)
    });
    Ok([right, printed])
}

fn path(pendulum: &Pendulum<f64>, refinement: u32, rhs: impl Fn(&[f64; 4]) -> [f64; 4]) -> Path {
    let mut state = start();
    let dt = 1.0 / f64::from(STEPS * refinement);
    let mut points = Vec::new();
    let [mut least, mut greatest] = [f64::INFINITY, f64::NEG_INFINITY];
    for step in 0..=DURATION * STEPS * refinement {
        if step.is_multiple_of(STEPS_PER_POINT * refinement) {
            let [_, bob2] = pendulum.positions(state.angles());
            points.push((bob2.x, bob2.y));
            let energy = pendulum.energy(&state);
            least = least.min(energy);
            greatest = greatest.max(energy);
        }
        state = rk4::step(&rhs, &state.into(), dt).into();
    }
    Path {
        points,
        energies: [least, greatest],
    }
}

pub fn figure() -> Result<String> {
    let paths = paths(1)?;
    let title = format!("Figure 7: path of bob 2 in the first {DURATION} s");
    let particulars = format!(
        "mass ratio {MASS_RATIO}, both rods let go at rest at {START}°; l = {ROD} m, g = \
         {PAGE_GRAVITY} m/s², m₁ = 1 kg"
    );
    let marks =
        "○ start, ● end; · every 1 s, with the seconds; paler earlier, darker later; × pivot";
    svg([800, 468], [&title, &particulars, marks], |area| {
        let halves = area.split_evenly((1, 2));
        let names = ["the right equations", "as printed, a factor μ missing"];
        for (((area, name), colour), path) in
            halves.iter().zip(names).zip([BLUE, ORANGE]).zip(&paths)
        {
            let [least, greatest] = path.energies.map(|energy| format!("{energy:.1} J"));
            let energy = if least == greatest {
                least
            } else {
                format!("{least} to {greatest}")
            };
            let name = format!("{name}; energy {energy}").replace('-', "−");
            let area = headed(area, &name, text(13).color(&colour))?;
            let mut chart = axes(
                &area,
                ("x, m", [-REACH, REACH]),
                ("y, m", [-REACH, REACH]),
                [9, 9],
            )?;
            draw(&path.points, &mut chart, colour)?;
        }
        Ok(())
    })
}

const SHADES: usize = 10;
const PALEST: f64 = 0.35;

fn draw(points: &[(f64, f64)], chart: &mut Axes, colour: RGBColor) -> Result<()> {
    let length = points.len().div_ceil(SHADES);
    for shade in 0..SHADES {
        // Each piece begins at the end of the previous one.
        let piece = points.iter().copied().skip(shade * length).take(length + 1);
        let strength = PALEST + (1.0 - PALEST) * shade as f64 / (SHADES - 1) as f64;
        chart.draw_series(LineSeries::new(piece, line(pale(colour, strength), 9)))?;
    }

    let per_second = (STEPS / STEPS_PER_POINT) as usize;
    for (second, &(x, y)) in points
        .iter()
        .step_by(per_second)
        .enumerate()
        .take(DURATION as usize)
        .skip(1)
    {
        chart.draw_series([Circle::new((x, y), units(2), TEXT.filled())])?;
        chart.draw_series([Text::new(
            second.to_string(),
            (x + 0.05, y + 0.02),
            text(10),
        )])?;
    }

    let [start, .., end] = *points else {
        return Ok(());
    };

    for (place, style) in [
        (start, WHITE.filled()),
        (start, line(TEXT, 12)),
        (end, TEXT.filled()),
    ] {
        chart.draw_series([Circle::new(place, units(5), style)])?;
    }
    Ok(chart
        .draw_series([Cross::new((0.0, 0.0), units(5), line(TEXT, 12))])
        .map(drop)?)
}
