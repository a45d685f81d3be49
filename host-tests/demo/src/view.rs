//! The layout of the terminal: the panel with the numbers next to it; below them the method and the
//! comparison, both angles and the log; and the keys.

use std::borrow::Cow;

use firmware::graphics::Format;
use firmware::protocol::PlayState;
use ratatui::Frame;
use ratatui::layout::Constraint::{Fill, Length, Min, Percentage};
use ratatui::layout::{Layout, Rect};
use ratatui::style::{Color, Stylize};
use ratatui::text::Line;
use ratatui::widgets::{Block, Paragraph};
use textwrap::{Options, WordSplitter, wrap};

use super::readings::{Help, Readings, stepping};
use super::{help, numbers, panel};
use boards::qemu::{LogLine, Screenshot};

const NARROWEST: u16 = 32;
const GAP: u16 = 1;
/// The rows for everything except the panel and the numbers, in a narrow terminal.
const WORDS: u16 = 7;
/// The rows of the chart of both angles, and its share of the width, percent.
const ANGLES: u16 = 7;
const ANGLES_WIDTH: u16 = 60;
const KEYS: [&str; 9] = [
    "↑↓ masses",
    "←→ angle",
    "space restart",
    "tab/shift-tab scene",
    "-+ speed",
    "p pause",
    ". step",
    "? help",
    "q quit",
];
const KEYS_ROWS: usize = 2;
const LEAST_USED: [usize; 2] = [4, 6];
const JOINT: &str = "\u{a0}";

/// Draws the whole terminal.
pub fn draw(
    frame: &mut Frame,
    board: &str,
    screenshot: &Screenshot,
    readings: &Readings,
    colours: bool,
) {
    let area = frame.area();
    let format = screenshot.format;
    let Some(width) = panel_width(area, format, colours) else {
        let least = (NARROWEST + GAP + numbers::NARROWEST, numbers::ROWS + WORDS);
        let text = format!(
            "terminal too small: {} x {}\nneeded: {} x {}",
            area.width, area.height, least.0, least.1
        );
        frame.render_widget(Paragraph::new(text), area);
        return;
    };
    if readings.help != Help::Hidden {
        return help::draw(frame, readings.help);
    }

    let now = readings.frame.as_ref();

    let words = now.map_or("no frame yet".to_owned(), |now| {
        format!("{} · {}", stepping(now), readings.comparison)
    });
    let words = rows(&words, area.width, "");
    let keys = keys(area.width);
    let height = panel_height(width, format);
    let top = height.max(numbers::ROWS);

    let parts = [
        Length(1),
        Length(top),
        Length(words.len() as u16),
        Min(0),
        Length(keys.len() as u16),
    ];
    let [title_at, top, words_at, lower, keys_at] = Layout::vertical(parts).areas(area);
    let [panel_at, side] = Layout::horizontal([Length(width), Min(0)])
        .spacing(GAP)
        .areas(top);

    let scene = now.map(|now| now.scene.name());
    let state = now.map(|now| now.state);
    let still = state.filter(|state| *state != PlayState::Playing);
    let speed = readings
        .speed
        .filter(|speed| *speed != 1.0)
        .map(|speed| format!("speed {speed}"));
    let title = [
        Some(board),
        scene,
        still.map(PlayState::name),
        speed.as_deref(),
    ]
    .into_iter()
    .flatten()
    .collect::<Vec<_>>()
    .join(" · ");
    frame.render_widget(Line::from(title).bold(), title_at);
    panel::draw(frame, Rect { height, ..panel_at }, screenshot, colours);
    numbers::draw(frame, side, readings);
    frame.render_widget(Paragraph::new(words.join("\n")), words_at);

    let mut log = lower;
    let block = Block::bordered().title("log");
    if lower.height >= ANGLES {
        let [angles, framed] = Layout::horizontal([Percentage(ANGLES_WIDTH), Fill(1)]).areas(lower);
        if now.is_none_or(|now| now.scene.has_angles()) {
            numbers::draw_angles(frame, angles, &readings.past);
        } else {
            let nothing = Paragraph::new("no motion here").block(Block::bordered().title("angles"));
            frame.render_widget(nothing, angles);
        }
        log = block.inner(framed);
        frame.render_widget(block, framed);
    }

    let latest = &readings.lines[readings.lines.len().saturating_sub(log.height.into())..];
    let lines: Vec<_> = latest
        .iter()
        .flat_map(|line| logged(line, log.width))
        .collect();
    let above = lines.len().saturating_sub(log.height.into());
    frame.render_widget(Paragraph::new(lines).scroll((above as u16, 0)), log);
    frame.render_widget(
        Paragraph::new(keys.join("\n").replace(JOINT, " ")).dim(),
        keys_at,
    );

    if !colours {
        frame
            .buffer_mut()
            .content
            .iter_mut()
            .for_each(|cell| (cell.fg, cell.bg) = (Color::Reset, Color::Reset));
    }
}

