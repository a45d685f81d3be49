//! The Pico with each colour panel in the emulator: pixels, time, buttons and restarts.

use std::time::Duration;

use crate::support::{LIMIT, application};
use boards::host::Show;
use boards::pico::PicoMachine;
use boards::pico_with;
use boards::qemu::LogLine;
use boards::toolchain;
use firmware::config::{CORTEX_M0PLUS, TICK_RATE};
use firmware::graphics::PanelName;
use firmware::protocol::{Command, ToHost};
use firmware::scenes::SceneName;

const FRAMES: u32 = 24;
/// The frames at the start of a scene that may take longer: the first is whole.
const FIRST: u32 = 6;
const IDLE: f64 = 0.25;

fn start(panel: PanelName) -> anyhow::Result<PicoMachine> {
    let node = toolchain::ready_for_pico().unwrap_or_else(|missing| panic!("{missing}"));
    PicoMachine::start(&node, &application(&pico_with(panel)), panel, LIMIT)
}

fn play(board: &mut PicoMachine, panel: PanelName, scene: SceneName) -> anyhow::Result<f64> {
    board.send(1, Command::Choose(scene))?;
    let settings = scene.first_settings();
    let mut show = Show::in_format(panel.format(), CORTEX_M0PLUS, scene, &settings)?;
    let mut busiest = 0;
    let mut frames = 0;
    while frames < FRAMES {
        let messages = board.run_to_frame()?;
        for frame in messages.into_iter().filter_map(ToHost::frame) {
            if frame.scene != scene || frame.report.step > u64::from(2 * FRAMES) {
                continue;
            }
            assert_eq!(frame, show.expected(&frame), "{panel:?}, {scene:?}");
            frames += 1;
            if frames > FIRST {
                busiest = busiest.max(frame.busy_cycles);
            }
        }
        // The rest of the millisecond in which the frame was sent is longer than its last line.
        if frames > 0 && frames.is_multiple_of(8) {
            let is_shown = board.screenshot()?.colours == show.frame().colours;
            assert!(is_shown, "{panel:?}, {scene:?}, frame {frames}");
        }
    }
    Ok(1.0 - f64::from(busiest * TICK_RATE) / 125e6)
}

/// Plays these scenes, each with the panel's pixels and enough idle time.
fn plays(board: &mut PicoMachine, panel: PanelName, scenes: &[SceneName]) -> anyhow::Result<()> {
    let mut idle = Vec::new();
    for scene in scenes {
        idle.push((scene.name(), play(board, panel, *scene)?));
    }
    println!("{}: {idle:.2?}", panel.name());
    assert!(idle.iter().all(|(_, idle)| *idle >= IDLE), "{idle:?}");
    Ok(())
}

/// The panel is dark until its first frame is complete.
#[test]
fn the_plug_on_panel_shows_the_hosts_pixels_in_every_scene() -> anyhow::Result<()> {
    let mut board = start(PanelName::Lcd13)?;
    while board.tell("panel")?.is_empty() {
        board.run(Duration::from_micros(500))?;
    }
    let settings = SceneName::Page.first_settings();
    let mut first = Show::in_format(
        PanelName::Lcd13.format(),
        CORTEX_M0PLUS,
        SceneName::Page,
        &settings,
    )?;
    first.tick();
    assert!(board.screenshot()?.colours == first.frame().colours);
    let is_named = |line: &LogLine| line.text.contains("built for the panel lcd-1.3");
    assert!(board.lines().iter().any(is_named));

    let mut scenes = SceneName::ALL.to_vec();
    scenes.reverse();
    plays(&mut board, PanelName::Lcd13, &scenes)
}

#[test]
#[ignore = "builds the program for three more panels; `cargo verify --long` runs it"]
fn every_other_panel_shows_the_hosts_pixels() -> anyhow::Result<()> {
    for panel in [PanelName::Lcd2, PanelName::Display2, PanelName::Display] {
        plays(&mut start(panel)?, panel, SceneName::ALL)?;
    }
    Ok(())
}
