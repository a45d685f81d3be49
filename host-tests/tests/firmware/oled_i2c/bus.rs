//! The panel's bus with its timing, and a controller that is stricter than the real one.

use embedded_hal::i2c::ErrorKind;
use firmware::config::TICK_RATE;
use firmware::display::{Outbox, PanelBus, SILENCE, Sent};
use firmware::graphics::Bitmap;

use super::{HEIGHT, WIDTH};

/// The number of bits that a byte takes with its acknowledgement; a start or stop takes 1.
pub const BYTE: u32 = 9;

/// The time of a byte on the bus as measured on boards with pull-ups of 4.7 kOhm (346 kHz), ns.
pub const USUAL: u32 = 26_000;

/// The bus as an interrupt drives it, with the panel at its end.
pub struct Line {
    pub panel: Controller,
    outbox: Outbox,
    message: Vec<u8>,
    byte_nanos: u32,
    time: u32,
    pub taken: u32,
    pub hangs: bool,
    pub fails: Option<ErrorKind>,
    pub freed: u32,
    pub sent: u32,
}

impl Line {
    pub fn to(panel: Controller) -> Self {
        Self::at(USUAL, panel)
    }

    pub fn at(byte_nanos: u32, panel: Controller) -> Self {
        Self {
            panel,
            outbox: Outbox::default(),
            message: Vec::new(),
            byte_nanos,
            time: 0,
            taken: 0,
            hangs: false,
            fails: None,
            freed: 0,
            sent: 0,
        }
    }

    pub fn run_tick(&mut self) {
        self.run(1_000_000_000 / TICK_RATE / (self.byte_nanos / BYTE));
    }

    /// Makes as much of the transfer as fits into the time of `bits` more bits.
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
            // The bits of the next byte, or of the start, the address and the answer.
            let asked = outbox.asked();
            let needed = if outbox.is_within_message() {
                BYTE
            } else if !outbox.is_empty() {
                1 + 2 * BYTE
            } else if asked == 0 {
                1
            } else {
                1 + (1 + asked as u32) * BYTE
            };
            if self.time < needed {
                return;
            }

            self.time -= needed;
            self.taken += needed;
            if let Some(error) = self.fails {
                outbox.sent = Some(Err(error));
                message.clear();
            } else if !panel.plugged_in || outbox.address != panel.address {
                outbox.sent = Some(Err(SILENCE));
                message.clear();
            } else if let Some(byte) = outbox.next() {
                message.push(byte.value);
                if byte.ends_message {
                    panel.take(message);
                    message.clear();
                }
            } else if let Some(answer) = panel.read(asked) {
                answer.into_iter().for_each(|byte| outbox.answer(byte));
                outbox.sent = Some(Ok(()));
            } else {
                outbox.sent = Some(Err(SILENCE));
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
        self.outbox.sent = None;
        self.taken = 0;
        self.sent += 1;
    }

    fn abort(&mut self) {
        assert!(!self.is_idle(), "nothing to abort");
        self.freed += 1;
        self.message.clear();
        self.outbox.sent = Some(Err(ErrorKind::Other));
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Says {
    Off(u8),
    /// The first byte until it is read for the first time after power-on, then the second one. Bit
    /// 6 is set while the display is off.
    FirstThen(u8, u8),
    Always(u8),
    Nothing,
}

#[derive(Clone, Copy, Debug)]
pub struct Kind {
    pub says: Says,
    pub returns_memory: bool,
    pub columns: usize,
    pub left: usize,
    pub own: &'static [(u8, usize)],
    pub needed: &'static [&'static [u8]],
}

pub const SSD1306: Kind = Kind {
    says: Says::Off(0x06),
    returns_memory: false,
    columns: WIDTH,
    left: 0,
    own: &[(0x20, 1), (0x2E, 0), (0x8D, 1), (0xDA, 1)],
    needed: &[
        &[0x20, 2],
        &[0x2E],
        &[0x8D, 0x14],
        &[0xA8, 0x3F],
        &[0xDA, 0x12],
    ],
};
pub const SH1106: Kind = Kind {
    says: Says::Off(0x08),
    returns_memory: true,
    columns: WIDTH + 4,
    left: 2,
    own: &[(0xAD, 1), (0xDA, 1)],
    needed: &[&[0xAD, 0x8B], &[0xA8, 0x3F], &[0xDA, 0x12]],
};
pub const SH1107: Kind = Kind {
    says: Says::Off(0x07),
    returns_memory: true,
    columns: WIDTH,
    left: 0,
    own: &[(0x20, 0), (0xAD, 1), (0xDC, 1)],
    needed: &[&[0x20], &[0xDC, 0], &[0xA8, 0x7F]],
};
impl Kind {
    pub fn says(self, says: Says) -> Self {
        Self { says, ..self }
    }
}

/// From the data sheets' command tables.
fn arguments(command: u8) -> Option<usize> {
    match command {
        0x00..=0x1F | 0x40 | 0xA0 | 0xA1 | 0xA4 | 0xA6 | 0xAE | 0xAF => Some(0),
        0xB0..=0xB7 | 0xC0 | 0xC8 | 0xE3 => Some(0),
        0x81 | 0xA8 | 0xD3 | 0xD5 | 0xD9 | 0xDB => Some(1),
        _ => None,
    }
}

/// A controller on a bus that panics on anything that its data sheet does not allow.
pub struct Controller {
    pub kind: Kind,
    pub address: u8,
    pub plugged_in: bool,
    column: usize,
    page: usize,
    memory: Vec<u8>,
    unknown: Vec<bool>,
    given: Vec<Vec<u8>>,
    on: bool,
    pub lit: u32,
    was_read: bool,
    reads_memory: bool,
}

impl Controller {
    pub fn new(kind: Kind, address: u8) -> Self {
        let size = kind.columns * HEIGHT / 8;
        Self {
            kind,
            address,
            plugged_in: true,
            column: 0,
            page: 0,
            memory: vec![0xE7; size],
            unknown: vec![true; size],
            given: Vec::new(),
            on: false,
            lit: 0,
            was_read: false,
            reads_memory: false,
        }
    }

