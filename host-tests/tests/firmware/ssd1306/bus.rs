//! The panel's bus at its time.

use embedded_hal::i2c::{ErrorKind, NoAcknowledgeSource};
use firmware::display::{Outbox, PanelBus, Sent};

use super::controller::Controller;

/// Bits that a byte takes with its acknowledgement; a start or stop takes 1.
pub const BYTE: u32 = 9;

/// The bus as an interrupt drives it, and the panel at its end.
pub struct Line {
    pub panel: Controller,
    outbox: Outbox,
    /// What has become of what was in it; `None` as long as it is going out.
    outcome: Option<Sent>,
    message: Vec<u8>,
    /// Bits there is time for.
    time: u32,
    /// Bits that the messages under way, or the last ones, have taken.
    pub taken: u32,
    /// Somebody holds the clock low.
    pub hangs: bool,
    pub freed: u32,
    /// Messages sent off in one go.
    pub sent: u32,
}

impl Line {
    pub fn to(panel: Controller) -> Self {
        let (outbox, outcome, message) = (Outbox::new(), Some(Ok(())), Vec::new());
        Self { panel, outbox, outcome, message, time: 0, taken: 0, hangs: false, freed: 0, sent: 0 }
    }

    /// Lets the time of `bits` bits pass on the bus.
    pub fn run(&mut self, bits: u32) {
        self.time = if self.hangs { 0 } else { self.time.saturating_add(bits) };
        let Self { outbox, panel, message, .. } = self;
        while self.outcome.is_none() {
            let needed = match (outbox.is_within_message(), outbox.is_empty() && !outbox.asks) {
                (true, _) => BYTE,
                (false, true) => 1,
                (false, false) => 1 + 2 * BYTE,
            };
            if self.time < needed {
                return;
            }
            self.time -= needed;
            self.taken += needed;
            if !panel.plugged_in || outbox.address != panel.address {
                let source = if outbox.has_begun() { NoAcknowledgeSource::Data } else { NoAcknowledgeSource::Address };
                self.outcome = Some(Err(ErrorKind::NoAcknowledge(source)));
                message.clear();
            } else if let Some(byte) = outbox.next() {
                message.push(byte.value);
                if byte.ends_message {
                    panel.take(message);
                    message.clear();
                }
            } else if outbox.asks {
                let silence = ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address);
                self.outcome = Some(panel.status().map(|status| outbox.status = status).ok_or(silence));
            } else {
                self.outcome = Some(Ok(()));
            }
        }
        self.time = 0;
    }

    pub fn is_idle(&self) -> bool {
        self.outcome.is_some()
    }
}

impl PanelBus for Line {
    fn outbox(&mut self) -> Option<(&mut Outbox, Sent)> {
        self.outcome.map(|sent| (&mut self.outbox, sent))
    }

    fn send(&mut self) {
        assert!(self.is_idle(), "one at a time");
        (self.outcome, self.taken, self.sent) = (None, 0, self.sent + 1);
    }

    fn give_up(&mut self) {
        assert!(!self.is_idle(), "nothing to give up");
        self.freed += 1;
        self.message.clear();
        self.outcome = Some(Err(ErrorKind::Other));
    }
}
