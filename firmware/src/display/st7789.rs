//! The ST7789 controller of colour panels, with a bus that sends a line of pixels while the next
//! one is converted.
//!
//! A whole frame of 240 x 240 takes 15 ms at 62.5 MHz. So only the cells that have changed are
//! sent, in windows of rows that share their columns.
//!
//! Source: Sitronix, ST7789V data sheet; the examples of Waveshare (Pico-LCD-1.3, Pico-LCD-2) and
//! Pimoroni (`st7789.cpp`) for the settings of their panels.

use core::convert::Infallible;

use super::{Display, PanelReport};
use crate::graphics::{Canvas, PanelName};

const SLEEP_OUT: u8 = 0x11;
const INVERT: u8 = 0x21;
const DISPLAY_ON: u8 = 0x29;
const COLUMNS: u8 = 0x2A;
const ROWS: u8 = 0x2B;
const WRITE: u8 = 0x2C;
const ADDRESS_MODE: u8 = 0x36;
const PIXEL_FORMAT: u8 = 0x3A;

/// The commands that set a panel up, with their arguments. All these panels are mounted on their
/// side, and show colours inverted otherwise.
const WAKE: [(u8, &[u8]); 4] = [
    (SLEEP_OUT, &[]),
    (ADDRESS_MODE, &[0x70]),
    (PIXEL_FORMAT, &[0x55]), // 16 bits
    (INVERT, &[]),
];

/// The time that the controller needs after it is woken, ms.
const WAKING: u32 = 120;

/// The high nibble of every byte.
const HIGH: u32 = 0xF0F0_F0F0;

/// The number of pixels that are sent in the time that another window costs.
const WINDOW: u32 = 24;

/// The bus of a panel.
pub trait PixelBus {
    /// Waits for the pixels, and sends a command with its arguments.
    fn command(&mut self, command: u8, arguments: &[u8]);

    /// Returns the buffer for the next pixels, at least as many as a row has.
    fn buffer(&mut self) -> &mut [u16];

    /// Waits for the pixels before, and begins to send this number of pixels of the buffer.
    fn send(&mut self, count: usize);

    /// Waits for this number of milliseconds.
    fn wait(&mut self, milliseconds: u32);

    /// Switches the light on.
    fn light(&mut self);
}

/// The driver of a panel. A frame is sent before [`flush`](Display::flush) returns, except for its
/// last line. The panel cannot be read, so that an absent one is no error.
#[derive(Debug)]
pub struct St7789<Bus> {
    /// The bus of the panel.
    pub bus: Bus,
    panel: PanelName,
    /// True once the panel shows a picture. It is dark before.
    is_lit: bool,
}

impl<Bus: PixelBus> St7789<Bus> {
    /// Sets up a panel that has just been reset. It stays dark until the first frame.
    pub fn new(mut bus: Bus, panel: PanelName) -> Self {
        for (command, arguments) in WAKE {
            bus.command(command, arguments);
            if command == SLEEP_OUT {
                bus.wait(WAKING);
            }
        }
        Self {
            bus,
            panel,
            is_lit: false,
        }
    }

    /// Sends these columns of these rows.
    fn window(&mut self, canvas: &Canvas, columns: [usize; 2], rows: [usize; 2]) {
        let (left, top) = self.panel.offset();
        let range = |[from, to]: [usize; 2], offset: usize| {
            let [from, to] = [from + offset, to + offset - 1].map(|end| (end as u16).to_be_bytes());
            [from[0], from[1], to[0], to[1]]
        };
        self.bus.command(COLUMNS, &range(columns, left));
        self.bus.command(ROWS, &range(rows, top));
        self.bus.command(WRITE, &[]);

        let table = canvas.palette.colours();
        let [from, to] = columns;
        for y in rows[0]..rows[1] {
            let row = canvas.row(y);
            let [ink, foreground] =
                row.map(|layer| layer.get(from / 8..to / 8).unwrap_or_default());
            let words = ink.iter().zip(foreground);
            let line = self.bus.buffer();
            for (pixels, (ink, foreground)) in line.as_chunks_mut::<8>().0.iter_mut().zip(words) {
                let even = ink & HIGH | foreground >> 4 & !HIGH;
                let odd = ink << 4 & HIGH | foreground & !HIGH;
                let [even, odd] = [even, odd].map(u32::to_le_bytes);
                let [e, o] = [even, odd].map(|four| four.map(|both| table[usize::from(both)]));
                *pixels = [e[0], o[0], e[1], o[1], e[2], o[2], e[3], o[3]];
            }
            self.bus.send(to - from);
        }
    }
}

impl<Bus: PixelBus> Display for St7789<Bus> {
    type Error = Infallible;

    fn flush(&mut self, canvas: &Canvas) -> Result<(), Infallible> {
        let height = usize::from(canvas.format.height);
        let width = usize::from(canvas.format.width);
        let cell = canvas.cell();
        let mut first = 0;
        while first < height {
            let mut cells = canvas.changed(first);
            let mut end = first + 1;
            if cells == 0 {
                first = end;
                continue;
            }

            // The next rows are in the same windows if few cells more are sent because of it.
            while end < height {
                let next = canvas.changed(end);
                let both = cells | next;
                let rows = (end - first) as u32;
                let more = (both.count_ones() - cells.count_ones()) * rows
                    + (both.count_ones() - next.count_ones());
                if next == 0 || more * cell as u32 > WINDOW {
                    break;
                }
                cells = both;
                end += 1;
            }

            // A window for each run of cells.
            while cells != 0 {
                let from = cells.trailing_zeros();
                let count = (cells >> from).trailing_ones();
                let to = ((from + count) as usize * cell).min(width);
                self.window(canvas, [from as usize * cell, to], [first, end]);
                cells &= !(u32::MAX >> (32 - count) << from);
            }
            first = end;
        }

        if !self.is_lit {
            self.bus.command(DISPLAY_ON, &[]);
            self.bus.light();
            self.is_lit = true;
        }
        Ok(())
    }

    fn report(&self) -> PanelReport {
        PanelReport {
            name: self.panel,
            ..PanelReport::default()
        }
    }
}
