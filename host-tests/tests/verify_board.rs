//! `cargo verify-board`: a pseudo-terminal with an emulated board behind it.

#[path = "support/bench.rs"]
mod bench;
mod support;

use std::fs;
use std::path::Path;
use std::process::Command;

use bench::{BOARD, Bench, at_port, intact};
use firmware::job::ON_BOARDS;
use firmware::protocol::{Frame, MAX_WIRE, Sample, encode};
use firmware::scenes::SceneName;
use host_tests::emulator::process::Output;
use host_tests::link::Received;
use serde_json::Value;

fn verify(report: &Path, wire: impl Fn(&Received) -> Vec<u8>) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_verify-board"));
    command.args(["--no-questions", "--report"]).arg(report);
    at_port(&mut Bench::new(), &mut command, |bench| bench.carry(&wire))
}

#[test]
fn a_board_with_the_hosts_bits_is_told_so_and_reported() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = verify(&folder.path().join("mps2"), intact);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(output.stdout.contains("every bit the host's"), "{}", output.stdout);
    let markdown = fs::read_to_string(folder.path().join("mps2.md")).expect("the report");
    assert_eq!(markdown.matches("| no cycle counter | - |").count(), ON_BOARDS.len(), "{markdown}");
    let json = fs::read_to_string(folder.path().join("mps2.json")).expect("the report");
    let json: Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!((&json["chip"]["board"], &json["chip"]["hertz"]), (&BOARD.name.into(), &BOARD.hertz.into()));
    assert_eq!(json["program"]["is_this"], true, "{}", json["program"]);
    assert_eq!(json["bits"].as_array().map(Vec::len), Some(2 * ON_BOARDS.len()));
    let scenes = json["scenes"].as_array().expect("all scenes");
    assert_eq!(scenes.len(), SceneName::ALL.len());
    assert!(scenes.iter().all(|scene| scene["frames"].as_u64() >= Some(60) && scene["difference"].is_null()), "{json}");
}

#[test]
fn a_flipped_bit_is_named_and_fails() {
    let folder = tempfile::tempdir().expect("a folder");
    let flipped = |message: &Received| {
        let mut wire = [0; MAX_WIRE];
        if let Some(mut sample) = message.read::<Sample>().filter(|sample| (sample.request, sample.index) == (3, 5)) {
            sample.velocities[1] = f64::from_bits(sample.velocities[1].to_bits() ^ 1);
            return encode(&sample, &mut wire).to_vec();
        }
        let is_it = |frame: &Frame| frame.scene == SceneName::Butterfly.code() && frame.step == 20;
        if let Some(mut frame) = message.read::<Frame>().filter(is_it) {
            frame.state[0] = f32::from_bits(frame.state[0].to_bits() ^ 1);
            return encode(&frame, &mut wire).to_vec();
        }
        intact(message)
    };
    let output = verify(&folder.path().join("flipped"), flipped);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    // The second arithmetic's second motion.
    let sample = format!("not well: {}, chaotic: step 160: w2 is 0x", ON_BOARDS[1]);
    assert!(output.stderr.contains(&sample), "no {sample:?} in {}", output.stderr);
    let scene = output.stderr.lines().find(|line| line.starts_with("not well: butterfly: frame"));
    assert!(scene.is_some_and(|line| line.contains("step 20: a1 is 0x")), "{}", output.stderr);
    let markdown = fs::read_to_string(folder.path().join("flipped.md")).expect("the report");
    assert!(markdown.contains("2 not well") && markdown.contains("step 160: w2 is 0x"), "{markdown}");
}
