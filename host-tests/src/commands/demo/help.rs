//! What each number on the panel and in the terminal means, over all of the terminal.

use ratatui::Frame;
use ratatui::style::Stylize;
use ratatui::text::{Line, Text};
use ratatui::widgets::{Block, Clear, Paragraph, Wrap};

const MEANINGS: [(&str, &str); 11] = [
    ("½px>19.8 s on the panel", "right to half a pixel until 19.8 s at least; ½px ok: for ever"),
    ("μ, mass ratio", "mass of bob 2 over that of bob 1"),
    ("time", "simulated, since the motion began"),
    ("start, angle 1, angle 2", "of the rods, from hanging straight down"),
    ("frames/s", "frames that came in the last second; 60 are due"),
    ("dropped", "frames that the board had no time to send"),
    ("CRC errors", "messages that were damaged on the way"),
    ("energy error", "what the arithmetic has added, relative to the energy above rest"),
    ("bars below it", "its size, the largest of each half second"),
    ("every bit the host's", "each frame is equal to one computed here"),
    ("not compared", "frames before the board said what it plays"),
];

pub fn draw(frame: &mut Frame) {
    let line = |(name, meaning): (&str, &'static str)| Line::from(vec![format!("{name}: ").bold(), meaning.into()]);
    let text: Text = MEANINGS.into_iter().map(line).collect();
    let block = Block::bordered().title("what the numbers mean; ? goes back");
    frame.render_widget(Clear, frame.area());
    frame.render_widget(Paragraph::new(text).wrap(Wrap { trim: true }).block(block), frame.area());
}
