//! The panel's controller, stricter than the real one.

use firmware::graphics::bitmap::Bitmap;
use firmware::graphics::canvas::{HEIGHT, WIDTH};

/// Commands and how many arguments each takes, from the data sheet's command table; their arguments follow them in the
/// same message.
const COMMANDS: [(u8, usize); 19] = [
    (0x20, 1), // addressing mode
    (0x21, 2), // columns
    (0x22, 2), // pages
    (0x2E, 0), // no scrolling
    (0x40, 0), // first row shown
    (0x81, 1), // contrast
    (0x8D, 1), // charge pump
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

/// An SSD1306 on a bus: panics on anything that the data sheet does not allow.
pub struct Controller {
    pub address: u8,
    pub plugged_in: bool,
    columns: (u8, u8),
    pages: (u8, u8),
    at: (u8, u8),
    memory: Vec<Option<u8>>,
    horizontal: bool,
    on: bool,
}

impl Controller {
    pub fn at(address: u8) -> Self {
        Self {
            address,
            plugged_in: true,
            columns: (0, 127),
            pages: (0, 7),
            at: (0, 0),
            memory: vec![None; WIDTH * HEIGHT / 8],
            horizontal: false,
            on: false,
        }
    }

    pub fn plugged(self, plugged_in: bool) -> Self {
        Self { plugged_in, ..self }
    }

    fn commands(&mut self, mut bytes: &[u8]) {
        while let Some((command, rest)) = bytes.split_first() {
            let known = COMMANDS.iter().find(|(known, _)| known == command);
            let (_, count) = known.unwrap_or_else(|| panic!("unknown command {command:#04x}"));
            let (arguments, others) = rest.split_at_checked(*count).expect("all arguments in one message");
            self.command(*command, arguments);
            bytes = others;
        }
    }

    fn command(&mut self, command: u8, arguments: &[u8]) {
        match (command, arguments) {
            (0x20, mode) => self.horizontal = mode == [0],
            (0x21, &[first, last]) => {
                assert!(first <= last && last < 128);
                self.columns = (first, last);
                self.at.0 = first;
            }
            (0x22, &[first, last]) => {
                assert!(self.horizontal && first <= last && last < 8);
                self.pages = (first, last);
                self.at.1 = first;
            }
            (0xAE, _) => self.on = false,
            (0xAF, _) => self.on = true,
            _ => {}
        }
    }

    fn data(&mut self, byte: u8) {
        assert!(self.horizontal, "data in another mode than the driver counts on");
        let (column, page) = self.at;
        self.memory[usize::from(page) * WIDTH + usize::from(column)] = Some(byte);
        self.at.0 = if column == self.columns.1 { self.columns.0 } else { column + 1 };
        if column == self.columns.1 {
            self.at.1 = if page == self.pages.1 { self.pages.0 } else { page + 1 };
        }
    }

    pub fn take(&mut self, message: &[u8]) {
        match message {
            [0x00, commands @ ..] => self.commands(commands),
            [0x40, data @ ..] => data.iter().for_each(|byte| self.data(*byte)),
            _ => panic!("neither commands nor data"),
        }
    }

    pub fn is_on(&self) -> bool {
        self.on
    }

    pub fn shows(&self, frame: &Bitmap) -> bool {
        self.on && self.memory.iter().copied().eq(frame.pages().as_flattened().iter().copied().map(Some))
    }
}
