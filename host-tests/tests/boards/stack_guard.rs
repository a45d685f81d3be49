//! No function of the firmware takes so much of the stack at once that it could step over the guard.

use std::collections::BTreeMap;

use crate::support::{address, application};
use cycles::Image;
use host_tests::emulator::boards::BOARDS;

/// The part of memory that statics and guard share, and what it can be divided by, as in `board/cortex_m/stack.rs`.
const REGION: u32 = 32 * 1024;
const EIGHTH: u32 = REGION / 8;
/// Registers that a function pushes before it takes what it needs: 9 of 4 bytes and 8 of 8, and those that it may be
/// given by number.
const PUSHED: u32 = 9 * 4 + 8 * 8 + 4 * 4;

/// Bytes that an instruction takes of the stack for local variables.
fn taken(first: u16, second: u16) -> Option<u32> {
    let second = u32::from(second);
    let imm12 = (u32::from(first) >> 10 & 1) << 11 | second >> 4 & 0x700 | second & 0xff;
    match (first & 0xfbff, second >> 8 & 0xf) {
        _ if first & 0xff80 == 0xb080 => Some(u32::from(first & 0x7f) * 4),
        (0xf2ad, 0xd) => Some(imm12),
        (0xf1ad, 0xd) => Some(expanded(imm12)),
        // By a register: whatever it holds.
        (0xebad, 0xd) => Some(u32::MAX),
        _ => None,
    }
}

/// A 12-bit constant of an instruction as the number it stands for (ThumbExpandImm, ARM DDI 0403, A5.3.2).
fn expanded(imm12: u32) -> u32 {
    let byte = imm12 & 0xff;
    match imm12 >> 8 {
        0 => byte,
        1 => byte << 16 | byte,
        2 => byte << 24 | byte << 8,
        3 => byte << 24 | byte << 16 | byte << 8 | byte,
        _ => (0x80 | imm12 & 0x7f).rotate_right(imm12 >> 7),
    }
}

#[test]
fn instructions_that_take_stack_are_recognised() {
    // As the assembler gives them: sub sp, #412; sub.w sp, sp, #8896; subw sp, sp, #1420; sub.w sp, sp, r12.
    for (first, second, bytes) in [
        (0xb0e7, 0, Some(412)),
        (0xf5ad, 0x5d0b, Some(8896)),
        (0xf5ad, 0x5d5a, Some(13952)),
        (0xf2ad, 0x5d8c, Some(1420)),
        (0xebad, 0x0d0c, Some(u32::MAX)),
        (0xb007, 0, None),      // add sp, #28
        (0xf5ad, 0x5c0b, None), // sub.w r12, sp, #8896
    ] {
        assert_eq!(taken(first, second), bytes, "{first:#x} {second:#x}");
    }
}

#[test]
fn no_function_steps_over_the_guard() {
    for board in &BOARDS {
        let elf = application(board);
        let image = Image::read(&elf).unwrap_or_else(|error| panic!("{error}"));
        let mut frames = BTreeMap::new();
        for (address, first, second) in image.words() {
            if let Some(bytes) = taken(first, second.unwrap_or_default()) {
                let frame: &mut u32 = frames.entry(image.function_at(address)).or_default();
                *frame = frame.saturating_add(bytes);
            }
        }
        let (function, frame) = frames
            .into_iter()
            .max_by_key(|(_, bytes)| *bytes)
            .expect("functions have frames");
        // What the statics leave of the region, in whole eighths.
        let guard = REGION
            - (address(&elf, "__euninit") - address(&elf, "_ram_start")).next_multiple_of(EIGHTH);
        let largest = function.map_or("", |function| &function.name);
        println!(
            "{}: a guard of {guard} bytes; the largest frame is {frame}, of {largest}",
            board.name
        );
        assert!(
            frame.saturating_add(PUSHED) <= guard,
            "{}: {largest} takes {frame} of {guard}",
            board.name
        );
    }
}
