//! The SSD1306 controller of a 128 x 64 OLED panel in one colour, over I2C.
//!
//! A whole frame takes 1,104 bytes of 9 bits, 25 ms at the bus's 400 kHz and longer than a tick. So only what has
//! changed is sent, and no frame waits for it: one that is ready before the bus is done with an earlier one is not shown, and
//! the next is sent by what differs from what the panel holds.
//!
//! Source: Solomon Systech, SSD1306 data sheet.

use core::iter::from_fn;
use core::ops::Range;

use embedded_hal::i2c::ErrorKind;

use super::Display;
use super::outbox::{Outbox, PanelBus, Sent};
use crate::config::TICK_RATE;
use crate::graphics::bitmap::{Bitmap, PAGES};
use crate::graphics::canvas::{Canvas, HEIGHT, WIDTH};

/// The two addresses that a panel can be set to.
const ADDRESSES: [u8; 2] = [0x3C, 0x3D];
/// First byte of a message: commands follow, with their arguments.
const COMMAND: u8 = 0x00;
/// First byte of a message: bytes for the window follow.
const DATA: u8 = 0x40;

/// Switches the panel off.
const OFF: &[u8] = &[0xAE];
/// What wakes the panel, one command a row.
#[rustfmt::skip]
const SETTINGS: &[u8] = &[
    0xD5, 0x80,                // clock as after reset, not divided
    0xA8, (HEIGHT - 1) as u8,  // rows driven, less one
    0xD3, 0,                   // rows not shifted
    0x40,                      // first row shown
    0x8D, 0x14,                // charge pump on
    0x20, 0,                   // data goes to the right, then to the next page of the window
    0xDA, 0x12,                // wiring of this panel's rows: odd and even apart
    0xA1,                      // columns from the left
    0xC8,                      // rows from the top
    0xD9, 0x21,                // precharge, 1 and 2 clocks
    0x81, 0x5F,                // contrast, of 0xFF
    0xDB, 0x40,                // voltage of rows not driven
    0xA4,                      // show what is in memory
    0xA6,                      // not inverted
    0x2E,                      // no scrolling
];
/// Switches it on.
const ON: &[u8] = &[0xAF];
/// Frames between two tries of a panel that does not answer: 1 s.
const RETRY: u32 = TICK_RATE;
/// Frames after which a panel that is awake is woken again, as soon as there is room: 1 s.
const REMINDER: u32 = TICK_RATE;
/// Pages that are sent again with that: the whole picture in 4 s.
const REMINDED: usize = 2;
/// Bytes of a frame beside which there is room for that in a tick: it takes 310, and the bus carries 740.
const SHORT: usize = 400;
/// Frames after which a bus that is still busy hangs: 0.1 s, four times what most bytes take.
const PATIENCE: u32 = 6;
/// Columns that are better sent again than left out: to address what comes after them takes as many bytes.
const GAP: usize = 10;

/// Why a frame did not reach the panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ssd1306Error {
    /// No panel answers at either address; what the bus said.
    Absent(ErrorKind),
    /// The panel answered before, but not now.
    Lost,
    /// The bus is too slow for every frame.
    Slow {
        /// How many of the last [`TICK_RATE`] frames reached the panel.
        shown: u32,
    },
}

/// The panel: an I2C bus that it may be on.
///
/// A panel that does not answer is absent: frames for it are refused at once. Once a second it is looked for, so that
/// it may be plugged in at any time. What becomes of a frame is told with one of the next.
///
/// A panel that was without power for a moment is dark, and answers all the same. So about once a second it is told again what
/// woke it, and a part of the picture, with a frame that leaves room for that in its tick: one that stands still, or any short one.
#[derive(Debug)]
pub struct Ssd1306<Bus> {
    bus: Bus,
    state: State,
    /// What the panel's memory holds once all that was sent has arrived.
    memory: Bitmap,
    told: Result<(), Ssd1306Error>,
    /// Frames for which the bus has been busy.
    waiting: u32,
    /// Frames since the panel was last woken, and the page with which the next reminder begins.
    since_woken: u32,
    page: usize,
    /// Frames since they were last counted, and those of them that the bus has taken.
    counted: u32,
    shown: u32,
}

#[derive(Clone, Copy, Debug)]
enum State {
    Absent { retry_in: u32 },
    Waking { address: u8 },
    Awake { address: u8 },
}

impl<Bus: PanelBus> Ssd1306<Bus> {
    /// Takes the bus; the panel is looked for with the first frame.
    pub fn new(bus: Bus) -> Self {
        let (state, memory) = (State::Absent { retry_in: 0 }, Bitmap::default());
        Self { bus, state, memory, told: Ok(()), waiting: 0, since_woken: 0, page: 0, counted: 0, shown: 0 }
    }

