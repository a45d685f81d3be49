//! The picture of a motion that cannot be computed.

use double_pendulum::Method;

use crate::graphics::{Anchor, Canvas, label, text};
use crate::motion::Settings;

/// Writes that the motion is too fast, for a requested `method` or for this chip, and the numbers
/// that a user can change by the buttons.
pub fn too_fast(settings: &Settings, method: Option<Method>, canvas: &mut Canvas) {
    let of = match method {
        None => "for this chip",
        Some(_) => "for this method",
    };
    let [angle, _] = settings.degrees;
    let mass_ratio = label::mass_ratio(settings.mass_ratio());
    let angle = label::degrees("α ", angle);

    // The scene needs its ink no more.
    canvas.clear_ink();
    let canvas = canvas.on_clear_foreground();
    let line = canvas.format.line();
    let top = (canvas.format.bottom() - 8 * line) / 2;
    for (number, words) in [(2, "too fast"), (3, of), (5, &mass_ratio), (6, &angle)] {
        text::write(canvas, words, Anchor::Middle(top + number * line));
    }
}
