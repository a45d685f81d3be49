//! Received bytes: an interrupt puts them into a queue, the application takes them out.

use core::cell::Cell;
use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::interrupt::Mutex;
use heapless::spsc::{Consumer, Producer, Queue};

use crate::config::RECEIVE_QUEUE;

#[derive(Clone, Copy)]
pub(in crate::board) struct Inlet {
    /// Ends the interrupt, given for how many bytes there is room. Done before the bytes are taken, so that one that comes
    /// meanwhile interrupts anew.
    pub clear: fn(usize),
    pub take: fn() -> Taken,
}

#[derive(Clone, Copy)]
pub(in crate::board) struct Taken {
    /// The next byte; `None` once there is none.
    pub byte: Option<u8>,
    /// Whether the port has had no room for a byte, or for several in a row, since it was last asked.
    pub overrun: bool,
}

/// How the interrupt gets at the bytes, and where it puts them.
struct Source {
    inlet: Inlet,
    queue: Producer<'static, u8>,
}

static SOURCE: Mutex<Cell<Option<Source>>> = Mutex::new(Cell::new(None));
static LOST: AtomicU32 = AtomicU32::new(0);

/// Moves what has come into the queue; for the receiver's interrupt.
pub(in crate::board) fn receive() {
    let source = cortex_m::interrupt::free(|token| SOURCE.borrow(token).take());
    if let Some(mut source) = source {
        (source.inlet.clear)(source.queue.capacity().saturating_sub(source.queue.len()));
        loop {
            let Taken { byte, overrun } = (source.inlet.take)();
            let is_refused = byte.is_some_and(|byte| source.queue.enqueue(byte).is_err());
            // Only this writes it: an M0+ cannot add in one go.
            let lost = LOST.load(Ordering::Relaxed).wrapping_add(u32::from(overrun) + u32::from(is_refused));
            LOST.store(lost, Ordering::Relaxed);
            if byte.is_none() {
                break;
            }
        }
        cortex_m::interrupt::free(|token| SOURCE.borrow(token).set(Some(source)));
    }
}

pub struct Receiver {
    queue: Consumer<'static, u8>,
}

impl Receiver {
    /// Lets the interrupt fill a queue from `inlet`; `None` the second time.
    pub(in crate::board) fn new(inlet: Inlet) -> Option<Self> {
        let queue = cortex_m::singleton!(: Queue<u8, RECEIVE_QUEUE> = Queue::new())?;
        let (producer, consumer) = queue.split();
        cortex_m::interrupt::free(|token| SOURCE.borrow(token).set(Some(Source { inlet, queue: producer })));
        Some(Self { queue: consumer })
    }

    /// Bytes lost since reset because they were not taken in time; at least so many, since a port does not say how many it had no
    /// room for. Wraps.
    pub fn lost(&self) -> u32 {
        LOST.load(Ordering::Relaxed)
    }
}

impl Iterator for Receiver {
    type Item = u8;

    fn next(&mut self) -> Option<u8> {
        self.queue.dequeue()
    }
}
