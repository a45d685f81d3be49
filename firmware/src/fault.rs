//! The crash report of a Cortex-M, in words.

use core::fmt;

/// The registers that describe a HardFault.
///
/// On a Cortex-M0+, which lacks the last three, they are 0.
///
/// Source: ARM DDI 0403 (ARMv7-M Architecture Reference Manual), B3.2.15 to B3.2.18; ARM DDI 0419
/// (ARMv6-M), B3.2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The registers that the processor has stacked; `None` if it could not stack them.
    pub stacked: Option<Stacked>,
    /// The stack pointer at the time of the fault, as computed from the place of the stacked
    /// registers, also if they could not be stacked. It is 4 bytes too low if the processor has
    /// aligned the stack.
    pub sp: u32,
    /// The lowest address of the stack.
    pub stack_end: u32,
    /// The address of the last call instruction found by its return address on the stack; `None` if
    /// none is found. It is the only evidence if the registers are missing. The report prints it
    /// only then.
    pub last_call: Option<u32>,
    /// The Configurable Fault Status Register.
    pub cfsr: u32,
    /// The HardFault Status Register.
    pub hfsr: u32,
    /// The BusFault Address Register, valid while bit 15 of CFSR is set.
    pub bfar: u32,
}

/// The registers of interest that the processor stacks on its way to the handler.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stacked {
    /// The program counter: the instruction that failed. For an imprecise bus fault it is a later
    /// instruction.
    pub pc: u32,
    /// The link register: the return address of the function that failed, unless it has called
    /// other functions before.
    pub lr: u32,
    /// The program status register.
    pub xpsr: u32,
}

/// The bits of CFSR that mean that registers are missing on the stack: registers stacked on entry
/// to an exception, or registers of the floating-point unit, which are stacked later (STKERR,
/// LSPERR).
const NOT_STACKED: u32 = 1 << 12 | 1 << 13;

/// The bit of the program status register that is set while the processor executes Thumb code, the
/// only code that it has.
const THUMB: u32 = 1 << 24;

/// The largest number of bytes that one instruction pushes: 16 double-precision registers. Until it
/// is complete, the stack pointer is still above them.
const LONGEST_PUSH: u32 = 16 * 8;

/// The causes by bit of CFSR, the most specific first.
const CAUSES: [(u32, &str); 11] = [
    (16, "undefined instruction"),
    (17, "invalid state (jump to an even address?)"),
    (18, "invalid return from an exception"),
    (19, "no such coprocessor (floating-point unit off?)"),
    (24, "unaligned access"),
    (25, "division by zero"),
    (0, "instruction fetch from memory that holds no code"),
    (8, "bus fault on an instruction fetch"),
    (9, "bus fault on a data access"),
    (10, "bus fault on an earlier data write"),
    (11, "bus fault while returning from an exception"),
];

impl Stacked {
    /// Returns the number of bytes that the processor has stacked, without the word that aligns the
    /// stack: 104 with the registers of the floating-point unit, and 32 without. `exception` is the
    /// value of the link register on entry to the handler; its bit 4 is 0 if they are included.
    pub fn size(exception: u32) -> u32 {
        if exception & (1 << 4) == 0 {
            26 * 4
        } else {
            8 * 4
        }
    }
}

impl Fault {
    /// Returns true if all registers are on the stack, as CFSR reports it. On a Cortex-M0+, whose
    /// value is 0, it is always true.
    pub fn has_stacked(cfsr: u32) -> bool {
        cfsr & NOT_STACKED == 0
    }

    /// Returns the cause of the fault in a few English words, such as `division by zero`. If
    /// several bits of CFSR are set, usage faults come before bus faults.
    ///
    /// It is `stack overflow` if the registers could not be stacked, or if the stack has no room for
    /// the longest push. If no bit of CFSR names a cause, HFSR is used, and then the Thumb bit of the stacked `xpsr`,
    /// which should be set. If none of them shows the cause, on any processor, but usual only on a
    /// Cortex-M0+, it is `unknown cause (a Cortex-M0+ tells none)`.
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

    /// Returns true if the registers of an exception, or of a push instruction, did not fit.
    fn is_stack_overflow(&self) -> bool {
        self.stacked.is_none() || self.sp < self.stack_end.saturating_add(LONGEST_PUSH)
    }
}

/// Writes the report in three lines, with the registers in hexadecimal digits. The last line has no
/// line end. The status registers are left out if CFSR and HFSR are 0.
impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Fault {
            sp,
            cfsr,
            hfsr,
            bfar,
            ..
        } = self;
        writeln!(f, "HARDFAULT: {}", self.cause())?;

        // The registers, or the evidence that remains on the stack.
        match self.stacked {
            Some(Stacked { pc, lr, xpsr }) => {
                writeln!(f, "  pc {pc:#010x}  lr {lr:#010x}  xpsr {xpsr:#010x}")?
            }
            None => match self.last_call {
                Some(call) => writeln!(
                    f,
                    "  pc and lr are lost; the last call on the stack is at {call:#010x}"
                )?,
                None => writeln!(f, "  pc and lr are lost")?,
            },
        }

        // The status registers, if the processor has them.
        write!(f, "  sp {sp:#010x}")?;
        if (*cfsr, *hfsr) == (0, 0) {
            return Ok(());
        }
        write!(
            f,
            "  cfsr {cfsr:#010x}  hfsr {hfsr:#010x}  bfar {bfar:#010x}"
        )
    }
}

/// Returns the size in bytes of the call that ends with these two halfwords of Thumb code, in the
/// order of their addresses: 4 for `bl`, 2 for `blx` of a register, which is the second halfword
/// alone. Returns `None` if they are no call. Data, and a part of another instruction, may look
/// like one.
pub fn call_size([first, second]: [u16; 2]) -> Option<u32> {
    if first & 0xf800 == 0xf000 && second & 0xd000 == 0xd000 {
        Some(4)
    } else if second & 0xff87 == 0x4780 {
        Some(2)
    } else {
        None
    }
}
