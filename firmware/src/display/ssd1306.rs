//! The SSD1306 controller of a 128 x 64 OLED panel in one colour, over I2C.
//!
//! A whole frame takes 1,120 bytes of 9 bits, 25 ms at the bus's 400 kHz and longer than a tick. So only what has
//! changed is sent: of each page the columns from the first that did to the last.
//!
//! Source: Solomon Systech, SSD1306 data sheet.

use embedded_hal::i2c::{Error, ErrorKind, I2c};

use super::Display;
use crate::config::TICK_RATE;
use crate::graphics::bitmap::{Bitmap, PAGES};
use crate::graphics::canvas::{Canvas, HEIGHT, WIDTH};

/// The two addresses that a panel can be set to.
const ADDRESSES: [u8; 2] = [0x3C, 0x3D];
/// First byte of a message: one command follows, with its arguments.
const COMMAND: u8 = 0x00;
/// First byte of a message: bytes for the window follow.
const DATA: u8 = 0x40;
/// A message without effect.
const NOTHING: &[u8] = &[COMMAND, 0xE3];

/// What wakes the panel, one message a row; its memory is blanked before the last.
#[rustfmt::skip]
const WAKE: [&[u8]; 17] = [
    &[COMMAND, 0xAE],                       // display off
    &[COMMAND, 0xD5, 0x80],                 // clock as after reset, not divided
    &[COMMAND, 0xA8, (HEIGHT - 1) as u8],   // rows driven, less one
    &[COMMAND, 0xD3, 0],                    // rows not shifted
    &[COMMAND, 0x40],                       // first row shown
    &[COMMAND, 0x8D, 0x14],                 // charge pump on
    &[COMMAND, 0x20, 0],                    // data goes to the right, then to the next page of the window
    &[COMMAND, 0xDA, 0x12],                 // wiring of this panel's rows: odd and even apart
    &[COMMAND, 0xA1],                       // columns from the left
    &[COMMAND, 0xC8],                       // rows from the top
    &[COMMAND, 0xD9, 0x21],                 // precharge, 1 and 2 clocks
    &[COMMAND, 0x81, 0x5F],                 // contrast, of 0xFF
    &[COMMAND, 0xDB, 0x40],                 // voltage of rows not driven
    &[COMMAND, 0xA4],                       // show what is in memory
    &[COMMAND, 0xA6],                       // not inverted
    &[COMMAND, 0x2E],                       // no scrolling
    &[COMMAND, 0xAF],                       // display on
];
/// Frames between two tries of a panel that does not answer: 1 s.
const RETRY: u32 = TICK_RATE;

/// Why a frame did not reach the panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ssd1306Error {
    /// No panel answers at either address; what the bus said.
    Absent(ErrorKind),
    /// The panel answered before, but not now.
    Lost,
}

/// The panel: an I2C bus that it may be on.
///
/// A panel that does not answer is absent: frames for it are refused at once. Once a second it is looked for, so that
/// it may be plugged in at any time.
#[derive(Debug)]
pub struct Ssd1306<Bus> {
    bus: Bus,
    state: State,
    /// What the panel's memory holds while it is awake.
    memory: Bitmap,
}

#[derive(Clone, Copy, Debug)]
enum State {
    Awake { address: u8 },
    Absent { error: Ssd1306Error, retry_in: u32 },
}

impl<Bus: I2c> Ssd1306<Bus> {
    /// Takes the bus; nothing is sent yet.
    pub fn new(bus: Bus) -> Self {
        Self { bus, state: State::Absent { error: Ssd1306Error::Lost, retry_in: 0 }, memory: Bitmap::default() }
    }

    /// Looks for the panel, configures it, blanks its memory and switches it on.
    pub fn init(&mut self) -> Result<(), Ssd1306Error> {
        let woken = self.find().and_then(|address| self.wake(address).map(|()| address));
        self.memory = Bitmap::default();
        self.state = match woken {
            Ok(address) => State::Awake { address },
            Err(error) => State::Absent { error, retry_in: RETRY },
        };
        woken.map(drop)
    }

    /// The address at which a panel answers.
    fn find(&mut self) -> Result<u8, Ssd1306Error> {
        let [first, second] = ADDRESSES;
        let mut answers = |address| self.bus.write(address, NOTHING).map(|()| address);
        answers(first).or_else(|_| answers(second)).map_err(|error| Ssd1306Error::Absent(error.kind()))
    }

    fn wake(&mut self, address: u8) -> Result<(), Ssd1306Error> {
        let [settings @ .., on] = WAKE;
        settings.iter().try_for_each(|message| send(&mut self.bus, address, message))?;
        for page in 0..PAGES {
            draw(&mut self.bus, address, page, (0, WIDTH - 1), &[0; WIDTH])?;
        }
        send(&mut self.bus, address, on)
    }
}

impl<Bus: I2c> Display for Ssd1306<Bus> {
    type Error = Ssd1306Error;

    fn flush(&mut self, canvas: &Canvas) -> Result<(), Ssd1306Error> {
        match &mut self.state {
            State::Absent { error, retry_in: left @ 1.. } => {
                *left -= 1;
                return Err(*error);
            }
            State::Absent { .. } => self.init()?,
            State::Awake { .. } => {}
        }
        let State::Awake { address } = self.state else { return Ok(()) };
        let frame = Bitmap::from(canvas);
        let sent = update(&mut self.bus, address, &self.memory, &frame);
        match sent {
            Ok(()) => self.memory = frame,
            Err(error) => self.state = State::Absent { error, retry_in: RETRY },
        }
        sent
    }
}

/// Sends what differs between the panel's memory and the frame.
fn update(bus: &mut impl I2c, address: u8, memory: &Bitmap, frame: &Bitmap) -> Result<(), Ssd1306Error> {
    for (page, (old, new)) in memory.pages().iter().zip(frame.pages()).enumerate() {
        let differs = |column: &usize| old.get(*column) != new.get(*column);
        if let (Some(first), Some(last)) = ((0..WIDTH).find(differs), (0..WIDTH).rfind(differs)) {
            draw(bus, address, page, (first, last), new.get(first..=last).unwrap_or_default())?;
        }
    }
    Ok(())
}

/// Sends the columns from `first` to `last` of a page.
fn draw(
    bus: &mut impl I2c,
    address: u8,
    page: usize,
    (first, last): (usize, usize),
    columns: &[u8],
) -> Result<(), Ssd1306Error> {
    send(bus, address, &[COMMAND, 0x21, first as u8, last as u8])?;
    send(bus, address, &[COMMAND, 0x22, page as u8, page as u8])?;
    let mut message = [DATA; 1 + WIDTH];
    for (place, byte) in message.iter_mut().skip(1).zip(columns) {
        *place = *byte;
    }
    send(bus, address, message.get(..=columns.len()).unwrap_or_default())
}

fn send(bus: &mut impl I2c, address: u8, message: &[u8]) -> Result<(), Ssd1306Error> {
    bus.write(address, message).map_err(|_| Ssd1306Error::Lost)
}
