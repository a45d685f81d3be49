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
}

/// How often a start or stop is waited for, which takes 5 us: these tries take at least 12.
pub const TRIES: u32 = 500;

/// The outbox that the interrupt has.
static OUTGOING: Shared<Option<&'static mut Outbox>> = Shared::new(None);

/// For the bus's interrupt: `advance` does what is due, and says what has become of the messages once nothing more is; from
/// then on the bus must not interrupt until [`PanelPort::begin`].
pub(in crate::board) fn serve(advance: impl FnOnce(&mut Outbox) -> Option<Sent>) {
    OUTGOING.with(|outgoing| {
        if let Some(outbox) = outgoing
            && outbox.sent.is_none()
        {
            outbox.sent = advance(outbox);
        }
    });
}

impl<P: PanelPort> Bus<P> {
    /// There is one at most: the interrupt knows no other.
    pub(in crate::board) fn new(mut port: P) -> Option<Self> {
        port.reset();
        Some(Self {
            port,
            outbox: Some(cortex_m::singleton!(: Outbox = Outbox::default())?),
        })
    }
}

impl<P: PanelPort> PanelBus for Bus<P> {
    fn outbox(&mut self) -> Option<(&mut Outbox, Sent)> {
        if let Some(outbox) = OUTGOING
            .with(|outgoing| outgoing.take_if(|outbox| outbox.sent.is_some()))
            .flatten()
        {
            if !matches!(outbox.sent, Some(Ok(()) | Err(ErrorKind::NoAcknowledge(_)))) {
                self.port.reset();
            }
            self.outbox = Some(outbox);
        }
        let outbox = self.outbox.as_deref_mut()?;
        let sent = outbox.sent?;
        Some((outbox, sent))
    }

    fn send(&mut self) {
        if let Some(outbox) = self.outbox.take() {
            let address = outbox.address;
            outbox.sent = None;
            OUTGOING.with(|outgoing| *outgoing = Some(outbox));
            self.port.begin(address);
        }
    }

    fn abort(&mut self) {
        self.port.reset();
        if let Some(outbox) = OUTGOING.with(Option::take).flatten() {
            outbox.sent = Some(Err(ErrorKind::Other));
            self.outbox = Some(outbox);
        }
    }
}
