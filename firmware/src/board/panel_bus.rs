//! A panel's bus: the main loop fills an outbox and hands it to the bus's interrupt, which hands it back when it is empty.

use embedded_hal::i2c::ErrorKind;

use super::cortex_m::interrupt::Shared;
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

static OUTGOING: Shared<Option<Outgoing>> = Shared::new(None);

/// For the bus's interrupt: `advance` does what is due, and says what has become of the messages once nothing more is; from
/// then on the bus must not interrupt until [`PanelPort::begin`].
pub(in crate::board) fn serve(advance: impl FnOnce(&mut Outbox) -> Option<Sent>) {
    OUTGOING.with(|outgoing| {
        if let Some(Outgoing { outbox, sent: sent @ None }) = outgoing {
            *sent = advance(outbox);
        }
    });
}

impl<P: PanelPort> Bus<P> {
    /// There is one at most: the interrupt knows no other.
    pub(in crate::board) fn new(port: P, outbox: &'static mut Outbox) -> Self {
        Self { port, outbox: Some(outbox), sent: Ok(()) }
    }
}

impl<P: PanelPort> PanelBus for Bus<P> {
    fn outbox(&mut self) -> Option<(&mut Outbox, Sent)> {
        let returned = OUTGOING.with(|outgoing| outgoing.take_if(|outgoing| outgoing.sent.is_some())).flatten();
        if let Some(Outgoing { outbox, sent: Some(sent) }) = returned {
            if !matches!(sent, Ok(()) | Err(ErrorKind::NoAcknowledge(_))) {
                self.port.reset();
            }
            (self.outbox, self.sent) = (Some(outbox), sent);
        }
        self.outbox.as_deref_mut().map(|outbox| (outbox, self.sent))
    }

    fn send(&mut self) {
        if let Some(outbox) = self.outbox.take() {
            let address = outbox.address;
            OUTGOING.with(|outgoing| *outgoing = Some(Outgoing { outbox, sent: None }));
            self.port.begin(address);
        }
    }

    fn give_up(&mut self) {
        self.port.reset();
        if let Some(Outgoing { outbox, .. }) = OUTGOING.with(Option::take).flatten() {
            (self.outbox, self.sent) = (Some(outbox), Err(ErrorKind::Other));
        }
    }
}
