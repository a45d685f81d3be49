//! Panels with drivers of other projects: every scene in a frame buffer of embedded-graphics.

use embedded_graphics::framebuffer::{Framebuffer, buffer_size};
use embedded_graphics::geometry::{Dimensions, Point};
use embedded_graphics::image::GetPixel;
use embedded_graphics::pixelcolor::raw::{LittleEndian, RawU16};
use embedded_graphics::pixelcolor::{Gray4, Rgb565};
use embedded_graphics::primitives::PointsIter;
use emulator::host::Show;
use firmware::display::{AnyPanel, Display};
use firmware::scenes::SceneName;

/// The position of the frame on the panel.
const CORNER: Point = Point::new(11, 9);
/// The number of frames of each scene.
const FRAMES: usize = 30;

/// The test draws 30 frames of each scene. Every pixel of a larger colour panel has the colour of
/// the canvas's grey at its place, and is black outside of the frame.
#[test]
fn every_scene_is_the_canvas_through_the_map_of_colours() {
    type Target =
        Framebuffer<Rgb565, RawU16, LittleEndian, 160, 80, { buffer_size::<Rgb565>(160, 80) }>;
    let mut panel = AnyPanel {
        target: Target::new(),
        corner: CORNER,
        colour: Rgb565::from,
    };
    for &name in SceneName::ALL {
        let mut scene = Show::new(name, &name.first_settings()).expect("a scene of the catalogue");
        for _ in 0..FRAMES {
            scene.tick();
            let canvas = scene.frame();
            panel.flush(&canvas).expect("it never fails");
            // Every pixel of the panel, inside and outside of the frame.
            for at in panel.target.bounding_box().points() {
                let place = at - CORNER;
                let grey = Gray4::new(canvas.get(place.x, place.y).unwrap_or(0));
                assert_eq!(
                    panel.target.pixel(at),
                    Some(grey.into()),
                    "{} at {at}",
                    name.name()
                );
            }
        }
    }
}
