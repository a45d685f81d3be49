//! Screenshot files: what the panel showed as an animation (GIF) or one screenshot of it (PNG).

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use anyhow::Context;
use firmware::config::TICK_RATE;
use gif::{DisposalMethod, Encoder, Frame, Repeat};

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
        let mut encoder =
            Encoder::new(BufWriter::new(file), size(WIDTH), size(HEIGHT), &[tint::palette(), vec![0; 3]].concat())?;
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

    /// Writes the pending screenshot, whose time ends at `tick`: only the rectangle that has changed, and of that all
    /// pixels or only those that have, whichever is shorter: where little has, that leaves long runs of one value.
    fn flush(&mut self, tick: u32) -> anyhow::Result<()> {
        let Some((screenshot, since)) = self.pending.take() else { return Ok(()) };
        let hundredths = |tick: u32| {
            let ticks = u64::from(tick.wrapping_sub(self.start));
            (ticks * GIF_RATE + u64::from(TICK_RATE) / 2) / u64::from(TICK_RATE)
        };
        let delay = u16::try_from(hundredths(tick) - hundredths(since)).unwrap_or(u16::MAX);
        let area = Area::changed(self.shown.as_ref(), &screenshot);
        let encoded = |transparent: Option<u8>, buffer: Vec<u8>| {
            let mut frame = Frame {
                delay,
                dispose: DisposalMethod::Keep,
                transparent,
                left: (area.left * SCALE) as u16,
                top: (area.top * SCALE) as u16,
                width: (area.width * SCALE) as u16,
                height: (area.height * SCALE) as u16,
                buffer: buffer.into(),
                ..Frame::default()
            };
            frame.make_lzw_pre_encoded();
            frame
        };
        let mut frame = encoded(None, area.magnified(|x, y| screenshot.grey(x, y)));
        if let Some(shown) = &self.shown {
            let unless_shown = |grey: u8, x, y| if shown.grey(x, y) == grey { UNCHANGED } else { grey };
            let changes = encoded(Some(UNCHANGED), area.magnified(|x, y| unless_shown(screenshot.grey(x, y), x, y)));
            if changes.buffer.len() < frame.buffer.len() {
                frame = changes;
            }
        }
        self.encoder.write_lzw_pre_encoded_frame(&frame)?;
        self.shown = Some(screenshot);
        Ok(())
    }
}

/// A rectangle of the panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Area {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
}

impl Area {
    const WHOLE: Self = Self { left: 0, top: 0, width: WIDTH, height: HEIGHT };

    /// The smallest that holds every difference; a single pixel if there is none.
    fn changed(before: Option<&Screenshot>, after: &Screenshot) -> Self {
        let Some(before) = before else { return Self::WHOLE };
        let differs = |x: usize, y: usize| before.grey(x, y) != after.grey(x, y);
        let mut columns = (0..WIDTH).filter(|&x| (0..HEIGHT).any(|y| differs(x, y)));
        let mut rows = (0..HEIGHT).filter(|&y| (0..WIDTH).any(|x| differs(x, y)));
        let (left, top) = (columns.next().unwrap_or(0), rows.next().unwrap_or(0));
        let (right, bottom) = (columns.next_back().unwrap_or(left), rows.next_back().unwrap_or(top));
        Self { left, top, width: right - left + 1, height: bottom - top + 1 }
    }

    /// The values of its pixels, magnified, row by row.
    fn magnified(self, value: impl Fn(usize, usize) -> u8) -> Vec<u8> {
        let at = |index: usize| {
            let (x, y) = (index % (self.width * SCALE), index / (self.width * SCALE));
            value(self.left + x / SCALE, self.top + y / SCALE)
        };
        (0..self.width * SCALE * self.height * SCALE).map(at).collect()
    }
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
    writer.write_image_data(&Area::WHOLE.magnified(|x, y| screenshot.grey(x, y)))?;
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
            assert!(greys == Area::WHOLE.magnified(|x, y| screenshot.grey(x, y)), "screenshot {number}");
            assert!((3..=4).contains(&delay), "screenshot {number} is shown for {delay}/100 s");
        }
    }
}
