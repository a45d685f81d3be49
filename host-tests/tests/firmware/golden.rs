//! The first 10 s of every scene on every class of processors equal `golden/frames.csv`: each
//! picture's greys and each report's bits.

use crate::snapshot;
use boards::host::Show;
use double_pendulum::golden::{FNV_OFFSET, fnv_1a};
use firmware::config::{
    CORTEX_M0PLUS, CORTEX_M3, CORTEX_M4F, PROCESSORS, Processor, STM32F405, TICK_RATE,
};
use firmware::protocol::{MAX_WIRE, ToHost, encode};
use firmware::scenes::SceneName;
use rayon::prelude::*;

const FRAMES: u32 = 10 * TICK_RATE;
const CLASSES: [(&str, Processor); 4] = [
    ("cortex-m0plus", CORTEX_M0PLUS),
    ("cortex-m3", CORTEX_M3),
    ("cortex-m4f", CORTEX_M4F),
    ("stm32f405", STM32F405),
];

/// Returns the line of a scene: the 64-bit FNV-1a hashes of all its pictures and of all its
/// messages.
fn line((class, processor): (&str, Processor), scene: SceneName) -> String {
    let mut show = Show::on(processor, scene, &scene.first_settings())
        .unwrap_or_else(|error| panic!("{}: {error}", scene.name()));
    let [mut pictures, mut messages] = [FNV_OFFSET; 2];
    for _ in 0..FRAMES {
        show.tick();
        let picture: Vec<u8> = show.frame().greys;
        pictures = fnv_1a(pictures, &picture);
        let message = ToHost::Frame(show.player.frame());
        messages = fnv_1a(messages, encode(&message, &mut [0; MAX_WIRE]));
    }
    format!("{class},{},{pictures:016x},{messages:016x}\n", scene.name())
}

#[test]
fn every_scene_shows_the_golden_frames() -> Result<(), String> {
    assert_eq!(CLASSES.len(), PROCESSORS.len());
    let scenes: Vec<_> = CLASSES
        .iter()
        .flat_map(|class| SceneName::ALL.iter().map(move |scene| (*class, *scene)))
        .collect();
    let lines: Vec<String> = scenes
        .into_par_iter()
        .map(|(class, scene)| line(class, scene))
        .collect();
    let text = format!("processor,scene,pictures,messages\n{}", lines.concat());
    snapshot::check_lines("host-tests/golden/frames.csv", &text)
}
