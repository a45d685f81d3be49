//! The SSD1306 controller of a 128 x 64 OLED panel in one colour, over I2C: commands by the `ssd1306` crate.
//!
//! A whole picture takes 1,152 bytes of 9 bits, 26 ms at the bus's 400 kHz and longer than a tick. So only what has
//! changed is sent: of each page the columns from the first that did to the last.

use embedded_hal::i2c::{Error, ErrorKind, I2c};
use ssd1306::command::AddrMode;
use ssd1306::mode::BasicMode;
use ssd1306::prelude::{DisplayRotation, DisplaySize128x64, I2CInterface};
use ssd1306::{I2CDisplayInterface, Ssd1306 as Driver};

use super::Display;
use crate::bitmap::Bitmap;
use crate::canvas::{Canvas, WIDTH};
use crate::config::TICK_RATE;

/// The two addresses that a panel can be set to.
const ADDRESSES: [u8; 2] = [0x3C, 0x3D];
/// A message without effect: one command follows, and it is "no operation".
const NOTHING: [u8; 2] = [0x00, 0xE3];
/// Pictures between two tries of a panel that does not answer: 1 s.
const RETRY: u32 = TICK_RATE;

/// Why a picture did not reach the panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ssd1306Error {
    /// No panel answers at either address; what the bus said.
    Absent(ErrorKind),
    /// The panel answered before, but not now.
    Lost,
}

/// The panel: an I2C bus that it may be on.
///
/// A panel that does not answer is absent: pictures for it are refused at once. Once a second it is looked for, so that
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
        let mut answers = |address| self.bus.write(address, &NOTHING).map(|()| address);
        answers(first).or_else(|_| answers(second)).map_err(|error| Ssd1306Error::Absent(error.kind()))
    }

    fn wake(&mut self, address: u8) -> Result<(), Ssd1306Error> {
        let mut driver = driver(&mut self.bus, address);
        let woken = driver.clear().and_then(|()| driver.init_with_addr_mode(AddrMode::Horizontal));
        woken.map_err(|_| Ssd1306Error::Lost)
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
        let picture = Bitmap::from(canvas);
        let sent = send(&mut driver(&mut self.bus, address), &self.memory, &picture);
        match sent {
            Ok(()) => self.memory = picture,
            Err(error) => self.state = State::Absent { error, retry_in: RETRY },
        }
        sent
    }
}

type Panel<'bus, Bus> = Driver<I2CInterface<&'bus mut Bus>, DisplaySize128x64, BasicMode>;

fn driver<Bus: I2c>(bus: &mut Bus, address: u8) -> Panel<'_, Bus> {
    let interface = I2CDisplayInterface::new_custom_address(bus, address);
    Driver::new(interface, DisplaySize128x64, DisplayRotation::Rotate0)
}

/// Sends what differs between the panel's memory and the picture.
fn send<Bus: I2c>(driver: &mut Panel<Bus>, memory: &Bitmap, picture: &Bitmap) -> Result<(), Ssd1306Error> {
    // The driver is made anew for every picture and does not know the mode that the panel is in.
    let mut sent = driver.set_addr_mode(AddrMode::Horizontal);
    for (page, (old, new)) in memory.pages().iter().zip(picture.pages()).enumerate() {
        let differs = |column: &usize| old.get(*column) != new.get(*column);
        let (Some(first), Some(last)) = ((0..WIDTH).find(differs), (0..WIDTH).rfind(differs)) else { continue };
        let (top, bytes) = (8 * page as u8, new.get(first..=last).unwrap_or_default());
        sent = sent
            .and_then(|()| driver.set_draw_area((first as u8, top), (last as u8 + 1, top + 8)))
            .and_then(|()| driver.draw(bytes));
    }
    sent.map_err(|_| Ssd1306Error::Lost)
}
