//! The terminal's layout: the panel and numbers beside it; both angles and the log below; and a line of keys.

use firmware::protocol::Frame as Reading;
use firmware::scenes::SceneName;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Stylize};
use ratatui::text::{Line, Text};
use ratatui::widgets::{Block, Paragraph, Sparkline, Wrap};

use super::panel::{Depth, Panel};
use super::plot;
use super::readings::Readings;
use super::summary::way;
use crate::emulator::qemu::{LogLine, Screenshot, WIDTH};

/// Columns for the numbers, their frame included.
const SIDE: u16 = 20;
/// Rows for the angles and the log, their frame included; more if there is room.
const LOWER: u16 = 7;
/// The share of the width that the angles have of that, percent.
const ANGLES: u16 = 60;
/// Rows for the keys.
const KEYS: u16 = 1;
/// Rows for the numbers, their frame and the smallest sparkline with its scale included.
const NUMBERS: u16 = 14;
/// The least scale of the energy errors: what is below a tenth of it is rounding and nothing to look at.
const LEAST_SCALE: f32 = 1e-6;
/// The panel's widths, columns: no wider than it has pixels, no narrower than makes sense.
const WIDEST: u16 = WIDTH as u16;
const NARROWEST: u16 = 32;
/// A frame takes a column or row on either side.
const FRAME: u16 = 2;

/// Draws everything.
pub fn draw(frame: &mut Frame, board: &str, screenshot: &Screenshot, readings: &Readings, depth: Depth) {
    let area = frame.area();
    let Some(width) = panel_width(area, depth) else {
        let least = (NARROWEST + FRAME + SIDE, NUMBERS + LOWER + KEYS);
        let text = format!("terminal too small: {} x {}\nneeded: {} x {}", area.width, area.height, least.0, least.1);
        frame.render_widget(Paragraph::new(text), area);
        return;
    };
    let top = (width / 4 + FRAME).max(NUMBERS);
    let [top, lower, keys] =
        Layout::vertical([Constraint::Length(top), Constraint::Min(LOWER), Constraint::Length(KEYS)]).areas(area);
    let [left, side] = Layout::horizontal([Constraint::Length(width + FRAME), Constraint::Min(SIDE)]).areas(top);

    let bits = format!(" {} · {} ", way(&readings.frame), readings.comparison);
    let panel = Block::bordered().title(title(board, &readings.frame).bold()).title_bottom(bits);
    let inside = panel.inner(left);
    frame.render_widget(panel, left);
    let inside = Rect { width, height: (width / 4).min(inside.height), ..inside };
    frame.render_widget(Panel { screenshot, depth }, inside);

    numbers(frame, side, readings, depth);
    let [angles, log] = Layout::horizontal([Constraint::Percentage(ANGLES), Constraint::Fill(1)]).areas(lower);
    if moves(&readings.frame) {
        plot::draw(frame, angles, &readings.angles, depth);
    } else {
        let text = "No motion here: the panel shows both frequencies over the mass ratio.";
        let paragraph = Paragraph::new(text).wrap(Wrap { trim: true });
        frame.render_widget(paragraph.block(Block::bordered().title("angles")), angles);
    }
    let block = Block::bordered().title("log");
    let (width, height) = (log.width.saturating_sub(FRAME), log.height.saturating_sub(FRAME));
    let lines: Vec<_> = readings.lines.iter().flat_map(|line| wrapped(line, width.into(), depth)).collect();
    let first = lines.len().saturating_sub(height.into());
    frame.render_widget(Paragraph::new(Text::from_iter(lines.into_iter().skip(first))).block(block), log);
    let help = " ↑ ↓ mass ratio  ← → angle  space restart  tab scene  p pause  . step  q quit";
    frame.render_widget(Line::from(help).dim(), keys);
}

/// What is played on which board.
fn title(board: &str, now: &Reading) -> String {
    let scene = SceneName::from_code(now.scene).map_or("?", SceneName::name);
    format!(" {board} · {scene}{} ", if now.paused != 0 { " · paused" } else { "" })
}

/// Whether anything of the scene moves.
fn moves(now: &Reading) -> bool {
    now.scene != SceneName::Frequencies.code()
}

