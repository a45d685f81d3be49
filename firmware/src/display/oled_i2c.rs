//! A 128 x 64 OLED panel in one colour on I2C, with an SSD1306, SSD1309, SH1106 or SH1107.
//!
//! A whole picture takes 1,080 bytes, 24 ms at the bus's 400 kHz and longer than a tick. So only
//! columns that have changed are sent, and the program never waits for the bus. A frame that comes
//! while the bus is still busy is sent when the bus is free, unless the next frame comes first.
//!
//! A panel is absent, or waking, or awake. After any error it is absent, and a second later it is
//! woken again. So a panel that is plugged in, or plugged in again, needs no special care.
//!
//! # How the controller is identified
//!
//! Cheap modules are sold without the name of their controller. The SH1106 and the SH1107 return
//! their memory over I2C; the SSD1306 does not. So while a panel wakes, a byte outside the picture
//! is written and read back, twice. The status byte distinguishes the SH1107 from the SH1106. It is
//! no help otherwise, because panels return almost any value in it.
//!
//! Source: Solomon Systech, SSD1306 data sheet; Sino Wealth, SH1106 and SH1107 data sheets; the
//! FlashFloppy firmware (`oled_probe_model`), for reading the memory back.

use core::fmt;

use embedded_hal::i2c::ErrorKind;

use super::bus::{Outbox, PanelBus, Sent};
use super::{BusFault, By, Controller, Display, Found, PanelOptions, PanelReport, PanelState};
use crate::config::TICK_RATE;
use crate::graphics::{Bitmap, Canvas, Format, PanelName};

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
const NOTHING: &[u8] = &[0xE3];
/// Columns from the left and rows from the top, and the same for a panel that is turned.
const UPRIGHT: &[u8] = &[0xA1, 0xC8];
const TURNED: &[u8] = &[0xA0, 0xC0];
/// Sets the contrast, which is allowed while the display is on.
const CONTRAST: u8 = 0x81;
/// The contrast of a dimmed panel.
const DIMMED: u8 = 0x01;
/// Selects page 0 and column 0. On an SH1106 this is outside the picture; on the others the next
/// frame overwrites it.
const CORNER: &[u8] = &[0xB0, 0x10, 0x00];
/// The differences between controllers.
struct Profile {
    /// The number of columns of the memory to the left of the panel's first column.
    left: u8,
    /// The contrast of a bright panel, of 0xFF.
    contrast: u8,
    /// The commands that are sent once, while the display is off.
    settings: &'static [u8],
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
    contrast: 0x5F,
    settings: &[
        0xD5, 0x80,                // clock as after reset, not divided
        0xA8, (HEIGHT - 1) as u8,  // rows driven, less one
        0xD3, 0,                   // rows not shifted
        0x40,                      // first row shown
        0xDA, 0x12,                // wiring of this panel's rows: odd and even apart
        0xD9, 0x21,                // precharge, 1 and 2 clocks
        0xDB, 0x40,                // voltage of rows not driven
        0xA4,                      // show the memory
        0xA6,                      // not inverted
        0x8D, 0x14,                // charge pump on
        0x20, 0x02,                // data stays within the page
        0x2E,                      // no scrolling
    ],
};

#[rustfmt::skip]
const SH1106: Profile = Profile {
    left: 2, // of 132 columns
    contrast: 0x5F,
    settings: &[
        0xD5, 0x80,                // clock
        0xA8, (HEIGHT - 1) as u8,  // rows driven, less one
        0xD3, 0,                   // rows not shifted
        0x40,                      // first row shown
        0xDA, 0x12,                // wiring of the rows
        0xD9, 0x21,                // precharge, 1 and 2 clocks
        0xDB, 0x40,                // voltage of rows not driven
        0xA4,                      // show the memory
        0xA6,                      // not inverted
        0xAD, 0x8B,                // converter on: only while the display is off (data sheet)
    ],
};