    /// Sends the frame if the bus is free; whether it is.
    fn offer(&mut self, canvas: &Canvas) -> bool {
        let Some((outbox, sent)) = self.bus.outbox() else {
            self.waiting += 1;
            if self.waiting >= PATIENCE {
                self.bus.give_up();
            }
            return false;
        };
        self.waiting = 0;
        let (state, news) = self.state.after(sent);
        self.state = state;
        if let Some(told) = news {
            (self.told, self.counted, self.shown) = (told, 0, 0);
        }
        match state {
            State::Absent { .. } => return true,
            State::Waking { address } => {
                self.memory = Bitmap::from(canvas);
                self.since_woken = 0;
                outbox.address_to(address);
                outbox.put(COMMAND, OFF);
                wake(outbox, &self.memory, 0..PAGES);
            }
            State::Awake { address } => {
                let frame = Bitmap::from(canvas);
                outbox.address_to(address);
                draw(outbox, Some(&self.memory), &frame, 0..PAGES);
                self.memory = frame;
                self.since_woken = self.since_woken.saturating_add(1);
                if self.since_woken >= REMINDER && outbox.len() <= SHORT {
                    wake(outbox, &self.memory, self.page..self.page + REMINDED);
                    (self.since_woken, self.page) = (0, (self.page + REMINDED) % PAGES);
                }
            }
        }
        if !outbox.is_empty() {
            self.bus.send();
        }
        true
    }

    /// Tells once a second whether all frames are shown.
    fn count(&mut self, is_shown: bool) {
        self.counted += 1;
        self.shown += u32::from(is_shown);
        if self.counted >= TICK_RATE {
            let shown = self.shown;
            self.told = if shown < self.counted { Err(Ssd1306Error::Slow { shown }) } else { Ok(()) };
            (self.counted, self.shown) = (0, 0);
        }
    }
}

impl State {
    /// The next state, given how the last messages fared, and what there is to report.
    fn after(self, sent: Sent) -> (Self, Option<Result<(), Ssd1306Error>>) {
        let [first, second] = ADDRESSES;
        let absent = Self::Absent { retry_in: RETRY };
        match (self, sent) {
            (Self::Absent { retry_in: 0 }, _) => (Self::Waking { address: first }, None),
            (Self::Absent { retry_in }, _) => (Self::Absent { retry_in: retry_in - 1 }, None),
            (Self::Waking { address }, Ok(())) => (Self::Awake { address }, Some(Ok(()))),
            (Self::Waking { address }, Err(ErrorKind::NoAcknowledge(_))) if address == first => {
                (Self::Waking { address: second }, None)
            }
            (Self::Waking { .. }, Err(error)) => (absent, Some(Err(Ssd1306Error::Absent(error)))),
            (Self::Awake { .. }, Ok(())) => (self, None),
            (Self::Awake { .. }, Err(_)) => (absent, Some(Err(Ssd1306Error::Lost))),
        }
    }
}

impl<Bus: PanelBus> Display for Ssd1306<Bus> {
    type Error = Ssd1306Error;

    fn flush(&mut self, canvas: &Canvas) -> Result<(), Ssd1306Error> {
        let is_shown = self.offer(canvas);
        if let State::Awake { .. } = self.state {
            self.count(is_shown);
        }
        self.told
    }
}

/// Configures the panel, fills these pages of its memory and switches it on.
fn wake(outbox: &mut Outbox, frame: &Bitmap, pages: Range<usize>) {
    outbox.put(COMMAND, SETTINGS);
    draw(outbox, None, frame, pages);
    outbox.put(COMMAND, ON);
}

/// Sends what differs in these pages between the panel's memory and the frame; all of it if the memory is not known.
fn draw(outbox: &mut Outbox, memory: Option<&Bitmap>, frame: &Bitmap, pages: Range<usize>) {
    for (page, new) in (0..).zip(frame.pages()).filter(|(page, _)| pages.contains(&usize::from(*page))) {
        let old = memory.and_then(|memory| memory.pages().get(usize::from(page)));
        for (first, last) in runs(|column| old.is_none_or(|old| old.get(column) != new.get(column))) {
            outbox.put(COMMAND, &[0x21, first as u8, last as u8, 0x22, page, page]);
            outbox.put(DATA, new.get(first..=last).unwrap_or_default());
        }
    }
}

/// The columns that differ, from the first to the last of each run; short gaps belong to it.
fn runs(differs: impl Fn(usize) -> bool) -> impl Iterator<Item = (usize, usize)> {
    let mut columns = (0..WIDTH).filter(move |&column| differs(column)).peekable();
    from_fn(move || {
        let first = columns.next()?;
        let mut last = first;
        while let Some(next) = columns.next_if(|&next| next - last <= GAP) {
            last = next;
        }
        Some((first, last))
    })
}
