//! Where the log of a real chip goes: into memory that a debug probe reads while the processor runs (RTT), which costs next to
//! nothing and never waits; or, where the same image runs in QEMU, to its standard output, as on the other boards.

use core::cell::UnsafeCell;

#[cfg(feature = "stm32f405")]
use cortex_m_semihosting::hio::{self, HostStream};
use critical_section::RestoreState;
use defmt::Encoder;
use rtt_target::{ChannelMode, UpChannel, rtt_init};

use super::cortex_m::crash;

#[defmt::global_logger]
struct Logger;

struct Path {
    encoder: Encoder,
    sink: Sink,
    /// Whether interrupts were on before the line that is being written.
    interrupts: Option<RestoreState>,
}

enum Sink {
    Nowhere,
    Memory(UpChannel),
    #[cfg(feature = "stm32f405")]
    Emulator(HostStream),
}

struct Shared(UnsafeCell<Path>);

// SAFETY: it is used with interrupts off only, on the one core there is.
unsafe impl Sync for Shared {}

static PATH: Shared = Shared(UnsafeCell::new(Path { encoder: Encoder::new(), sink: Sink::Nowhere, interrupts: None }));

/// Opens the log of a chip; before that, lines are lost.
pub fn into_memory() {
    crash::expect_no_debugger();
    open(Sink::Memory(rtt_init! { up: { 0: { size: 1024, name: "defmt" } } }.up.0));
}

/// Opens the log of an emulated chip.
#[cfg(feature = "stm32f405")]
pub fn into_emulator() {
    open(hio::hstdout().map_or(Sink::Nowhere, Sink::Emulator));
}

fn open(sink: Sink) {
    // SAFETY: interrupts are off, and no line is being written.
    critical_section::with(|_| unsafe { (*PATH.0.get()).sink = sink });
}

impl Sink {
    fn write(&mut self, bytes: &[u8]) {
        match self {
            Self::Nowhere => {}
            Self::Memory(channel) => {
                // A probe may ask to be waited for. One that is unplugged would then be waited for without end.
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

// SAFETY: `acquire` switches interrupts off until `release`, so a line is written by one at a time; written bytes are
// passed on in order.
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        // SAFETY: ended by `release`.
        let interrupts = unsafe { critical_section::acquire() };
        // SAFETY: interrupts are off.
        let path = unsafe { &mut *PATH.0.get() };
        assert!(path.interrupts.replace(interrupts).is_none(), "a line of the log within a line");
        path.encoder.start_frame(|bytes| path.sink.write(bytes));
    }

    unsafe fn flush() {}

    unsafe fn release() {
        // SAFETY: interrupts are off since `acquire`.
        let path = unsafe { &mut *PATH.0.get() };
        path.encoder.end_frame(|bytes| path.sink.write(bytes));
        if let Some(interrupts) = path.interrupts.take() {
            // SAFETY: begun by `acquire`.
            unsafe { critical_section::release(interrupts) };
        }
    }

    unsafe fn write(bytes: &[u8]) {
        // SAFETY: interrupts are off since `acquire`.
        let path = unsafe { &mut *PATH.0.get() };
        path.encoder.write(bytes, |bytes| path.sink.write(bytes));
    }
}
