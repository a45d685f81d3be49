//! The panel's picture, in the terminal and in files: an animation (GIF) or one screenshot (PNG).
//!
//! If the terminal is large enough, a pixel is half a character in its colour. Otherwise a character
//! shows eight pixels or more as dots, in the amber of the brightest.

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufWriter, ErrorKind};
use std::path::{Path, PathBuf};

use anyhow::anyhow;
use firmware::config::TICK_RATE;
use firmware::graphics::{Format, rgb};
use gif::{ColorOutput, DecodeOptions, Encoder, EncodingError, Frame as Picture, Repeat};
use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::Color;
use ratatui::symbols::Marker;
use ratatui::widgets::canvas::{Canvas, Points};

use boards::console::cli::unwritable;
use boards::out_file::OutFile;
use boards::qemu::{HEIGHT, Screenshot, WIDTH};

/// The smallest grey that is shown as a dot. Only the end of a fading trail is darker.
const SET: u8 = 3;

/// Returns true if a panel is shown in half blocks: with colours, and with a column for each pixel of
/// its text, or else in Braille.
pub fn in_half_blocks(format: Format, columns: u16, colours: bool) -> bool {
    colours && columns >= format.width / u16::from(format.unit)
}

/// Draws the screenshot over the area. The shape is right if a character is twice as high as it is
/// wide.
pub fn draw(frame: &mut Frame, area: Rect, screenshot: &Screenshot, colours: bool) {
    let in_greys = in_half_blocks(screenshot.format, area.width, colours);
    if let Some(pixels) = screenshot.colours.as_ref().filter(|_| in_greys) {
        return draw_colours(frame, area, screenshot.format, pixels);
    }
    let width = usize::from(screenshot.format.width);
    let canvas = Canvas::default().marker(if in_greys {
        Marker::HalfBlock
    } else {
        Marker::Braille
    });

    let scale = (usize::from(area.width) / width).max(1);
    let height = usize::from(screenshot.format.height) * scale;
    let canvas = canvas
        .x_bounds([0.0, (width * scale) as f64 - 1.0])
        .y_bounds([1.0 - height as f64, 0.0]);
    let points = |index: usize| {
        let [left, top] = [index % width, index / width].map(|place| place * scale);
        (0..scale * scale).map(move |part| {
            let [x, y] = [left + part % scale, top + part / scale];
            (x as f64, -(y as f64))
        })
    };
    let canvas = canvas.paint(|context| {
        // The brightest pixels are drawn last, because they determine the colour of a character.
        for grey in if in_greys { 0 } else { SET }..=BRIGHTEST_GREY {
            let lit = screenshot
                .greys
                .iter()
                .enumerate()
                .filter(|(_, pixel)| **pixel == grey);
            let coords: Vec<_> = lit.flat_map(|(index, _)| points(index)).collect();
            context.draw(&Points {
                coords: &coords,
                color: in_terminal(grey),
            });
        }
    });
    frame.render_widget(canvas, area);
}

fn draw_colours(frame: &mut Frame, area: Rect, format: Format, pixels: &[u16]) {
    let [width, height] = [format.width, format.height].map(usize::from);
    let [columns, halves] = [usize::from(area.width), 2 * usize::from(area.height)];
    let part = |place: usize, count: usize, size: usize| {
        let from = place * size / count;
        from..((place + 1) * size / count).max(from + 1)
    };
    let colour = |column: usize, half: usize| {
        let rows = part(half, halves, height);
        let covered = rows.flat_map(|y| part(column, columns, width).map(move |x| y * width + x));
        let mut sum = [0; 3];
        let mut count = 0;
        for place in covered {
            let channels = rgb(pixels[place]).map(u32::from);
            (0..3).for_each(|channel| sum[channel] += channels[channel]);
            count += 1;
        }
        nearest(sum.map(|channel| (channel / count) as u8))
    };
    for row in 0..area.height {
        for column in 0..area.width {
            let [upper, lower] =
                [0, 1].map(|half| colour(column.into(), 2 * usize::from(row) + half));
            if let Some(cell) = frame.buffer_mut().cell_mut((area.x + column, area.y + row)) {
                cell.set_symbol("▀").set_fg(upper).set_bg(lower);
            }
        }
    }
}

