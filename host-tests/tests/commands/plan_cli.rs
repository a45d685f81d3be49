//! `cargo plan` plans what the boards show; what it says and refuses is in the snapshots.

use firmware::app::News;
use firmware::config::{CORTEX_M3, STM32F405};
use firmware::scenes::SceneName;
use host_tests::emulator::host::Show;

use super::cli::{output, program};

/// The boards' own scene starts from the nearest `f32` to 120 degrees, which is another motion in the end.
#[test]
fn a_scene_is_planned_as_the_boards_start_it() {
    let name = SceneName::Page;
    for (target, processor) in [("m3", CORTEX_M3), ("m4f", STM32F405)] {
        let mut show = Show::on(processor, name, &name.first_settings()).expect("a scene of the catalogue");
        let horizon = loop {
            show.tick();
            if let [.., (_, News::Found(Ok(plan)))] = show.news[..] {
                break plan.horizon;
            }
        };
        let said = output(program("plan").args(["--scene", "page", "--target", target])).stdout;
        assert!(said.contains(&format!("until {horizon:.2} s of 30 s")), "{horizon} {said}");
    }
}
