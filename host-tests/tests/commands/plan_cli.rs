//! `cargo plan`: what it says, and what it refuses.

use std::process::{Command, Output};

use firmware::app::player::News;
use firmware::config::{CORTEX_M3, STM32F405};
use firmware::motion::planner::Finding;
use firmware::scenes::SceneName;
use host_tests::emulator::host::Show;

fn plan(arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_plan")).args(arguments.split_whitespace()).output().expect("it runs")
}

fn said(arguments: &str) -> String {
    let output = plan(arguments);
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout).expect("text")
}

#[test]
fn it_says_the_method_the_step_and_the_horizon() {
    let small = said("--angles 3,3 --degrees --height 64 --duration 10");
    assert!(small.contains("rk4-fixed32") && small.contains("until 10.00 s of 10 s"), "{small}");
    let large = said("--angles 90,90 --degrees --duration 10 --target m4f");
    assert!(large.contains("rk4-f32-direction-plain") && large.contains("1/60 s, one to a frame"), "{large}");
    let figure7 = said("--masses 1,2.75 --angles 171,171 --degrees --duration 30");
    assert!(figure7.contains("errors grow until they show") && figure7.contains("of 30 s"), "{figure7}");
    let light = said("--masses 1,1000 --angles 30,30 --degrees --duration 1");
    assert!(light.contains("no rod can turn over"), "{light}");
}

/// Where nothing affordable is right in any frame, that is all there is to say: no method, no share of the chip, no horizon.
#[test]
fn it_says_that_nothing_holds() {
    let nothing = said("--angles 90,90 --degrees --masses 1,1000 --height 240 --duration 20");
    assert!(nothing.starts_with("nothing  that a Cortex-M3 at 50 MHz can afford"), "{nothing}");
    for absent in ["method", "horizon", "%", "0.00 s"] {
        assert!(!nothing.contains(absent), "{absent}: {nothing}");
    }
    assert!(nothing.contains("why      steps fine enough cost more than"), "{nothing}");
}

/// The boards' own scene starts from the nearest `f32` to 120 degrees, which is another motion in the end.
#[test]
fn a_scene_is_planned_as_the_boards_start_it() {
    let name = SceneName::Page;
    for (target, processor) in [("m3", CORTEX_M3), ("m4f", STM32F405)] {
        let mut show = Show::on(processor, name, &name.first_settings()).expect("a scene of the catalogue");
        let horizon = loop {
            show.tick();
            if let [.., (_, News::Found(Finding::Plan(plan)))] = show.news[..] {
                break plan.horizon;
            }
        };
        let said = said(&format!("--scene page --target {target}"));
        assert!(said.contains(&format!("until {horizon:.2} s of 30 s")), "{horizon} {said}");
    }
}

/// Nothing moves without gravity, from rest; and what is shown if nothing is said is the boards' first start.
#[test]
fn it_has_words_for_rest_and_a_start_of_its_own() {
    let rest = said("--gravity 0");
    assert!(rest.contains("nothing moves") && !rest.contains("1/0 s"), "{rest}");
    assert!(said("").contains("a rod may turn over"), "120 degrees");
    assert_eq!(said(""), said("--angles 120,120 --degrees --gravity 9.81"));
}

#[test]
fn bad_input_is_refused_in_one_line_that_names_option_and_value() {
    for (arguments, option, value) in [
        ("--masses 0,1", "--masses", "0"),
        ("--lengths 1,-2", "--lengths", "-2"),
        ("--gravity -1", "--gravity", "-1"),
        ("--height 0", "--height", "0"),
        ("--height tall", "--height", "tall"),
        ("--duration -1", "--duration", "-1"),
        ("--duration 1e12", "--duration", "1000000000000"),
        ("--rate 0", "--rate", "0"),
        ("--rate 0.5", "--rate", "0.5"),
        ("--rate 70000", "--rate", "70000"),
        ("--target m7", "--target", "m7"),
        ("--study -1", "--study", "-1 is not in 1.."),
        ("--height 1e9", "--height", "1e9"),
        ("--scene nowhere", "--scene", "nowhere"),
        ("--scene flips", "--scene", "flips"),
        ("--seed -1", "--seed", "-1 is not in 0.."),
    ] {
        let output = plan(arguments);
        let error = String::from_utf8(output.stderr).expect("text");
        assert_eq!(output.status.code(), Some(2), "{arguments}: {error}");
        assert!(error.lines().count() == 1 && error.contains(option) && error.contains(value), "{arguments}: {error}");
        assert!(output.stdout.is_empty(), "{arguments}");
    }
}
