//! The bus of a panel. The main loop fills an outbox and passes it to the bus's interrupt, which
//! returns it when it is empty.

use embedded_hal::i2c::ErrorKind;

use super::cortex_m::interrupt::Shared;
use crate::display::{Outbox, PanelBus, Sent};

/// The device of a bus. Its [`Bus`] calls [`reset`](Self::reset) before the first transfer, which
/// sets the device up.
pub trait PanelPort {
    /// Begins a transfer to this address of seven bits; the interrupt does the rest. It only waits
    /// for the stop of the last transfer, at most [`TRIES`] polls. A panel that does not answer is
    /// reported by the outbox later ([`Outbox::sent`]).
    ///
    /// Not checked: no transfer is in progress, the interrupt owns the outbox, and the address is
    /// that of the outbox, at most 127.
    fn begin(&mut self, address: u8);

    /// Frees a bus that hangs, and resets the device, which ends a transfer in progress. The device
    /// does not interrupt until the next [`begin`](Self::begin). The outbox stays where it is.
    ///
    /// It waits for the clocks that free the bus, at most some 0.1 ms. If the bus still hangs, this
    /// is not reported.
    fn reset(&mut self);
}

/// The bus, and the outbox while the interrupt does not own it. There is at most one. The board
/// creates it; [`PanelBus`] is its interface.
pub struct Bus<P> {
    port: P,
    outbox: Option<&'static mut Outbox>,
}

/// The largest number of polls that wait for a start or a stop on the I2C bus of the panel. A start
/// or a stop takes 5 us, and these polls take at least 12 us. The Pico also waits this long for the
/// bus's block to leave its reset.
///
/// After the last poll the set-up continues, or the transfer begins, all the same; if it hangs, the
/// driver of the panel aborts it. But if the STM32 waits in vain for the start within a transfer,
/// before a further message of the outbox or before the panel's answer, the transfer ends with
/// [`ErrorKind::Other`], and the port is reset.
pub const TRIES: u32 = 500;

/// The outbox that the interrupt owns.
static OUTGOING: Shared<Option<&'static mut Outbox>> = Shared::new(None);

/// Handles the bus's interrupt.
///
/// `advance` does the next part of the transfer, and returns the outcome of the messages when all
/// is done; `None` while the transfer continues. It is not called without an outbox to send. After
/// that the bus must not interrupt until [`PanelPort::begin`].
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
    /// Creates the bus of a port. There is at most one bus, because the interrupt knows no other.
    /// Returns `None` the second time.
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
