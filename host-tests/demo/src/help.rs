//! The pages of the help: the keys and the scenes, then the numbers on the screen.

use firmware::scenes::SceneName;
use ratatui::Frame;
use ratatui::style::Stylize;
use ratatui::text::{Line, Text};
use ratatui::widgets::{Block, Paragraph, Wrap};

use super::options::{KEYS, scene_key};
use super::readings::Help;

const NUMBERS: [(&str, &str); 9] = [
    (
        "½px or ½ pixel, >19.8 s",
        "accurate to half a pixel until at least 19.8 s; without >: until then; ?: not known yet; \
         ok: for ever",
    ),
    ("μ, mass ratio", "mass of bob 2 over that of bob 1"),
    ("time", "simulated time since the motion began"),
    (
        "start, angle 1, 2",
        "of the rods, from hanging straight down",
    ),
    ("frames/s", "frames in the last second; 60 are due"),
    ("dropped", "frames skipped because the board was busy"),
    (
        "energy error",
        "of the motion as computed, relative to the energy above hanging at rest; < 4e-15: too \
         little for f64 to show",
    ),
    ("bars", "its largest size in each half second"),
    (
        "identical to the host",
        "the host computes every frame again and compares all bits",
    ),
];

pub fn draw(frame: &mut Frame, page: Help) {
    let (title, text) = match page {
        Help::Hidden => return,
        Help::Keys => ("keys; ? for the numbers, Esc goes back", keys()),
        Help::Numbers => ("what the numbers mean; Esc goes back", entries(&NUMBERS)),
    };
    let block = Block::bordered().title(title);
    frame.render_widget(
        Paragraph::new(text).wrap(Wrap { trim: true }).block(block),
        frame.area(),
    );
}

fn keys() -> Text<'static> {
    let mut text = entries(&KEYS);
    let scenes = SceneName::ALL
        .iter()
        .enumerate()
        .map(|(place, scene)| format!("{} {}", scene_key(place), scene.name()));
    text.push_line(Line::from(vec![
        "scenes: ".bold(),
        scenes.collect::<Vec<_>>().join(", ").into(),
    ]));
    text
}

fn entries(entries: &[(&'static str, &'static str)]) -> Text<'static> {
    entries
        .iter()
        .map(|(name, meaning)| Line::from(vec![format!("{name}: ").bold(), (*meaning).into()]))
        .collect()
}
