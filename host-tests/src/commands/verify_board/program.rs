//! The program in the board's flash: is it the one that is built here, from which commit, by which compiler?

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use anyhow::Context;
use firmware::protocol::{CRC, Identity};
use object::{Object, ObjectSymbol};
use serde::Serialize;

use crate::emulator::boards::Board;
use crate::emulator::flash::flash_image;
use crate::emulator::process;
use crate::emulator::toolchain::{self, workspace};

/// Guards against hanging.
const LIMIT: Duration = Duration::from_secs(30);

/// The program.
#[derive(Clone, Debug, Serialize)]
pub struct Program {
    /// CRC-32 of it, as the board says.
    pub crc: String,
    /// Its length.
    pub bytes: u32,
    /// Whether it is the one that is built here; commit and compiler are those of that one.
    pub is_this: bool,
    /// With a plus where files have been changed since.
    pub commit: String,
    /// Its name and version.
    pub compiler: String,
}

/// What the board says of its program beside the one that is built here for `board`.
pub fn compare(board: Option<&Board>, identity: &Identity) -> anyhow::Result<Program> {
    let built = board.map(|board| anyhow::Ok(crc(&toolchain::ready()?.build_for(board)?)?)).transpose()?;
    let said = |program: &str, arguments: &[&str]| {
        let output = process::run(Command::new(program).args(arguments).current_dir(workspace()), LIMIT);
        output.map_or_else(|_| "unknown".to_owned(), |output| output.stdout.trim().to_owned())
    };
    let changed = !said("git", &["status", "--porcelain"]).is_empty();
    Ok(Program {
        crc: format!("{:08x}", identity.image),
        bytes: identity.image_bytes,
        is_this: built == Some((identity.image, identity.image_bytes)),
        commit: said("git", &["rev-parse", "--short=12", "HEAD"]) + if changed { "+" } else { "" },
        compiler: said("rustc", &["--version"]),
    })
}

/// CRC and length of what a board takes for its program, by the ELF file.
fn crc(elf: &Path) -> anyhow::Result<(u32, u32)> {
    let bytes = std::fs::read(elf).with_context(|| elf.display().to_string())?;
    let file = object::File::parse(&*bytes)?;
    let address = |name: &str| {
        let symbol = file.symbols().find(|symbol| symbol.name() == Ok(name));
        symbol.map(|symbol| symbol.address()).with_context(|| format!("no {name} in {}", elf.display()))
    };
    let (start, end) = (address("__vector_table")?, address("__erodata")?);
    let (first, image) = flash_image(&bytes)?;
    let place = |address: u64| address.checked_sub(first.into()).map(|offset| offset as usize);
    let image = place(start).zip(place(end)).and_then(|(start, end)| image.get(start..end));
    let image = image.with_context(|| format!("{}: the program is not where its names say", elf.display()))?;
    Ok((CRC.checksum(image), image.len() as u32))
}
