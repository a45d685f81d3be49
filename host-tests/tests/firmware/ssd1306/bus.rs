//! The panel's bus at its time.

use std::cell::RefCell;

use embedded_hal::i2c::{ErrorKind, NoAcknowledgeSource};
use firmware::display::{Outbox, PanelBus, Sent};

use super::controller::Controller;

/// Bits that a byte takes with its acknowledgement; a start or stop takes 1.
pub const BYTE: u32 = 9;

/// The bus as an interrupt drives it, and the panel at its end.
pub struct Line {
    pub panel: Controller,
    /// What is going out, and what has become of it.
    outgoing: Option<(Outbox, Option<Sent>)>,
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
    pub fn to(panel: Controller) -> RefCell<Self> {
        let (outgoing, message) = (None, Vec::new());
        RefCell::new(Self { panel, outgoing, message, time: 0, taken: 0, hangs: false, freed: 0, sent: 0 })
    }

    /// Lets the time of `bits` bits pass on the bus.
    pub fn run(&mut self, bits: u32) {
        self.time = if self.hangs { 0 } else { self.time.saturating_add(bits) };
        while let Some((outbox, sent @ None)) = &mut self.outgoing {
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
            if !self.panel.plugged_in || outbox.address != self.panel.address {
                let source = if outbox.has_begun() { NoAcknowledgeSource::Data } else { NoAcknowledgeSource::Address };
                *sent = Some(Err(ErrorKind::NoAcknowledge(source)));
                self.message.clear();
            } else if let Some(byte) = outbox.next() {
                self.message.push(byte.value);
                if byte.ends_message {
                    self.panel.take(&self.message);
                    self.message.clear();
                }
            } else if outbox.asks {
                let silence = ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address);
                *sent = Some(self.panel.status().map(|status| outbox.status = status).ok_or(silence));
            } else {
                *sent = Some(Ok(()));
            }
        }
        self.time = 0;
    }

    pub fn is_idle(&self) -> bool {
        !matches!(self.outgoing, Some((_, None)))
    }
}

/// The driver's end of the bus.
pub struct Bus<'a> {
    line: &'a RefCell<Line>,
    outbox: Option<Outbox>,
    sent: Sent,
}

impl<'a> Bus<'a> {
    pub fn new(line: &'a RefCell<Line>) -> Self {
        Self { line, outbox: Some(Outbox::new()), sent: Ok(()) }
    }
}

impl PanelBus for Bus<'_> {
    fn outbox(&mut self) -> Option<(&mut Outbox, Sent)> {
        let mut line = self.line.borrow_mut();
        if line.is_idle()
            && let Some((outbox, Some(sent))) = line.outgoing.take()
        {
            (self.outbox, self.sent) = (Some(outbox), sent);
        }
        self.outbox.as_mut().map(|outbox| (outbox, self.sent))
    }

    fn send(&mut self) {
        let mut line = self.line.borrow_mut();
        line.outgoing = Some((self.outbox.take().expect("sent once"), None));
        (line.taken, line.sent) = (0, line.sent + 1);
    }

    fn give_up(&mut self) {
        let mut line = self.line.borrow_mut();
        let (outbox, _) = line.outgoing.take().expect("something to give up");
        line.freed += 1;
        line.message.clear();
        (self.outbox, self.sent) = (Some(outbox), Err(ErrorKind::Other));
    }
}
