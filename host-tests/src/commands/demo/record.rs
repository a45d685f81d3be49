//! Screenshot files: what the panel showed as an animation (GIF) or one screenshot of it (PNG).

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use anyhow::Context;
use firmware::config::TICK_RATE;
use gif::{ColorOutput, DecodeOptions, Encoder, Frame, Repeat};

use super::panel::palette;
use crate::emulator::qemu::{HEIGHT, Screenshot, WIDTH};

/// Every pixel of the panel becomes a square of this many by as many.
const SCALE: usize = 3;
const SIZE: [u16; 2] = [(WIDTH * SCALE) as u16, (HEIGHT * SCALE) as u16];
/// The board's ticks from one screenshot to the next: 60/2 = 30 frames per second.
const TICKS_PER_FRAME: i64 = TICK_RATE as i64 / 30;
/// In a picture after the first: as it was. Few pixels change, which leaves long runs of this. The palette's first colour after
/// the greys.
const UNCHANGED: u8 = 16;
/// GIF counts time in hundredths of a second.
const GIF_RATE: i64 = 100;

pub struct Recording {
    encoder: Encoder<BufWriter<File>>,
    /// The screenshot to be shown next, and since which tick; it is written when its end is known.
    pending: Option<(Screenshot, i64)>,
    shown: Vec<u8>,
    start: Option<i64>,
}

impl Recording {
    pub fn create(path: &Path) -> anyhow::Result<Self> {
        let file = File::create(path).with_context(|| format!("cannot write {}", path.display()))?;
        let [width, height] = SIZE;
        let palette = [palette(), vec![0; 3]].concat();
        let mut encoder = Encoder::new(BufWriter::new(file), width, height, &palette)?;
        encoder.set_repeat(Repeat::Infinite)?;
        Ok(Self { encoder, pending: None, shown: Vec::new(), start: None })
    }

    pub fn is_due(&self, tick: i64) -> bool {
        self.pending.as_ref().is_none_or(|(_, since)| tick - since >= TICKS_PER_FRAME)
    }

    /// Takes the screenshot that the panel shows from `tick` on; one that comes too soon after the last is left out.
    pub fn add(&mut self, screenshot: Screenshot, tick: i64) -> anyhow::Result<()> {
        if self.is_due(tick) {
            self.flush(tick)?;
            self.start.get_or_insert(tick);
            self.pending = Some((screenshot, tick));
        }
        Ok(())
    }

    /// Writes the last screenshot, shown as long as the others, and completes the file.
    pub fn finish(mut self) -> anyhow::Result<()> {
        let end = self.pending.as_ref().map_or(0, |(_, since)| since + TICKS_PER_FRAME);
        self.flush(end)
    }

    /// Writes the pending screenshot, whose time ends at `tick`.
    fn flush(&mut self, tick: i64) -> anyhow::Result<()> {
        let Some(((screenshot, since), start)) = self.pending.take().zip(self.start) else { return Ok(()) };
        let rate = i64::from(TICK_RATE);
        let hundredths = |tick: i64| ((tick - start) * GIF_RATE + rate / 2) / rate;
        let delay = u16::try_from(hundredths(tick) - hundredths(since)).unwrap_or(u16::MAX);
        let [width, height] = SIZE;
        let now = magnified(&screenshot);
        let before = std::mem::replace(&mut self.shown, now.clone());
        let change = |(index, grey)| if before.get(index) == Some(&grey) { UNCHANGED } else { grey };
        let buffer = now.into_iter().enumerate().map(change).collect::<Vec<_>>().into();
        let transparent = Some(UNCHANGED);
        Ok(self.encoder.write_frame(&Frame { delay, width, height, transparent, buffer, ..Frame::default() })?)
    }
}

fn magnified(screenshot: &Screenshot) -> Vec<u8> {
    let at = |index: usize| screenshot.greys[index / (WIDTH * SCALE) / SCALE * WIDTH + index % (WIDTH * SCALE) / SCALE];
    (0..WIDTH * SCALE * HEIGHT * SCALE).map(at).collect()
}

/// Reads an animation back, for tests: the greys of each of its pictures, and the hundredths of a second it stays.
pub fn played(path: &Path) -> anyhow::Result<Vec<(Vec<u8>, u16)>> {
    let mut options = DecodeOptions::new();
    options.set_color_output(ColorOutput::Indexed);
    let mut decoder = options.read_info(File::open(path)?)?;
    let (mut played, mut shown) = (Vec::new(), Vec::new());
    while let Some(frame) = decoder.read_next_frame()? {
        shown.resize(frame.buffer.len(), 0);
        let dots = shown.iter_mut().zip(frame.buffer.iter());
        dots.filter(|(_, dot)| frame.transparent != Some(**dot)).for_each(|(shown, dot)| *shown = *dot);
        let greys = shown.chunks(WIDTH * SCALE).step_by(SCALE).flat_map(|row| row.iter().step_by(SCALE).copied());
        played.push((greys.collect(), frame.delay));
    }
    Ok(played)
}

pub fn png(screenshot: &Screenshot) -> anyhow::Result<Vec<u8>> {
    let ([width, height], mut file) = (SIZE.map(u32::from), Vec::new());
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_palette(palette());
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&magnified(screenshot))?;
    writer.finish()?;
    Ok(file)
}
