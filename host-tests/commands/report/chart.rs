//! A chart of cost against error: a few lines have names and colours, and all others are grey.

use std::cmp::Reverse;
use std::ops::Range;

use anyhow::Result;
use firmware::config::REACH;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::accuracy::ReportedMotion;
use super::c_peers::PROGRAMS;
use super::join::Point;
use boards::Board;

const SIZE: (u32, u32) = (860, 460);
/// The range of errors. Points outside are not drawn, and errors decrease to the right.
const ERRORS: Range<f64> = 1e-15..0.1;
/// Limits the points of a line. A finer step is drawn only if its error is less than this share of
/// the smallest error of the coarser steps. Otherwise it is not worth its cycles.
const WORTH: f64 = 0.9;
/// The marked errors, rad: half a pixel of the panel, for an error of both angles, and typical
/// accuracies.
const MARKS: [(f64, &str); 3] = [
    (0.5 / REACH as f64, "half a pixel: 60 fps on the panel"),
    (1e-9, "1e-9"),
    (1e-12, "1e-12"),
];
/// The number of lines with a name: the programs in C, which are the usual solution today, and the
/// methods that are the best in some respect.
const NAMED: usize = 7;
const COLOURS: [RGBColor; NAMED] = [
    RGBColor(0, 95, 175),
    RGBColor(205, 85, 15),
    RGBColor(0, 130, 95),
    RGBColor(170, 50, 120),
    RGBColor(120, 95, 0),
    RGBColor(80, 80, 80),
    RGBColor(200, 30, 30),
];
const TEXT: RGBColor = RGBColor(34, 34, 34);
const GREY: RGBColor = RGBColor(200, 200, 200);
const FONT: &str = "sans-serif";
const LETTER: (i32, i32) = (7, 15);

/// Returns the lines, each with the number of points that no other point dominates. The programs in
/// C are first, then the methods with the largest counts.
fn lines<'a>(
    points: &'a [Point],
    scene: &ReportedMotion,
    board: &Board,
) -> Vec<(usize, &'static str, Vec<&'a Point>)> {
    let shown = points
        .iter()
        .filter(|point| point.scene == scene && point.board == board);
    let shown: Vec<_> = shown
        .filter(|point| ERRORS.contains(&point.error.angle))
        .collect();

    let line = |all: &[&'a Point]| {
        let mut least = f64::INFINITY;
        let is_better = |point: &&Point| {
            let is_it = point.error.angle < WORTH * least;
            least = least.min(point.error.angle);
            is_it
        };
        let name = all[0].name;
        let line: Vec<_> = all.iter().copied().filter(is_better).collect();

        let is_peer = PROGRAMS.iter().any(|(program, _)| *program == name);
        let best = line
            .iter()
            .filter(|point| !point.is_dominated(points))
            .count();
        (if is_peer { usize::MAX } else { best }, name, line)
    };

    let mut lines: Vec<_> = shown.chunk_by(|a, b| a.name == b.name).map(line).collect();
    lines.sort_by_key(|(best, ..)| Reverse(*best));
    lines
}