/// The widest panel that leaves room for the rest, in steps that keep its shape; `None` if there is none. Of dots that are
/// on or off each is one pixel, if there is room for that.
fn panel_width(area: Rect, depth: Depth) -> Option<u16> {
    let columns = area.width.checked_sub(SIDE + FRAME)?;
    let rows = area.height.checked_sub(LOWER + KEYS + FRAME)?;
    let width = columns.min(4 * rows).min(WIDEST) / 4 * 4;
    let width = if depth == Depth::None && width >= WIDEST / 2 { width / (WIDEST / 2) * (WIDEST / 2) } else { width };
    (width >= NARROWEST && area.height >= NUMBERS + LOWER + KEYS).then_some(width)
}

fn numbers(frame: &mut Frame, area: Rect, readings: &Readings, depth: Depth) {
    let now = &readings.frame;
    let [a1, a2, ..] = now.state;
    let of_motion = |text: String| if moves(now) { text } else { "-".to_owned() };
    let angle = |angle: f32| of_motion(format!("{:.1}°", plot::within_half_a_turn(f64::from(angle).to_degrees())));
    let rows = [
        ("mass ratio", format!("{}", now.mass_ratio)),
        ("start", of_motion(start(readings.start.unwrap_or([now.start_angle.to_degrees(); 2])))),
        ("angle 1", angle(a1)),
        ("angle 2", angle(a2)),
        ("time", format!("{:.2} s", now.time)),
        ("frames/s", format!("{}", readings.rate())),
        ("dropped", format!("{}", now.dropped)),
        ("CRC errors", format!("{}", readings.counts.damaged)),
        ("energy err", of_motion(format!("{:+.1e}", now.energy_error))),
    ];
    let block = Block::bordered().title("now");
    let inside = block.inner(area);
    frame.render_widget(block, area);
    let heights = [Constraint::Length(rows.len() as u16), Constraint::Length(1), Constraint::Min(1)];
    let [table, legend, spark] = Layout::vertical(heights).areas(inside);
    let width = usize::from(SIDE - FRAME);
    let lines = rows.iter().map(|(name, value)| {
        let space = width.saturating_sub(name.chars().count());
        Line::from(vec![(*name).dim(), format!("{value:>space$}").bold()])
    });
    frame.render_widget(Paragraph::new(lines.collect::<Text>()), table);
    if moves(now) {
        energy_errors(frame, legend, spark, readings, depth);
    }
}

/// The angles at the start, degrees: one if both rods have the same.
fn start([degrees1, degrees2]: [f32; 2]) -> String {
    let [degrees1, degrees2] = [degrees1, degrees2].map(|degrees| (10.0 * degrees).round() / 10.0);
    if degrees1 == degrees2 { format!("{degrees1}°") } else { format!("{degrees1}°, {degrees2}°") }
}

/// The size of the energy error, the largest of each half second, as bars up to a power of ten, which is told.
fn energy_errors(frame: &mut Frame, legend: Rect, area: Rect, readings: &Readings, depth: Depth) {
    const HEIGHT: f32 = 1000.0;
    let errors = &readings.energy_errors;
    let greatest = errors.iter().copied().fold(LEAST_SCALE, f32::max);
    let exponent = greatest.log10().ceil() as i32;
    frame.render_widget(Line::from(format!("its size, 0 to 1e{exponent}")).dim(), legend);
    let shown = errors.iter().skip(errors.len().saturating_sub(usize::from(area.width)));
    let bars = shown.map(|error| (error / 10.0_f32.powi(exponent) * HEIGHT) as u64).collect::<Vec<_>>();
    let sparkline = Sparkline::default().data(bars).max(HEIGHT as u64).style(depth.style(Color::Yellow));
    frame.render_widget(sparkline, area);
}

/// A line of the log in as many of the pane's as it takes, broken between words; where it was written is left out.
fn wrapped(line: &LogLine, width: usize, depth: Depth) -> Vec<Line<'static>> {
    let (level, colour) = match line.level.as_deref() {
        None => ("", Color::Red),
        Some("error") => ("error: ", Color::Red),
        Some("warn") => ("warning: ", Color::Yellow),
        Some(_) => ("", Color::Reset),
    };
    let mut rows: Vec<String> = Vec::new();
    for word in format!("{level}{}", line.text).split_whitespace() {
        match rows.last_mut() {
            Some(row) if row.chars().count() + 1 + word.chars().count() <= width => *row = format!("{row} {word}"),
            // What continues a line stands back.
            _ => rows.push(if rows.is_empty() { word.to_owned() } else { format!("  {word}") }),
        }
    }
    rows.into_iter().map(|row| Line::styled(row, depth.style(colour))).collect()
}

