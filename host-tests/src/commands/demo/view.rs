//! The terminal's layout: the panel and numbers beside it; both angles and the log below; and a line of keys.

use firmware::protocol::Frame as Reading;
use firmware::scenes::SceneName;
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Style, Stylize};
use ratatui::text::{Line, Text};
use ratatui::widgets::{Block, Paragraph, Sparkline};

use super::panel::{Depth, Panel};
use super::plot;
use super::readings::Readings;
use crate::emulator::qemu::{LogLine, Screenshot, WIDTH};

/// Columns for the numbers, their frame included.
const SIDE: u16 = 20;
/// Rows for the angles and the log, their frame included; more if there is room.
const LOWER: u16 = 7;
/// The share of the width that the angles have of that, percent.
const ANGLES: u16 = 60;
/// Rows for the keys.
const KEYS: u16 = 1;
/// Rows for the numbers, their frame and the smallest sparkline included.
const NUMBERS: u16 = 14;
/// The panel's widths, columns: no wider than it has pixels, no narrower than makes sense.
const WIDEST: u16 = WIDTH as u16;
const NARROWEST: u16 = 32;
/// A frame takes a column or row on either side.
const FRAME: u16 = 2;

/// Draws everything.
pub fn draw(frame: &mut Frame, board: &str, screenshot: &Screenshot, readings: &Readings, depth: Depth) {
    let area = frame.area();
    let Some(width) = panel_width(area) else {
        let least = (NARROWEST + FRAME + SIDE, NUMBERS + LOWER + KEYS);
        let text = format!("terminal too small: {} x {}\nneeded: {} x {}", area.width, area.height, least.0, least.1);
        frame.render_widget(Paragraph::new(text), area);
        return;
    };
    let top = (width / 4 + FRAME).max(NUMBERS);
    let [top, lower, keys] =
        Layout::vertical([Constraint::Length(top), Constraint::Min(LOWER), Constraint::Length(KEYS)]).areas(area);
    let [left, side] = Layout::horizontal([Constraint::Length(width + FRAME), Constraint::Min(SIDE)]).areas(top);

    let panel = Block::bordered().title(title(board, &readings.frame).bold());
    let inside = panel.inner(left);
    frame.render_widget(panel, left);
    let inside = Rect { width, height: (width / 4).min(inside.height), ..inside };
    frame.render_widget(Panel { screenshot, depth }, inside);

    numbers(frame, side, readings);
    let [angles, log] = Layout::horizontal([Constraint::Percentage(ANGLES), Constraint::Fill(1)]).areas(lower);
    plot::draw(frame, angles, &readings.angles);
    let block = Block::bordered().title("log");
    let rows = usize::from(log.height.saturating_sub(FRAME));
    let lines = readings.lines.iter().skip(readings.lines.len().saturating_sub(rows)).map(styled);
    frame.render_widget(Paragraph::new(lines.collect::<Text>()).block(block), log);
    let help = " ↑ ↓ mass ratio  ← → angle  space restart  tab scene  p pause  . step  q quit";
    frame.render_widget(Line::from(help).dim(), keys);
}

/// What is played on which board.
fn title(board: &str, now: &Reading) -> String {
    let scene = SceneName::from_code(now.scene).map_or("?", SceneName::name);
    format!(" {board} · {scene}{} ", if now.paused != 0 { " · paused" } else { "" })
}

/// The widest panel that leaves room for the rest, in steps that keep its shape; `None` if there is none.
fn panel_width(area: Rect) -> Option<u16> {
    let columns = area.width.checked_sub(SIDE + FRAME)?;
    let rows = area.height.checked_sub(LOWER + KEYS + FRAME)?;
    let width = columns.min(4 * rows).min(WIDEST) / 4 * 4;
    (width >= NARROWEST && area.height >= NUMBERS + LOWER + KEYS).then_some(width)
}

fn numbers(frame: &mut Frame, area: Rect, readings: &Readings) {
    let now = &readings.frame;
    let [a1, a2, ..] = now.state.map(f32::to_degrees);
    let rows = [
        ("mass ratio", format!("{}", now.mass_ratio)),
        ("start", format!("{:.1}°", now.start_angle.to_degrees())),
        ("angle 1", format!("{a1:.1}°")),
        ("angle 2", format!("{a2:.1}°")),
        ("time", format!("{:.2} s", now.time)),
        ("frames/s", format!("{}", readings.rate())),
        ("dropped", format!("{}", now.dropped)),
        ("CRC errors", format!("{}", readings.counts.damaged)),
        ("energy err", format!("{:+.1e}", now.energy_error)),
    ];
    let block = Block::bordered().title("now");
    let inside = block.inner(area);
    frame.render_widget(block, area);
    let heights = [Constraint::Length(rows.len() as u16), Constraint::Min(1)];
    let [table, spark] = Layout::vertical(heights).areas(inside);
    let width = usize::from(SIDE - FRAME);
    let lines = rows.iter().map(|(name, value)| {
        let space = width.saturating_sub(name.chars().count());
        Line::from(vec![(*name).dim(), format!("{value:>space$}").bold()])
    });
    frame.render_widget(Paragraph::new(lines.collect::<Text>()), table);

    let errors = &readings.energy_errors;
    let shown = errors.iter().skip(errors.len().saturating_sub(usize::from(spark.width)));
    let greatest = errors.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
    const HEIGHT: f32 = 1000.0;
    let bars = shown.map(|error| (error / greatest * HEIGHT) as u64).collect::<Vec<_>>();
    let sparkline = Sparkline::default().data(bars).max(HEIGHT as u64).style(Style::new().yellow());
    frame.render_widget(sparkline, spark);
}

fn styled(line: &LogLine) -> Line<'_> {
    let text = Line::from(line.to_string());
    match line.level.as_deref() {
        None | Some("error") => text.red(),
        Some("warn") => text.yellow(),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;

    use super::*;

    /// What the terminal shows after half a second of a scene, row by row.
    fn rows(width: u16, height: u16) -> Vec<String> {
        let mut readings = Readings::default();
        for tick in 0..30_u32 {
            let time = f64::from(tick) / 60.0;
            let state = [0.5 * (6.0 * time).sin() as f32, -2.0, 0.0, 0.0];
            let scene = SceneName::Figure7.code();
            readings.frame(Reading {
                sequence: tick,
                scene,
                paused: 1,
                time,
                mass_ratio: 2.75,
                state,
                ..Reading::default()
            });
        }
        let mut terminal = Terminal::new(TestBackend::new(width, height)).expect("a terminal of characters");
        let drawn = |frame: &mut Frame| draw(frame, "board", &Screenshot::blank(), &readings, Depth::True);
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
            for text in ["board · figure-7 · paused", "2.75", "-114.6°", "angles, degrees", "180", "5.0 s", "log"] {
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
}
