//! What is written: a picture or a table.

use std::fmt::Write;
use std::path::Path;

use anyhow::Result;
use double_pendulum::flips::Flip;

use super::legend;
use super::map::{Followed, Map};

/// The bytes of a file of this name; with `doubt`, points of a picture whose time is uncertain get a colour of their own.
pub fn file(name: &Path, map: &Map, points: &[Followed], doubt: bool) -> Result<Vec<u8>> {
    let [width, height] = map.square.size;
    let places = (0..height).flat_map(|row| (0..width).map(move |column| [column, row]));
    let pixels = places.map(|place| (place, points[map.square.place(place)]));
    if name.extension().is_some_and(|end| end == "csv") {
        return table(map, pixels);
    }
    picture(map, pixels.map(|(_, point)| colour(map, point, doubt)), doubt)
}

pub type Colour = [u8; 3];

/// There is not the energy for it; not within the limit; the two steps do not agree.
pub const NEVER: Colour = [0, 0, 0];
pub const LATER: Colour = [110, 110, 118];
pub const DOUBT: Colour = [255, 0, 90];

/// The colour of a share of the scale: viridis, in which equal steps look equal; bright is early.
pub fn scale(share: f32) -> Colour {
    colorous::VIRIDIS.eval_continuous(f64::from(1.0 - share)).as_array()
}

fn colour(map: &Map, point: Followed, doubt: bool) -> Colour {
    match point.flip {
        _ if doubt && map.is_in_doubt(point) => DOUBT,
        Flip::Never => NEVER,
        flip => map.share(flip).map_or(LATER, scale),
    }
}

/// The map above its legend.
fn picture(map: &Map, pixels: impl Iterator<Item = Colour>, doubt: bool) -> Result<Vec<u8>> {
    let [width, _] = map.square.size;
    let colours: Vec<Colour> = pixels.chain(legend::pixels(map, doubt)).collect();
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width as u32, (colours.len() / width) as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(colours.as_flattened())?;
    writer.finish()?;
    Ok(file)
}

/// A row for each pixel, from the top left corner.
fn table(map: &Map, pixels: impl Iterator<Item = ([usize; 2], Followed)>) -> Result<Vec<u8>> {
    let mut text = String::from("a1,a2,time,half_step\n");
    let word = |flip: Flip<f32>| match flip {
        Flip::Never => "never".to_owned(),
        Flip::After(time) => time.to_string(),
        Flip::Later => "later".to_owned(),
    };
    for (place, Followed { flip, check }) in pixels {
        let ([a1, a2], [time, check]) = (map.square.start(place), [flip, check].map(word));
        writeln!(text, "{a1},{a2},{time},{check}")?;
    }
    Ok(text.into_bytes())
}
