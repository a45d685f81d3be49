//! `cargo pico` from outside: the file that it makes, and the drive that it copies it onto.

use std::fs;
use std::path::Path;

use host_tests::emulator::boards::PICO;
use host_tests::emulator::flash::flash_image;
use host_tests::emulator::process::Output;
use host_tests::emulator::toolchain;

use super::cli::{output, program};

/// What the label on an RP2040's drive says.
const LABEL: &str = "UF2 Bootloader v3.0\nModel: Raspberry Pi RP2\nBoard-ID: RPI-RP2\n";

fn pico(drive: &Path) -> Output {
    output(program("pico").arg("--drive").arg(drive))
}

/// Block by block, as the boot ROM takes it.
#[test]
fn the_copied_file_brings_the_program_into_flash() {
    let drive = tempfile::tempdir().expect("a folder");
    fs::write(drive.path().join("INFO_UF2.TXT"), LABEL).expect("a label");
    let output = pico(drive.path());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let file = fs::read(drive.path().join("pico.uf2")).expect("it is copied");
    let (blocks, rest) = file.as_chunks::<512>();
    assert!(rest.is_empty());
    let elf = toolchain::ready().expect("the tools").build_for(&PICO).expect("the firmware");
    let (start, image) = flash_image(&fs::read(elf).expect("a file")).expect("a program");
    let mut flashed = Vec::new();
    for (number, block) in blocks.iter().enumerate() {
        let words: Vec<_> = block.as_chunks().0.iter().map(|bytes| u32::from_le_bytes(*bytes)).collect();
        let place = start + 256 * number as u32;
        // Magic, a family is named, where, how many, which of how many, the family of the RP2040.
        let head = [0x0a32_4655, 0x9e5d_5157, 0x2000, place, 256, number as u32, blocks.len() as u32, 0xe48b_ff56];
        assert_eq!((&words[..8], words[127]), (&head[..], 0x0ab1_6f30));
        flashed.extend(&block[32..][..256]);
    }
    assert_eq!(flashed.len(), image.len().next_multiple_of(256));
    assert!(flashed.starts_with(&image));
}

#[test]
fn the_drive_of_another_board_is_refused() {
    let drive = tempfile::tempdir().expect("a folder");
    fs::write(drive.path().join("INFO_UF2.TXT"), LABEL.replace("RPI-RP2", "RP2350")).expect("a label");
    let output = pico(drive.path());
    assert_eq!((output.status.code(), output.stdout.as_str()), (Some(2), ""));
    assert!(output.stderr.lines().count() == 1 && output.stderr.contains("another board"), "{}", output.stderr);
}
