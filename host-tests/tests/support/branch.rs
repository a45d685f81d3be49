//! The few Thumb instructions by which code names other code.
//!
//! Source: ARM DDI 0403 (ARMv7-M Architecture Reference Manual), A7.7.12 (B), A7.7.18 (BL), A7.7.21 (CBZ), A7.7.77 (MOV),
//! A7.7.80 (MOVT).

/// What an instruction says of an address.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Names {
    /// It goes there: so far from the program counter, which reads as the instruction's address plus 4.
    Branch(i32),
    /// Puts the lower half of a number into a register.
    Lower(u8, u16),
    /// Puts the upper half of a number into a register.
    Upper(u8, u16),
}

/// What the instruction of these halfwords names, the second of which it only has if it is a long one.
pub fn names(first: u16, second: Option<u16>) -> Option<Names> {
    match second {
        None => short_branch(first.into()).map(Names::Branch),
        Some(second) => {
            half(first.into(), second.into()).or(long_branch(first.into(), second.into()).map(Names::Branch))
        }
    }
}

fn short_branch(word: i32) -> Option<i32> {
    match word >> 12 {
        0xd if word >> 8 & 0xf < 0xe => Some(signed(word, 8) << 1),
        0xe => Some(signed(word, 11) << 1),
        _ if word & 0xf500 == 0xb100 => Some((word >> 9 & 1) << 6 | (word >> 3 & 0x1f) << 1),
        _ => None,
    }
}

fn long_branch(first: i32, second: i32) -> Option<i32> {
    if first >> 11 != 0x1e || second >> 15 == 0 {
        return None;
    }
    let (sign, j1, j2, low) = (first >> 10 & 1, second >> 13 & 1, second >> 11 & 1, second & 0x7ff);
    let with_condition = second >> 12 & 1 == 0;
    if with_condition {
        let is_branch = second >> 14 & 1 == 0 && first >> 6 & 0xf < 0xe;
        is_branch.then(|| signed(sign << 19 | j2 << 18 | j1 << 17 | (first & 0x3f) << 11 | low, 20) << 1)
    } else {
        let [i1, i2] = [j1, j2].map(|j| 1 ^ j ^ sign);
        Some(signed(sign << 23 | i1 << 22 | i2 << 21 | (first & 0x3ff) << 11 | low, 24) << 1)
    }
}

fn half(first: i32, second: i32) -> Option<Names> {
    let number = (first & 0xf) << 12 | (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 0xff;
    let (register, number) = ((second >> 8 & 0xf) as u8, number as u16);
    match first & 0xfbf0 {
        0xf240 if second >> 15 == 0 => Some(Names::Lower(register, number)),
        0xf2c0 if second >> 15 == 0 => Some(Names::Upper(register, number)),
        _ => None,
    }
}

/// The lowest `bits` of `value`, the highest of which is the sign.
fn signed(value: i32, bits: u32) -> i32 {
    value << (32 - bits) >> (32 - bits)
}

/// Every form of each instruction, and what is none: as LLVM's disassembler reads them.
#[test]
fn instructions_are_read_as_a_disassembler_reads_them() {
    let branch = |offset| Some(Names::Branch(offset));
    let table = [
        (0xd0fe, None, branch(-4)),                            // beq
        (0xd180, None, branch(-256)),                          // bne
        (0xde00, None, None),                                  // udf #0
        (0xdf00, None, None),                                  // svc #0
        (0xe7fe, None, branch(-4)),                            // b
        (0xe3ff, None, branch(2046)),                          // b
        (0xb120, None, branch(8)),                             // cbz r0
        (0xbb20, None, branch(72)),                            // cbnz r0
        (0xbf00, None, None),                                  // nop
        (0xf000, Some(0xf800), branch(0)),                     // bl
        (0xf123, Some(0xfa2b), branch(1_193_046)),             // bl
        (0xf7ff, Some(0xbffe), branch(-4)),                    // b.w
        (0xf554, Some(0xbaa1), branch(-2_800_318)),            // b.w
        (0xf43f, Some(0xaffe), branch(-4)),                    // beq.w
        (0xf054, Some(0xa990), branch(869_152)),               // bne.w
        (0xf3bf, Some(0x8f4f), None),                          // dsb
        (0xf04f, Some(0x30ff), None),                          // mov.w r0, #-1
        (0xf645, Some(0x2834), Some(Names::Lower(8, 0x5a34))), // movw r8, #0x5a34
        (0xf6c0, Some(0x0801), Some(Names::Upper(8, 0x0801))), // movt r8, #0x801
    ];
    for (first, second, expected) in table {
        assert_eq!(names(first, second), expected, "{first:04x} {second:04x?}");
    }
}
