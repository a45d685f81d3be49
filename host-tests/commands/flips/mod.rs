//! `cargo flips`: the time when a rod first turns over, for every start from rest, as a picture or
//! as numbers.

pub mod map;
mod output;

use std::f64::consts::PI;
use std::path::PathBuf;

use anyhow::{Result, anyhow, ensure};
use clap::Parser;
use double_pendulum::Parameters;

use boards::console::cli::option_of;
use boards::console::cli::{Refused, complain, say};
use boards::console::number::{Number, Pair};
use boards::console::progress::Progress;
use boards::out_file::OutFile;
use map::Map;

/// Draws a map of the time until a rod first turns over, for every start from rest: a1 across, a2
/// upwards, the time as colour.
///
/// Each start is computed twice in f32, with a step and with half of it; the map shows the first
/// time. Numbers are decimals (0.25, 1e-3) or fractions (1/256).
#[derive(Debug, Parser)]
#[command(
    name = "cargo flips",
    bin_name = "cargo flips",
    after_help = "Examples:
  cargo flips --size 1024 --out flips.png
  cargo flips --size 512 --limit 100 --centre 110,125 --degrees --zoom 8 --doubt --out corner.png

Exit code 2: bad input, with one line on stderr."
)]
pub struct FlipsOptions {
    /// Size of the map in pixels: one number for a square, or two; a legend is added below it
    #[arg(long, value_name = "N|WxH", default_value = "512", value_parser = size)]
    size: [usize; 2],
    /// The longest time to wait for a turn-over, sqrt(l1/g)
    #[arg(
        long,
        value_name = "T",
        default_value = "1000",
        allow_hyphen_values = true
    )]
    limit: Number,
    /// Masses of the bobs
    #[arg(
        long,
        value_name = "M1,M2",
        default_value = "1,1",
        allow_hyphen_values = true
    )]
    masses: Pair,
    /// Lengths of the rods
    #[arg(
        long,
        value_name = "L1,L2",
        default_value = "1,1",
        allow_hyphen_values = true
    )]
    lengths: Pair,
    /// The start in the middle of the map, rad (see --degrees)
    #[arg(
        long,
        value_name = "A1,A2",
        default_value = "0,0",
        allow_hyphen_values = true
    )]
    centre: Pair,
    /// Read the centre in degrees
    #[arg(long)]
    degrees: bool,
    /// Zoom factor (with 1 the longer side shows a whole turn)
    #[arg(
        long,
        value_name = "Z",
        default_value = "1",
        allow_hyphen_values = true
    )]
    zoom: Number,
    /// Mark the starts whose two times differ by more than a grey level of the panel
    #[arg(long)]
    doubt: bool,
    /// The file to write: a picture (.png) or a table (.csv)
    #[arg(long, value_name = "FILE", default_value = "flips.png", value_parser = picture_or_table)]
    out: PathBuf,
}

/// The limit beyond which even a small map takes a minute or more.
const ANNOUNCED_STEPS: f64 = 1e6;

/// Computes the map and writes the file. An existing file is replaced when the map is complete.
pub fn run(options: &FlipsOptions) -> Result<()> {
    let map = options
        .map()
        // Everything that can be refused is refused before the computation.
        .map_err(|error| Refused::because(format_args!("{error:#}")))?;
    let file = OutFile::create("--out", &options.out)?;
    let all: usize = map.size.iter().product();
    let computed = map.size[0] * map.rows();
    let steps = map.steps();
    if steps > ANNOUNCED_STEPS {
        complain(format_args!(
            "note: up to {steps:.1e} steps for each of {computed} starts; a smaller --limit takes \
             less time"
        ));
    }

    let doing = if computed < all {
        format!("starts ({} more are mirror images)", all - computed)
    } else {
        "starts".to_owned()
    };
    let bar = Progress::of(&doing, computed as u64);
    let points = map.points(|done| bar.advance(done as u64))?;
    drop(bar);
    file.write_whole(&output::file(&options.out, &map, &points, options.doubt)?)?;

    let out = options.out.display();
    let doubtful = map
        .shown(&points)
        .filter(|(_, point)| map.differ(*point))
        .count();
    let percent = 100.0 * doubtful as f64 / all as f64;
    Ok(say(format_args!(
        "wrote {out}; {doubtful} of {all} starts are uncertain ({percent:.3} %)"
    ))?)
}

const SIZES: std::ops::RangeInclusive<usize> = 2..=32_768;

fn size(text: &str) -> Result<[usize; 2], String> {
    let number = |text: &str| {
        let number = text
            .parse()
            .map_err(|_| format!("'{text}': not a whole number"))?;
        let least = SIZES.start();
        let most = SIZES.end();
        if SIZES.contains(&number) {
            Ok(number)
        } else {
            Err(format!("must be from {least} to {most}"))
        }
    };
    let (width, height) = text.split_once('x').unwrap_or((text, text));
    Ok([number(width)?, number(height)?])
}

fn picture_or_table(file: &str) -> Result<PathBuf, &'static str> {
    let is_it = [".png", ".csv"].into_iter().any(|end| file.ends_with(end));
    if is_it {
        Ok(file.into())
    } else {
        Err("must end in .png or .csv")
    }
}

/// The smallest time limit, because colours show its logarithm; and the largest number of steps of
/// a start.
const LEAST_LIMIT: f64 = 2.0;
const MOST_STEPS: f64 = 1e9;

/// The smallest pixel, rad: several times the spacing of `f32` angles of a turn.
const FINEST: f64 = 8.0 * 2.4e-7;

impl FlipsOptions {
    fn map(&self) -> Result<Map> {
        let Self {
            limit, zoom, size, ..
        } = self;
        ensure!(
            limit.value() >= LEAST_LIMIT,
            "--limit {limit}: must be at least {LEAST_LIMIT}"
        );
        ensure!(zoom.value() >= 1.0, "--zoom {zoom}: must be at least 1");
        let pixel = 2.0 * PI / zoom.value() / size[0].max(size[1]) as f64;
        ensure!(pixel >= FINEST, "--zoom {zoom}: f32 has no angles so close");

        let [centre, [m1, m2], [l1, l2]] =
            [&self.centre, &self.masses, &self.lengths].map(Pair::values);
        let centre = if self.degrees {
            centre.map(f64::to_radians)
        } else {
            centre
        };
        ensure!(
            centre.iter().all(|angle| angle.abs() <= PI),
            "--centre {}: must be within half a turn; for degrees add --degrees",
            self.centre
        );

        // Times are in sqrt(l1/g) for any g.
        let parameters = Parameters {
            m1,
            m2,
            l1,
            l2,
            g: l1,
        }
        .cast::<f32>();

        let map =
            Map::new(parameters, limit.value() as f32, *size).map_err(|error| {
                match option_of(&error, "") {
                    "" => anyhow!(
                        "--masses {}, --lengths {}: too extreme together for f32",
                        self.masses,
                        self.lengths
                    ),
                    option => anyhow!("{option}: {error}"),
                }
            })?;
        let map = Map {
            centre,
            half: PI / zoom.value(),
            ..map
        };

        let longest = limit.value() * MOST_STEPS / map.steps();

        // The limit has two digits, rounded down.
        let unit = 10_f64.powf(longest.log10().floor() - 1.0);
        ensure!(
            limit.value() <= longest,
            "--limit {limit}: at most {:.1e} for these --masses and --lengths (more takes \
             over {MOST_STEPS:.0e} steps a start)",
            (longest / unit).floor() * unit
        );
        Ok(map)
    }
}
