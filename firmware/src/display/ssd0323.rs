//! The SSD0323 controller of a 128 x 64 OLED panel with 16 greys, on four-wire SPI.
//!
//! A whole frame takes 4,096 bytes, 9 ms at 3.6 MHz. So only the drawn cells that differ from the
//! panel's memory are sent.
//!
//! Source: Solomon Systech, SSD0323 data sheet; register values from the panel's application note
//! (OSRAM AN018).

use core::convert::Infallible;
use core::ops::Range;

use embedded_hal::digital::OutputPin;
use embedded_hal::spi::SpiDevice;

use super::Display;
use crate::graphics::{Canvas, Format};

const WIDTH: usize = Format::OLED.width as usize;
const HEIGHT: usize = Format::OLED.height as usize;
/// The number of cells in a row.
const CELLS: usize = WIDTH / 8;

const LAST_COLUMN: u8 = (WIDTH / 2 - 1) as u8;
const LAST_ROW: u8 = (HEIGHT - 1) as u8;

/// The commands for the rows, from this one to the last, and for the columns, of two pixels each,
/// that data is written to. They also set the address to the first row and column. After the last
/// column of a row, the address continues with the first column of the next row.
const fn window(row: u8, first: u8, last: u8) -> [u8; 6] {
    [0x75, row, LAST_ROW, 0x15, first, last]
}
const ALL: [u8; 6] = window(0, 0, LAST_COLUMN);

/// The commands that set the panel up, one in each line.
#[rustfmt::skip]
const WAKE: [&[u8]; 18] = [
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
    &ALL,
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
/// word.
#[derive(Debug)]
pub struct Memory {
    rows: [[u32; CELLS]; HEIGHT],
    is_known: bool,
}

impl Memory {
    /// Unknown contents.
    pub const UNKNOWN: Self = Self {
        rows: [[0; CELLS]; HEIGHT],
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
        self.command(&ALL)?;
        self.memory.is_known = false;
        (0..HEIGHT).try_for_each(|_| self.data(&[0; WIDTH / 2]))?;
        self.memory.rows = [[0; CELLS]; HEIGHT];
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
        for y in 0..HEIGHT {
            let drawn = canvas.changed(y);
            if drawn == 0 {
                continue;
            }
            let mut differing = self.memory.take(y, drawn, canvas);
            while differing != 0 {
                // A gap of up to two cells takes fewer bytes than another window.
                let first = differing.trailing_zeros();
                let near = (differing | differing << 1 | differing << 2) >> first;
                let run = differing & (u32::MAX >> (32 - near.trailing_ones()) << first);
                let last = u32::BITS - run.leading_zeros();
                differing &= !run;
                self.send(y, first as usize..last as usize)?;
            }
        }
        Ok(())
    }

    /// Sends these cells of a row from the memory.
    fn send(&mut self, y: usize, cells: Range<usize>) -> Result<(), Spi::Error> {
        let [first, last] = [4 * cells.start, 4 * cells.end - 1];
        self.command(&window(y as u8, first as u8, last as u8))?;
        let row = self.memory.rows.get(y).map_or(&[][..], |row| row);
        let words = row.get(cells).unwrap_or_default();
        let Ok(()) = self.data_not_command.set_high();
        self.spi.write(bytemuck::cast_slice(words))
    }
}

impl Memory {
    /// Takes over the drawn cells of row `y`. Returns a bit for each cell that differs.
    fn take(&mut self, y: usize, drawn: u32, canvas: &Canvas) -> u32 {
        let [_, greys] = canvas.row(y);
        let greys: Option<&[u32; CELLS]> = greys.first_chunk();
        let (Some(memory), Some(greys)) = (self.rows.get_mut(y), greys) else {
            return 0;
        };

        let mut rest = drawn;
        let mut differing = 0;
        while rest != 0 {
            // A cell of a canvas of this size is eight pixels wide: a word.
            let cell = rest.trailing_zeros() as usize % CELLS;
            rest &= rest - 1;
            if memory[cell] != greys[cell] {
                memory[cell] = greys[cell];
                differing |= 1 << cell;
            }
        }
        if self.is_known { differing } else { drawn }
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