fn keys(width: u16) -> Vec<String> {
    let rows_of = |keys: Vec<&str>| {
        let keys: Vec<_> = keys.iter().map(|key| key.replace(' ', JOINT)).collect();
        rows(&keys.join("  "), width, "")
    };
    let all = rows_of(KEYS.to_vec());
    if all.len() <= KEYS_ROWS {
        return all;
    }
    // In two rows without the least-used keys.
    let few = (0..KEYS.len()).filter(|place| !LEAST_USED.contains(place));
    rows_of(few.map(|place| KEYS[place]).collect())
}

/// Returns the width of the panel in characters. In half blocks an OLED has whole pixels, and a
/// colour panel fills the room; in Braille at most one dot is a pixel. `None` if the terminal is too
/// small.
fn panel_width(area: Rect, format: Format, colours: bool) -> Option<u16> {
    let columns = area.width.checked_sub(GAP + numbers::NARROWEST)?;
    let rows = area.height.checked_sub(WORDS)?;
    let most = columns
        .min((2 * u32::from(rows) * u32::from(format.width) / u32::from(format.height)) as u16);
    let best = if !panel::in_half_blocks(format, most, colours) {
        format.width / 2
    } else if format.is_large() {
        most
    } else {
        most / format.width * format.width
    };
    let width = best.min(most / 4 * 4);
    (width >= NARROWEST && rows >= numbers::ROWS).then_some(width)
}

fn panel_height(width: u16, format: Format) -> u16 {
    let Format {
        width: pixels,
        height,
        ..
    } = format;
    (u32::from(width) * u32::from(height) / (2 * u32::from(pixels))) as u16
}

fn rows(text: &str, width: u16, indent: &str) -> Vec<String> {
    let options = Options::new(width.into())
        .subsequent_indent(indent)
        .word_splitter(WordSplitter::NoHyphenation);
    wrap(text, options)
        .into_iter()
        .map(Cow::into_owned)
        .collect()
}

fn logged(line: &LogLine, width: u16) -> Vec<Line<'static>> {
    let (level, colour) = match line.level.as_deref() {
        None => ("", Color::Red),
        Some("error") => ("error: ", Color::Red),
        Some("warn") => ("warning: ", Color::Yellow),
        Some(_) => ("", Color::Reset),
    };
    let rows = rows(&format!("{level}{}", line.text), width, "  ");
    rows.into_iter()
        .map(|row| Line::from(row).fg(colour))
        .collect()
}

#[cfg(test)]
mod tests {
    use boards::host::canvas;
    use double_pendulum::plan::Stepping;
    use double_pendulum::{Method, State};
    use firmware::graphics::PanelName;
    use firmware::graphics::text::{self, Anchor};
    use firmware::motion::Horizon;
    use firmware::protocol::Frame as Reading;
    use firmware::scenes::{Report, SceneName};
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;

    use super::*;
    use crate::snapshot;

    fn readings(scene: SceneName) -> Readings {
        let mut readings = Readings::default();
        let text = "plan: direction form, 4 steps to a frame, and as many words as make it longer \
                    than a pane is wide";
        readings.lines.push(LogLine {
            level: Some("info".to_owned()),
            text: text.to_owned(),
            place: String::new(),
        });

        for tick in 0..30_u32 {
            let time = 86_399.0 + f64::from(tick) / 60.0;
            readings.frame(Reading {
                sequence: tick,
                scene,
                state: PlayState::Paused,
                mass_ratio: 25.0 / 144.0,
                dropped: 123_456,
                report: Report {
                    time,
                    state: State {
                        a1: 0.5 * (6.0 * time).sin() as f32,
                        a2: -2.0,
                        ..State::default()
                    },
                    energy_error: -2.5e-7,
                    stepping: Some(Stepping {
                        method: Method::Extrapolation10Fixed64,
                        steps: 12,
                    }),
                    horizon: Horizon::AtLeast(86_400.0),
                    ..Report::default()
                },
                ..Reading::default()
            });
        }

        readings.arrivals.clear();
        readings.counts.damaged = 12_345;
        readings.start = Some([-179.9, 179.9]);
        readings
    }