#[cfg(test)]
mod tests {
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;

    use super::*;

    /// What the terminal shows after half a second of figure 7, row by row.
    fn rows(width: u16, height: u16) -> Vec<String> {
        rows_of(SceneName::Figure7, Depth::True, width, height)
    }

    fn rows_of(scene: SceneName, depth: Depth, width: u16, height: u16) -> Vec<String> {
        let mut readings = Readings::default();
        let text =
            "plan: direction form, 4 steps to a frame, and as many words as make it longer than any pane is wide";
        readings.line(LogLine { level: Some("info".to_owned()), text: text.to_owned(), place: None });
        for tick in 0..30_u32 {
            let time = f64::from(tick) / 60.0;
            let state = [0.5 * (6.0 * time).sin() as f32, -2.0, 0.0, 0.0];
            readings.frame(Reading {
                sequence: tick,
                scene: scene.code(),
                paused: 1,
                time,
                mass_ratio: 2.75,
                state,
                energy_error: 2.5e-7,
                ..Reading::default()
            });
        }
        readings.start = Some([0.0, 30.0]);
        let mut terminal = Terminal::new(TestBackend::new(width, height)).expect("a terminal of characters");
        let drawn = |frame: &mut Frame| draw(frame, "board", &Screenshot::blank(), &readings, depth);
        terminal.draw(drawn).expect("it is drawn");
        let cells = terminal.backend().buffer().content().chunks(usize::from(width));
        cells.map(|row| row.iter().map(|cell| cell.symbol()).collect()).collect()
    }

    /// Characters that draw curves, all rows together.
    fn braille(rows: &[String]) -> usize {
        rows.iter().flat_map(|row| row.chars()).filter(|c| ('\u{2801}'..='\u{28FF}').contains(c)).count()
    }

    #[test]
    fn scene_numbers_curves_and_keys_are_in_view_on_a_common_terminal() {
        for (width, height) in [(80, 24), (120, 40), (200, 60)] {
            let rows = rows(width, height);
            let texts =
                ["board · figure-7 · paused", "2.75", "0°, 30°", "-114.6°", "+2.5e-7", "0 to 1e-6", "angles, degrees"];
            for text in texts.into_iter().chain(["1 ⠤⠤  2 ••", "180", "5.0 s", "log", "plan: direction", "wide"])
            {
                assert!(rows.iter().any(|row| row.contains(text)), "no {text:?} in\n{rows:#?}");
            }
            for key in ["↑ ↓ mass ratio", "← → angle", "space restart", "tab scene", "p pause", ". step", "q quit"]
            {
                assert!(rows[usize::from(height) - 1].contains(key), "no {key:?} in {:?}", rows.last());
            }
            assert!(braille(&rows) > 3, "{width} x {height}: no curves in\n{rows:#?}");
        }
    }

    #[test]
    fn a_terminal_too_small_is_told_what_is_needed() {
        let rows = rows(53, 24);
        assert!(rows[0].contains("too small: 53 x 24") && rows[1].contains("needed: 54 x 22"), "{rows:#?}");
        assert!(!self::rows(54, 22)[0].contains("too small"));
    }

    #[test]
    fn both_angles_can_be_told_apart_without_colours() {
        let rows = rows_of(SceneName::Page, Depth::None, 80, 24);
        assert!(braille(&rows) > 3, "{rows:#?}");
        let dots = rows.iter().flat_map(|row| row.chars()).filter(|c| *c == '•').count();
        assert!(dots > 4, "{dots} in\n{rows:#?}");
    }

    #[test]
    fn where_nothing_moves_no_motion_is_drawn() {
        let rows = rows_of(SceneName::Frequencies, Depth::True, 80, 24);
        assert!(rows.iter().any(|row| row.contains("No motion here")), "{rows:#?}");
        assert!(rows.iter().all(|row| !row.contains("0.0°") && !row.contains("e-7")), "{rows:#?}");
    }
}
