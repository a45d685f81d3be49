//! The largest stack frame of the firmware. It must be smaller than the guard, so that no function
//! steps over the guard.

use std::collections::BTreeMap;

use crate::support::{address, application};
use cycles::Image;
use emulator::boards::every_board;

/// The part of memory that statics and guard share, and the size of its subregions, as in
/// `board/cortex_m/stack.rs`.
const REGION: u32 = 32 * 1024;
const EIGHTH: u32 = REGION / 8;
/// The size of the registers that a function may push before its local variables: r4 to r11 and lr
/// of 4 bytes, d8 to d15 of 8 bytes, and the argument registers r0 to r3 of 4 bytes. The compiler
/// pushes argument registers in place of a small subtraction from the stack pointer.
const PUSHED: u32 = 9 * 4 + 8 * 8 + 4 * 4;

/// The bytes that may follow at the deepest place before the guard is accessed: the registers that
/// the next function pushes, or the registers that an interrupt saves with a floating-point unit.
const NEXT: u32 = if PUSHED > 104 { PUSHED } else { 104 };
/// The bytes of every guard that no stack frame may use, reserved for changes of the code or the
/// compiler.
const MARGIN: u32 = 512;

/// Returns the bytes of stack that an instruction takes for local variables. `literal` is the
/// constant that the previous instruction has loaded, with its register.
///
/// `mov sp, rN` is ignored, because functions use it to release the stack.
fn taken(first: u16, second: u16, literal: Option<(u16, u32)>) -> Option<u32> {
    let second = u32::from(second);
    let imm12 = (u32::from(first) >> 10 & 1) << 11 | second >> 4 & 0x700 | second & 0xff;

    // add sp, rN: a Cortex-M0+ uses this with a negative constant to take more than 508 bytes.
    if first & 0xff87 == 0x4485 {
        return match literal {
            Some((register, constant)) if register == first >> 3 & 0xf => {
                let change = constant.cast_signed();
                (change < 0).then(|| change.unsigned_abs())
            }

            // The register may have any value.
            _ => Some(u32::MAX),
        };
    }
    let is_sp = second >> 8 & 0xf == 0xd;
    match first & 0xfbff {
        _ if first & 0xff80 == 0xb080 => Some(u32::from(first & 0x7f) * 4),
        0xf2ad if is_sp => Some(imm12),
        0xf1ad if is_sp => Some(expanded(imm12)),
        // The register may have any value.
        0xebad if is_sp => Some(u32::MAX),
        _ => None,
    }
}

/// Returns the constant that `ldr rN, [pc, #...]` at this address loads, with its register.
fn literal(image: &Image, address: u32, first: u16) -> Option<(u16, u32)> {
    let is_load = first & 0xf800 == 0x4800;
    let at = ((address + 4) & !3) + 4 * u32::from(first & 0xff);
    is_load.then(|| Some((first >> 8 & 7, image.word(at)?)))?
}

/// Returns the value of an instruction's 12-bit constant (ThumbExpandImm, ARM DDI 0403, A5.3.2).
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

/// [`taken`] returns the exact number of bytes by which an encoded instruction lowers the stack
/// pointer, `u32::MAX` if it depends on an unknown register, and `None` for an instruction that
/// releases stack or changes another register.
#[test]
fn instructions_that_take_stack_are_recognised() {
    // The encodings are the assembler's: sub sp, #412; sub.w sp, sp, #8896; subw sp, sp, #1420;
    // sub.w sp, sp, r12.
    for (first, second, bytes) in [
        (0xb0e7, 0, Some(412)),
        (0xf5ad, 0x5d0b, Some(8896)),
        (0xf5ad, 0x5d5a, Some(13952)),
        (0xf2ad, 0x5d8c, Some(1420)),
        (0xebad, 0x0d0c, Some(u32::MAX)),
        (0xb007, 0, None),      // add sp, #28
        (0xf5ad, 0x5c0b, None), // sub.w r12, sp, #8896
    ] {
        assert_eq!(taken(first, second, None), bytes, "{first:#x} {second:#x}");
    }

    // Thumb-1 instructions: add sp, r6 after ldr r6, to take and to release; after ldr r5; add sp,
    // r0 after another instruction; add r8, r6.
    let minus = |bytes: u32| 0_u32.wrapping_sub(bytes);
    for (first, literal, bytes) in [
        (0x44b5, Some((6, minus(8016))), Some(8016)),
        (0x44b5, Some((6, 8016)), None),
        (0x44b5, Some((5, minus(8016))), Some(u32::MAX)),
        (0x4485, None, Some(u32::MAX)),
        (0x44b0, Some((6, minus(8016))), None),
    ] {
        assert_eq!(taken(first, 0, literal), bytes, "{first:#x} {literal:?}");
    }
}

/// On every board, the largest frame of a function, with the registers that may be pushed after it
/// and [`MARGIN`], is smaller than the guard between the stack and the statics.
#[test]
fn no_function_steps_over_the_guard() {
    let mut too_large = Vec::new();
    for board in every_board() {
        let elf = application(board);
        let image = Image::read(&elf).unwrap_or_else(|error| panic!("{error}"));
        let mut frames = BTreeMap::new();
        let mut constant = None;
        // The stack of a function is the sum of all its instructions that take some.
        for (address, first, second) in image.words() {
            if let Some(bytes) = taken(first, second.unwrap_or_default(), constant) {
                let frame: &mut u32 = frames.entry(image.function_at(address)).or_default();
                *frame = frame.saturating_add(bytes);
            }
            constant = literal(&image, address, first);
        }
        let (function, frame) = frames
            .into_iter()
            .max_by_key(|(_, bytes)| *bytes)
            .expect("functions have frames");

        // The part of the region that the statics leave, in whole eighths.
        let guard = REGION
            - (address(&elf, "__euninit") - address(&elf, "_ram_start")).next_multiple_of(EIGHTH);

        // The guard must be larger than the frame with everything that can follow it.
        let largest = function.map_or("", |function| &function.name);
        let needed = frame.saturating_add(PUSHED + NEXT + MARGIN);
        println!(
            "{}: a guard of {guard} bytes; the largest frame is {frame}, of {largest}",
            board.name
        );
        if needed > guard {
            too_large.push(format!(
                "{}: {largest} takes {frame} of {guard}",
                board.name
            ));
        }
    }

    assert!(too_large.is_empty(), "{too_large:#?}");
}
