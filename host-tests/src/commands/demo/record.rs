//! Screenshot files: what the panel showed as an animation (GIF) or one screenshot of it (PNG).

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use anyhow::Context;
use firmware::config::TICK_RATE;
use gif::{Encoder, Frame, Repeat};

use super::tint;
use crate::emulator::qemu::{HEIGHT, Screenshot, WIDTH};

/// Every pixel of the panel becomes a square of this many by as many.
const SCALE: usize = 3;
/// The board's ticks from one screenshot to the next: 60/2 = 30 frames per second.
const TICKS_PER_FRAME: u32 = TICK_RATE / 30;
/// In a screenshot after the first: as it was. The palette's first colour after the greys.
const UNCHANGED: u8 = 16;
/// GIF counts time in hundredths of a second.
const GIF_RATE: u64 = 100;

/// An animation being written.
pub struct Recording {
    encoder: Encoder<BufWriter<File>>,
    /// The screenshot to be shown next, and since which tick; it is written when its end is known.
    pending: Option<(Screenshot, u32)>,
    /// The screenshot that the file shows so far.
    shown: Option<Screenshot>,
    /// The tick of the first screenshot.
    start: u32,
}

impl Recording {
    /// Begins the file.
    pub fn create(path: &Path) -> anyhow::Result<Self> {
        let file = File::create(path).with_context(|| format!("cannot write {}", path.display()))?;
        let size = |pixels: usize| (pixels * SCALE) as u16;
        let palette = [tint::palette(), vec![0; 3]].concat();
        let mut encoder = Encoder::new(BufWriter::new(file), size(WIDTH), size(HEIGHT), &palette)?;
        encoder.set_repeat(Repeat::Infinite)?;
        Ok(Self { encoder, pending: None, shown: None, start: 0 })
    }

    /// Whether a screenshot of `tick` does not come too soon after the last.
    pub fn is_due(&self, tick: u32) -> bool {
        self.pending.as_ref().is_none_or(|(_, since)| tick.wrapping_sub(*since) >= TICKS_PER_FRAME)
    }

    /// Takes the screenshot that the panel shows from `tick` on; one that comes too soon after the last is left out.
    pub fn add(&mut self, screenshot: Screenshot, tick: u32) -> anyhow::Result<()> {
        if !self.is_due(tick) {
            return Ok(());
        }
        if self.pending.is_none() {
            self.start = tick;
        }
        self.flush(tick)?;
        self.pending = Some((screenshot, tick));
        Ok(())
    }

    /// Writes the last screenshot, shown as long as the others, and completes the file.
    pub fn finish(mut self) -> anyhow::Result<()> {
        let end = self.pending.as_ref().map_or(0, |(_, since)| since.wrapping_add(TICKS_PER_FRAME));
        self.flush(end)
    }

    /// Writes the pending screenshot, whose time ends at `tick`.
    fn flush(&mut self, tick: u32) -> anyhow::Result<()> {
        let Some((screenshot, since)) = self.pending.take() else { return Ok(()) };
        let hundredths = |tick: u32| {
            let ticks = u64::from(tick.wrapping_sub(self.start));
            (ticks * GIF_RATE + u64::from(TICK_RATE) / 2) / u64::from(TICK_RATE)
        };
        let delay = u16::try_from(hundredths(tick) - hundredths(since)).unwrap_or(u16::MAX);
        let [width, height] = [WIDTH, HEIGHT].map(|pixels| (pixels * SCALE) as u16);
        // Few pixels change, which leaves long runs of one value.
        let change = |x, y| match (&self.shown, screenshot.grey(x, y)) {
            (Some(shown), grey) if shown.grey(x, y) == grey => UNCHANGED,
            (_, grey) => grey,
        };
        let transparent = Some(UNCHANGED);
        let frame = Frame { delay, width, height, transparent, buffer: magnified(change).into(), ..Frame::default() };
        self.encoder.write_frame(&frame)?;
        self.shown = Some(screenshot);
        Ok(())
    }
}

/// The panel's values, magnified, row by row.
fn magnified(value: impl Fn(usize, usize) -> u8) -> Vec<u8> {
    let at = |index: usize| value(index % (WIDTH * SCALE) / SCALE, index / (WIDTH * SCALE) / SCALE);
    (0..WIDTH * SCALE * HEIGHT * SCALE).map(at).collect()
}

/// Writes one screenshot to a PNG file.
pub fn save(screenshot: &Screenshot, path: &Path) -> anyhow::Result<()> {
    let unwritable = || format!("cannot write {}", path.display());
    png(screenshot, BufWriter::new(File::create(path).with_context(unwritable)?)).with_context(unwritable)
}

/// Writes one screenshot as a PNG file.
pub fn png(screenshot: &Screenshot, file: impl Write) -> anyhow::Result<()> {
    let size = |pixels: usize| (pixels * SCALE) as u32;
    let mut encoder = png::Encoder::new(file, size(WIDTH), size(HEIGHT));
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_palette(tint::palette());
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&magnified(|x, y| screenshot.grey(x, y)))?;
    Ok(writer.finish()?)
}

#[cfg(test)]
mod tests {
    use fastrand::Rng;
    use firmware::graphics::canvas::Canvas;

    use super::*;
    use crate::commands::demo::played;

    #[test]
    fn an_animation_shows_every_picture_as_it_was() {
        let mut rng = Rng::with_seed(1);
        let mut canvas = Canvas::default();
        // None, one, a few and nearly all pixels change.
        let mut frames = vec![Screenshot::from(&canvas)];
        for changes in [0, 1, 30, 20_000, 5, 20_000, 0] {
            for _ in 0..changes {
                canvas.update(rng.i32(0..WIDTH as i32), rng.i32(0..HEIGHT as i32), |_| rng.u8(0..16));
            }
            frames.push(Screenshot::from(&canvas));
        }
        let file = tempfile::NamedTempFile::new().expect("a file");
        let mut recording = Recording::create(file.path()).expect("it can be written");
        for (screenshot, tick) in frames.iter().zip((0..).step_by(TICKS_PER_FRAME as usize)) {
            recording.add(screenshot.clone(), tick).expect("it can be written");
        }
        recording.finish().expect("it can be written");
        let played = played(file.path()).expect("a GIF file");
        assert_eq!(played.len(), frames.len());
        for (number, (screenshot, (greys, delay))) in frames.iter().zip(played).enumerate() {
            assert!(greys == magnified(|x, y| screenshot.grey(x, y)), "screenshot {number}");
            assert!((3..=4).contains(&delay), "screenshot {number} is shown for {delay}/100 s");
        }
    }
}
