//! Panels by other people's drivers: every scene in a frame buffer of embedded-graphics' own.

use std::convert::Infallible;
use std::fmt::Debug;

use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::framebuffer::{Framebuffer, buffer_size};
use embedded_graphics::geometry::Point;
use embedded_graphics::image::GetPixel;
use embedded_graphics::pixelcolor::raw::{LittleEndian, RawU1, RawU4, RawU16};
use embedded_graphics::pixelcolor::{BinaryColor, Gray4, PixelColor, Rgb565};
use firmware::display::{AnyPanel, Display};
use firmware::scenes::SceneName;
use host_tests::emulator::host::Show;

/// The panel's size, and where on it the frame is.
const PANEL: (usize, usize) = (160, 80);
const CORNER: Point = Point::new(11, 9);
/// Frames of each scene.
const FRAMES: usize = 30;

/// Every scene on a black panel, which stays black around the frame.
fn shows_every_scene<Color: PixelColor + Debug, Target>(target: Target, colour: fn(Gray4) -> Color)
where
    Target: DrawTarget<Color = Color, Error = Infallible> + GetPixel<Color = Color>,
{
    let mut panel = AnyPanel { target, corner: CORNER, colour };
    for &name in SceneName::ALL {
        let mut scene = Show::new(name, &name.first_settings()).expect("a scene of the catalogue");
        for _ in 0..FRAMES {
            scene.tick();
            let canvas = scene.frame();
            panel.flush(&canvas).expect("it never fails");
            for at in (0..PANEL.1).flat_map(|y| (0..PANEL.0).map(move |x| Point::new(x as i32, y as i32))) {
                let place = at - CORNER;
                let grey = Gray4::new(canvas.get(place.x, place.y).unwrap_or(0));
                assert_eq!(panel.target.pixel(at), Some(colour(grey)), "{} at {at}", name.name());
            }
        }
    }
}

macro_rules! frame_buffer {
    ($color:ty, $raw:ty) => {
        Framebuffer::<$color, $raw, LittleEndian, { PANEL.0 }, { PANEL.1 }, { buffer_size::<$color>(PANEL.0, PANEL.1) }>::new()
    };
}

#[test]
fn every_scene_is_the_canvas_through_the_map_of_colours() {
    shows_every_scene(frame_buffer!(Rgb565, RawU16), Rgb565::from);
    shows_every_scene(frame_buffer!(Gray4, RawU4), Gray4::from);
    shows_every_scene(frame_buffer!(BinaryColor, RawU1), BinaryColor::from);
}
