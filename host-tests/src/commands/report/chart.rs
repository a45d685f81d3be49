//! Cost against error as a frame.

use std::error::Error;
use std::ops::Range;

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::accuracy::Contestant;
use super::scene::Scene;
use super::speed::Priced;
use crate::emulator::boards::Board;

/// Pixels: the whole, and how much of the width the axes have.
const SIZE: (u32, u32) = (1150, 680);
const AXES: u32 = 770;
/// Pixels from one line of the key to the next.
const LINE: i32 = 17;
/// Points outside are not drawn.
const ERRORS: Range<f64> = 1e-16..10.0;
const FONT: &str = "sans-serif";

/// A colour that can be told from those of the others of so many: around the wheel, neighbours dark and light.
fn colour(index: usize, of: usize) -> HSLColor {
    HSLColor(index as f64 / of as f64, 0.8, [0.33, 0.47][index % 2])
}

/// Who has points, in their order.
fn contestants(priced: &[Priced]) -> Vec<Contestant> {
    let mut all = Vec::new();
    for one in priced {
        if !all.contains(&one.point.contestant) {
            all.push(one.point.contestant);
        }
    }
    all
}

/// Estimated cycles per simulated second against the error, one line for each arithmetic, as SVG. A point is hollow if
/// another arithmetic or step is at least as good in both.
pub fn speed_against_error(priced: &[Priced], scene: &Scene, board: &Board) -> Result<String, Box<dyn Error>> {
    let shown: Vec<_> = priced
        .iter()
        .filter(|one| one.point.scene == scene && one.board == board && ERRORS.contains(&one.point.error.angle))
        .collect();
    let cycles = shown.iter().map(|one| one.cycles);
    let (least, most) = cycles.fold((f64::INFINITY, 0.0_f64), |(least, most), next| (least.min(next), most.max(next)));

    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        area.fill(&WHITE)?;
        let (left, right) = area.split_horizontally(AXES);
        let mut chart = ChartBuilder::on(&left)
            .caption(format!("{}; {}", scene.title, board.cpu), (FONT, 20))
            .margin(12)
            .x_label_area_size(45)
            .y_label_area_size(75)
            .build_cartesian_2d(ERRORS.log_scale(), (least / 2.0..most * 2.0).log_scale())?;
        chart
            .configure_mesh()
            .x_desc("largest error of an angle (rad)")
            .y_desc("cycles per simulated second (estimated)")
            .axis_desc_style((FONT, 16))
            .label_style((FONT, 13))
            .x_label_formatter(&|error| format!("{error:.0e}"))
            .y_label_formatter(&|cycles| format!("{cycles:.0e}"))
            .light_line_style(TRANSPARENT)
            .draw()?;
        let text = TextStyle::from((FONT, 13)).pos(Pos::new(HPos::Left, VPos::Center));
        let mut y = 2 * LINE;
        let contestants = contestants(priced);
        for (index, contestant) in contestants.iter().enumerate() {
            let colour = colour(index, contestants.len());
            let line: Vec<_> = shown.iter().filter(|one| one.point.contestant == *contestant).collect();
            if line.is_empty() {
                continue;
            }
            let place = |one: &&&Priced| (one.point.error.angle, one.cycles);
            let stroke = colour.stroke_width(2);
            chart.draw_series(LineSeries::new(line.iter().map(place), stroke))?;
            chart.draw_series(line.iter().map(|one| {
                let inside = if one.dominated { WHITE.filled() } else { colour.filled() };
                EmptyElement::at(place(one)) + Circle::new((0, 0), 4, inside) + Circle::new((0, 0), 4, stroke)
            }))?;
            right.draw(&PathElement::new([(0, y), (24, y)], stroke))?;
            right.draw(&Text::new(contestant.to_string(), (32, y), text.clone()))?;
            y += LINE;
        }
        for (inside, meaning) in [(BLACK.filled(), "none is better in both"), (WHITE.filled(), "dominated")] {
            y += LINE;
            right.draw(&Circle::new((12, y), 4, inside))?;
            right.draw(&Circle::new((12, y), 4, BLACK.stroke_width(2)))?;
            right.draw(&Text::new(meaning, (32, y), text.clone()))?;
        }
        area.present()?;
    }
    Ok(svg)
}
