//! The framebuffer and the brush: layout, clipping, and that a disc is where it was put.

use embedded_graphics::geometry::Size;
use embedded_graphics::pixelcolor::Gray4;
use embedded_graphics::prelude::{Dimensions, DrawTarget, Drawable, Pixel, Point, Primitive};
use embedded_graphics::primitives::{PrimitiveStyle, Rectangle};
use firmware::graphics::brush::{SUBPIXELS, Spot, Stroke};
use firmware::graphics::canvas::{Canvas, HEIGHT, WIDTH};

/// Greys are rounded down to one of 16, which shifts a disc's centre of light by far less than this, pixels.
const CENTRE_TOLERANCE: f64 = 0.1;

fn grey(canvas: &Canvas, x: i32, y: i32) -> u8 {
    canvas.get(x, y).expect("inside")
}

fn light(canvas: &Canvas) -> u32 {
    canvas.bytes().iter().map(|byte| u32::from(byte >> 4) + u32::from(byte & 15)).sum()
}

/// The top left corner, a character per pixel.
fn frame(canvas: &Canvas, width: i32, height: i32) -> Vec<String> {
    let row = |y| (0..width).map(|x| char::from_digit(grey(canvas, x, y).into(), 16).expect("a grey")).collect();
    (0..height).map(row).collect()
}

#[test]
fn the_left_pixel_is_the_high_nibble() {
    let mut canvas = Canvas::default();
    canvas.update(2, 1, |_| 0xA);
    canvas.update(3, 1, |_| 0x5);
    canvas.update(127, 63, |_| 0x7);
    let set: Vec<_> = canvas.bytes().iter().enumerate().filter(|(_, byte)| **byte != 0).collect();
    assert_eq!(set, [(65, &0xA5), (4095, &0x07)]);
    canvas.clear();
    assert_eq!(canvas, Canvas::default());
}

#[test]
fn what_lies_outside_is_not_drawn() {
    let mut canvas = Canvas::default();
    let (width, height) = (WIDTH as i32, HEIGHT as i32);
    let outside = [-1, i32::MIN, i32::MAX, width, height];
    for a in outside {
        let pixels = [(a, 0), (0, a), (a, a)].map(|(x, y)| Pixel(Point::new(x, y), Gray4::new(15)));
        let inside = |pixel: &Pixel<Gray4>| canvas.bounding_box().contains(pixel.0);
        let pixels: Vec<_> = pixels.into_iter().filter(|pixel| !inside(pixel)).collect();
        let Ok(()) = canvas.draw_iter(pixels);
    }
    assert_eq!(canvas, Canvas::default());

    let style = PrimitiveStyle::with_fill(Gray4::new(9));
    let Ok(()) = Rectangle::new(Point::new(-10, -10), Size::new(12, 11)).into_styled(style).draw(&mut canvas);
    assert_eq!((light(&canvas), grey(&canvas, 0, 0), grey(&canvas, 1, 0)), (18, 9, 9));
}

#[test]
fn a_disc_has_a_soft_edge() {
    let mut canvas = Canvas::default();
    Stroke::disc(Spot::at(4.0, 4.0), 3 * SUBPIXELS as u8).lighten(&mut canvas, u8::MAX);
    let expected = [
        "00000000", //
        "009ee900", "09ffff90", "0effffe0", "0effffe0", "09ffff90", "009ee900", "00000000",
    ];
    assert_eq!(frame(&canvas, 8, 8), expected);
}

#[test]
fn a_disc_is_where_it_was_put() {
    for number in 0..1000 {
        let (x, y) = (10.0 + (number as f32 * 0.377) % 100.0, 10.0 + (number as f32 * 0.713) % 40.0);
        let mut canvas = Canvas::default();
        Stroke::disc(Spot::at(x, y), (1.5 * SUBPIXELS as f32) as u8).lighten(&mut canvas, u8::MAX);
        let mut sum = [0.0; 3];
        for (row, column) in (0..HEIGHT as i32).flat_map(|row| (0..WIDTH as i32).map(move |column| (row, column))) {
            let grey = f64::from(grey(&canvas, column, row));
            sum = [sum[0] + grey, sum[1] + grey * (f64::from(column) + 0.5), sum[2] + grey * (f64::from(row) + 0.5)];
        }
        let (found_x, found_y) = (sum[1] / sum[0], sum[2] / sum[0]);
        assert!((found_x - f64::from(x)).abs() < CENTRE_TOLERANCE, "x {x}: {found_x}");
        assert!((found_y - f64::from(y)).abs() < CENTRE_TOLERANCE, "y {y}: {found_y}");
    }
}

#[test]
fn a_stroke_of_any_numbers_is_safe() {
    let numbers = [0.0, -1.0, 127.9, 1e3, -1e3, f32::MAX, f32::MIN, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
    let spots: Vec<_> = numbers.iter().flat_map(|&x| numbers.map(|y| Spot::at(x, y))).collect();
    for &from in &spots {
        for &to in &spots {
            let mut canvas = Canvas::default();
            Stroke { from, to, radius: 255 }.lighten(&mut canvas, 255);
            Stroke { from, to, radius: 0 }.erase(&mut canvas);
        }
    }
}

#[test]
fn a_line_is_as_bright_in_every_direction() {
    let length = 20.0;
    let total = |degrees: f32| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let mut canvas = Canvas::default();
        let (from, to) = (Spot::at(60.0, 30.0), Spot::at(60.0 + length * cos, 30.0 + length * sin));
        Stroke { from, to, radius: SUBPIXELS as u8 }.lighten(&mut canvas, u8::MAX);
        f64::from(light(&canvas))
    };
    // A stroke 2 wide and 20 long with round ends, all white: (2 x 20 + pi) x 15.
    let expected = (2.0 * f64::from(length) + std::f64::consts::PI) * 15.0;
    for degrees in 0..360 {
        let ratio = total(degrees as f32) / expected;
        assert!((0.97..1.03).contains(&ratio), "{degrees} degrees: {ratio}");
    }
}
