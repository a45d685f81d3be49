//! What of an ELF file goes into flash, byte for byte.

use anyhow::{Context, Result, ensure};
use object::Endianness;
use object::elf::{FileHeader32, PT_LOAD};
use object::read::elf::{FileHeader, ProgramHeader};

/// What stands in flash where the program has nothing.
const ERASED: u8 = 0xff;
/// More than any chip's: a gap longer than this is none.
const MOST: usize = 1 << 21;

/// The program as it lies in flash: its first address, and its bytes from there on.
pub fn flash_image(elf: &[u8]) -> Result<(u32, Vec<u8>)> {
    let header = FileHeader32::<Endianness>::parse(elf)?;
    let endian = header.endian()?;
    let mut parts = Vec::new();
    for segment in header.program_headers(endian, elf)? {
        let data = segment.data(endian, elf).ok().context("a segment is cut short")?;
        if segment.p_type(endian) == PT_LOAD && !data.is_empty() {
            parts.push((segment.p_paddr(endian), data));
        }
    }
    let start = parts.iter().map(|(address, _)| *address).min().context("nothing to load")?;
    let mut image = Vec::new();
    for (address, data) in parts {
        let from = (address - start) as usize;
        ensure!(from + data.len() <= MOST, "a segment at {address:#x}, far from the others");
        if image.len() < from + data.len() {
            image.resize(from + data.len(), ERASED);
        }
        image[from..from + data.len()].copy_from_slice(data);
    }
    Ok((start, image))
}
