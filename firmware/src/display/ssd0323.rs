//! The SSD0323 controller of a 128 x 64 OLED panel with 16 greys, on four-wire SPI.
//!
//! A whole frame takes 4,096 bytes, 9 ms at 3.6 MHz. So only the changes are sent: of the cells that
//! were drawn, those that differ from the panel's memory, from the first in a row to the last.
//!
//! Source: Solomon Systech, SSD0323 data sheet; register values from the panel's application note
//! (OSRAM AN018).

use core::convert::Infallible;

use embedded_hal::digital::OutputPin;
use embedded_hal::spi::SpiDevice;

use super::Display;
use crate::graphics::{Canvas, Format, visible_pair};

const WIDTH: usize = Format::OLED.width as usize;
const HEIGHT: usize = Format::OLED.height as usize;

const LAST_COLUMN: u8 = (WIDTH / 2 - 1) as u8;
const LAST_ROW: u8 = (HEIGHT - 1) as u8;

/// The commands for the columns, of two pixels each, and for the rows that data is written to. Each
/// command also sets its part of the address to the first column or row. After the last column of a
/// row, the address continues with the first column of the next row.
const fn columns(first: u8, last: u8) -> [u8; 3] {
    [0x15, first, last]
}
const fn rows(first: u8) -> [u8; 3] {
    [0x75, first, LAST_ROW]
}
const ALL_COLUMNS: [u8; 3] = columns(0, LAST_COLUMN);
const ALL_ROWS: [u8; 3] = rows(0);

/// The commands that set the panel up, one in each line.
#[rustfmt::skip]
const WAKE: [&[u8]; 19] = [
    &[0xAE],                    // display off
    &[0x81, 50],                // contrast, of 127
    &[0x85],                    // half current range
    // Wiring of this panel: nibbles swapped, rows from the bottom and split odd/even.
    &[0xA0, 0x52],
    &[0xA1, 0],                 // first row shown
    &[0xA2, 0x4C],              // shift of the rows by the wiring
    &[0xA4],                    // show the memory
    &[0xA8, LAST_ROW],          // rows driven, less one
    &[0xB1, 0x22],              // phase lengths, 2 and 2 clocks
    &[0xB2, 70],                // row period, clocks
    &[0xB3, 0xF1],              // oscillator fastest, divided by 2
    &[0xB8, 0x01, 0x11, 0x22, 0x32, 0x43, 0x54, 0x65, 0x76], // steps between the greys
    &[0xBC, 0x10],              // precharge voltage
    &[0xBE, 0x02],              // voltage of rows not driven
    &[0xBF, 0x0D],              // low level of the segments
    &[0xAD, 0x03],              // DC-DC converter on
    &ALL_COLUMNS,
    &ALL_ROWS,
    &[0xAF],                    // display on
];

/// The driver of a panel: an SPI device in mode 2 at up to 4 MHz, and the pin that is high for data
/// and low for commands. The panel cannot be read, so that an absent one is no error.
#[derive(Debug)]
pub struct Ssd0323<'a, Spi, Pin> {
    spi: Spi,
    data_not_command: Pin,
    memory: &'a mut Memory,
}

/// The contents of the panel's memory, if they are known: the rows from the top, eight pixels in a
/// word as [`visible_pair`] returns them.
#[derive(Debug)]
pub struct Memory {
    rows: [[u32; WIDTH / 8]; HEIGHT],
    is_known: bool,
}

impl Memory {
    /// Unknown contents.
    pub const UNKNOWN: Self = Self {
        rows: [[0; WIDTH / 8]; HEIGHT],
        is_known: false,
    };
}

impl<'a, Spi: SpiDevice, Pin: OutputPin<Error = Infallible>> Ssd0323<'a, Spi, Pin> {
    pub fn new(spi: Spi, data_not_command: Pin, memory: &'a mut Memory) -> Self {
        Self {
            spi,
            data_not_command,
            memory,
        }
    }

    /// Blanks the panel's memory, configures the controller and switches the panel on.
    pub fn init(&mut self) -> Result<(), Spi::Error> {
        self.command(&ALL_COLUMNS)?;
        self.command(&ALL_ROWS)?;
        self.memory.is_known = false;
        (0..HEIGHT).try_for_each(|_| self.data(&[0; WIDTH / 2]))?;
        self.memory.rows = [[0; WIDTH / 8]; HEIGHT];
        self.memory.is_known = true;
        WAKE.iter().try_for_each(|command| self.command(command))
    }

    fn data(&mut self, bytes: &[u8]) -> Result<(), Spi::Error> {
        let Ok(()) = self.data_not_command.set_high();
        self.spi.write(bytes)
    }

    /// Sends a command. This controller takes the arguments as commands, too.
    fn command(&mut self, bytes: &[u8]) -> Result<(), Spi::Error> {
        let Ok(()) = self.data_not_command.set_low();
        self.spi.write(bytes)
    }
}

impl<Spi: SpiDevice, Pin: OutputPin<Error = Infallible>> Ssd0323<'_, Spi, Pin> {
    fn update(&mut self, canvas: &Canvas) -> Result<(), Spi::Error> {
        let mut next = None;
        for y in 0..HEIGHT {
            let Some((first, last)) = self.memory.take(y, canvas) else {
                continue;
            };
            if next != Some(y) {
                self.command(&rows(y as u8))?;
            }
            self.command(&columns(4 * first as u8, 4 * last as u8 + 3))?;
            let mut bytes = [[0; 4]; WIDTH / 8];
            let row = self.memory.rows.get(y).map_or(&[][..], |row| row);
            let cells = row.get(first..=last).unwrap_or_default();
            for (bytes, greys) in bytes.iter_mut().zip(cells) {
                let [left, right] = [*greys, greys >> 4].map(|four| four & 0x0F0F_0F0F);
                let [left, right] = [left, right].map(|four| (four << 4 | four >> 8).to_le_bytes());
                *bytes = [left[0], left[2], right[0], right[2]];
            }
            let Ok(()) = self.data_not_command.set_high();
            let bytes = bytes.get(..cells.len()).unwrap_or_default();
            self.spi.write(bytes.as_flattened())?;
            next = Some(y + 1);
        }
        Ok(())
    }
}

impl Memory {
    /// Takes over the drawn cells of row `y`. Returns the first and the last that differ, `None` if
    /// all are equal.
    fn take(&mut self, y: usize, canvas: &Canvas) -> Option<(usize, usize)> {
        let mut drawn = canvas.changed(y);
        let mut differing = 0;
        let mut cell = 1_u32;
        // A cell of a canvas of this size is eight pixels wide: two words.
        let cells = canvas.row(y).as_chunks::<2>().0;
        let is_known = self.is_known;
        for (old, [left, right]) in self.rows.get_mut(y)?.iter_mut().zip(cells) {
            if drawn & 1 != 0 {
                let new = visible_pair(*left, *right);
                if *old != new || !is_known {
                    *old = new;
                    differing |= cell;
                }
            }
            drawn >>= 1;
            cell <<= 1;
        }
        let first = differing.trailing_zeros() as usize;
        let last = differing.checked_ilog2()? as usize;
        Some((first, last))
    }
}

impl<Spi: SpiDevice, Pin: OutputPin<Error = Infallible>> Display for Ssd0323<'_, Spi, Pin> {
    type Error = Spi::Error;

    /// Sends the changes before it returns.
    fn flush(&mut self, canvas: &Canvas) -> Result<(), Self::Error> {
        let sent = self.update(canvas);
        self.memory.is_known = sent.is_ok();
        sent
    }
}
