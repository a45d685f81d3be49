//! Running one firmware binary in QEMU: which board it is for, and its log as it comes.

use std::io::{self, Write};
use std::path::Path;
use std::process::ExitStatus;

use crate::emulator::boards::{BOARDS, Board};
use crate::emulator::qemu::{Machine, Settings};

/// The board for a binary: the one asked for; else the first that has it as its application; else the default one.
/// Where the file says its target, as in `target/thumbv7m-none-eabi/release/x`, only boards of that target count.
/// `None` if there is no such board.
pub fn board_for(name: Option<&str>, binary: &Path) -> Option<&'static Board> {
    let target = |board: &&Board| {
        let known = |target: &str| BOARDS.iter().any(|board| board.target == target);
        let folders = || binary.components().filter_map(|part| part.as_os_str().to_str());
        folders().all(|folder| !known(folder)) || folders().any(|folder| folder == board.target)
    };
    if let Some(name) = name {
        return BOARDS.iter().find(|board| board.name == name);
    }
    let runs_it = |board: &&Board| binary.file_name().is_some_and(|file| file == board.binary);
    BOARDS.iter().filter(target).find(runs_it).or_else(|| BOARDS.iter().find(target))
}

/// Runs a firmware to its own end, or to its limit, which is an error; each line of its log goes to `output`.
pub fn run(settings: &Settings, output: &mut impl Write) -> anyhow::Result<ExitStatus> {
    let mut machine = Machine::start(settings)?;
    for line in machine.log.rest() {
        // Whoever stops reading does not stop the board.
        let _: io::Result<()> = writeln!(output, "{line}").and_then(|()| output.flush());
    }
    Ok(machine.wait()?.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_board_is_the_one_asked_for_or_follows_from_the_binary() {
        for (asked, binary, name) in [
            (None, "lm3s6965evb", Some("lm3s6965evb")),
            (None, "mps2-an386", Some("mps2-an386")),
            (None, "inject-panic", Some("lm3s6965evb")),
            (None, "target/thumbv7em-none-eabihf/release/lm3s6965evb", Some("lm3s6965evb-m4")),
            (None, "target/thumbv7em-none-eabihf/release/inject-panic", Some("lm3s6965evb-m4")),
            (Some("mps2-an386"), "inject-panic", Some("mps2-an386")),
            (Some("toaster"), "inject-panic", None),
        ] {
            assert_eq!(board_for(asked, Path::new(binary)).map(|board| board.name), name, "{asked:?} {binary}");
        }
    }
}
