//! The bus of a panel. The main loop fills an outbox and passes it to the bus's interrupt, which
//! returns it when it is empty.

use embedded_hal::i2c::ErrorKind;

use super::cortex_m::interrupt::Shared;
use crate::display::{Outbox, PanelBus, Sent};

pub trait PanelPort {
    /// Begins a transfer to this address; the interrupt does the rest. It only waits for the stop
    /// of the last transfer, at most [`TRIES`] polls. A panel that does not answer is reported by
    /// the outbox later ([`Outbox::sent`]).
    fn begin(&mut self, address: u8);

    /// Frees a bus that hangs, and resets the device, which ends a transfer in progress.
    fn reset(&mut self);
}

/// The bus, and the outbox while the interrupt does not own it.
pub struct Bus<P> {
    port: P,
    outbox: Option<&'static mut Outbox>,
}

/// The largest number of polls that wait for a start or a stop on the I2C bus of the panel. A start
/// or a stop takes 5 us, and these polls take at least 12 us. After the last poll the transfer goes
/// on all the same; if it hangs, the driver of the panel aborts it.
pub const TRIES: u32 = 500;

/// The outbox that the interrupt owns.
static OUTGOING: Shared<Option<&'static mut Outbox>> = Shared::new(None);

/// Handles the bus's interrupt. `advance` does the next part of the transfer, and returns the
/// outcome of the messages when all is done.
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
    /// Creates the only bus, because the interrupt knows no other.
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
        // The interrupt has set the outcome if it is done with the outbox.
        let arrived = OUTGOING.with(|outgoing| outgoing.take_if(|outbox| outbox.sent.is_some()));
        if let Some(outbox) = arrived.flatten() {
            // After an error other than silence, the bus may hang.
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
            // The interrupt owns the outbox before the transfer begins.
            OUTGOING.with(|place| *place = Some(outbox));
            self.port.begin(address);
        }
    }

    fn abort(&mut self) {
        // The outcome is an error, and the outbox returns at once.
        self.port.reset();
        if let Some(outbox) = OUTGOING.with(Option::take).flatten() {
            outbox.sent = Some(Err(ErrorKind::Other));
            self.outbox = Some(outbox);
        }
    }
}
