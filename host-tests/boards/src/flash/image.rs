//! The flash image of an ELF file, as plain bytes and as a UF2 file.
//!
//! A chip's boot loader appears as a drive and takes a UF2 file. The file consists of blocks of 512
//! bytes, each with its address in flash.
//!
//! Source: <https://github.com/microsoft/uf2>.

use anyhow::{Context, Result, ensure};
use object::Endianness;
use object::elf::{FileHeader32, PT_LOAD};
use object::read::elf::{FileHeader, ProgramHeader};

const RP2040: u32 = 0xe48b_ff56;
const HAS_FAMILY: u32 = 0x2000;
const MAGIC: [u32; 2] = [0x0a32_4655, 0x9e5d_5157];
const MAGIC_END: u32 = 0x0ab1_6f30;
const BROUGHT: usize = 256;
const ROOM: usize = 476;
pub const ERASED: u8 = 0xff;
/// The largest image; the chips here have no more flash.
const MOST: usize = 1 << 21;

pub fn flash_image(elf: &[u8]) -> Result<(u32, Vec<u8>)> {
    flash_image_over(elf, ERASED)
}

/// Returns the program as it is stored in flash, from the address of its first byte on, with
/// `unused` between its parts: erased flash, or zeros as QEMU's loader leaves.
pub fn flash_image_over(elf: &[u8], unused: u8) -> Result<(u32, Vec<u8>)> {
    let header = FileHeader32::<Endianness>::parse(elf)?;
    let endian = header.endian()?;
    let mut parts = Vec::new();

    for segment in header.program_headers(endian, elf)? {
        let data = segment
            .data(endian, elf)
            .ok()
            .context("a segment is cut short")?;
        if segment.p_type(endian) == PT_LOAD && !data.is_empty() {
            parts.push((segment.p_paddr(endian), data));
        }
    }

    let start = parts
        .iter()
        .map(|(address, _)| *address)
        .min()
        .context("nothing to load")?;

    let mut image = Vec::new();
    for (address, data) in parts {
        let from = (address - start) as usize;
        ensure!(
            from + data.len() <= MOST,
            "a segment at {address:#x}, far from the others"
        );
        if image.len() < from + data.len() {
            image.resize(from + data.len(), unused);
        }
        image[from..from + data.len()].copy_from_slice(data);
    }

    Ok((start, image))
}

pub fn uf2(start: u32, image: &[u8]) -> Vec<u8> {
    let parts = image.chunks(BROUGHT);
    let count = parts.len() as u32;
    let blocks = (0..).zip(parts).flat_map(|(number, part)| {
        let place = start + number * BROUGHT as u32;
        let head = [
            MAGIC[0],
            MAGIC[1],
            HAS_FAMILY,
            place,
            BROUGHT as u32,
            number,
            count,
            RP2040,
        ];
        let mut block: Vec<u8> = head.into_iter().flat_map(u32::to_le_bytes).collect();
        let end = block.len() + ROOM;
        block.extend(part);
        block.resize(end, 0);
        block.extend(MAGIC_END.to_le_bytes());
        block
    });
    blocks.collect()
}
