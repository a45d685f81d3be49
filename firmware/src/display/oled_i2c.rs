//! A 128 x 64 OLED panel in one colour on I2C, with an SSD1306, SSD1309, SH1106 or SH1107.
//!
//! A whole picture takes 1,080 bytes, 24 ms at the bus's 400 kHz and longer than a tick. So only
//! columns that have changed are sent, and the program never waits for the bus:
//!
//! - A frame that needs more bytes than the bus carries in a tick is sent in part. The part that is
//!   left over comes first in the next frame. The speed of the bus is measured.
//! - A frame that comes while the bus is still busy is sent when the bus is free, unless the next
//!   frame comes first.
//!
//! # How the controller is identified
//!
//! The SH1106 returns its memory over I2C; the SSD1306 does not. So a byte outside the picture is
//! written and read back, twice. The status byte is a hint only, because panels return almost any
//! value in it.
//!
//! # How a loss of power is detected
//!
//! A panel whose power fails for less than a tick is dark, yet acknowledges. The status byte is
//! read once a second, and a panel that reports its display as off is set up again. The first
//! answers show if the status byte reports this. If it does not, the driver repeats the settings
//! that a lit display accepts, and parts of the picture.
//!
//! Source: Solomon Systech, SSD1306 data sheet; Sino Wealth, SH1106 and SH1107 data sheets; the
//! FlashFloppy firmware (`oled_probe_model`), for reading the memory back.

use core::fmt;

use embedded_hal::i2c::ErrorKind;

use super::bus::{Outbox, PanelBus, Sent};
use super::{BusFault, By, Controller, Display, Found, PanelReport, PanelState};
use crate::config::TICK_RATE;
use crate::graphics::{Bitmap, Canvas, Format, PAGES};

const WIDTH: usize = Format::OLED.width as usize;
const HEIGHT: usize = Format::OLED.height as usize;

/// The two addresses that a panel can be set to.
const ADDRESSES: [u8; 2] = [0x3C, 0x3D];
/// The first byte of a message of commands and their arguments.
const COMMAND: u8 = 0x00;
/// The first byte of a message of data for the memory.
const DATA: u8 = 0x40;
/// The first byte of a message of one command, after which the next control byte follows.
const ONE_COMMAND: u8 = 0x80;
/// The control byte of one data byte, written or read.
const ONE_DATA: u8 = 0xC0;

const OFF: &[u8] = &[0xAE];
const ON: &[u8] = &[0xAF];
/// Selects page 0 and column 0. On an SH1106 this is outside the picture; on the others the next
/// frame overwrites it.
const CORNER: &[u8] = &[0xB0, 0x10, 0x00];
/// The status bit that is set while the display is off. Data sheets define no other bit.
const DISPLAY_OFF: u8 = 1 << 6;

/// The differences between controllers.
struct Profile {
    /// The number of columns of the memory to the left of the panel's first column.
    left: u8,
    /// The commands that are sent once, while the display is off.
    settings: &'static [u8],
    /// The settings that may be repeated while the display is on.
    repeated: &'static [u8],
}

/// Returns the profile of a controller.
fn profile(controller: Controller) -> &'static Profile {
    match controller {
        Controller::Ssd1306 => &SSD1306,
        Controller::Sh1106 => &SH1106,
        Controller::Sh1107 => &SH1107,
    }
}

#[rustfmt::skip]
const SSD1306: Profile = Profile {
    left: 0,
    settings: &[
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
        0xA4,                      // show the memory
        0xA6,                      // not inverted
        0x8D, 0x14,                // charge pump on
        0x20, 0x02,                // data stays within the page
        0x2E,                      // no scrolling
    ],
    // Not the clock, the charge pump or the addressing mode, which a lit panel must not receive.
    repeated: &[
        0xA8, (HEIGHT - 1) as u8, 0xD3, 0, 0x40, 0xDA, 0x12, 0xA1, 0xC8,
        0xD9, 0x21, 0x81, 0x5F, 0xDB, 0x40, 0xA4, 0xA6, 0xAF,
    ],
};

#[rustfmt::skip]
const SH1106: Profile = Profile {
    left: 2, // of 132 columns
    settings: &[
        0xD5, 0x80,                // clock
        0xA8, (HEIGHT - 1) as u8,  // rows driven, less one
        0xD3, 0,                   // rows not shifted
        0x40,                      // first row shown
        0xDA, 0x12,                // wiring of the rows
        0xA1,                      // columns from the left
        0xC8,                      // rows from the top
        0xD9, 0x21,                // precharge, 1 and 2 clocks
        0x81, 0x5F,                // contrast, of 0xFF
        0xDB, 0x40,                // voltage of rows not driven
        0xA4,                      // show the memory
        0xA6,                      // not inverted
        0xAD, 0x8B,                // converter on: only while the display is off (data sheet)
    ],
    repeated: &[],
};