    pub fn plugged(self, plugged_in: bool) -> Self {
        Self { plugged_in, ..self }
    }

    fn status(&mut self) -> Option<u8> {
        let off = u8::from(!self.on) << 6;
        let was_read = std::mem::replace(&mut self.was_read, true);
        match self.kind.says {
            Says::Off(bits) => Some(bits | off),
            Says::FirstThen(first, _) if !was_read => Some(first | off),
            Says::FirstThen(_, bits) => Some(bits | off),
            Says::Always(byte) => Some(byte),
            Says::Nothing => None,
        }
    }

    /// After data, if the memory can be read, these are a dummy byte and the bytes of the memory
    /// from the present column on; otherwise all are the status.
    pub fn read(&mut self, count: usize) -> Option<Vec<u8>> {
        let status = (count > 0 && self.kind.says != Says::Nothing)
            .then(|| self.status())
            .flatten();
        if count > 0 {
            status?;
        }
        if !(self.reads_memory && self.kind.returns_memory) {
            return Some(vec![status.unwrap_or(0); count]);
        }

        // The first byte of memory is a dummy.
        let at = self.page * self.kind.columns + self.column;
        let dummy = 0x55;
        Some(
            [dummy]
                .into_iter()
                .chain(self.memory[at..].iter().copied())
                .take(count)
                .collect(),
        )
    }

    fn is_given(&self, needed: &[u8]) -> bool {
        self.given.iter().any(|given| given == needed)
    }

    pub fn last_of(&self, commands: [u8; 2]) -> Option<&[u8]> {
        let is_one = |given: &&Vec<u8>| commands.contains(&given[0]);
        self.given.iter().rev().find(is_one).map(Vec::as_slice)
    }

    fn commands(&mut self, mut bytes: &[u8]) {
        while let [command, rest @ ..] = bytes {
            // A command of this controller, or a command that all controllers have.
            let own = || {
                self.kind
                    .own
                    .iter()
                    .find(|(own, _)| own == command)
                    .map(|(_, count)| *count)
            };
            let count = own()
                .or_else(|| arguments(*command))
                .unwrap_or_else(|| panic!("unknown command {command:#04x}"));
            assert!(rest.len() >= count, "all arguments in one message");

            match *command {
                low @ 0x00..=0x0F => self.column = self.column & 0xF0 | usize::from(low),
                high @ 0x10..=0x1F => {
                    self.column = self.column & 0x0F | usize::from(high & 0x0F) << 4
                }
                page @ 0xB0..=0xB7 => self.page = usize::from(page & 7),
                0xAE => self.on = false,
                0xAF => {
                    self.lit += u32::from(!self.on);
                    self.on = true;
                    for needed in self.kind.needed {
                        assert!(self.is_given(needed), "lit before {needed:#04x?}");
                    }
                }
                0xE3 => {} // It does nothing.
                // Any other command is a setting. All but the contrast are only for a display that
                // is off.
                setting => {
                    assert!(
                        !self.on || setting == 0x81,
                        "{setting:#04x} while the display is on"
                    );
                    self.given.push(bytes[..=count].to_vec());
                }
            }
            bytes = &rest[count..];
        }
    }

    fn data(&mut self, byte: u8) {
        assert!(self.column < self.kind.columns, "beyond the last column");
        let at = self.page * self.kind.columns + self.column;
        self.memory[at] = byte;

        // The addressing mode decides on the place of the byte.
        let is_addressing = |needed: &&[u8]| needed.starts_with(&[0x20]);
        let is_placed = !self.kind.needed.iter().any(is_addressing)
            || self.given.iter().any(|given| given.starts_with(&[0x20]));
        self.unknown[at] = !is_placed;
        self.column += 1;
    }

    pub fn take(&mut self, message: &[u8]) {
        let mut rest = message;
        while let [control, after @ ..] = rest {
            let is_data = control & 0x40 != 0;
            self.reads_memory = is_data;

            // A control byte applies to the next byte, or to the rest of the message.
            let (bytes, next) = if control & 0x80 == 0 {
                (after, &[][..])
            } else {
                after.split_at(after.len().min(1))
            };
            assert!(control & 0x3F == 0, "neither commands nor data");
            if is_data {
                bytes.iter().for_each(|byte| self.data(*byte));
            } else {
                self.commands(bytes);
            }
            rest = next;
        }
    }

    /// A byte that is unknown since power-on is from no frame.
    pub fn shows(&self, frame: &Bitmap) -> bool {
        let Kind { columns, left, .. } = self.kind;
        let is_shown = |page: usize| {
            let visible = page * columns + left..page * columns + left + WIDTH;
            self.memory[visible.clone()] == frame.pages[page]
                && !self.unknown[visible].contains(&true)
        };
        self.on && (0..HEIGHT / 8).all(is_shown)
    }
}
