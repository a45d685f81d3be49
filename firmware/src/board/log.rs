//! The output of the log on a real chip.
//!
//! A chip writes the log into memory that a debug probe reads while the processor runs (RTT). This
//! costs next to nothing and never waits. If the same image runs in QEMU, it writes the log to the
//! standard output, as the other boards do.

use cortex_m::interrupt::{disable, enable};
use cortex_m::register::primask;
#[cfg(feature = "stm32f405")]
use cortex_m_semihosting::hio::{self, HostStream};
use defmt::Encoder;
use rtt_target::{ChannelMode, UpChannel, rtt_init};

use super::cortex_m::crash;
use super::cortex_m::interrupt::Shared;

#[defmt::global_logger]
struct Logger;

struct Path {
    encoder: Encoder,
    sink: Sink,
    interrupts: bool,
}

enum Sink {
    Nowhere,
    Memory(UpChannel),
    #[cfg(feature = "stm32f405")]
    Emulator(HostStream),
}

static PATH: Shared<Path> = Shared::new(Path {
    encoder: Encoder::new(),
    sink: Sink::Nowhere,
    interrupts: false,
});

/// Opens the log of a chip, in memory (RTT).
///
/// From now on no debugger is assumed to be present: a crash or a hang is recorded for the next
/// run, but not printed.
pub fn into_memory() {
    crash::expect_no_debugger();
    let channel = rtt_init! { up: { 0: { size: 768, name: "defmt" } } }.up.0;
    PATH.with(|path| path.sink = Sink::Memory(channel));
}

/// Opens the log of an emulated chip, on the emulator's standard output.
#[cfg(feature = "stm32f405")]
pub fn into_emulator() {
    PATH.with(|path| path.sink = hio::hstdout().map_or(Sink::Nowhere, Sink::Emulator));
}

impl Sink {
    fn write(&mut self, bytes: &[u8]) {
        match self {
            Self::Nowhere => {}
            Self::Memory(channel) => {
                // A probe can request that the chip waits for it. If it were unplugged then, the
                // wait would never end.
                channel.set_mode(ChannelMode::NoBlockSkip);
                channel.write(bytes);
            }
            #[cfg(feature = "stm32f405")]
            Self::Emulator(stream) => {
                let _ = stream.write_all(bytes);
            }
        }
    }
}

// SAFETY: `acquire` switches interrupts off until `release`, so that only one writer at a time
// writes a line. Bytes are passed on in order.
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        let interrupts = primask::read().is_active();
        disable();
        PATH.with(|path| {
            // A line within a line is garbled, but the state of the interrupts is restored.
            path.interrupts |= interrupts;
            path.encoder.start_frame(|bytes| path.sink.write(bytes));
        });
    }

    unsafe fn flush() {}

    unsafe fn release() {
        PATH.with(|path| path.encoder.end_frame(|bytes| path.sink.write(bytes)));
        if PATH.with(|path| core::mem::take(&mut path.interrupts)) == Some(true) {
            // SAFETY: `acquire` has switched the interrupts off, and they were on before.
            unsafe { enable() };
        }
    }

    unsafe fn write(bytes: &[u8]) {
        PATH.with(|path| path.encoder.write(bytes, |bytes| path.sink.write(bytes)));
    }
}