/// A panel of 128 x 128. Its upper half is used.
#[rustfmt::skip]
const SH1107: Profile = Profile {
    left: 0,
    settings: &[
        0xD5, 0x50,                // clock as after reset
        0xA8, 0x7F,                // rows driven, less one
        0xD3, 0,                   // rows not shifted
        0xDC, 0,                   // first row shown
        0x20,                      // data stays within the page
        0xA1,                      // columns from the left
        0xC8,                      // rows from the top
        0xD9, 0x22,                // precharge, 2 and 2 clocks
        0x81, 0x2F,                // contrast, of 0xFF
        0xDB, 0x35,                // voltage of rows not driven
        0xA4,                      // show the memory
        0xA6,                      // not inverted
    ],
    repeated: &[],
};

/// The number of frames between two searches for an absent panel, and between two readings of the
/// status byte: 1 s.
const SECOND: u8 = TICK_RATE as u8;
/// The number of frames after which a busy bus is considered to hang: 0.1 s, nearly three times the
/// time of a whole picture on a slow bus.
const PATIENCE: u32 = 6;
/// Values that turn a byte read from memory into the next byte to write: one for each round.
const PATTERN: [u8; 2] = [0x5A, 0xC6];

/// The number of columns in a part of the picture, for repetition.
const PART: usize = 16;
/// The number of parts of the picture. All are repeated within 1.1 s.
const PARTS: usize = PAGES * WIDTH / PART;
/// The number of bytes that address a run of columns: an address, a control byte and three commands
/// (the first selects the page), and an address and a control byte for the data.
const HEAD: usize = 7;
/// The same number for another run in a page that is already selected.
const NEXT_HEAD: usize = HEAD - 1;
/// The number of bytes on the bus for a reading of the status byte.
const CHECK: usize = 4;
/// The longest distance between two changed columns of one run. The unchanged columns between them,
/// one fewer, take fewer bytes than another address.
const GAP: usize = NEXT_HEAD;

/// The reason why the panel does not show the frames, or not all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OledError {
    /// The search or the set-up has failed with this error of the bus. If that is
    /// [`ErrorKind::NoAcknowledge`], no panel answers at either address, 0x3C or 0x3D, or a panel
    /// answers no longer. It is tried again after a second.
    Absent(ErrorKind),
    /// The panel showed frames earlier, but the bus has failed since, as when the panel does not
    /// answer; the search begins again after a second. Or the panel lost its power, and the search
    /// begins again at once.
    Lost,
    /// The bus is too slow: of the last 60 frames ([`TICK_RATE`]) at least one was left out. The
    /// panel shows the others.
    Slow {
        /// The number of frames, of the last [`TICK_RATE`], that were sent to the panel, whole or
        /// in part.
        shown: u32,
    },
}

impl fmt::Display for OledError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Absent(error) => write!(f, "absent: {}", BusFault::from(error).name()),
            Self::Lost => f.write_str("it no longer answers, or it lost its power"),
            Self::Slow { shown } => write!(
                f,
                "the bus is slow: {shown} of {TICK_RATE} frames were sent; \
                 use resistors of 2.2 to 4.7 kOhm and short wires"
            ),
        }
    }
}

/// Driver for a panel that may be absent or plugged in later.
///
/// The driver looks for an absent panel once a second, and returns an error for its frames at once.
/// The bus sends a frame after [`flush`](Display::flush) has returned, so that an error is returned
/// with a later frame, and then with every frame until it is over. The result before the first
/// search has ended is `Ok`. No function waits for the bus. If six frames in a row find it busy,
/// 0.1 s, the transfer is aborted, and the panel counts as lost or absent.
#[derive(Debug)]
pub struct OledI2c<'a, Bus> {
    /// The bus of the panel.
    pub bus: Bus,
    state: State,
    /// The address of the panel, or the address that is being tried.
    address: u8,
    chosen: Option<Controller>,
    found: Option<Found>,
    /// The picture in the panel's memory after everything sent has arrived.
    memory: &'a mut Bitmap,
    /// The first page of the next frame: the first page that did not fit into this one.
    page: usize,
    /// The number of bytes that the bus carries in a tick.
    room: Room,
    result: Result<(), OledError>,
    /// The number of frames in a row that found the bus busy.
    waiting: u32,
    /// True while the last frame waits for the bus.
    is_owed: bool,
    /// The number of frames until the status byte is read.
    check_in: u8,
    /// The part that is repeated next.
    part: usize,
    counted: Count,
    /// The counts of the last whole second.
    counts: Count,
}

