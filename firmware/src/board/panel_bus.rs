//! A panel's bus: the main loop fills an outbox and hands it to the bus's interrupt, which hands it back when it is empty.

use core::cell::Cell;

use cortex_m::interrupt::{Mutex, free};
use embedded_hal::i2c::ErrorKind;

use crate::display::{Outbox, PanelBus, Sent};

pub trait PanelPort {
    /// Begins a message to this address; the interrupt does the rest.
    fn begin(&mut self, address: u8);

    /// Frees a bus that hangs, and makes the device forget it: it interrupts no more.
    fn reset(&mut self);
}

/// The bus, and the outbox as long as the interrupt does not have it.
pub struct Bus<P> {
    port: P,
    outbox: Option<&'static mut Outbox>,
    sent: Sent,
}

/// What the interrupt has: an outbox, and once that is done with, what has become of the messages in it.
struct Outgoing {
    outbox: &'static mut Outbox,
    sent: Option<Sent>,
}

static OUTGOING: Mutex<Cell<Option<Outgoing>>> = Mutex::new(Cell::new(None));

fn replace(outgoing: Option<Outgoing>) -> Option<Outgoing> {
    free(|token| OUTGOING.borrow(token).replace(outgoing))
}

/// The outbox that the interrupt is done with, if it is. Looked at and put back within one critical section: an interrupt that
/// found no outbox would do nothing, and fire again at once.
fn returned() -> Option<(&'static mut Outbox, Sent)> {
    free(|token| match OUTGOING.borrow(token).take() {
        Some(Outgoing { outbox, sent: Some(sent) }) => Some((outbox, sent)),
        under_way => {
            OUTGOING.borrow(token).set(under_way);
            None
        }
    })
}

/// For the bus's interrupt: `advance` does what is due, and says what has become of the messages once nothing more is; from
/// then on the bus must not interrupt until [`PanelPort::begin`].
pub(in crate::board) fn serve(advance: impl FnOnce(&mut Outbox) -> Option<Sent>) {
    if let Some(Outgoing { outbox, sent }) = replace(None) {
        let sent = sent.or_else(|| advance(outbox));
        replace(Some(Outgoing { outbox, sent }));
    }
}

impl<P: PanelPort> Bus<P> {
    /// There is one at most: the interrupt knows no other.
    pub(in crate::board) fn new(port: P, outbox: &'static mut Outbox) -> Self {
        Self { port, outbox: Some(outbox), sent: Ok(()) }
    }
}

impl<P: PanelPort> PanelBus for Bus<P> {
    fn outbox(&mut self) -> Option<(&mut Outbox, Sent)> {
        if let Some((outbox, sent)) = returned() {
            if !matches!(sent, Ok(()) | Err(ErrorKind::NoAcknowledge(_))) {
                self.port.reset();
            }
            (self.outbox, self.sent) = (Some(outbox), sent);
        }
        self.outbox.as_deref_mut().map(|outbox| (outbox, self.sent))
    }

    fn send(&mut self) {
        if let Some(outbox) = self.outbox.take() {
            let address = outbox.address();
            replace(Some(Outgoing { outbox, sent: None }));
            self.port.begin(address);
        }
    }

    fn give_up(&mut self) {
        self.port.reset();
        if let Some(Outgoing { outbox, .. }) = replace(None) {
            (self.outbox, self.sent) = (Some(outbox), Err(ErrorKind::Other));
        }
    }
}
