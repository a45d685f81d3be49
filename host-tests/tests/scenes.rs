//! Every scene of the catalogue, on the host: its frame to the pixel, and what all scenes have in common.

use firmware::graphics::canvas::{Canvas, HEIGHT, WIDTH};
use firmware::scenes::SceneName;
use host_tests::emulator::host::Show;
use host_tests::oracle::snapshot;

/// The ticks after which each scene is pictured: one second, when all is in view, and four.
const PICTURED: [u32; 2] = [60, 240];

fn scene(name: SceneName) -> Show {
    Show::new(name, &name.first_settings()).unwrap_or_else(|error| panic!("{}: {error}", name.name()))
}

fn after(name: SceneName, ticks: u32) -> Show {
    let mut scene = scene(name);
    (0..ticks).for_each(|_| scene.tick());
    scene
}

fn greys(canvas: &Canvas) -> Vec<u8> {
    let pixels = (0..HEIGHT as i32).flat_map(|y| (0..WIDTH as i32).map(move |x| (x, y)));
    pixels.map(|(x, y)| canvas.get(x, y).unwrap_or_default()).collect()
}

#[test]
fn every_scene_looks_as_it_did() {
    let check = |name: SceneName, ticks| {
        let frame = snapshot::text(&greys(&after(name, ticks).frame()), WIDTH);
        snapshot::check(&format!("{}-{ticks}", name.name()), &frame)
    };
    let differences: Vec<_> = SceneName::ALL
        .iter()
        .flat_map(|&name| PICTURED.map(|ticks| check(name, ticks)))
        .filter_map(Result::err)
        .collect();
    assert!(differences.is_empty(), "{}", differences.join("\n"));
}

#[test]
fn a_picture_is_drawn_over_whatever_was_there() {
    for &name in SceneName::ALL {
        let scene = after(name, 30);
        let mut canvas = after(SceneName::Page, 100).frame();
        scene.draw(&mut canvas);
        assert!(canvas == scene.frame(), "{}", name.name());
    }
}
