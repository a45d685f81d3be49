//! What a crashed Cortex-M says about itself, in words.

use core::fmt;

/// The registers that tell why a HardFault was taken, the last four the Configurable and the HardFault Status Register and the
/// MemManage and the BusFault Address Register. A Cortex-M0+ has none of those: they are 0.
///
/// Source: ARM DDI 0403 (ARMv7-M Architecture Reference Manual), B3.2.15 to B3.2.18; ARM DDI 0419 (ARMv6-M), B3.2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The registers that the processor stacked; `None` if the stack could not take them.
    pub stacked: Option<Stacked>,
    /// The stack pointer when the fault came.
    pub sp: u32,
    /// The last call found on the stack: all there is to go by without the registers.
    pub last_call: Option<u32>,
    pub cfsr: u32,
    pub hfsr: u32,
    pub mmfar: u32,
    pub bfar: u32,
}

/// What the processor puts on the stack on its way to the handler, as far as it is of interest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stacked {
    /// Program counter: the instruction that failed, or for imprecise bus faults one soon after it.
    pub pc: u32,
    /// Link register: where the function that failed returns to, unless it has called others meanwhile.
    pub lr: u32,
    pub xpsr: u32,
}

/// The stack did not take the registers, or not all of them: on the way into an exception or, of the floating-point unit, later
/// (MSTKERR, MLSPERR, STKERR, LSPERR).
const NOT_STACKED: u32 = 1 << 4 | 1 << 5 | 1 << 12 | 1 << 13;
/// Data is refused by the memory protection unit, at an address that is known (DACCVIOL, MMARVALID).
const REFUSED: u32 = 1 << 1 | 1 << 7;

/// The bit of the program status that is set as long as the processor executes Thumb code, which is all it can.
const THUMB: u32 = 1 << 24;

/// The most bytes that one instruction pushes: 16 double-precision registers. Before it is done, the stack pointer still
/// stands above them.
const LONGEST_PUSH: u32 = 16 * 8;

/// The causes by bit of CFSR, the most telling first.
const CAUSES: [(u32, &str); 13] = [
    (16, "undefined instruction"),
    (17, "invalid state (jump to an even address?)"),
    (18, "invalid return from an exception"),
    (19, "no such coprocessor (floating-point unit off?)"),
    (24, "unaligned access"),
    (25, "division by zero"),
    (0, "instruction fetch refused by the memory protection unit"),
    (1, "data access refused by the memory protection unit"),
    (3, "memory protection while returning from an exception"),
    (8, "bus fault on an instruction fetch"),
    (9, "bus fault on a data access"),
    (10, "bus fault on an earlier data write"),
    (11, "bus fault while returning from an exception"),
];

impl Stacked {
    /// The bytes that the processor has stacked, by what the link register held on the way into the handler: with the
    /// registers of the floating-point unit or without.
    pub fn size(exception: u32) -> u32 {
        if exception & (1 << 4) == 0 {
            26 * 4
        } else {
            8 * 4
        }
    }
}

impl Fault {
    /// Whether the registers that should be on the stack are there.
    pub fn has_stacked(cfsr: u32) -> bool {
        cfsr & NOT_STACKED == 0
    }

    pub fn cause(&self) -> &'static str {
        if self.is_stack_overflow() {
            return "stack overflow";
        }
        let has = |register: u32, bit: u32| register & (1 << bit) != 0;
        match CAUSES.iter().find(|(bit, _)| has(self.cfsr, *bit)) {
            Some((_, cause)) => cause,
            None if has(self.hfsr, 1) => "vector table could not be read",
            None if has(self.hfsr, 31) => "breakpoint without a debugger",
            None if self
                .stacked
                .is_some_and(|stacked| stacked.xpsr & THUMB == 0) =>
            {
                "invalid state (jump to an even address?)"
            }
            None => "unknown cause (a Cortex-M0+ tells none)",
        }
    }

    /// The stack took no more: not the registers of an exception, or not what was being pushed.
    fn is_stack_overflow(&self) -> bool {
        let below = self.sp.wrapping_sub(self.mmfar);
        !Self::has_stacked(self.cfsr)
            || self.cfsr & REFUSED == REFUSED && (1..=LONGEST_PUSH).contains(&below)
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Fault {
            sp,
            cfsr,
            hfsr,
            mmfar,
            bfar,
            ..
        } = self;
        writeln!(f, "HARDFAULT: {}", self.cause())?;
        match (self.stacked, self.last_call) {
            (Some(Stacked { pc, lr, xpsr }), _) => {
                writeln!(f, "  pc {pc:#010x}  lr {lr:#010x}  xpsr {xpsr:#010x}")?
            }
            (None, Some(call)) => writeln!(
                f,
                "  pc and lr are lost; the last call on the stack is at {call:#010x}"
            )?,
            (None, None) => writeln!(f, "  pc and lr are lost")?,
        }
        write!(f, "  sp {sp:#010x}")?;
        if cfsr | hfsr == 0 {
            return Ok(());
        }
        write!(
            f,
            "  cfsr {cfsr:#010x}  hfsr {hfsr:#010x}  mmfar {mmfar:#010x}  bfar {bfar:#010x}"
        )
    }
}

/// The bytes of the call, `bl` or `blx`, that ends with these two halfwords; `None` if none does.
pub fn call_size([first, second]: [u16; 2]) -> Option<u32> {
    if first & 0xf800 == 0xf000 && second & 0xd000 == 0xd000 {
        Some(4)
    } else if second & 0xff87 == 0x4780 {
        Some(2)
    } else {
        None
    }
}
