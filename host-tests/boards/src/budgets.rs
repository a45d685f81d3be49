//! The table of budgets: the limits of time and memory for each board, and their reasons.

/// The largest part of a frame that a scene may take to advance and to be drawn, after the first 6
/// frames, on a Cortex-M3 and a Cortex-M0+. It is meant for the tick that prepares a motion on the
/// former, and for the map of flips on the latter. The cycles per instruction of that map vary by
/// 4 % from frame to frame, which is included. The rest is for the panel's bus, the serial link,
/// commands, and requested motions.
pub const SCENE: f64 = 0.56;
/// The same for the page on a Cortex-M3 in its first 10 s. Its motion in 64 bits takes half of it.
pub const PAGE: f64 = 0.15;
/// The largest cost of drawing and sending a frame on a Cortex-M3, cycles. The most expensive
/// scenes are the butterfly, with its two pendulums and a plot, and `small-5`. The report of the
/// frame is not included.
pub const SHOWING: u64 = 107_000;
/// The smallest part of a frame that must remain, on every board. It is enough for a command in
/// each frame, for a log line, and to compute requested motions in reasonable time. QEMU's buses
/// take no time. A real `lm3s6965evb` will wait 0.7 ms (page) to 6 ms (`small-5`) for SPI; I2C
/// delays no frame.
pub const IDLE: f64 = 0.4;

/// The memory of a program, bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Memory {
    pub text: u32,
    /// Initialised statics, in flash and in memory.
    pub data: u32,
    pub bss: u32,
    pub stack: u32,
}

/// The largest memory that each application may take, by the name of its board.
///
/// - Text: the smallest chip has 256 KiB of flash. An eighth of it stays free, and a sixteenth with
///   a Cortex-M0+, whose code is longer.
/// - Data: only a few words need an initial value.
/// - Bss: the two frames take 8 KiB. The application with its planner and a motion by two methods
///   takes 9 KiB, the queue of received bytes 1 KiB, and the panel's copy of its picture 4 KiB
///   more, or 2 KiB on the F405 with its log. A twentieth is left for growth, within the memory
///   map's limit for statics.
/// - Stack: the preparation of a scene takes most of it. The memory map gives the stack 32 KiB. An
///   eighth of that is for cases that no run has met: an interrupt at the deepest place, the report
///   of a crash.
///
/// The Pico has 2 MiB of flash and more memory than the others. Its limits of text and bss are
/// higher because an M0+ takes more instructions and because of USB.
pub const MEMORY: [(&str, Memory); 5] = [
    (
        "lm3s6965evb",
        Memory {
            text: 224 * KIB,
            data: 256,
            bss: 24 * KIB,
            stack: 28 * KIB,
        },
    ),
    (
        "lm3s6965evb-m4",
        Memory {
            text: 224 * KIB,
            data: 256,
            bss: 24 * KIB,
            stack: 28 * KIB,
        },
    ),
    (
        "stm32f405",
        Memory {
            text: 224 * KIB,
            data: 256,
            bss: 23 * KIB,
            stack: 28 * KIB,
        },
    ),
    (
        "lm3s6965evb-m0",
        Memory {
            text: 240 * KIB,
            data: 256,
            bss: 24 * KIB,
            stack: 28 * KIB,
        },
    ),
    (
        "pico",
        Memory {
            text: 256 * KIB,
            data: 256,
            bss: 25 * KIB,
            stack: 28 * KIB,
        },
    ),
];

const KIB: u32 = 1024;
