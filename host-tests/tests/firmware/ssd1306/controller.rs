//! The panel's controller, stricter than the real one.

use firmware::graphics::{Bitmap, HEIGHT, WIDTH};

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
pub const SH1106: Kind =
    Kind { status: Some(0x08), columns: WIDTH + 4, left: 2, own: &[(0xAD, 1)], needed: &[&[0xAD, 0x8B]] };
/// As SSD1306s that tell nothing.
pub const SILENT: Kind = Kind { status: None, ..SSD1306 };

/// Commands of both and how many arguments each takes, from the data sheets' command tables; their arguments follow them in the
/// same message.
const COMMANDS: [(u8, usize); 14] = [
    (0x40, 0), // first row shown
    (0x81, 1), // contrast
    (0xA1, 0), // columns mirrored
    (0xA4, 0), // show what is in memory
    (0xA6, 0), // not inverted
    (0xA8, 1), // rows driven
    (0xAE, 0), // off
    (0xAF, 0), // on
    (0xC8, 0), // rows mirrored
    (0xD3, 1), // shift of the rows
    (0xD5, 1), // clock
    (0xD9, 1), // precharge
    (0xDA, 1), // wiring of the rows
    (0xDB, 1), // voltage of rows not driven
];

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
        Self { kind, address, plugged_in: true, column: 0, page: 0, memory, given: Vec::new(), on: false }
    }

    pub fn at(address: u8) -> Self {
        Self::new(SSD1306, address)
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
            let count = match command {
                0x00..=0x1F | 0xB0..=0xB7 => 0,
                _ => {
                    let known = COMMANDS.iter().chain(self.kind.own).find(|(known, _)| known == command);
                    known.unwrap_or_else(|| panic!("unknown command {command:#04x}")).1
                }
            };
            assert!(rest.len() >= count, "all arguments in one message");
            self.command(&bytes[..=count]);
            bytes = &rest[count..];
        }
    }

    fn command(&mut self, command: &[u8]) {
        match command[0] {
            low @ 0x00..=0x0F => self.column = self.column & 0xF0 | usize::from(low),
            high @ 0x10..=0x1F => self.column = self.column & 0x0F | usize::from(high & 0x0F) << 4,
            page @ 0xB0..=0xB7 => self.page = usize::from(page & 7),
            0xAE => self.on = false,
            0xAF => self.on = true,
            _ => self.given.push(command.to_vec()),
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
        let Kind { columns, left, needed, .. } = self.kind;
        let seen = |page: &[Option<u8>], new: &[u8; WIDTH]| page[left..][..WIDTH] == new.map(Some);
        let is_set = needed.iter().all(|needed| self.given.iter().any(|given| given == needed));
        self.on && is_set && self.memory.chunks(columns).zip(&frame.pages).all(|(page, new)| seen(page, new))
    }
}
