//! The one table of budgets: what a board may spend, and why.

/// What a scene may take of a frame of 1/60 s on a 50 MHz Cortex-M3: the other half is for the panel's bus, the serial
/// link, commands, and motions asked for.
pub const SCENE: f64 = 0.5;
/// What is left of a frame when the picture is on the panel and sent: enough for a command a frame, for a log line, and
/// to compute motions on request in reasonable time. QEMU's buses take no time; see the README for those of a real board.
pub const IDLE: f64 = 0.4;
