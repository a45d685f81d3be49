//! The output of the map: a picture with a legend in the panel's letters, or a table.

use std::fmt::Write;
use std::path::Path;

use anyhow::Result;
use double_pendulum::flips::Flip;
use firmware::graphics::glyph;

use super::map::{FlipPair, Map};

/// Returns the content of a file with this name: a table in CSV or a PNG.
pub fn file(name: &Path, map: &Map, points: &[FlipPair], doubt: bool) -> Result<Vec<u8>> {
    let pixels = map.shown(points);
    if name.extension().is_some_and(|end| end == "csv") {
        return table(map, pixels);
    }

    let [across, _] = map.size;
    let legend = legend(map, doubt);
    let width = legend.width;
    let mut colours = Vec::new();
    for ([column, _], point) in pixels {
        colours.push(colour(map, point, doubt));
        if column + 1 == across {
            colours.resize(colours.len() + width - across, WHITE);
        }
    }
    colours.extend(legend.pixels);
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width as u32, (colours.len() / width) as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(colours.as_flattened())?;
    writer.finish()?;
    Ok(file)
}

type Colour = [u8; 3];

/// The colours of three kinds of starts: the energy forbids a flip, no flip happens within the
/// limit, and the two steps disagree.
const NEVER: Colour = [0, 0, 0];
const LATER: Colour = [110, 110, 118];
const DOUBT: Colour = [255, 0, 90];

/// The colour scale viridis, in which equal steps look equal.
fn scale(share: f32) -> Colour {
    colorous::VIRIDIS
        .eval_continuous(f64::from(1.0 - share))
        .as_array()
}

fn colour(map: &Map, point: FlipPair, doubt: bool) -> Colour {
    match point[0] {
        _ if doubt && map.differ(point) => DOUBT,
        Flip::Never => NEVER,
        flip => map.share(flip).map_or(LATER, scale),
    }
}

/// Returns the table. A time is empty if no rod can turn over, and `inf` if no rod does within the
/// limit.
fn table(map: &Map, pixels: impl Iterator<Item = ([usize; 2], FlipPair)>) -> Result<Vec<u8>> {
    let mut text =
        String::from("a1 [rad],a2 [rad],time [sqrt(l1/g)],time_by_half_the_step [sqrt(l1/g)]\n");
    let word = |flip: Flip<f32>| match flip {
        Flip::Never => String::new(),
        Flip::After(time) => time.to_string(),
        Flip::Later => f32::INFINITY.to_string(),
    };
    for (place, point) in pixels {
        let [a1, a2] = map.start(place);
        let [time, check] = point.map(word);
        writeln!(text, "{a1},{a2},{time},{check}")?;
    }
    Ok(text.into_bytes())
}

/// The sizes in units; a unit is a whole number of pixels.
const WIDTH: usize = 400;
const HEIGHT: usize = 42;
const LEFT: usize = 8;
const LENGTH: usize = 160;
const BESIDE: usize = LEFT + LENGTH + 20;

const WHITE: Colour = [255; 3];
const TEXT: Colour = [34; 3];

struct Legend {
    width: usize,
    unit: usize,
    pixels: Vec<Colour>,
}

fn legend(map: &Map, doubt: bool) -> Legend {
    let [width, _] = map.size;
    let unit = (width / WIDTH).max(1);
    let motion = motion(map);
    let end = LEFT + motion.chars().map(across).sum::<usize>() + LEFT;
    let width = width.max(end * unit).max(WIDTH);
    let mut legend = Legend {
        width,
        unit,
        pixels: vec![WHITE; width * HEIGHT * unit],
    };

    for x in 0..LENGTH {
        legend.fill(
            [LEFT + x, 4, 1, 10],
            scale((x as f32 + 0.5) / LENGTH as f32),
        );
    }

    // A power too close to the limit would overlap it.
    let tens = std::iter::successors(Some(1.0), |time| Some(10.0 * time));
    let tens = tens
        .take_while(|time| *time < 0.7 * map.limit)
        .chain([map.limit]);

    for time in tens {
        let x = LEFT + (LENGTH as f32 * time.ln() / map.limit.ln()) as usize;
        let words = time.to_string();
        let half = words.chars().map(across).sum::<usize>() / 2;
        legend.text([x.saturating_sub(half), 17], &words);
    }

    let mut x = BESIDE;
    for (colour, name) in [
        (NEVER, "cannot"),
        (LATER, "not by then"),
        (DOUBT, "in doubt"),
    ]
    .into_iter()
    .take(2 + usize::from(doubt))
    {
        legend.fill([x, 4, 10, 10], colour);
        x = legend.text([x + 14, 5], name) + 12;
    }
    legend.text([BESIDE, 17], "first turn-over of a rod, √(l₁/g)");

    legend.text([LEFT, 30], &motion);
    legend
}

fn across(character: char) -> usize {
    glyph(character).width as usize
}

fn motion(map: &Map) -> String {
    let [width, height] = map.size;
    let longer = width.max(height) as f64;
    let [a1, a2] = [0, 1].map(|axis| {
        let at = map.centre[axis].to_degrees();
        let half = map.half.to_degrees() * map.size[axis] as f64 / longer;
        format!("{}° to {}°", short(at - half), short(at + half))
    });
    let [masses, lengths] = [
        map.parameters.m2 / map.parameters.m1,
        map.parameters.l2 / map.parameters.l1,
    ]
    .map(|ratio| short(ratio.into()));
    format!("let go at α₁ → {a1}, α₂ ↑ {a2}; m₂/m₁ = {masses}, l₂/l₁ = {lengths}")
}

fn short(number: f64) -> f64 {
    (number * 1e4).round() / 1e4 + 0.0
}

impl Legend {
    fn fill(&mut self, place: [usize; 4], colour: Colour) {
        let [x, y, width, height] = place.map(|units| units * self.unit);
        for row in self.pixels.chunks_mut(self.width).skip(y).take(height) {
            row.iter_mut()
                .skip(x)
                .take(width)
                .for_each(|pixel| *pixel = colour);
        }
    }

    fn text(&mut self, [mut x, y]: [usize; 2], words: &str) -> usize {
        for glyph in words.chars().map(glyph) {
            for bit in (0..64).filter(|bit| glyph.rows << bit >> 63 == 1) {
                self.fill([x + bit % 8, y + bit / 8, 1, 1], TEXT);
            }
            x += glyph.width as usize;
        }
        x
    }
}