/// Returns a colour that the terminal shows: any colour with `COLORTERM`, or else the nearest of
/// the cube of 216 common ones.
fn nearest([red, green, blue]: [u8; 3]) -> Color {
    let has_all = std::env::var("COLORTERM").is_ok_and(|it| it == "truecolor" || it == "24bit");
    if has_all {
        return Color::Rgb(red, green, blue);
    }
    let step = |channel: u8| (u16::from(channel) * 5 + 127) / 255;
    Color::Indexed((16 + 36 * step(red) + 6 * step(green) + step(blue)) as u8)
}

const BRIGHTEST_GREY: u8 = 15;
/// The red, green and blue of the brightest grey and of black, because the panel's glass is not
/// quite dark.
const BRIGHTEST: [u32; 3] = [255, 200, 64];
const DARKEST: [u32; 3] = [10, 8, 4];
/// The greys in the 256 common colours of terminals: black, a few that are too dark to have a hue,
/// then amber. They are chosen by hand, because the nearest colours of the dark greys would be
/// olive and red.
const TERMINAL: [u8; 16] = [
    16, 233, 234, 235, 237, 239, 94, 94, 130, 136, 136, 172, 178, 214, 214, 221,
];

fn in_terminal(grey: u8) -> Color {
    Color::Indexed(TERMINAL[usize::from(grey.min(BRIGHTEST_GREY))])
}

/// The colours of all greys, from black on, in the format of image files.
pub fn palette() -> Vec<u8> {
    let most = u32::from(BRIGHTEST_GREY);
    let mix = |grey: u32| {
        DARKEST
            .into_iter()
            .zip(BRIGHTEST)
            .map(move |(dark, bright)| dark + (bright - dark) * grey / most)
    };
    (0..=most)
        .flat_map(mix)
        .map(|channel| channel as u8)
        .collect()
}

const TICKS_PER_FRAME: i64 = TICK_RATE as i64 / 30;
/// The colour of an unchanged pixel in a picture after the first. Few pixels change, so this makes
/// long runs.
const UNCHANGED: u8 = 16;
const GIF_RATE: i64 = 100;

/// An animation (GIF) that is being written. The file has its name only after
/// [`Recording::finish`].
pub struct Recording {
    path: PathBuf,
    encoder: Encoder<BufWriter<OutFile>>,
    scale: usize,
    pictures: usize,
    format: Format,
    shown: Vec<u8>,
    shown_colours: Vec<u16>,
    due: Option<i64>,
}

impl Recording {
    pub fn begin(file: OutFile, format: Format, scale: usize) -> anyhow::Result<Self> {
        let path = file.path().to_owned();
        let [width, height] = size(format, scale);
        let palette = if format.is_large() {
            Vec::new()
        } else {
            [palette(), vec![0; 3]].concat()
        };
        let mut encoder = Encoder::new(BufWriter::new(file), width, height, &palette)?;
        encoder.set_repeat(Repeat::Infinite)?;
        Ok(Self {
            path,
            encoder,
            scale,
            format,
            pictures: 0,
            shown: Vec::new(),
            shown_colours: Vec::new(),
            due: None,
        })
    }

    pub fn is_due(&self, tick: i64) -> bool {
        self.due.is_none_or(|due| tick >= due)
    }

