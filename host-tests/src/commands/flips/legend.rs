//! What the colours of a map say, as an SVG.

use std::fmt::Write;

use super::map::Map;
use super::output::{Colour, DOUBT, LATER, NEVER, scale};

/// Units across and down; the picture's width is as many units.
pub const SIZE: [u32; 2] = [512, 62];

/// Where the scale begins, how long it is, and in how many pieces.
const LEFT: f32 = 14.0;
const LENGTH: f32 = 250.0;
const PIECES: usize = 125;

/// The legend of `map`.
pub fn svg(map: &Map, doubt: bool) -> String {
    let [width, height] = SIZE;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" font-family=\"sans-serif\" \
         font-size=\"11\" fill=\"#222\"><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>"
    );
    let piece = LENGTH / PIECES as f32;
    for number in 0..PIECES {
        let x = LEFT + number as f32 * piece;
        square(&mut svg, [x, 8.0, piece + 0.3, 12.0], scale((number as f32 + 0.5) / PIECES as f32));
    }
    let mut times: Vec<f32> =
        std::iter::successors(Some(1.0), |time| Some(10.0 * time)).take_while(|&time| time < 0.7 * map.limit).collect();
    times.push(map.limit);
    for time in times {
        let x = LEFT + LENGTH * time.ln() / map.limit.ln();
        text(&mut svg, [x, 32.0], "middle", &time.to_string());
    }
    let kinds = [(NEVER, "cannot"), (LATER, "not by then"), (DOUBT, "in doubt")];
    let mut x = LEFT + LENGTH + 26.0;
    for (colour, name) in kinds.into_iter().take(if doubt { 3 } else { 2 }) {
        square(&mut svg, [x, 8.0, 12.0, 12.0], colour);
        text(&mut svg, [x + 17.0, 18.0], "start", name);
        x += 26.0 + 6.2 * name.len() as f32;
    }
    text(&mut svg, [LEFT + LENGTH + 26.0, 32.0], "start", "first turn-over of a rod, √(l₁/g)");
    let [a1, a2] = map.square.centre.map(f64::to_degrees);
    let half = map.square.half.to_degrees();
    let range = |angle: f64| format!("{}° to {}°", short(angle - half), short(angle + half));
    let masses = short(f64::from(map.parameters.m2 / map.parameters.m1));
    let lengths = short(f64::from(map.parameters.l2 / map.parameters.l1));
    let starts = format!("let go at α₁ → {}, α₂ ↑ {}; m₂/m₁ = {masses}, l₂/l₁ = {lengths}", range(a1), range(a2));
    text(&mut svg, [LEFT, 52.0], "start", &starts);
    svg + "</svg>"
}

/// To four digits after the point, without needless zeros.
fn short(number: f64) -> String {
    ((number * 1e4).round() / 1e4 + 0.0).to_string().replace('-', "−")
}

fn square(svg: &mut String, [x, y, width, height]: [f32; 4], [red, green, blue]: Colour) {
    let fill = format!("#{red:02x}{green:02x}{blue:02x}");
    let _ = write!(svg, "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{fill}\"/>");
}

fn text(svg: &mut String, [x, y]: [f32; 2], anchor: &str, words: &str) {
    let _ = write!(svg, "<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\">{words}</text>");
}
