//! The one table of budgets: what a board may spend, and why.

/// What a scene may take of a frame of 1/60 s, on a 50 MHz Cortex-M3 in the tick that prepares a motion, on a Cortex-M0+ at
/// 125 MHz for the map of flips: the rest is for the panel's bus, the serial link, commands, and motions asked for.
pub const SCENE: f64 = 0.55;
/// Cycles in which a Cortex-M3 draws and sends a frame of any scene, moving it apart: a seventh of a frame at 50 MHz. The most
/// expensive one, figure 7, takes 98,700.
pub const SHOWING: u64 = 110_000;
/// What is left of a frame when the frame is on the panel and sent: enough for a command a frame, for a log line, and
/// to compute motions on request in reasonable time. QEMU's buses take no time; see the README for those of a real board.
pub const IDLE: f64 = 0.4;

/// Bytes of a board's memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Memory {
    /// Program and constants, in flash.
    pub text: u32,
    /// Statics with values to start from: in flash and in memory.
    pub data: u32,
    /// Statics that start as zeros or as anything.
    pub bss: u32,
    pub stack: u32,
}

/// What each application may take.
///
/// Text: the smallest chip has 256 KiB of flash, and it keeps a sixteenth free, with a Cortex-M0+, whose code is longer, 12 KiB; the
/// F405 has 1 MiB, of which three quarters are left to those who build on it. Data:
/// nothing needs a start value but a few words. Bss: the two frames are 8 KiB, the application with its planner and a motion by two methods 9, the
/// queue of received bytes 1, what a panel shows 4 more, or on the F405 with its log 2; a twentieth is left to grow, within what
/// the memory map lets the statics have. Stack: making a scene takes most of it; an eighth of the 32 KiB that the guard leaves to
/// the stack is for what no run has met: an interrupt at the deepest place, the report of a crash. The Pico has 2 MiB of flash and
/// more memory than the others: an M0+ takes more instructions, and there is USB.
pub const MEMORY: [(&str, Memory); 6] = [
    (
        "lm3s6965evb",
        Memory {
            text: 240 * KIB,
            data: 256,
            bss: 24 * KIB,
            stack: 28 * KIB,
        },
    ),
    (
        "lm3s6965evb-m4",
        Memory {
            text: 240 * KIB,
            data: 256,
            bss: 24 * KIB,
            stack: 28 * KIB,
        },
    ),
    (
        "mps2-an386",
        Memory {
            text: 240 * KIB,
            data: 256,
            bss: 20 * KIB,
            stack: 28 * KIB,
        },
    ),
    (
        "stm32f405",
        Memory {
            text: 248 * KIB,
            data: 256,
            bss: 22 * KIB,
            stack: 28 * KIB,
        },
    ),
    (
        "lm3s6965evb-m0",
        Memory {
            text: 244 * KIB,
            data: 256,
            bss: 24 * KIB,
            stack: 28 * KIB,
        },
    ),
    (
        "pico",
        Memory {
            text: 272 * KIB,
            data: 256,
            bss: 25 * KIB,
            stack: 28 * KIB,
        },
    ),
];

const KIB: u32 = 1024;
