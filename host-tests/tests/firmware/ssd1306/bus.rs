//! The panel's bus at its time, and the controller at its end, stricter than the real one.

use embedded_hal::i2c::ErrorKind;
use firmware::display::{Outbox, PanelBus, SILENCE, Sent};
use firmware::graphics::{Bitmap, HEIGHT, WIDTH};

/// Bits that a byte takes with its acknowledgement; a start or stop takes 1.
pub const BYTE: u32 = 9;

/// The bus as an interrupt drives it, and the panel at its end.
pub struct Line {
    pub panel: Controller,
    outbox: Outbox,
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
        Self {
            panel,
            outbox: Outbox::default(),
            message: Vec::new(),
            time: 0,
            taken: 0,
            hangs: false,
            freed: 0,
            sent: 0,
        }
    }

    /// Lets the time of `bits` bits pass on the bus.
    pub fn run(&mut self, bits: u32) {
        self.time = if self.hangs {
            0
        } else {
            self.time.saturating_add(bits)
        };
        let Self {
            outbox,
            panel,
            message,
            ..
        } = self;
        while outbox.sent.is_none() {
            let needed = match (
                outbox.is_within_message(),
                outbox.is_empty() && !outbox.asks,
            ) {
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
                outbox.sent = Some(Err(SILENCE));
                message.clear();
            } else if let Some(byte) = outbox.next() {
                message.push(byte.value);
                if byte.ends_message {
                    panel.take(message);
                    message.clear();
                }
            } else if outbox.asks {
                outbox.sent = Some(
                    panel
                        .status()
                        .map(|status| outbox.status = status)
                        .ok_or(SILENCE),
                );
            } else {
                outbox.sent = Some(Ok(()));
            }
        }
        self.time = 0;
    }

    pub fn is_idle(&self) -> bool {
        self.outbox.sent.is_some()
    }
}

impl PanelBus for Line {
    fn outbox(&mut self) -> Option<(&mut Outbox, Sent)> {
        self.outbox.sent.map(|sent| (&mut self.outbox, sent))
    }

    fn send(&mut self) {
        assert!(self.is_idle(), "one at a time");
        (self.outbox.sent, self.taken, self.sent) = (None, 0, self.sent + 1);
    }

    fn abort(&mut self) {
        assert!(!self.is_idle(), "nothing to abort");
        self.freed += 1;
        self.message.clear();
        self.outbox.sent = Some(Err(ErrorKind::Other));
    }
}

/// A kind of controller: what tells it from the other.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// The lower half of its status; `None` if it does not tell.
    pub status: Option<u8>,
    /// Columns of its memory, and the first that is seen.
    pub columns: usize,
    pub left: usize,
    /// The commands that the other has not.
    pub own: &'static [(u8, usize)],
    /// Those that must be given: the converter on, data in pages.
    pub needed: &'static [&'static [u8]],
}

pub const SSD1306: Kind = Kind {
    status: Some(0x06),
    columns: WIDTH,
    left: 0,
    own: &[(0x20, 1), (0x2E, 0), (0x8D, 1)],
    needed: &[&[0x20, 2], &[0x8D, 0x14]],
};
pub const SH1106: Kind = Kind {
    status: Some(0x08),
    columns: WIDTH + 4,
    left: 2,
    own: &[(0xAD, 1)],
    needed: &[&[0xAD, 0x8B]],
};
/// As SSD1306s that tell nothing.
pub const SILENT: Kind = Kind {
    status: None,
    ..SSD1306
};

/// How many arguments a command of both takes, from the data sheets' command tables; they follow it in the same message.
fn arguments(command: u8) -> Option<usize> {
    match command {
        0x00..=0x1F | 0x40 | 0xA1 | 0xA4 | 0xA6 | 0xAE | 0xAF | 0xB0..=0xB7 | 0xC8 => Some(0),
        0x81 | 0xA8 | 0xD3 | 0xD5 | 0xD9 | 0xDA | 0xDB => Some(1),
        _ => None,
    }
}

/// A controller on a bus: panics on anything that its data sheet does not allow.
pub struct Controller {
    pub kind: Kind,
    pub address: u8,
    pub plugged_in: bool,
    column: usize,
    page: usize,
    /// As it is after power has come: no bit of it known.
    memory: Vec<Option<u8>>,
    given: Vec<Vec<u8>>,
    on: bool,
}

impl Controller {
    pub fn new(kind: Kind, address: u8) -> Self {
        let memory = vec![None; kind.columns * HEIGHT / 8];
        Self {
            kind,
            address,
            plugged_in: true,
            column: 0,
            page: 0,
            memory,
            given: Vec::new(),
            on: false,
        }
    }

    pub fn plugged(self, plugged_in: bool) -> Self {
        Self { plugged_in, ..self }
    }

    /// What it answers when it is read.
    pub fn status(&self) -> Option<u8> {
        self.kind.status.map(|kind| kind | u8::from(!self.on) << 6)
    }

    fn commands(&mut self, mut bytes: &[u8]) {
        while let [command, rest @ ..] = bytes {
            let own = || {
                self.kind
                    .own
                    .iter()
                    .find(|(own, _)| own == command)
                    .map(|(_, count)| *count)
            };
            let count = arguments(*command)
                .or_else(own)
                .unwrap_or_else(|| panic!("unknown command {command:#04x}"));
            assert!(rest.len() >= count, "all arguments in one message");
            match *command {
                low @ 0x00..=0x0F => self.column = self.column & 0xF0 | usize::from(low),
                high @ 0x10..=0x1F => {
                    self.column = self.column & 0x0F | usize::from(high & 0x0F) << 4
                }
                page @ 0xB0..=0xB7 => self.page = usize::from(page & 7),
                0xAE => self.on = false,
                0xAF => self.on = true,
                _ => self.given.push(bytes[..=count].to_vec()),
            }
            bytes = &rest[count..];
        }
    }

    /// Data goes to the right within the page.
    fn data(&mut self, byte: u8) {
        assert!(self.column < self.kind.columns, "beyond the last column");
        self.memory[self.page * self.kind.columns + self.column] = Some(byte);
        self.column += 1;
    }

    pub fn take(&mut self, message: &[u8]) {
        match message {
            [0x00, commands @ ..] => self.commands(commands),
            [0x40, data @ ..] => data.iter().for_each(|byte| self.data(*byte)),
            _ => panic!("neither commands nor data"),
        }
    }

    pub fn shows(&self, frame: &Bitmap) -> bool {
        let Kind {
            columns,
            left,
            needed,
            ..
        } = self.kind;
        let seen = |page: &[Option<u8>], new: &[u8; WIDTH]| page[left..][..WIDTH] == new.map(Some);
        let is_set = needed
            .iter()
            .all(|needed| self.given.iter().any(|given| given == needed));
        self.on
            && is_set
            && self
                .memory
                .chunks(columns)
                .zip(&frame.pages)
                .all(|(page, new)| seen(page, new))
    }
}
