//! The framebuffer and the brush: layout, clipping, and the position of discs.

use boards::host::canvas;
use embedded_graphics::geometry::Point;
use embedded_graphics::image::GetPixel;
use embedded_graphics::mono_font::MonoFont;
use embedded_graphics::mono_font::iso_8859_7::FONT_5X8;
use embedded_graphics::pixelcolor::BinaryColor;
use fastrand::Rng;
use firmware::graphics::{
    Canvas, Disc, Format, Glyph, Palette, PanelName, SUBPIXELS, Spot, Stroke, glyph,
};

use crate::bench::{blank, places};

/// The tolerance, pixels. Greys are rounded to one of 16, which shifts the light by far less.
const CENTRE_TOLERANCE: f64 = 0.1;

/// A ramp one pixel wide differs from the covered share of a pixel, at most by 2.8 of 15 greys, at
/// the end of a narrow stroke.
const GREY_TOLERANCE: f64 = 3.0;

fn grey(canvas: &Canvas, x: i32, y: i32) -> u8 {
    canvas.get(x, y).expect("inside")
}

fn ink_grey(canvas: &Canvas, x: i32, y: i32) -> u8 {
    canvas.pixel(x, y).expect("inside") >> 4
}

fn light(canvas: &Canvas) -> u32 {
    places()
        .map(|(x, y)| u32::from(ink_grey(canvas, x, y)))
        .sum()
}

/// Ink is in the high nibble of a pixel, and the foreground in the low one.
#[test]
fn the_foreground_covers_the_ink_until_it_is_cleared() {
    let mut canvas = canvas(PanelName::Lcd13.format());
    canvas.settle();
    for x in 2..6 {
        canvas.on_ink().update(x, 1, |_| 9);
    }
    let canvas = &mut *canvas.on_clear_foreground();
    canvas.update(3, 1, |old| old + 4);
    canvas.update(4, 1, |_| 0);
    canvas.row_mut(1, 5..6).expect("a row").lighten(5, 8);
    let pixels = |canvas: &Canvas| [2, 3, 4, 5].map(|x| canvas.pixel(x, 1));
    assert_eq!(pixels(canvas), [0x90, 0x9D, 0x91, 0x90].map(Some));
    assert_eq!([2, 3, 4, 5].map(|x| grey(canvas, x, 1)), [9, 13, 0, 9]);
    assert_eq!([0, 1, 2].map(|y| canvas.changed(y)), [0, 1, 0]);

    canvas.settle();
    canvas.on_clear_foreground();
    assert_eq!(pixels(canvas), [Some(0x90); 4]);
    assert_eq!(canvas.changed(1), 1, "the cleared cell");
    canvas.settle();
    assert_eq!(canvas.changed(1), 0);
    canvas.on_ink().update(127, 1, |_| 1);
    assert_eq!(canvas.changed(1), 1 << 15);
}

#[test]
fn pixels_outside_are_not_drawn() {
    let mut canvas = ink();
    let width = Format::OLED.right();
    let height = Format::OLED.bottom();
    for out in [-1, i32::MIN, i32::MAX, width.max(height)] {
        for (x, y) in [(out, 0), (0, out), (out, out), (width, 0), (0, height)] {
            canvas.update(x, y, |_| 15);
            canvas.stamp(x, y, 0x80 << 56, 15);
            assert_eq!(canvas.get(x, y), None);
        }
    }
    assert_eq!(canvas, blank());

    canvas.stamp(-2, -6, u64::MAX, 9);
    canvas.stamp(width - 3, height - 1, u64::MAX, 9);
    assert_eq!(
        (
            light(&canvas),
            ink_grey(&canvas, 5, 1),
            ink_grey(&canvas, 6, 1)
        ),
        ((2 * 6 + 3) * 9, 9, 0)
    );
}

#[test]
fn glyphs_equal_the_font_of_the_library() {
    for character in (' '..='~')
        .chain(['±', '°', 'μ'])
        .filter(|character| !" .".contains(*character))
    {
        let MonoFont {
            image,
            glyph_mapping,
            ..
        } = FONT_5X8;
        let index = glyph_mapping.index(character) as i32;
        let corner = Point::new(index % 16 * 5, index / 16 * 8);
        let Glyph { width, rows } = glyph(character);
        for (x, y) in (0..8).flat_map(|x| (0..8).map(move |y| (x, y))) {
            let is_ink = x < 5 && image.pixel(corner + Point::new(x, y)) == Some(BinaryColor::On);
            assert_eq!(
                rows >> (63 - (8 * y + x)) & 1 != 0,
                is_ink,
                "{character:?}, column {x}, row {y}"
            );
        }
        assert_eq!(width, 5);
    }
}