/// Counts of the frames since the panel shows them, and of the frames sent in part or whole.
#[derive(Clone, Copy, Debug, Default)]
struct Count {
    frames: u32,
    shown: u32,
    whole: u32,
}

/// The state of the search for the panel.
#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    /// The search begins after this number of frames.
    Absent { retry_in: u8 },
    /// The display is being switched off at the current address.
    Looking,
    /// The status byte is being read.
    Asking,
    /// The memory is being read. The round before has written `expected` to it.
    Probing {
        status: u8,
        round: usize,
        expected: u8,
    },
    /// Settings and the first picture are being sent.
    Waking(Found),
    /// The panel shows the frames.
    Awake(Found, Watch),
}

/// The detection of a loss of power of the panel.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Watch {
    /// The status byte has correctly reported the display as off. It has not yet reported it as on.
    Unproven,
    /// The status byte reports whether the display is on.
    Status,
    /// The status byte has reported the display as off once.
    Suspect,
    /// The status byte is useless, so the settings are repeated.
    Blind,
}

/// The outcome of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Offer {
    /// The bus was busy until the next frame came.
    Skipped,
    /// A part did not fit.
    InPart,
    /// All changes were sent, or there was nothing to send.
    Whole,
}

/// The number of bytes that the bus carries in a tick, minus 1/32 because the time between frames
/// varies.
#[derive(Clone, Copy, Debug)]
struct Room(usize);

impl Room {
    /// The time for a frame, us.
    const TIME: u32 = 1_000_000 / TICK_RATE * 31 / 32;
    /// The room of a bus that has not been measured yet. A byte takes 34 us with pull-ups of 10
    /// kOhm.
    const FIRST: Self = Self((Self::TIME / 34) as usize);
    /// The limits of the room, bytes; the upper one is a whole picture.
    const LEAST: usize = 128;
    const MOST: usize = PAGES * (HEAD + WIDTH);
    /// The shortest transfer that is measured, bytes.
    const MEASURED: usize = 64;

    /// Learns from a transfer. The room shrinks at once and grows gradually.
    fn measure(&mut self, outbox: &Outbox) {
        let bytes = outbox.len();
        if outbox.took == 0 || bytes < Self::MEASURED {
            return;
        }

        // The time that this transfer has taken, scaled to a tick.
        let room = bytes as u32 * Self::TIME / outbox.took;
        let room = (room as usize).clamp(Self::LEAST, Self::MOST);
        self.0 = room.min(self.0 + room.saturating_sub(self.0).div_ceil(8));
    }
}

impl<'a, Bus: PanelBus> OledI2c<'a, Bus> {
    /// Creates a driver with a place to remember the picture, whose contents do not matter. The
    /// panel is driven as the controller `chosen`, which is identified if it is `None`. Nothing is
    /// sent yet: the search for the panel begins with the first frame.
    pub fn new(bus: Bus, memory: &'a mut Bitmap, chosen: Option<Controller>) -> Self {
        Self {
            bus,
            state: State::Absent { retry_in: 0 },
            address: ADDRESSES[0],
            chosen,
            found: None,
            memory,
            page: 0,
            room: Room::FIRST,
            result: Ok(()),
            waiting: 0,
            is_owed: false,
            check_in: SECOND,
            part: 0,
            counted: Count::default(),
            counts: Count::default(),
        }
    }

