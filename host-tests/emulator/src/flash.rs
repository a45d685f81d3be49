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

/// The family ID of the RP2040.
const RP2040: u32 = 0xe48b_ff56;
/// The flag of a block that contains a family ID.
const HAS_FAMILY: u32 = 0x2000;
/// The marks at the start of a block.
const MAGIC: [u32; 2] = [0x0a32_4655, 0x9e5d_5157];
/// The mark at its end.
const MAGIC_END: u32 = 0x0ab1_6f30;
/// The number of data bytes that a block carries, out of the `ROOM` bytes it has for them.
const BROUGHT: usize = 256;
const ROOM: usize = 476;
/// The value of a byte in erased flash.
pub const ERASED: u8 = 0xff;
/// The largest image, in bytes; no chip here has more flash. A longer gap between segments is an
/// error.
const MOST: usize = 1 << 21;

/// Returns the program as it is stored in flash: its first address and its bytes from there, with
/// 0xff between its parts. Errors are as in [`flash_image_over`].
pub fn flash_image(elf: &[u8]) -> Result<(u32, Vec<u8>)> {
    flash_image_over(elf, ERASED)
}

/// Returns the program as it is stored in flash, with `unused` between its parts: erased flash, or
/// zeros as QEMU's loader leaves. The first element is the address of the first byte. Each part is
/// at its load address (`p_paddr`); parts without bytes are left out. Of parts that overlap, the
/// last one in the file counts. An error means that the file is no 32-bit ELF file, is cut short,
/// has nothing to load, or would fill more than 2 MiB. Not checked: the processor.
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

    // The image starts at the lowest address.
    let start = parts
        .iter()
        .map(|(address, _)| *address)
        .min()
        .context("nothing to load")?;

    let mut image = Vec::new();
    // The gaps between the parts are filled.
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

/// Returns the UF2 file that writes `image` to an RP2040's flash at the address `start`. Each block
/// of 512 bytes writes 256 bytes; in the last one, zeros follow the image. An empty image gives an
/// empty file. Not checked: that the image is in flash and `start` a multiple of 256.
pub fn uf2(start: u32, image: &[u8]) -> Vec<u8> {
    let parts = image.chunks(BROUGHT);
    let count = parts.len() as u32;
    let blocks = (0..).zip(parts).flat_map(|(number, part)| {
        let place = start + number * BROUGHT as u32;
        // The head of a block, in the order of the format.
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
        // The data, padding, and the mark at the end.
        block.extend(part);
        block.resize(end, 0);
        block.extend(MAGIC_END.to_le_bytes());
        block
    });
    blocks.collect()
}