    /// Adds the panel's picture, if it is due.
    pub fn add(&mut self, screenshot: &Screenshot, tick: i64) -> anyhow::Result<()> {
        if !self.is_due(tick) {
            return Ok(());
        }

        // This picture begins at the tick at which it was due, also if it is late, so that the
        // animation keeps the board's time.
        let hundredths = |tick: i64| tick * GIF_RATE / i64::from(TICK_RATE);
        let next = tick + TICKS_PER_FRAME;
        let length = hundredths(next) - hundredths(self.due.replace(next).unwrap_or(tick));
        let delay = u16::try_from(length).unwrap_or(u16::MAX);
        self.pictures += 1;
        if let Some(colours) = &screenshot.colours {
            return self.add_colours(colours, delay);
        }
        let [width, height] = size(self.format, self.scale);

        let now = magnified(screenshot, self.scale);
        let change = |(index, grey): (usize, &u8)| {
            if self.shown.get(index) == Some(grey) {
                UNCHANGED
            } else {
                *grey
            }
        };
        let buffer = now
            .iter()
            .enumerate()
            .map(change)
            .collect::<Vec<_>>()
            .into();
        self.shown = now;

        let transparent = Some(UNCHANGED);
        let picture = Picture {
            delay,
            width,
            height,
            transparent,
            buffer,
            ..Picture::default()
        };
        self.write(&picture)
    }

    fn add_colours(&mut self, colours: &[u16], delay: u16) -> anyhow::Result<()> {
        let width = usize::from(self.format.width);
        let is_changed = |place: usize| self.shown_colours.get(place) != Some(&colours[place]);
        let changed: Vec<_> = (0..colours.len())
            .filter(|place| is_changed(*place))
            .collect();
        let columns = || changed.iter().map(|place| place % width);
        let left = columns().min().unwrap_or(0);
        let right = columns().max().unwrap_or(0) + 1;
        let top = changed.first().map_or(0, |place| place / width);
        let bottom = changed.last().map_or(0, |place| place / width) + 1;

        let mut palette = vec![0; 3];
        let mut known = HashMap::new();
        let scale = self.scale;
        let mut buffer = Vec::with_capacity((right - left) * (bottom - top) * scale * scale);
        for y in top * scale..bottom * scale {
            for x in left * scale..right * scale {
                let place = y / scale * width + x / scale;
                buffer.push(if is_changed(place) {
                    let colour = colours[place];
                    let next = known.len().min(254) as u8 + 1;
                    *known.entry(colour).or_insert_with(|| {
                        if usize::from(next) * 3 == palette.len() {
                            palette.extend(rgb(colour));
                        }
                        next
                    })
                } else {
                    0
                });
            }
        }

        let picture = Picture {
            delay,
            left: (left * scale) as u16,
            top: (top * scale) as u16,
            width: ((right - left) * scale) as u16,
            height: ((bottom - top) * scale) as u16,
            transparent: Some(0),
            palette: Some(palette),
            buffer: buffer.into(),
            ..Picture::default()
        };
        self.shown_colours = colours.to_vec();
        self.write(&picture)
    }

    fn write(&mut self, picture: &Picture) -> anyhow::Result<()> {
        self.encoder
            .write_frame(picture)
            .map_err(|error| unwritten(&self.path, &cause(error)))
    }

    pub fn finish(self) -> anyhow::Result<(PathBuf, usize)> {
        let finished = self
            .encoder
            .into_inner()
            .map_err(cause)
            .and_then(|file| file.into_inner().map_err(io::IntoInnerError::into_error));
        let file = finished.map_err(|error| unwritten(&self.path, &error))?;
        file.finish()?;
        Ok((self.path, self.pictures))
    }
}

/// An encoder's error may hide the error of the file.
fn cause(error: EncodingError) -> io::Error {
    match error {
        EncodingError::Io(error) => error,
        other => io::Error::new(ErrorKind::InvalidData, other),
    }
}

fn unwritten(path: &Path, error: &io::Error) -> anyhow::Error {
    anyhow!(unwritable("--record", path, error).to_string())
}

fn size(Format { width, height, .. }: Format, scale: usize) -> [u16; 2] {
    [width, height].map(|pixels| pixels * scale as u16)
}

fn magnified(screenshot: &Screenshot, scale: usize) -> Vec<u8> {
    let width = WIDTH * scale;
    let at = |index: usize| screenshot.greys[index / width / scale * WIDTH + index % width / scale];
    (0..width * HEIGHT * scale).map(at).collect()
}

