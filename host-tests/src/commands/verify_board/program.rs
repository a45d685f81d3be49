//! The program in the board's flash: is it the one that is built here, from which commit, by which compiler?

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use anyhow::Context;
use firmware::protocol::{CRC, Identity};
use object::{Object, ObjectSymbol};

use crate::emulator::boards::Board;
use crate::emulator::flash::flash_image;
use crate::emulator::process;
use crate::emulator::toolchain::{self, workspace};

const LIMIT: Duration = Duration::from_secs(30);

/// What the board says of its program beside the one that is built here for `board`, in a line.
pub fn compare(board: Option<&Board>, identity: &Identity) -> anyhow::Result<String> {
    let built = board.map(|board| anyhow::Ok(crc(&toolchain::ready()?.build_for(board)?)?)).transpose()?;
    let said = |program: &str, arguments: &[&str]| {
        let output = process::run(Command::new(program).args(arguments).current_dir(workspace()), LIMIT);
        output.map_or_else(|_| "unknown".to_owned(), |output| output.stdout.trim().to_owned())
    };
    // With a plus where files have been changed since.
    let changed = if said("git", &["status", "--porcelain"]).is_empty() { "" } else { "+" };
    let (commit, compiler) = (said("git", &["rev-parse", "--short=12", "HEAD"]), said("rustc", &["--version"]));
    let Identity { image, image_bytes, .. } = *identity;
    let whose = if built == Some((image, image_bytes)) {
        format!("built from commit {commit}{changed} by {compiler}")
    } else {
        format!("not the one that commit {commit}{changed} and {compiler} build")
    };
    Ok(format!("program of {image_bytes} bytes, CRC {image:08x}: {whose}"))
}

/// CRC and length of what a board takes for its program, by the ELF file.
fn crc(elf: &Path) -> anyhow::Result<(u32, u32)> {
    let bytes = std::fs::read(elf).with_context(|| elf.display().to_string())?;
    let file = object::File::parse(&*bytes)?;
    let (first, image) = flash_image(&bytes)?;
    let place = |name: &str| {
        let address = file.symbols().find(|symbol| symbol.name() == Ok(name))?.address();
        Some(address.checked_sub(first.into())? as usize)
    };
    let image = place("__vector_table").zip(place("__erodata")).and_then(|(start, end)| image.get(start..end));
    let image = image.with_context(|| format!("{}: the program is not where its names say", elf.display()))?;
    Ok((CRC.checksum(image), image.len() as u32))
}