    /// Takes the outcome of the last messages, and sends the frame, a part of it, or the messages
    /// of the search. Returns `None`, and does nothing, if the bus is busy.
    ///
    /// A frame that is late is sent in a shorter part, so that the next one is not late as well.
    fn offer(&mut self, canvas: &Canvas, is_late: bool) -> Option<Offer> {
        let (outbox, sent) = self.bus.outbox()?;
        self.waiting = 0;
        if sent.is_ok() {
            self.room.measure(outbox);
        }

        // Choose the next state by the outcome of the last messages.
        let answer = outbox.answered();
        let (state, news) = self
            .state
            .after(&mut self.address, self.chosen, sent, answer);
        if let (State::Waking(found), false) = (state, state == self.state) {
            self.found = Some(found);
        }
        self.state = state;
        if let Some(result) = news {
            self.result = result;
            self.counted = Count::default();
            self.counts = Count::default();
            self.check_in = SECOND;
        }

        // Put the messages of this state into the outbox.
        outbox.address_to(self.address);
        let mut offer = Offer::Whole;
        match state {
            State::Absent { .. } => return Some(offer),
            State::Looking => outbox.put(COMMAND, OFF),
            State::Asking => {
                outbox.put(COMMAND, &[]);
                outbox.ask(1);
            }
            State::Probing {
                round, expected, ..
            } => probe(outbox, round, expected),
            // The settings, the whole picture, and the command that switches the display on.
            State::Waking(Found { controller, .. }) => {
                let profile = profile(controller);
                outbox.put(COMMAND, profile.settings);
                *self.memory = Bitmap::from(canvas);
                for (page, columns) in self.memory.pages.iter().enumerate() {
                    put_columns(outbox, Some(page), profile.left, columns);
                }
                outbox.put(COMMAND, ON);
                self.page = 0;
            }
            // The changed columns, a part that is repeated, and perhaps a reading of the status
            // byte.
            State::Awake(Found { controller, .. }, watch) => {
                let profile = profile(controller);
                let frame = Bitmap::from(canvas);
                let checks = checks(watch, &mut self.check_in);
                let late = if is_late { self.room.0 / 4 } else { 0 };
                let room = self.room.0 - late - if checks { CHECK } else { 0 };
                let left_over = draw(outbox, profile.left, self.memory, &frame, self.page, room);
                self.page = left_over.unwrap_or(0);
                if left_over.is_some() {
                    offer = Offer::InPart;
                }
                self.part = repeat(outbox, profile, watch, self.memory, self.part, room);
                if checks {
                    outbox.put(COMMAND, &[]);
                    outbox.ask(1);
                }
            }
        }

        // The interrupts of the bus do the rest.
        if !outbox.is_empty() {
            self.bus.send();
        }
        Some(offer)
    }

    /// Counts a frame that was shown or skipped, if the panel shows the frames. After each
    /// [`TICK_RATE`] of them, the result says if all were sent.
    fn count(&mut self, offer: Offer) {
        if !matches!(self.state, State::Awake(..)) {
            return;
        }

        self.counted.frames += 1;
        self.counted.shown += u32::from(offer != Offer::Skipped);
        self.counted.whole += u32::from(offer == Offer::Whole);

        if self.counted.frames >= TICK_RATE {
            let shown = self.counted.shown;
            self.result = if shown < self.counted.frames {
                Err(OledError::Slow { shown })
            } else {
                Ok(())
            };
            self.counts = core::mem::take(&mut self.counted);
        }
    }
}

impl State {
    /// Returns the next state, given the outcome of the last messages, and the result to return for
    /// the frames from now on; `None` if that stays. May change the address to try.
    fn after(
        self,
        address: &mut u8,
        chosen: Option<Controller>,
        sent: Sent,
        answer: &[u8],
    ) -> (Self, Option<Result<(), OledError>>) {
        let [first, second] = ADDRESSES;
        let absent = |error| (Self::Absent { retry_in: SECOND }, Some(Err(error)));
        let wake = |controller, by, status| {
            let found = Found {
                controller,
                by,
                status,
            };
            (Self::Waking(found), None)
        };
        let unanswered = matches!(sent, Err(ErrorKind::NoAcknowledge(_)));

        // Each group of arms is a step of the search.
        match (self, sent, answer) {
            (Self::Absent { retry_in: 0 }, ..) => {
                *address = first;
                (Self::Looking, None)
            }
            (Self::Absent { retry_in }, ..) => {
                let retry_in = retry_in - 1;
                (Self::Absent { retry_in }, None)
            }

            (Self::Looking, Ok(()), _) => (Self::Asking, None),
            (Self::Looking, ..) if unanswered && *address == first => {
                *address = second;
                (self, None)
            }

            (Self::Asking, Ok(()), &[status, ..]) => match chosen {
                Some(controller) => wake(controller, By::Choice, Some(status)),
                None => {
                    let round = 0;
                    let expected = 0;
                    let probing = Self::Probing {
                        status,
                        round,
                        expected,
                    };
                    (probing, None)
                }
            },
            (Self::Asking, ..) if unanswered => match chosen {
                Some(controller) => wake(controller, By::Choice, None),
                None => wake(Controller::Ssd1306, By::Silence, None),
            },

            // The first byte read is a dummy byte.
            (
                Self::Probing {
                    status,
                    round,
                    expected,
                },
                Ok(()),
                &[_, byte],
            ) => {
                if round > 0 && byte != expected {
                    wake(Controller::Ssd1306, By::Memory, Some(status))
                } else if let Some(pattern) = PATTERN.get(round) {
                    let probing = Self::Probing {
                        status,
                        round: round + 1,
                        expected: byte ^ pattern,
                    };
                    (probing, None)
                } else {
                    wake(with_memory(status), By::Memory, Some(status))
                }
            }
            (Self::Probing { status, .. }, ..) if unanswered => {
                wake(by_status(status), By::Status, Some(status))
            }

            (Self::Waking(found), Ok(()), _) => {
                let reports_off = found.status.is_some_and(|status| status & DISPLAY_OFF != 0);
                let watch = if reports_off {
                    Watch::Unproven
                } else {
                    Watch::Blind
                };
                (Self::Awake(found, watch), Some(Ok(())))
            }

            (Self::Awake(found, watch), Ok(()), answer) => match watch.after(answer) {
                Some(watch) => (Self::Awake(found, watch), None),
                None => {
                    *address = first;
                    (Self::Looking, Some(Err(OledError::Lost)))
                }
            },
            (Self::Awake(..), Err(_), _) => absent(OledError::Lost),

            (_, sent, _) => absent(OledError::Absent(sent.err().unwrap_or(ErrorKind::Other))),
        }
    }
}