/// A panel of 128 x 128. Its upper half is used.
#[rustfmt::skip]
const SH1107: Profile = Profile {
    left: 0,
    contrast: 0x2F,
    settings: &[
        0xD5, 0x50,                // clock as after reset
        0xA8, 0x7F,                // rows driven, less one
        0xD3, 0,                   // rows not shifted
        0xDC, 0,                   // first row shown
        0x20,                      // data stays within the page
        0xD9, 0x22,                // precharge, 2 and 2 clocks
        0xDB, 0x35,                // voltage of rows not driven
        0xA4,                      // show the memory
        0xA6,                      // not inverted
    ],
};

/// The number of frames between two searches for an absent panel: 1 s.
const SECOND: u8 = TICK_RATE as u8;
/// The number of frames after which a busy bus is considered to hang: 0.1 s, nearly three times the
/// time of a whole picture on a slow bus.
const PATIENCE: u32 = 6;
/// Values that turn a byte read from memory into the next byte to write: one for each round.
const PATTERN: [u8; 2] = [0x5A, 0xC6];
/// The longest distance between two changed columns of one run. The unchanged columns between them,
/// one fewer, take fewer bytes than the six of another address.
const GAP: usize = 6;

/// The panel is absent, for this reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OledError(pub BusFault);

impl fmt::Display for OledError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "absent: {}", self.0.name())
    }
}

/// Driver for a panel that may be absent or plugged in later.
///
/// The bus sends a frame after [`flush`](Display::flush) has returned, so that an error is returned
/// with a later frame, and then with every frame until the panel is awake. If six frames in a row
/// find the bus busy, 0.1 s, the transfer is aborted, which is an error.
#[derive(Debug)]
pub struct OledI2c<'a, Bus> {
    /// The bus of the panel.
    pub bus: Bus,
    state: State,
    /// The address of the panel, or the address that is being tried.
    address: u8,
    chosen: PanelOptions,
    found: Option<Found>,
    /// True if the panel is to be dimmed, and if it has been told so.
    is_dim: bool,
    was_dim: bool,
    /// The picture in the panel's memory after everything sent has arrived.
    memory: &'a mut Bitmap,
    result: Result<(), OledError>,
    /// The number of frames in a row that found the bus busy.
    waiting: u32,
    /// True while the last frame waits for the bus.
    is_owed: bool,
    counts: Counts,
}

/// Counts of frames while the panel is awake.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    /// The frames of the present second, and those of them that were sent.
    frames: u32,
    sent: u32,
    /// The frames that were sent in the last whole second.
    shown: u32,
}

/// The state of the panel.
#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    /// The panel is woken after this number of frames.
    Absent { retry_in: u8 },
    /// The panel is identified and set up, with its display off.
    Waking(Step),
    /// The panel shows the frames.
    Awake(Found),
}

/// The messages that wake a panel.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Step {
    /// The display is switched off.
    Off,
    /// The status byte is read.
    Status,
    /// The memory is read. The round before has written `expected` to it.
    Memory {
        status: u8,
        round: usize,
        expected: u8,
    },
    /// The settings and the first picture are sent, and the display is switched on.
    Picture(Found),
}

impl<'a, Bus: PanelBus> OledI2c<'a, Bus> {
    /// Creates a driver with a place to remember the picture, whose contents do not matter. The
    /// panel is driven as this controller, which is identified if it is `None`.
    pub fn new(bus: Bus, memory: &'a mut Bitmap, controller: Option<Controller>) -> Self {
        Self {
            bus,
            state: State::Absent { retry_in: 0 },
            address: ADDRESSES[0],
            chosen: PanelOptions {
                controller,
                ..PanelOptions::default()
            },
            found: None,
            is_dim: false,
            was_dim: false,
            memory,
            result: Ok(()),
            waiting: 0,
            is_owed: false,
            counts: Counts::default(),
        }
    }