#[test]
fn an_unknown_character_is_a_question_mark() {
    for unknown in ['\n', 'é', '漢'] {
        assert_eq!(glyph(unknown), glyph('?'), "{unknown:?}");
    }
}

/// On a panel of greys, the foreground begins as a copy of the ink.
#[test]
fn a_panel_of_greys_shows_what_was_drawn_last() {
    let mut canvas = blank();
    for x in 2..5 {
        canvas.on_ink().update(x, 1, |_| 9);
    }
    let canvas = &mut *canvas.on_clear_foreground();
    canvas.settle();
    canvas.update(3, 1, |old| old + 4);
    canvas.update(4, 1, |_| 0);
    assert_eq!([2, 3, 4, 5].map(|x| grey(canvas, x, 1)), [9, 13, 0, 0]);
    assert_eq!([0, 1, 2].map(|y| canvas.changed(y)), [0, 1, 0]);

    canvas.on_clear_foreground();
    assert_eq!([2, 3, 4, 5].map(|x| grey(canvas, x, 1)), [9, 9, 9, 0]);
}

fn ink() -> Canvas<'static> {
    let mut canvas = blank();
    canvas.on_ink();
    canvas
}

fn disc(x: f32, y: f32, pixels: f32) -> Disc {
    Disc {
        centre: Spot::at(x, y, Format::OLED),
        radius: (pixels * SUBPIXELS as f32) as u16,
        gap: 0,
    }
}

#[test]
fn a_disc_of_radius_0_is_a_faint_pixel() {
    let mut canvas = ink();
    disc(10.5, 10.5, 0.0).draw(&mut canvas, u8::MAX);
    assert_eq!((ink_grey(&canvas, 10, 10), light(&canvas)), (8, 8));
}

#[test]
fn a_disc_is_where_it_was_put() {
    let mut canvas = ink();
    for number in 0..1000 {
        canvas.blank(Palette::Trail);
        let x = 10.0 + (number as f32 * 0.377) % 100.0;
        let y = 10.0 + (number as f32 * 0.713) % 40.0;
        disc(x, y, 1.5).draw(&mut canvas, u8::MAX);

        let mut sum = [0.0; 3];
        for (column, row) in places() {
            let grey = f64::from(ink_grey(&canvas, column, row));
            sum = [
                sum[0] + grey,
                sum[1] + grey * (f64::from(column) + 0.5),
                sum[2] + grey * (f64::from(row) + 0.5),
            ];
        }
        let found_x = sum[1] / sum[0];
        let found_y = sum[2] / sum[0];
        assert!(
            (found_x - f64::from(x)).abs() < CENTRE_TOLERANCE,
            "x {x}: {found_x}"
        );
        assert!(
            (found_y - f64::from(y)).abs() < CENTRE_TOLERANCE,
            "y {y}: {found_y}"
        );
    }
}

#[test]
fn a_stroke_of_any_numbers_is_safe() {
    let numbers = [
        0.0,
        -1.0,
        127.9,
        1e3,
        -1e3,
        f32::MAX,
        f32::MIN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
    ];

    let spots: Vec<_> = numbers
        .iter()
        .flat_map(|&x| numbers.map(|y| Spot::at(x, y, Format::OLED)))
        .collect();

    let mut canvas = ink();
    for &from in &spots {
        for &to in &spots {
            Stroke {
                from,
                to,
                radius: 255,
            }
            .lighten(&mut canvas, 255);
            Disc {
                centre: from,
                radius: 255,
                gap: 255,
            }
            .draw(&mut canvas, 255);
            Disc {
                centre: to,
                radius: 0,
                gap: 0,
            }
            .draw(&mut canvas, 0);
        }
    }
}

