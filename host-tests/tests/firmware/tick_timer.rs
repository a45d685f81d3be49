//! The time that a board reads from SysTick, with a SysTick whose every reading takes time.

use std::cell::Cell;

#[path = "../../../firmware/src/board/cortex_m/tick_timer.rs"]
mod code;

use code::{TickTimer, elapsed};

const PERIOD: u32 = 50;
/// The cycles from the end of a period to the first instruction of the interrupt's handler, and to
/// its end.
const ENTRY: u32 = 12;

/// A SysTick that continues to count during each reading, which takes some cycles.
struct FakeTimer {
    now: Cell<u32>,
    ticks: Cell<u32>,
    is_pending: Cell<bool>,
    is_masked: bool,
    reading: u32,
}

impl FakeTimer {
    fn pass(&self, cycles: u32) {
        for _ in 0..cycles {
            self.now.set(self.now.get() + 1);

            // The exception becomes pending when the counter reaches 0.
            if self.counter_now() == 0 {
                self.is_pending.set(true);
            }
        }
    }

    fn interrupt(&self) {
        if self.is_pending.get() && !self.is_masked {
            self.pass(ENTRY);
            self.is_pending.set(false);
            self.ticks.set(self.ticks.get().wrapping_add(1));
        }
    }

    fn counter_now(&self) -> u32 {
        PERIOD - 1 - self.now.get() % PERIOD
    }

    fn read<T>(&self, value: impl Fn() -> T) -> T {
        self.interrupt();
        self.pass(self.reading.div_ceil(2));
        let value = value();
        self.pass(self.reading / 2);
        value
    }
}

impl TickTimer for FakeTimer {
    fn ticks(&self) -> u32 {
        self.read(|| self.ticks.get())
    }

    fn counter(&self) -> u32 {
        self.read(|| self.counter_now())
    }

    fn is_pending(&self) -> bool {
        self.read(|| self.is_pending.get())
    }
}

#[test]
fn a_time_read_at_any_moment_is_between_the_moments_before_and_after() {
    // The interrupt handler and all readings together must fit into a period.
    // The count of ticks begins at 0, or wraps during the test.
    for reading in 1..=5 {
        for is_masked in [false, true] {
            for first in [0, u32::MAX] {
                for start in 0..2 * PERIOD {
                    let timer = FakeTimer {
                        now: Cell::new(0),
                        ticks: Cell::new(first),
                        is_pending: Cell::new(false),
                        is_masked: false,
                        reading,
                    };
                    (0..start).for_each(|_| {
                        timer.pass(1);

                        if timer.now.get() % PERIOD == PERIOD / 2 {
                            timer.interrupt();
                        }
                    });

                    let timer = FakeTimer { is_masked, ..timer };

                    let origin = first.wrapping_mul(PERIOD);
                    let before = timer.now.get();
                    let time = elapsed(&timer, PERIOD).wrapping_sub(origin);
                    let after = timer.now.get();
                    let case =
                        format!("from {start}, {reading} cycles a reading, masked {is_masked}");
                    assert!(
                        (before..=after).contains(&time),
                        "{case}: {time}, not {before} to {after}"
                    );
                }
            }
        }
    }
}