/// Reads an animation for tests. Returns the greys of each picture and its duration in hundredths
/// of a second.
pub fn played(path: &Path) -> anyhow::Result<Vec<(Vec<u8>, u16)>> {
    let mut options = DecodeOptions::new();
    options.set_color_output(ColorOutput::Indexed);
    let mut decoder = options.read_info(File::open(path)?)?;
    let mut played = Vec::new();
    let mut greys = vec![0; WIDTH * HEIGHT];
    let scale = usize::from(decoder.width()) / WIDTH;
    while let Some(frame) = decoder.read_next_frame()? {
        let dots = frame
            .buffer
            .chunks(WIDTH * scale)
            .step_by(scale)
            .flat_map(|row| row.iter().step_by(scale));

        for (grey, &dot) in greys.iter_mut().zip(dots) {
            if frame.transparent != Some(dot) {
                *grey = dot;
            }
        }
        played.push((greys.clone(), frame.delay));
    }
    Ok(played)
}

pub fn png(screenshot: &Screenshot, scale: usize) -> anyhow::Result<Vec<u8>> {
    let [width, height] = size(screenshot.format, scale).map(u32::from);
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    if let Some(colours) = &screenshot.colours {
        let width = usize::from(screenshot.format.width);
        let rows = colours
            .chunks(width)
            .flat_map(|row| std::iter::repeat_n(row, scale));
        let pixels = rows
            .flatten()
            .flat_map(|colour| std::iter::repeat_n(rgb(*colour), scale));
        encoder.set_color(png::ColorType::Rgb);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&pixels.flatten().collect::<Vec<_>>())?;
        writer.finish()?;
        return Ok(file);
    }
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_palette(palette());
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&magnified(screenshot, scale))?;
    writer.finish()?;
    Ok(file)
}

#[cfg(test)]
mod tests {
    use boards::host::canvas;
    use firmware::graphics::Format;
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;
    use ratatui::style::Color;

    use super::*;

    /// Returns the characters that show a panel with three lit pixels, with their colours.
    fn drawn(width: u16) -> Vec<(String, Color, Color)> {
        let mut canvas = canvas(Format::OLED);
        [(0, 0, 15), (3, 2, 15), (127, 63, 6)]
            .into_iter()
            .for_each(|(x, y, grey)| canvas.update(x, y, |_| grey));
        let mut terminal =
            Terminal::new(TestBackend::new(width, width / 4)).expect("a terminal of characters");
        terminal
            .draw(|frame| draw(frame, frame.area(), &Screenshot::from(&canvas), true))
            .expect("it is drawn");

        let cells = terminal.backend().buffer().content();
        let lit = cells
            .iter()
            .filter(|cell| ![" ", "█"].contains(&cell.symbol()));
        lit.map(|cell| (cell.symbol().to_owned(), cell.fg, cell.bg))
            .collect()
    }

    /// The pixels are dots in 64 columns and half characters in 128.
    #[test]
    fn a_lit_pixel_is_a_dot_or_half_a_character_in_its_colour() {
        let dots = [("⠁", 15), ("⠠", 15), ("⢀", 6)];
        assert_eq!(
            drawn(64),
            dots.map(|(dot, grey)| (dot.to_owned(), in_terminal(grey), Color::Reset))
        );
        let pixels = [[15, 0], [15, 0], [0, 6]].map(|greys| greys.map(in_terminal));
        assert_eq!(
            drawn(128),
            pixels.map(|[above, below]| ("▀".to_owned(), above, below))
        );
    }

    #[test]
    fn a_full_disk_is_named_once() {
        let file = OutFile::create("--record", Path::new("/dev/full")).expect("a device");
        let mut recording =
            Recording::begin(file, Format::OLED, 1).expect("a header in the buffer");
        let failed = (0..2000).find_map(|number| {
            let mut canvas = canvas(Format::OLED);
            canvas.update(number % 128, number / 128, |_| 15);
            let tick = i64::from(number) * TICKS_PER_FRAME;
            recording.add(&Screenshot::from(&canvas), tick).err()
        });
        let reason = format!("{:#}", failed.expect("the disk is full"));
        assert_eq!(reason.matches("No space left").count(), 1, "{reason}");
        assert!(
            reason.contains("--record: cannot write /dev/full"),
            "{reason}"
        );
    }
}
