//! The kernel under the embassy executor: one task steps the pendulum 60 times a second, woken by
//! the SysTick timer.
//!
//! For any Cortex-M3 or M4. Only the clock frequency below depends on the chip.
//!
//! `cargo build --release --package firmware --example embassy --target thumbv7em-none-eabihf`
#![no_std]
#![no_main]

use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::exception;
use double_pendulum::{DirectionF32, Error, Parameters, Pendulum, State};
use embassy_executor::Spawner;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;

/// The processor's clock of an STM32F405 after reset, Hz.
const CLOCK: u32 = 16_000_000;
/// The frames per second.
const RATE: u32 = 60;
/// The steps per frame.
const STEPS: u32 = 4;

/// The timer's tick.
static TICK: Signal<CriticalSectionRawMutex, ()> = Signal::new();
/// The latest directions of the rods, for the task that draws.
static FRAME: Signal<CriticalSectionRawMutex, [[f32; 2]; 2]> = Signal::new();

#[exception]
fn SysTick() {
    TICK.signal(());
}

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    // The timer's interrupt begins a frame.
    if let Some(cortex_m::Peripherals { mut SYST, .. }) = cortex_m::Peripherals::take() {
        SYST.set_clock_source(SystClkSource::Core);
        SYST.set_reload(CLOCK / RATE - 1);
        SYST.clear_current();
        SYST.enable_counter();
        SYST.enable_interrupt();
    }

    spawner.must_spawn(pendulum()); // there is room for one, and this is the one
    loop {
        let [[_sin1, _cos1], [_sin2, _cos2]] = FRAME.wait().await; // draw it here
    }
}

/// Steps the pendulum for ever. The kernel never panics; it returns its errors.
#[embassy_executor::task]
async fn pendulum() {
    let _error = swing().await; // report it here
}

/// Steps the pendulum at each tick of the timer. Returns only if its numbers are no longer finite.
async fn swing() -> Result<(), Error> {
    let dt = 1.0 / f64::from(RATE * STEPS);
    let pendulum = Pendulum::new(&Parameters::equal_rods(1.0, 1.0, 9.81))?;
    let mut motion = pendulum.run::<DirectionF32>(&State::at_rest(2.0, 2.0), dt)?;
    loop {
        TICK.wait().await;
        motion.advance(STEPS)?;
        FRAME.signal(motion.directions());
    }
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}