    /// Takes the outcome of the last messages, and sends the next ones. Returns false, and does
    /// nothing, if the bus is busy.
    fn offer(&mut self, canvas: &Canvas) -> bool {
        let Some((outbox, sent)) = self.bus.outbox() else {
            return false;
        };
        self.waiting = 0;

        // Choose the next state by the outcome of the last messages.
        let before = self.state;
        let next = before.after(
            &mut self.address,
            self.chosen.controller,
            sent,
            outbox.answered(),
        );
        self.state = next.unwrap_or(State::Absent { retry_in: SECOND });
        match (before, self.state) {
            (State::Waking(Step::Picture(found)), State::Awake(_)) => {
                self.found = Some(found);
                self.result = Ok(());
            }
            (State::Waking(_) | State::Awake(_), State::Absent { .. }) => {
                let fault = sent.err().unwrap_or(ErrorKind::Other);
                self.result = Err(OledError(fault.into()));
                self.counts = Counts::default();
            }
            _ => {}
        }

        outbox.address_to(self.address);
        let is_dim = self.is_dim && !self.chosen.stays_bright;
        match self.state {
            State::Absent { .. } => {}
            State::Waking(step) => step.put(outbox, self.chosen.is_turned, canvas, self.memory),
            State::Awake(Found { controller, .. }) => {
                let profile = profile(controller);
                draw(outbox, profile.left, self.memory, &Bitmap::from(canvas));
                if is_dim != self.was_dim {
                    let contrast = if is_dim { DIMMED } else { profile.contrast };
                    outbox.put(COMMAND, &[CONTRAST, contrast]);
                }
                // So the loss of a panel is noticed while the picture does not change.
                if outbox.is_empty() {
                    outbox.put(COMMAND, NOTHING);
                }
            }
        }
        // A panel that wakes is bright.
        self.was_dim = is_dim && matches!(self.state, State::Awake(_));
        // The interrupts of the bus do the rest.
        if !outbox.is_empty() {
            self.bus.send();
        }
        true
    }

    /// Counts a frame that was sent, or skipped because the bus was busy.
    fn count(&mut self, is_sent: bool) {
        if !matches!(self.state, State::Awake(_)) {
            return;
        }
        let counts = &mut self.counts;
        counts.frames += 1;
        counts.sent += u32::from(is_sent);
        if counts.frames >= TICK_RATE {
            *counts = Counts {
                shown: counts.sent,
                ..Counts::default()
            };
        }
    }
}

impl State {
    /// Returns the next state, given the outcome of the last messages; `None` after an error, which
    /// makes the panel absent. May change the address to try.
    fn after(
        self,
        address: &mut u8,
        chosen: Option<Controller>,
        sent: Sent,
        answer: &[u8],
    ) -> Option<Self> {
        let [first, second] = ADDRESSES;
        let unanswered = matches!(sent, Err(ErrorKind::NoAcknowledge(_)));
        match self {
            Self::Absent { retry_in: 0 } => {
                *address = first;
                Some(Self::Waking(Step::Off))
            }
            Self::Absent { retry_in } => Some(Self::Absent {
                retry_in: retry_in - 1,
            }),
            Self::Waking(Step::Off) if unanswered && *address == first => {
                *address = second;
                Some(self)
            }
            Self::Waking(Step::Status) if unanswered => {
                let controller = chosen.unwrap_or_default();
                Some(picture(controller, chosen, By::Silence, None))
            }
            Self::Waking(step) if sent.is_ok() => step.after(chosen, answer),
            Self::Awake(_) if sent.is_ok() => Some(self),
            Self::Waking(_) | Self::Awake(_) => None,
        }
    }
}

impl Step {
    /// Puts the messages of this step into the outbox.
    fn put(self, outbox: &mut Outbox, is_turned: bool, canvas: &Canvas, memory: &mut Bitmap) {
        match self {
            Self::Off => outbox.put(COMMAND, OFF),
            Self::Status => {
                outbox.put(COMMAND, &[]);
                outbox.ask(1);
            }
            Self::Memory {
                round, expected, ..
            } => probe(outbox, round, expected),
            Self::Picture(Found { controller, .. }) => {
                let profile = profile(controller);
                outbox.put(COMMAND, profile.settings);
                outbox.put(COMMAND, if is_turned { TURNED } else { UPRIGHT });
                outbox.put(COMMAND, &[CONTRAST, profile.contrast]);
                *memory = Bitmap::from(canvas);
                for (page, columns) in memory.pages.iter().enumerate() {
                    put_columns(outbox, Some(page), profile.left, columns);
                }
                outbox.put(COMMAND, ON);
            }
        }
    }

