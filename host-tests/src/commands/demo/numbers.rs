//! The latest numbers in a column beside the panel, the energy error's past as bars below them; and what they mean.

use double_pendulum::State;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Stylize};
use ratatui::text::{Line, Text};
use ratatui::widgets::{Block, Clear, Paragraph, Sparkline, Wrap};

use super::plot;
use super::readings::Readings;
use super::view::has_angles;

/// Columns that they need, and beyond which a value would be far from its name.
pub const NARROWEST: u16 = 15;
const WIDEST: u16 = 24;
/// Rows that they need in the narrowest column.
pub const ROWS: u16 = 13;
/// The least scale of the energy errors: what is below a tenth of it is rounding and nothing to look at.
const LEAST_SCALE: f32 = 1e-6;

pub fn draw(frame: &mut Frame, area: Rect, readings: &Readings) {
    let area = Rect { width: area.width.min(WIDEST), ..area };
    let lines: Vec<_> = rows(readings).into_iter().flat_map(|row| lines(row, area.width.into())).collect();
    let rows = lines.len() as u16;
    let scale = area.height.saturating_sub(rows).min(1);
    let heights = [Constraint::Length(rows), Constraint::Length(scale), Constraint::Min(0)];
    let [table, scale, bars] = Layout::vertical(heights).areas(area);
    frame.render_widget(Paragraph::new(Text::from(lines)), table);
    if readings.frame.as_ref().is_some_and(has_angles) && bars.height > 0 {
        energy_errors(frame, scale, bars, readings);
    }
}

fn rows(readings: &Readings) -> [(&'static str, String); 9] {
    let (is_shown, moves) = (readings.frame.is_some(), readings.frame.as_ref().is_some_and(has_angles));
    let now = readings.frame.unwrap_or_default();
    // Those at the start, one if both rods have the same.
    let degrees = readings.start.unwrap_or([now.start_angle.to_degrees(); 2]).map(|degrees| rounded(degrees, 1) + "°");
    let start = if degrees[0] == degrees[1] { degrees[0].clone() } else { degrees.join(", ") };
    let State { a1, a2, .. } = now.report.state;
    let [angle_1, angle_2] = [a1, a2].map(|angle| plot::within_half_a_turn(f64::from(angle).to_degrees()));
    let rows = [
        ("time", is_shown, format!("{:.2} s", now.report.time)),
        ("mass ratio", is_shown, rounded(now.mass_ratio, 4)),
        ("start", moves, start),
        ("angle 1", moves, format!("{angle_1:.1}°")),
        ("angle 2", moves, format!("{angle_2:.1}°")),
        ("frames/s", is_shown, readings.rate().to_string()),
        ("dropped", is_shown, now.dropped.to_string()),
        ("CRC errors", true, readings.counts.damaged.to_string()),
        ("energy error", moves, format!("{:+.1e}", now.report.energy_error)),
    ];
    rows.map(|(name, is_known, value)| (name, if is_known { value } else { "-".to_owned() }))
}

/// A row as one line, or as two where it would not fit into one.
fn lines((name, value): (&'static str, String), width: usize) -> Vec<Line<'static>> {
    let left = width.saturating_sub(name.chars().count());
    if value.chars().count() < left {
        return vec![Line::from(vec![name.dim(), format!("{value:>left$}").bold()])];
    }
    vec![Line::from(name).dim(), Line::from(format!("{value:>width$}")).bold()]
}

fn rounded(number: f32, decimals: i32) -> String {
    let unit = 10_f64.powi(decimals);
    ((f64::from(number) * unit).round() / unit).to_string()
}

/// The size of the energy error, the largest of each half second, as bars up to a power of ten, which is told.
fn energy_errors(frame: &mut Frame, scale: Rect, area: Rect, readings: &Readings) {
    const HEIGHT: f32 = 1000.0;
    let errors = &readings.energy_errors;
    let greatest = errors.iter().copied().fold(LEAST_SCALE, f32::max);
    let exponent = greatest.log10().ceil() as i32;
    frame.render_widget(Line::from(format!("error 0 to 1e{exponent}")).dim(), scale);
    let shown = &errors[errors.len().saturating_sub(usize::from(area.width))..];
    let bars = shown.iter().map(|error| (error / 10.0_f32.powi(exponent) * HEIGHT) as u64).collect::<Vec<_>>();
    frame.render_widget(Sparkline::default().data(bars).max(HEIGHT as u64).fg(Color::Yellow), area);
}

const MEANINGS: [(&str, &str); 10] = [
    ("½px>19.8 s on the panel", "right to half a pixel until 19.8 s at least; ½px ok: for ever"),
    ("μ, mass ratio", "mass of bob 2 over that of bob 1"),
    ("time", "simulated, since the motion began"),
    ("start, angle 1, angle 2", "of the rods, from hanging straight down"),
    ("frames/s", "frames that came in the last second; 60 are due"),
    ("dropped", "frames that the board had no time to send"),
    ("CRC errors", "messages that were damaged on the way"),
    ("energy error", "what the arithmetic has added, relative to the energy above rest"),
    ("bars below it", "its size, the largest of each half second"),
    ("every bit the host's", "each frame is equal to one computed here, once the board has said what it plays"),
];

pub fn draw_help(frame: &mut Frame) {
    let line = |(name, meaning): (&str, &'static str)| Line::from(vec![format!("{name}: ").bold(), meaning.into()]);
    let text: Text = MEANINGS.into_iter().map(line).collect();
    let block = Block::bordered().title("what the numbers mean; ? goes back");
    frame.render_widget(Clear, frame.area());
    frame.render_widget(Paragraph::new(text).wrap(Wrap { trim: true }).block(block), frame.area());
}