impl Watch {
    /// Returns the next state after an answer, or the same state without one. Returns `None` if the
    /// panel has lost its power.
    fn after(self, answer: &[u8]) -> Option<Self> {
        let Some(status) = answer.first() else {
            return Some(self);
        };
        let is_off = status & DISPLAY_OFF != 0;
        match (self, is_off) {
            (Self::Blind, _) | (Self::Unproven, true) => Some(Self::Blind),
            (_, false) => Some(Self::Status),
            (Self::Status, true) => Some(Self::Suspect),
            (Self::Suspect, true) => None,
        }
    }
}

/// Returns the controller of a panel that returns its memory and this status.
fn with_memory(status: u8) -> Controller {
    // The lower six bits identify the SH1107; an SH1106 leaves them open.
    if status & 0x3F == 0x07 {
        Controller::Sh1107
    } else {
        Controller::Sh1106
    }
}

/// Returns the most likely controller of a panel, judged by its status byte alone.
fn by_status(status: u8) -> Controller {
    if status & 0x0F == 0x08 {
        Controller::Sh1106
    } else {
        Controller::Ssd1306
    }
}

impl<Bus: PanelBus> Display for OledI2c<'_, Bus> {
    type Error = OledError;

    /// Sends the changes, or keeps the frame for [`catch_up`](Display::catch_up) if the bus is
    /// busy, or continues the search. Returns the result of earlier frames.
    fn flush(&mut self, canvas: &Canvas) -> Result<(), OledError> {
        // A frame that still waits will never be sent.
        if core::mem::take(&mut self.is_owed) {
            self.count(Offer::Skipped);
        }
        match self.offer(canvas, false) {
            Some(offer) => self.count(offer),
            None => {
                self.is_owed = true;
                self.waiting += 1;
                if self.waiting >= PATIENCE {
                    self.bus.abort();
                }
            }
        }
        self.result
    }

    fn catch_up(&mut self, canvas: &Canvas) -> bool {
        if self.is_owed
            && let Some(offer) = self.offer(canvas, true)
        {
            self.is_owed = false;
            self.count(offer);
        }
        self.is_owed
    }

    fn found(&mut self) -> Option<Found> {
        self.found.take()
    }

    fn report(&self) -> PanelReport {
        let state = match (self.state, self.result) {
            (State::Awake(found, _), _) => PanelState::Shown(found),
            (_, Err(OledError::Absent(error))) => PanelState::Absent(error.into()),
            (State::Absent { .. }, Err(_)) => PanelState::Absent(BusFault::NoAnswer),
            _ => PanelState::Starting,
        };
        PanelReport {
            state,
            chosen: self.chosen,
            shown: self.counts.shown as u8,
            whole: self.counts.whole as u8,
        }
    }

    /// Always returns true. From the next frame on the panel is searched for and set up again;
    /// until that ends, the result of [`flush`](Display::flush) stays, except that
    /// [`OledError::Slow`] becomes `Ok`. The frames are counted anew.
    fn choose(&mut self, chosen: Option<Controller>) -> bool {
        self.chosen = chosen;
        if let Err(OledError::Slow { .. }) = self.result {
            self.result = Ok(());
        }
        self.counted = Count::default();
        self.counts = Count::default();
        // The next frame begins the search and the set-up.
        self.state = State::Absent { retry_in: 0 };
        true
    }
}