    /// Returns the state after these messages have arrived; `None` if the answer is incomplete.
    fn after(self, chosen: Option<Controller>, answer: &[u8]) -> Option<State> {
        match (self, answer) {
            (Self::Off, _) => Some(State::Waking(Self::Status)),
            (Self::Status, &[status, ..]) => Some(match chosen {
                Some(controller) => picture(controller, chosen, By::Choice, Some(status)),
                None => State::Waking(Self::Memory {
                    status,
                    round: 0,
                    expected: 0,
                }),
            }),
            // The first byte read is a dummy byte.
            (
                Self::Memory {
                    status,
                    round,
                    expected,
                },
                &[_, byte],
            ) => Some(if round > 0 && byte != expected {
                picture(Controller::Ssd1306, chosen, By::Memory, Some(status))
            } else if let Some(pattern) = PATTERN.get(round) {
                State::Waking(Self::Memory {
                    status,
                    round: round + 1,
                    expected: byte ^ pattern,
                })
            } else {
                picture(with_memory(status), chosen, By::Memory, Some(status))
            }),
            (Self::Picture(found), _) => Some(State::Awake(found)),
            _ => None,
        }
    }
}

/// Returns the state in which a panel of this controller gets its first picture. A chosen
/// controller is known by the choice, any other one `by` this.
fn picture(
    controller: Controller,
    chosen: Option<Controller>,
    by: By,
    status: Option<u8>,
) -> State {
    State::Waking(Step::Picture(Found {
        controller,
        by: chosen.map_or(by, |_| By::Choice),
        status,
    }))
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

impl<Bus: PanelBus> Display for OledI2c<'_, Bus> {
    type Error = OledError;

    /// Sends the changes, or keeps the frame for [`catch_up`](Display::catch_up) if the bus is
    /// busy, or continues to wake the panel. Returns the result of earlier frames.
    fn flush(&mut self, canvas: &Canvas) -> Result<(), OledError> {
        // A frame that still waits will never be sent.
        if core::mem::take(&mut self.is_owed) {
            self.count(false);
        }
        if self.offer(canvas) {
            self.count(true);
        } else {
            self.is_owed = true;
            self.waiting += 1;
            if self.waiting >= PATIENCE {
                self.bus.abort();
            }
        }
        self.result
    }

    fn catch_up(&mut self, canvas: &Canvas) -> bool {
        if self.is_owed && self.offer(canvas) {
            self.is_owed = false;
            self.count(true);
        }
        self.is_owed
    }

    fn found(&mut self) -> Option<Found> {
        self.found.take()
    }

    fn report(&self) -> PanelReport {
        let state = match (self.state, self.result) {
            (State::Awake(found), _) => PanelState::Shown(found),
            (_, Err(OledError(fault))) => PanelState::Absent(fault),
            _ => PanelState::Starting,
        };
        PanelReport {
            name: PanelName::Oled,
            state,
            chosen: self.chosen,
            shown: self.counts.shown as u8,
        }
    }

    fn choose(&mut self, chosen: PanelOptions) -> bool {
        self.chosen = chosen;
        // The next frame wakes the panel with these options.
        self.state = State::Absent { retry_in: 0 };
        self.counts = Counts::default();
        true
    }

    fn dim(&mut self, is_dim: bool) {
        self.is_dim = is_dim;
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

/// Appends the columns that differ between the panel's memory and the frame, and records the frame
/// in the memory.
fn draw(outbox: &mut Outbox, left: u8, memory: &mut Bitmap, frame: &Bitmap) {
    for (page, (old, new)) in memory.pages.iter_mut().zip(&frame.pages).enumerate() {
        let mut named = Some(page);
        let mut from = 0;
        while let Some((start, end)) = next_run(old, new, from) {
            let columns = new.get(start..end).unwrap_or_default();
            put_columns(outbox, named.take(), left + start as u8, columns);
            from = end;
        }
        *old = *new;
    }
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

/// Appends columns for the given page, or for the page that is already selected.
fn put_columns(outbox: &mut Outbox, page: Option<usize>, first: u8, columns: &[u8]) {
    let [low, high] = [first & 0x0F, 0x10 | first >> 4];
    match page {
        Some(page) => outbox.put(COMMAND, &[0xB0 | page as u8, low, high]),
        None => outbox.put(COMMAND, &[low, high]),
    }
    outbox.put(DATA, columns);
}