/// Returns the covered share of a pixel's area, by 16 x 16 points.
fn covered((x, y): (i32, i32), [from, to]: [(f64, f64); 2], radius: f64) -> f64 {
    let along = (to.0 - from.0, to.1 - from.1);
    let squared = along.0 * along.0 + along.1 * along.1;
    let is_far = |at: i32, a: f64, b: f64| {
        (f64::from(at) - (a + b) / 2.0).abs() > (a - b).abs() / 2.0 + radius + 2.0
    };

    if is_far(x, from.0, to.0) || is_far(y, from.1, to.1) {
        return 0.0;
    }
    let is_inside = |(x, y): (f64, f64)| {
        let part = ((x - from.0) * along.0 + (y - from.1) * along.1) / squared;
        let part = if squared > 0.0 {
            part.clamp(0.0, 1.0)
        } else {
            0.0
        };
        (x - from.0 - part * along.0).hypot(y - from.1 - part * along.1) <= radius
    };
    let points = (0..256).map(|i| {
        (
            f64::from(x) + (f64::from(i % 16) + 0.5) / 16.0,
            f64::from(y) + (f64::from(i / 16) + 0.5) / 16.0,
        )
    });
    points.filter(|point| is_inside(*point)).count() as f64 / 256.0
}

#[test]
fn a_pixel_is_as_bright_as_it_is_covered() {
    let mut rng = Rng::with_seed(7);
    let mut greatest = 0.0_f64;

    for _ in 0..100 {
        let mut place = || (rng.f64() * 160.0 - 16.0, rng.f64() * 80.0 - 8.0);
        let from = place();
        let mut to = place();
        if rng.bool() {
            to = (
                from.0 + 4.0 * rng.f64() - 2.0,
                from.1 + 4.0 * rng.f64() - 2.0,
            );
        }
        let radius = rng.u16(15..96);
        let spot = |(x, y): (f64, f64)| Spot::at(x as f32, y as f32, Format::OLED);
        let mut canvas = ink();
        Stroke {
            from: spot(from),
            to: spot(to),
            radius,
        }
        .lighten(&mut canvas, u8::MAX);

        for (x, y) in places() {
            let exact =
                15.0 * covered((x, y), [from, to], f64::from(radius) / f64::from(SUBPIXELS));
            let error = (f64::from(ink_grey(&canvas, x, y)) - exact).abs();
            assert!(
                error < GREY_TOLERANCE,
                "{from:?} to {to:?}, radius {radius}: {exact} at {x}, {y}"
            );
            greatest = greatest.max(error);
        }
    }

    println!("off by {greatest} greys at most");
}

#[test]
fn a_gap_sets_a_disc_off() {
    let mut canvas = ink();
    places().for_each(|(x, y)| canvas.update(x, y, |_| 15));
    let x = 30.3_f32;
    let y = 20.7_f32;
    Disc {
        gap: 2 * SUBPIXELS as u16,
        ..disc(x, y, 3.0)
    }
    .draw(&mut canvas, u8::MAX);

    // The edge is soft from 2.5 to 3.5 pixels. The gap ends at 5 pixels.
    for (column, row) in places() {
        let distance = (column as f32 + 0.5 - x).hypot(row as f32 + 0.5 - y);
        let allowed = match distance {
            ..2.4 => 15..=15,
            2.4..3.6 => 0..=15,
            3.6..4.9 => 0..=0,
            4.9..5.1 => 0..=15,
            _ => 15..=15,
        };
        let found = ink_grey(&canvas, column, row);
        assert!(allowed.contains(&found), "{found} at {column}, {row}");
    }
}

#[test]
fn the_shortest_stroke_looks_like_a_disc() {
    let from = Spot::at(10.0, 10.0, Format::OLED);
    let drawn = |to| {
        let mut canvas = ink();
        Stroke {
            from,
            to,
            radius: 128,
        }
        .lighten(&mut canvas, u8::MAX);
        canvas
    };
    let disc = drawn(from);
    let short = drawn(Spot {
        x: from.x + 1,
        y: from.y + 1,
    });
    for (x, y) in places() {
        let difference = grey(&short, x, y).abs_diff(grey(&disc, x, y));
        assert!(difference <= 1, "{x}, {y}: {difference}");
    }
}

#[test]
fn a_line_is_as_bright_in_every_direction() {
    let length = 20.0;
    let total = |degrees: f32| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let mut canvas = ink();
        let from = Spot::at(60.0, 30.0, Format::OLED);
        let to = Spot::at(60.0 + length * cos, 30.0 + length * sin, Format::OLED);
        Stroke {
            from,
            to,
            radius: SUBPIXELS as u16,
        }
        .lighten(&mut canvas, u8::MAX);
        f64::from(light(&canvas))
    };

    // A white stroke 2 wide and 20 long with round ends has a light of (2 x 20 + pi) x 15.
    let expected = (2.0 * f64::from(length) + std::f64::consts::PI) * 15.0;
    for degrees in 0..360 {
        let ratio = total(degrees as f32) / expected;
        assert!((0.96..1.04).contains(&ratio), "{degrees} degrees: {ratio}");
    }
}
