//! A figure on paper: an SVG file with the same bytes in every run.
//!
//! A unit of length is as wide as a pixel of a common screen. It has 8 dots, which are the pixels
//! of the drawing areas.

use anyhow::Result;
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// The number of plotters' dots in a unit of length. Plotters draws on whole dots; a unit is as
/// wide as a pixel of a common screen.
const DOTS: u32 = 8;
const TYPEFACE: &str = "sans-serif";

pub const TEXT: RGBColor = RGBColor(34, 34, 34);
pub const GRID: RGBColor = RGBColor(225, 225, 225);
/// It and [`ORANGE`] can be distinguished without colour vision.
pub const BLUE: RGBColor = RGBColor(0, 95, 175);
pub const ORANGE: RGBColor = RGBColor(205, 85, 15);

pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub type Axes<'a> = ChartContext<'a, SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

pub const fn units(length: u32) -> u32 {
    length * DOTS
}

/// The `width` is in tenths of a unit.
pub fn line(colour: RGBColor, width: u32) -> ShapeStyle {
    colour.stroke_width(units(width).div_ceil(10))
}

pub fn pale(RGBColor(red, green, blue): RGBColor, strength: f64) -> RGBColor {
    let [red, green, blue] =
        [red, green, blue].map(|channel| (255.0 - strength * (255.0 - f64::from(channel))) as u8);
    RGBColor(red, green, blue)
}

pub fn text(height: u32) -> TextStyle<'static> {
    (TYPEFACE, units(height)).into_font().color(&TEXT)
}

/// Writes a centred line into the top of the area and returns the rest.
pub fn headed<'a>(area: &Area<'a>, line: &str, style: TextStyle<'_>) -> Result<Area<'a>> {
    let (head, rest) = area.split_vertically(units(23));
    let (width, height) = head.dim_in_pixel();
    let centred = style.pos(Pos::new(HPos::Center, VPos::Bottom));
    head.draw_text(line, &centred, (width as i32 / 2, height as i32))?;
    Ok(rest)
}

/// Draws axes. Each has a quantity with its unit (empty if the chart below names it), a range, and
/// a largest number of labels.
pub fn axes<'a>(
    area: &Area<'a>,
    (across, [left, right]): (&str, [f64; 2]),
    (upwards, [bottom, top]): (&str, [f64; 2]),
    [columns, rows]: [usize; 2],
) -> Result<Axes<'a>> {
    let mut chart = ChartBuilder::on(area)
        .margin(units(6))
        .margin_right(units(16))
        .x_label_area_size(units(if across.is_empty() { 20 } else { 40 }))
        .y_label_area_size(units(54))
        .build_cartesian_2d(left..right, bottom..top)?;

    // A chart without a name of its horizontal quantity shares the axis of the chart below.
    let mut mesh = chart.configure_mesh();
    if !across.is_empty() {
        mesh.x_desc(across);
    }
    mesh.y_desc(upwards)
        .x_labels(columns)
        .y_labels(rows)
        .x_label_formatter(&plain)
        .y_label_formatter(&plain)
        .label_style(text(12))
        .axis_desc_style(text(13))
        .set_all_tick_mark_size(units(5))
        .axis_style(line(TEXT, 10))
        .bold_line_style(line(GRID, 10))
        .light_line_style(TRANSPARENT)
        .draw()?;
    Ok(chart)
}

fn plain(number: &f64) -> String {
    // The ticks are multiples of a round number, except for rounding. The sum with 0 turns -0 into
    // 0.
    let rounded = (number * 1e6).round() / 1e6 + 0.0;
    rounded.to_string().replace('-', "−")
}

/// Returns a figure as an SVG file: its title, the other lines, and `draw` in the area below them.
pub fn svg<const N: usize>(
    [width, height]: [u32; 2],
    lines: [&str; N],
    draw: impl FnOnce(&Area) -> Result<()>,
) -> Result<String> {
    let mut file = String::new();
    let area =
        SVGBackend::with_string(&mut file, (units(width), units(height))).into_drawing_area();
    area.fill(&WHITE)?;

    // The first line is the title, in larger letters than the others.
    let styles = [15].into_iter().chain(std::iter::repeat(12)).map(text);
    draw(
        &lines
            .into_iter()
            .zip(styles)
            .try_fold(area.clone(), |area, (line, style)| {
                headed(&area, line, style)
            })?,
    )?;
    area.present()?;
    drop(area);

    // The SVG is shown in its own size, and its coordinates remain dots.
    let in_dots = format!(
        "<svg width=\"{}\" height=\"{}\"",
        units(width),
        units(height)
    );
    Ok(file.replacen(
        &in_dots,
        &format!("<svg width=\"{width}\" height=\"{height}\""),
        1,
    ))
}