/// Returns a chart of the estimated cycles per simulated second against the error of an angle, as
/// an SVG file.
pub fn speed_against_error(
    points: &[Point],
    scene: &ReportedMotion,
    board: &Board,
) -> Result<String> {
    let lines = lines(points, scene, board);
    let best = lines.iter().take_while(|(best, ..)| *best > 0).count();
    let (named, others) = lines.split_at(best.min(NAMED));

    let cycles = lines
        .iter()
        .flat_map(|(.., points)| points)
        .map(|point| point.cycles());
    let (least, most) = cycles.fold((f64::INFINITY, 1.0_f64), |(least, most), next| {
        (least.min(next), most.max(next))
    });
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        area.fill(&WHITE)?;

        let ReportedMotion {
            name,
            angle,
            duration,
        } = scene;
        let title = format!(
            "{}: {name}: {angle}/{angle} rad, {duration} s",
            board.core().name()
        );
        let mut chart = ChartBuilder::on(&area)
            .caption(title, (FONT, 17).into_font().color(&TEXT))
            .margin(10)
            .x_label_area_size(42)
            .y_label_area_size(66)
            .build_cartesian_2d(
                (ERRORS.end..ERRORS.start).log_scale(),
                (least / 2.0..most * 2.0).log_scale(),
            )?;
        chart
            .configure_mesh()
            .x_desc("largest error of an angle, rad: better to the right")
            .y_desc("cycles per simulated second, estimated")
            .axis_desc_style((FONT, 14))
            .label_style((FONT, 12))
            .x_label_formatter(&|error| format!("{error:.0e}"))
            .y_label_formatter(&|cycles| format!("{cycles:.0e}"))
            .bold_line_style(RGBColor(238, 238, 238))
            .light_line_style(TRANSPARENT)
            .draw()?;

        let small = TextStyle::from((FONT, 12)).color(&TEXT);
        for (error, meaning) in MARKS {
            chart.draw_series([PathElement::new(
                [(error, least / 2.0), (error, most * 2.0)],
                TEXT.stroke_width(1),
            )])?;
            let top =
                EmptyElement::at((error, most * 2.0)) + Text::new(meaning, (4, 2), small.clone());
            chart.draw_series([top])?;
        }

        // The lines without a name are drawn first, so that the others are in front.
        let place = |point: &&Point| (point.error.angle, point.cycles());
        for (.., points) in others {
            chart.draw_series(LineSeries::new(
                points.iter().map(place),
                GREY.stroke_width(1),
            ))?;
        }

        // The lines with a name, and the boxes of the names that are already drawn.
        let mut taken: Vec<[i32; 3]> = Vec::new();
        for ((_, name, points), colour) in named.iter().zip(COLOURS) {
            chart.draw_series(LineSeries::new(
                points.iter().map(place),
                colour.stroke_width(2),
            ))?;
            chart.draw_series(
                points
                    .iter()
                    .map(|point| Circle::new(place(point), 3, colour.filled())),
            )?;
            let Some(end) = points.last() else { continue };
            let (x, mut y) = chart.backend_coord(&place(end));
            let width = LETTER.0 * name.len() as i32;

            // The name is right of the line's end, or left of it if the frame is near, and is moved
            // up if it overlaps another name.
            let left = if x + 10 + width < SIZE.0 as i32 {
                x + 10
            } else {
                x - 10 - width
            };
            let overlaps = |y: i32| {
                taken
                    .iter()
                    .any(|&[a, b, at]| left < b && a < left + width && (y - at).abs() < LETTER.1)
            };
            while overlaps(y) {
                y -= 1;
            }
            taken.push([left, left + width, y]);
            let style = TextStyle::from((FONT, 13))
                .color(&colour)
                .pos(Pos::new(HPos::Left, VPos::Center));
            area.draw(&Text::new(*name, (left, y), style))?;
        }
        area.present()?;
    }

    Ok(svg)
}

#[cfg(test)]
mod tests {
    use super::super::accuracy::SCENES;
    use super::super::join::tests::point;
    use super::*;
    use boards::BOARDS;

    #[test]
    fn seven_lines_at_most_have_names_and_the_programs_in_c_do() -> Result<()> {
        let names = [
            "a",
            "b",
            "c",
            "d",
            "e",
            "f",
            "g",
            "h",
            PROGRAMS[0].0,
            PROGRAMS[1].0,
        ];
        let each = |(i, name): (usize, &&'static str)| {
            point(name, 10_f64.powi(i as i32), 0.1_f64.powi(i as i32 + 1))
        };
        let mut points: Vec<_> = names.iter().enumerate().map(each).collect();
        points.insert(0, point("worse than all others", 1e12, 0.5));

        let svg = speed_against_error(&points, &SCENES[0], &BOARDS[0])?;
        let named = |name: &str| svg.lines().any(|line| line.trim() == name);
        assert_eq!(
            names.iter().filter(|name| named(name)).count(),
            NAMED,
            "{svg}"
        );
        assert!(
            PROGRAMS.iter().all(|(name, _)| named(name)) && !named("worse than all others"),
            "{svg}"
        );
        assert!(MARKS.iter().all(|(_, meaning)| named(meaning)), "{svg}");
        Ok(())
    }
}
