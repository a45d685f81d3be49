//! The SSD1306 controller of a 128 x 64 OLED panel in one colour, over I2C, and the SH1106, whose panels look the same.
//!
//! A whole frame takes 1,080 bytes of 9 bits, 24 ms at the bus's 400 kHz and longer than a tick. So only what has
//! changed is sent, and no frame waits for it: one that is ready before the bus is done with an earlier one is not shown, and
//! the next is sent by what differs from what the panel holds.
//!
//! Source: Solomon Systech, SSD1306 data sheet; Sino Wealth, SH1106 data sheet.

use core::iter::from_fn;
use core::ops::Range;

use embedded_hal::i2c::ErrorKind;

use super::bus::{Outbox, PanelBus, Sent};
use super::{By, Controller, Display, Found};
use crate::config::TICK_RATE;
use crate::graphics::{Bitmap, Canvas, HEIGHT, PAGES, WIDTH};

/// The two addresses that a panel can be set to.
const ADDRESSES: [u8; 2] = [0x3C, 0x3D];
/// First byte of a message: commands follow, with their arguments.
const COMMAND: u8 = 0x00;
/// First byte of a message: bytes for the window follow.
const DATA: u8 = 0x40;

const OFF: &[u8] = &[0xAE];
/// What wakes either of them, one command a row.
#[rustfmt::skip]
const SETTINGS: &[u8] = &[
    0xD5, 0x80,                // clock as after reset, not divided
    0xA8, (HEIGHT - 1) as u8,  // rows driven, less one
    0xD3, 0,                   // rows not shifted
    0x40,                      // first row shown
    0xDA, 0x12,                // wiring of this panel's rows: odd and even apart
    0xA1,                      // columns from the left
    0xC8,                      // rows from the top
    0xD9, 0x21,                // precharge, 1 and 2 clocks
    0x81, 0x5F,                // contrast, of 0xFF
    0xDB, 0x40,                // voltage of rows not driven
    0xA4,                      // show what is in memory
    0xA6,                      // not inverted
];
/// What an SSD1306 needs as well: charge pump on; data stays within the page, as an SH1106's always does; no scrolling.
const SSD1306: &[u8] = &[0x8D, 0x14, 0x20, 0x02, 0x2E];
/// What an SH1106 needs as well: its converter on.
const SH1106: &[u8] = &[0xAD, 0x8B];
/// Columns of the SH1106's 132 that are left of the panel's 128.
const SH1106_LEFT: u8 = 2;
const ON: &[u8] = &[0xAF];
/// Frames between two tries of a panel that does not answer: 1 s.
const RETRY: u8 = TICK_RATE as u8;
/// Columns of a part of the picture that is sent again.
const PART: usize = 16;
/// Parts of the picture; with the two messages that wake the panel, one a frame, all are sent again within 1.1 s.
const PARTS: usize = PAGES * WIDTH / PART;
/// Bytes of a frame beside which there is room for a part in a tick: it takes 23, and the bus carries 740.
const SHORT: usize = 700;
/// Frames after which a bus that is still busy hangs: 0.1 s, four times what most bytes take.
const PATIENCE: u32 = 6;
/// Columns that are better sent again than left out: to address what comes after them takes as many bytes.
const GAP: usize = 7;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ssd1306Error {
    /// No panel answers at either address; what the bus said.
    Absent(ErrorKind),
    /// The panel says that it has this controller, whose rows lie otherwise.
    Sh1107,
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
/// A panel that does not answer is absent: its frames are refused at once. It is probed once a second, so it may be plugged in at
/// any time. The probe also reads which controller it has, unless the build names one. The result of a frame is returned with a
/// later one.
///
/// A panel that lost power for a moment is dark, yet acknowledges. So every frame that leaves room in its tick sends again a part of
/// the picture, or one of the messages that wake the panel.
#[derive(Debug)]
pub struct Ssd1306<Bus> {
    pub bus: Bus,
    state: State,
    /// Where it is, or is looked for.
    address: u8,
    built_for: Option<Controller>,
    found: Option<Found>,
    /// What the panel's memory holds once all that was sent has arrived.
    memory: Bitmap,
    told: Result<(), Ssd1306Error>,
    /// Frames for which the bus has been busy.
    waiting: u32,
    /// The part that is sent again next.
    part: usize,
    /// Frames since they were last counted, and those of them that the bus has taken.
    counted: u32,
    shown: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    Absent { retry_in: u8 },
    Looking,
    Asking,
    Waking(Controller),
    Awake(Controller),
}

impl<Bus: PanelBus> Ssd1306<Bus> {
    /// Takes the bus, and the controller if that is not to be asked for; the panel is looked for with the first frame.
    pub fn new(bus: Bus, built_for: Option<Controller>) -> Self {
        let (state, address, memory, told) = (
            State::Absent { retry_in: 0 },
            ADDRESSES[0],
            Bitmap::BLACK,
            Ok(()),
        );
        Self {
            bus,
            state,
            address,
            built_for,
            found: None,
            memory,
            told,
            waiting: 0,
            part: 0,
            counted: 0,
            shown: 0,
        }
    }

    /// Sends the frame if the bus is free; whether it is.
    fn offer(&mut self, canvas: &Canvas) -> bool {
        let Some((outbox, sent)) = self.bus.outbox() else {
            self.waiting += 1;
            if self.waiting >= PATIENCE {
                self.bus.abort();
            }
            return false;
        };
        self.waiting = 0;
        let found = match (self.state, self.built_for, sent) {
            (State::Looking, Some(controller), Ok(())) => Some(Found {
                controller,
                by: By::Build,
            }),
            (State::Asking, _, Ok(())) => Some(Found::told(outbox.status)),
            (State::Asking, _, Err(ErrorKind::NoAcknowledge(_))) => Some(Found::SILENT),
            _ => None,
        };
        let (state, news) = self.state.after(&mut self.address, sent, found);
        // One that is refused is looked for again and again, and reported once.
        if found.is_some() && news.is_none_or(|told| told != self.told) {
            self.found = found;
        }
        self.state = state;
        if let Some(told) = news {
            (self.told, self.counted, self.shown) = (told, 0, 0);
        }
        outbox.address_to(self.address);
        match state {
            State::Absent { .. } => return true,
            State::Looking => outbox.put(COMMAND, OFF),
            State::Asking => {
                outbox.put(COMMAND, &[]);
                outbox.asks = true;
            }
            State::Waking(controller) => {
                self.memory = Bitmap::from(canvas);
                draw(outbox, controller, None, &self.memory);
                (0..2).for_each(|half| wake(outbox, controller, half));
            }
            State::Awake(controller) => {
                let frame = Bitmap::from(canvas);
                draw(outbox, controller, Some(&self.memory), &frame);
                self.memory = frame;
                if outbox.len() <= SHORT {
                    match self.part.checked_sub(PARTS) {
                        None => {
                            let (page, column) =
                                (self.part * PART / WIDTH, self.part * PART % WIDTH);
                            write(
                                outbox,
                                controller,
                                &self.memory,
                                page,
                                column..column + PART,
                            );
                        }
                        Some(half) => wake(outbox, controller, half),
                    }
                    self.part = (self.part + 1) % (PARTS + 2);
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
            self.told = if shown < self.counted {
                Err(Ssd1306Error::Slow { shown })
            } else {
                Ok(())
            };
            (self.counted, self.shown) = (0, 0);
        }
    }
}

impl State {
    /// The next state, given how the last messages fared and which panel was found by them, and what there is to report.
    fn after(
        self,
        address: &mut u8,
        sent: Sent,
        found: Option<Found>,
    ) -> (Self, Option<Result<(), Ssd1306Error>>) {
        let [first, second] = ADDRESSES;
        let absent = |error| (Self::Absent { retry_in: RETRY }, Some(Err(error)));
        match (self, sent, found) {
            (
                ..,
                Some(Found {
                    controller: Controller::Sh1107,
                    ..
                }),
            ) => absent(Ssd1306Error::Sh1107),
            (.., Some(Found { controller, .. })) => (Self::Waking(controller), None),
            (Self::Absent { retry_in: 0 }, ..) => {
                *address = first;
                (Self::Looking, None)
            }
            (Self::Absent { retry_in }, ..) => (
                Self::Absent {
                    retry_in: retry_in - 1,
                },
                None,
            ),
            (Self::Looking, Ok(()), _) => (Self::Asking, None),
            (Self::Looking, Err(ErrorKind::NoAcknowledge(_)), _) if *address == first => {
                *address = second;
                (self, None)
            }
            (Self::Waking(controller), Ok(()), _) => (Self::Awake(controller), Some(Ok(()))),
            (Self::Awake(_), Ok(()), _) => (self, None),
            (Self::Awake(_), Err(_), _) => absent(Ssd1306Error::Lost),
            (_, sent, _) => absent(Ssd1306Error::Absent(sent.err().unwrap_or(ErrorKind::Other))),
        }
    }
}

impl<Bus: PanelBus> Display for Ssd1306<Bus> {
    type Error = Ssd1306Error;

    fn flush(&mut self, canvas: &Canvas) -> Result<(), Ssd1306Error> {
        let is_shown = self.offer(canvas);
        if let State::Awake(_) = self.state {
            self.count(is_shown);
        }
        self.told
    }

    fn found(&mut self) -> Option<Found> {
        self.found.take()
    }
}

/// The first half of what wakes the panel, or the second, which switches it on.
fn wake(outbox: &mut Outbox, controller: Controller, half: usize) {
    if half == 0 {
        outbox.put(COMMAND, SETTINGS);
    } else {
        outbox.put(
            COMMAND,
            if controller == Controller::Sh1106 {
                SH1106
            } else {
                SSD1306
            },
        );
        outbox.put(COMMAND, ON);
    }
}

/// Puts what differs between the panel's memory and the frame into the outbox; all of it if the memory is not known.
fn draw(outbox: &mut Outbox, controller: Controller, memory: Option<&Bitmap>, frame: &Bitmap) {
    for (page, new) in frame.pages.iter().enumerate() {
        let old = memory.and_then(|memory| memory.pages.get(page));
        for columns in runs(|column| old.is_none_or(|old| old.get(column) != new.get(column))) {
            write(outbox, controller, frame, page, columns);
        }
    }
}

fn write(
    outbox: &mut Outbox,
    controller: Controller,
    frame: &Bitmap,
    page: usize,
    columns: Range<usize>,
) {
    let first = columns.start as u8
        + if controller == Controller::Sh1106 {
            SH1106_LEFT
        } else {
            0
        };
    outbox.put(
        COMMAND,
        &[0xB0 | page as u8, first & 0x0F, 0x10 | first >> 4],
    );
    outbox.put(
        DATA,
        frame
            .pages
            .get(page)
            .and_then(|page| page.get(columns))
            .unwrap_or_default(),
    );
}

/// The columns that differ, from the first to the last of each run; short gaps belong to it.
fn runs(differs: impl Fn(usize) -> bool) -> impl Iterator<Item = Range<usize>> {
    let mut columns = (0..WIDTH).filter(move |&column| differs(column)).peekable();
    from_fn(move || {
        let first = columns.next()?;
        let mut last = first;
        while let Some(next) = columns.next_if(|&next| next - last <= GAP) {
            last = next;
        }
        Some(first..last + 1)
    })
}