/// Reads a byte of the memory. After the first round, it first writes the expected byte.
fn probe(outbox: &mut Outbox, round: usize, expected: u8) {
    outbox.put(COMMAND, CORNER);
    if round > 0 {
        outbox.put(ONE_COMMAND, &[0x00, ONE_DATA, expected]);
    }
    outbox.put(ONE_COMMAND, &[0x00, ONE_DATA]);
    outbox.ask(2);
}

/// Returns true if the status byte is to be read with this frame.
fn checks(watch: Watch, check_in: &mut u8) -> bool {
    match watch {
        Watch::Unproven | Watch::Suspect => true,
        Watch::Blind => false,
        Watch::Status => {
            *check_in = check_in.saturating_sub(1);
            let is_due = *check_in == 0;
            if is_due {
                *check_in = SECOND;
            }
            is_due
        }
    }
}

/// Appends the columns that differ between the panel's memory and the frame, and records them in
/// the memory, until the outbox has `room` bytes on the bus. Begins with page `first`, and
/// continues with page 0 after the last. Returns the first page that did not fit; `None` if all
/// did.
fn draw(
    outbox: &mut Outbox,
    left: u8,
    memory: &mut Bitmap,
    frame: &Bitmap,
    first: usize,
    room: usize,
) -> Option<usize> {
    for page in (first..PAGES).chain(0..first) {
        let old = memory.pages.get_mut(page)?;
        let new = frame.pages.get(page)?;
        let mut named = Some(page);
        let mut head = HEAD;
        let mut from = 0;
        // One run of differing columns for each round.
        while let Some((start, end)) = next_run(old, new, from) {
            let space = room.saturating_sub(outbox.len() + head);
            if space == 0 {
                return Some(page);
            }
            let end = end.min(start + space);
            let (Some(old), Some(new)) = (old.get_mut(start..end), new.get(start..end)) else {
                break;
            };
            put_columns(outbox, named.take(), left + start as u8, new);
            old.copy_from_slice(new);
            head = NEXT_HEAD;
            from = end;
        }
    }
    None
}

/// Returns the start and the end of the next run of differing columns, from column `from` on. Short
/// gaps ([`GAP`]) are part of a run.
fn next_run(old: &[u8; WIDTH], new: &[u8; WIDTH], from: usize) -> Option<(usize, usize)> {
    let mut differing = old
        .iter()
        .zip(new)
        .enumerate()
        .skip(from)
        .filter(|(_, (old, new))| old != new)
        .map(|(column, _)| column);
    let start = differing.next()?;
    // Extend the run over short gaps.
    let mut last = start;
    for column in differing {
        if column - last > GAP {
            break;
        }
        last = column;
    }
    Some((start, last + 1))
}

/// Appends a part of the picture as a repetition, or the settings after the last part, if there is
/// room. Returns the number of the next part.
fn repeat(
    outbox: &mut Outbox,
    profile: &Profile,
    watch: Watch,
    memory: &Bitmap,
    part: usize,
    room: usize,
) -> usize {
    let space = room.saturating_sub(outbox.len());
    if space < HEAD + PART {
        return part;
    }
    let page = part * PART / WIDTH;
    let column = part * PART % WIDTH;
    if let Some(columns) = memory
        .pages
        .get(page)
        .and_then(|page| page.get(column..column + PART))
    {
        put_columns(outbox, Some(page), profile.left + column as u8, columns);
        return part + 1;
    }

    // All parts are repeated, so the settings are next.
    if watch == Watch::Blind && !profile.repeated.is_empty() {
        outbox.put(COMMAND, profile.repeated);
    }
    0
}

/// Appends columns for the given page, or for the page that is already selected.
fn put_columns(outbox: &mut Outbox, page: Option<usize>, first: u8, columns: &[u8]) {
    let [low, high] = [first & 0x0F, 0x10 | first >> 4];
    match page {
        Some(page) => outbox.put(COMMAND, &[0xB0 | page as u8, low, high]),
        None => outbox.put(COMMAND, &[low, high]),
    }
    outbox.put(DATA, columns);
}

const _: () = assert!(PARTS < TICK_RATE as usize * 11 / 10);
