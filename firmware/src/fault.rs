//! What a crashed Cortex-M says about itself, in words.

use core::fmt;

/// The registers that tell why a HardFault was taken.
///
/// Source: ARM DDI 0403 (ARMv7-M Architecture Reference Manual), B3.2.15 and B3.2.16.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Program counter: the instruction that failed, or for imprecise bus faults one soon after it.
    pub pc: u32,
    /// Link register: where the function that failed returns to.
    pub lr: u32,
    /// Program status.
    pub xpsr: u32,
    /// Configurable Fault Status Register.
    pub cfsr: u32,
    /// HardFault Status Register.
    pub hfsr: u32,
    /// BusFault Address Register.
    pub bfar: u32,
}

/// The causes by bit of CFSR, the most telling first.
const CAUSES: [(u32, &str); 15] = [
    (16, "undefined instruction"),
    (17, "invalid state (jump to an even address?)"),
    (18, "invalid return from an exception"),
    (19, "no such coprocessor (floating-point unit off?)"),
    (24, "unaligned access"),
    (25, "division by zero"),
    (0, "instruction fetch refused by the memory protection unit"),
    (1, "data access refused by the memory protection unit"),
    (3, "memory protection while returning from an exception"),
    (4, "memory protection while entering an exception (stack overflow?)"),
    (8, "bus fault on an instruction fetch"),
    (9, "bus fault on a data access"),
    (10, "bus fault on an earlier data write"),
    (11, "bus fault while returning from an exception"),
    (12, "bus fault while entering an exception (stack overflow?)"),
];

impl Fault {
    /// The cause in words.
    pub fn cause(&self) -> &'static str {
        let has = |register: u32, bit: u32| register & (1 << bit) != 0;
        match CAUSES.iter().find(|(bit, _)| has(self.cfsr, *bit)) {
            Some((_, cause)) => cause,
            None if has(self.hfsr, 1) => "vector table could not be read",
            None if has(self.hfsr, 31) => "breakpoint without a debugger",
            None => "unknown cause",
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Fault { pc, lr, xpsr, cfsr, hfsr, bfar } = self;
        writeln!(f, "HARDFAULT: {}", self.cause())?;
        write!(f, "  pc {pc:#010x}  lr {lr:#010x}  xpsr {xpsr:#010x}  ")?;
        write!(f, "cfsr {cfsr:#010x}  hfsr {hfsr:#010x}  bfar {bfar:#010x}")
    }
}
