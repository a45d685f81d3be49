//! `cargo flips`: its files, and that an interrupted run goes on as if nothing had been.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::Duration;

use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;

fn command(arguments: &str, out: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_flips"));
    // Bands as small as they come, on any machine.
    command.env("RAYON_NUM_THREADS", "1").args(arguments.split_whitespace()).arg("--out").arg(out);
    command
}

fn run(arguments: &str, out: &Path) -> Output {
    command(arguments, out).output().expect("it runs")
}

/// A map large enough to be caught half done: several bands, of which the first are quickly done.
const LARGE: &str = "--size 450x80 --limit 5 --centre 1,-1 --zoom 8";

const PIXELS: usize = 450 * 80;

/// Runs it until it has put down something.
fn begun(out: &Path) -> Child {
    let mut child = command(LARGE, out).stderr(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("it runs");
    let mut part = out.as_os_str().to_owned();
    part.push(".part");
    while fs::metadata(&part).map_or(0, |part| part.len()) < 1000 {
        assert_eq!(child.try_wait().expect("a state"), None, "it was too fast");
        sleep(Duration::from_millis(1));
    }
    child
}

/// Runs it until it has put down something, and sends it a signal; what it says to that.
fn interrupted(out: &Path, signal: Signal) -> Output {
    let child = begun(out);
    kill(Pid::from_raw(child.id() as i32), signal).expect("it is alive");
    child.wait_with_output().expect("it ends")
}

#[test]
fn an_interrupted_run_goes_on_to_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    let [whole, stopped, killed, ended] =
        ["whole.png", "stopped.png", "killed.png", "ended.png"].map(|name| folder.path().join(name));
    assert!(run(LARGE, &whole).status.success());
    let output = interrupted(&stopped, Signal::SIGINT);
    assert_eq!(output.status.code(), Some(130), "{output:?}");
    let partly = png::Decoder::new(std::io::BufReader::new(fs::File::open(&stopped).expect("a picture")));
    let mut reader = partly.read_info().expect("a picture");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
    reader.next_frame(&mut pixels).expect("a whole picture");
    let undone = pixels.chunks(3).take(PIXELS).filter(|pixel| *pixel == [255; 3]).count();
    assert!(undone > 0 && undone < PIXELS, "{undone} undone");
    assert!(!interrupted(&killed, Signal::SIGKILL).status.success());
    let output = interrupted(&ended, Signal::SIGTERM);
    assert_eq!(output.status.code(), Some(143), "{output:?}");
    for out in [&stopped, &killed, &ended] {
        let resumed = run(&format!("{LARGE} --resume"), out);
        assert!(resumed.status.success(), "{resumed:?}");
        assert!(fs::read(out).expect("a file") == fs::read(&whole).expect("a file"), "{out:?}");
    }
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 4, "nothing is left beside");
}

#[test]
fn a_second_run_does_not_write_over_the_first() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("one.png");
    let first = begun(&out);
    let second = run(LARGE, &out);
    let line = String::from_utf8(second.stderr).expect("text");
    assert_eq!((second.status.code(), line.lines().count()), (Some(2), 1), "{line}");
    assert!(line.contains("one.png: another cargo flips is writing it"), "{line}");
    assert!(first.wait_with_output().expect("it ends").status.success());
}

#[test]
fn a_table_has_every_start_and_is_its_own_mirror_image() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("map.csv");
    assert!(run("--size 12x6 --limit 20", &out).status.success());
    let table = fs::read_to_string(&out).expect("a file");
    let times: Vec<_> = table.lines().skip(1).filter_map(|line| line.split(',').nth(2)).collect();
    assert_eq!(times.len(), 72);
    // Both angles mirrored: the same motion.
    assert!(times.iter().eq(times.iter().rev()));
    let [never, later] = ["never", "later"].map(|word| times.iter().filter(|time| **time == word).count());
    assert!(never > 10 && never < 40 && later > 0, "{table}");
    assert!(times.iter().filter_map(|time| time.parse::<f32>().ok()).all(|time| time > 0.0 && time <= 20.0), "{table}");
}