    fn rows(readings: &Readings, colours: bool, (width, height): (u16, u16)) -> String {
        let mut canvas = canvas(Format::OLED);
        (0..128).for_each(|x| {
            [0, x / 2, 63]
                .into_iter()
                .for_each(|y| canvas.update(x, y, |_| 15))
        });
        text::write(&mut canvas, "μ 2.75", Anchor::Left(0));
        let mut terminal =
            Terminal::new(TestBackend::new(width, height)).expect("a terminal of characters");
        let drawn = |frame: &mut Frame| {
            draw(
                frame,
                "lm3s6965evb-m4",
                &Screenshot::from(&canvas),
                readings,
                colours,
            )
        };
        terminal.draw(drawn).expect("it is drawn");
        let cells = terminal.backend().buffer().content();
        // Without colours no cell may set one.
        assert!(
            colours
                || cells
                    .iter()
                    .all(|cell| (cell.fg, cell.bg) == (Color::Reset, Color::Reset))
        );

        let row = |row: &[ratatui::buffer::Cell]| {
            row.iter().map(|cell| cell.symbol()).collect::<String>()
        };
        cells
            .chunks(usize::from(width))
            .map(|cells| row(cells).trim_end().to_owned() + "\n")
            .collect()
    }

    #[test]
    fn panel_is_enlarged_where_its_text_stays_readable() {
        let shown = |panel: PanelName, columns, rows, colours| {
            let format = panel.format();
            let area = Rect::new(0, 0, columns, rows);
            let width = panel_width(area, format, colours).expect("room");
            (width, panel::in_half_blocks(format, width, colours))
        };
        for (panel, columns, rows, width, in_half_blocks) in [
            (PanelName::Oled, 80, 24, 64, false),
            (PanelName::Oled, 143, 39, 64, false),
            (PanelName::Oled, 144, 39, 128, true),
            (PanelName::Oled, 300, 100, 256, true),
            (PanelName::Lcd13, 80, 24, 32, false),
            (PanelName::Lcd13, 144, 39, 64, false),
            (PanelName::Lcd13, 136, 67, 120, true),
            (PanelName::Lcd13, 300, 100, 184, true),
        ] {
            let expected = (width, in_half_blocks);
            let case = format!("{} in {columns} x {rows}", panel.name());
            assert_eq!(shown(panel, columns, rows, true), expected, "{case}");
            assert!(!shown(panel, columns, rows, false).1, "{case}");
        }
    }

    /// The snapshots cover six sizes, scenes with and without a motion, and both pages of the help.
    #[test]
    fn common_terminals_look_as_they_did() {
        let butterfly = readings(SceneName::Butterfly);
        let help = |page| {
            let mut asking = readings(SceneName::Page);
            asking.help = page;
            asking
        };
        let mut slow = readings(SceneName::Page);
        slow.speed = Some(0.1);
        let shown = [
            ("150x45", rows(&butterfly, true, (150, 45))),
            ("100x30", rows(&butterfly, false, (100, 30))),
            ("80x24", rows(&butterfly, false, (80, 24))),
            ("60x20", rows(&butterfly, false, (60, 20))),
            ("47x24", rows(&butterfly, false, (47, 24))),
            (
                "nothing-moves",
                rows(&readings(SceneName::Flips), false, (100, 30)),
            ),
            ("no-frame", rows(&Readings::default(), false, (80, 24))),
            ("48x20", rows(&slow, false, (48, 20))),
            ("help-keys", rows(&help(Help::Keys), false, (48, 20))),
            ("help", rows(&help(Help::Numbers), false, (48, 20))),
        ];
        let check =
            |(name, rows): (_, String)| snapshot::check(&format!("terminal-{name}"), &rows).err();
        let differences: Vec<_> = shown.into_iter().filter_map(check).collect();
        assert!(differences.is_empty(), "{}", differences.join("\n"));
    }
}
