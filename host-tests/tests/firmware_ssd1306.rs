//! The one-colour panel: its frame, and its driver against a controller that is stricter than the real one.

use std::cell::RefCell;

use embedded_hal::i2c::{ErrorKind, NoAcknowledgeSource};
use fastrand::Rng;
use firmware::app::player::Player;
use firmware::config::{STM32F405, TICK_RATE};
use firmware::display::outbox::{Outbox, PanelBus, Sent};
use firmware::display::{Display, Ssd1306, Ssd1306Error};
use firmware::graphics::bitmap::Bitmap;
use firmware::graphics::canvas::{Canvas, HEIGHT, WIDTH};
use firmware::graphics::frame_buffers::FrameBuffers;
use firmware::motion::settings::Settings;
use firmware::scenes::SceneName;
use host_tests::emulator::host::Show;

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

/// Nobody answered.
const SILENCE: ErrorKind = ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address);
/// Bits that 400 kHz carry in a tick; a byte takes 9 with its acknowledgement, a start or stop 1.
const TICK: u32 = 400_000 / TICK_RATE;
const BYTE: u32 = 9;

/// An SSD1306 on a bus: panics on anything that the data sheet does not allow.
struct Controller {
    address: u8,
    plugged_in: bool,
    columns: (u8, u8),
    pages: (u8, u8),
    at: (u8, u8),
    memory: Vec<Option<u8>>,
    horizontal: bool,
    on: bool,
}

impl Controller {
    fn at(address: u8) -> Self {
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

    fn take(&mut self, message: &[u8]) {
        match message {
            [0x00, commands @ ..] => self.commands(commands),
            [0x40, data @ ..] => data.iter().for_each(|byte| self.data(*byte)),
            _ => panic!("neither commands nor data"),
        }
    }

    fn shows(&self, frame: &Bitmap) -> bool {
        self.on && self.memory.iter().copied().eq(frame.pages().as_flattened().iter().copied().map(Some))
    }
}

/// The bus as an interrupt drives it, and the panel at its end.
struct Line {
    panel: Controller,
    /// What is going out, and what has become of it.
    outgoing: Option<(Outbox, Option<Sent>)>,
    message: Vec<u8>,
    /// Bits there is time for.
    time: u32,
    /// Bits that the messages under way, or the last ones, have taken.
    taken: u32,
    /// Somebody holds the clock low.
    hangs: bool,
    freed: u32,
    /// Messages sent off in one go.
    sent: u32,
}

impl Line {
    fn to(panel: Controller) -> RefCell<Self> {
        let (outgoing, message) = (None, Vec::new());
        RefCell::new(Self { panel, outgoing, message, time: 0, taken: 0, hangs: false, freed: 0, sent: 0 })
    }

    /// Lets time pass, of so many bits.
    fn run(&mut self, bits: u32) {
        self.time = if self.hangs { 0 } else { self.time.saturating_add(bits) };
        while let Some((outbox, sent @ None)) = &mut self.outgoing {
            let needed = match (outbox.is_within_message(), outbox.is_empty()) {
                (true, _) => BYTE,
                (false, true) => 1,
                (false, false) => 1 + 2 * BYTE,
            };
            if self.time < needed {
                return;
            }
            self.time -= needed;
            self.taken += needed;
            if !self.panel.plugged_in || outbox.address() != self.panel.address {
                let source = if outbox.has_begun() { NoAcknowledgeSource::Data } else { NoAcknowledgeSource::Address };
                *sent = Some(Err(ErrorKind::NoAcknowledge(source)));
                self.message.clear();
            } else if let Some(byte) = outbox.next() {
                self.message.push(byte.value);
                if byte.ends_message {
                    self.panel.take(&self.message);
                    self.message.clear();
                }
            } else {
                *sent = Some(Ok(()));
            }
        }
        self.time = 0;
    }

    fn is_idle(&self) -> bool {
        !matches!(self.outgoing, Some((_, None)))
    }
}

/// The driver's end of the bus.
struct Bus<'a> {
    line: &'a RefCell<Line>,
    outbox: Option<Outbox>,
    sent: Sent,
}

impl<'a> Bus<'a> {
    fn new(line: &'a RefCell<Line>) -> Self {
        Self { line, outbox: Some(Outbox::new()), sent: Ok(()) }
    }
}

impl PanelBus for Bus<'_> {
    fn outbox(&mut self) -> Option<(&mut Outbox, Sent)> {
        let mut line = self.line.borrow_mut();
        if line.is_idle()
            && let Some((outbox, Some(sent))) = line.outgoing.take()
        {
            (self.outbox, self.sent) = (Some(outbox), sent);
        }
        self.outbox.as_mut().map(|outbox| (outbox, self.sent))
    }

    fn send(&mut self) {
        let mut line = self.line.borrow_mut();
        line.outgoing = Some((self.outbox.take().expect("sent once"), None));
        (line.taken, line.sent) = (0, line.sent + 1);
    }

    fn give_up(&mut self) {
        let mut line = self.line.borrow_mut();
        let (outbox, _) = line.outgoing.take().expect("something to give up");
        line.freed += 1;
        line.message.clear();
        (self.outbox, self.sent) = (Some(outbox), Err(ErrorKind::Other));
    }
}

/// As much time as any frame needs, with all that wakes the panel.
const LONG: u32 = 4 * TICK;

/// The application's first scene after some ticks.
fn scene(ticks: u32) -> Canvas {
    let FrameBuffers { mut canvas, mut ink } = FrameBuffers::default();
    let mut player = Player::new(Settings::default(), &mut ink).expect("the default settings are a pendulum");
    (0..ticks).for_each(|_| player.tick(|_| ()));
    player.draw(&mut canvas);
    canvas
}

#[test]
fn black_is_dark_and_the_upper_half_of_the_greys_is_solid() {
    let share = |grey: u8, all_greys: bool| {
        let mut canvas = Canvas::default();
        if all_greys {
            canvas.use_all_greys();
        }
        (0..HEIGHT as i32).for_each(|y| (0..WIDTH as i32).for_each(|x| canvas.update(x, y, |_| grey)));
        let bitmap = Bitmap::from(&canvas);
        bitmap.pages().as_flattened().iter().map(|byte| byte.count_ones()).sum::<u32>() as usize * 16 / (WIDTH * HEIGHT)
    };
    let shares: Vec<_> = (0..16).map(|grey| share(grey, false)).collect();
    assert_eq!(shares, [0, 0, 0, 3, 6, 8, 11, 14, 16, 16, 16, 16, 16, 16, 16, 16], "lit pixels of 16");
    let shares: Vec<_> = (0..16).map(|grey| share(grey, true)).collect();
    assert_eq!(shares, [0, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16], "lit pixels of 16 in a picture");
}

#[test]
fn every_pixel_is_in_its_place() {
    for (x, y) in [(0, 0), (127, 0), (0, 63), (127, 63), (5, 9), (64, 32)] {
        let mut canvas = Canvas::default();
        canvas.update(x, y, |_| 15);
        let bitmap = Bitmap::from(&canvas);
        let lit = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y))).filter(|&(x, y)| bitmap.is_lit(x, y));
        assert_eq!(lit.collect::<Vec<_>>(), [(x as usize, y as usize)]);
    }
}

/// A frame of these pixels.
fn pixels(mut is_lit: impl FnMut() -> bool) -> Canvas {
    let mut canvas = Canvas::default();
    let places = (0..HEIGHT as i32).flat_map(|y| (0..WIDTH as i32).map(move |x| (x, y)));
    places.filter(|_| is_lit()).for_each(|(x, y)| canvas.update(x, y, |_| 15));
    canvas
}

#[test]
fn the_panel_shows_each_picture_at_either_address() {
    let mut rng = Rng::with_seed(1);
    // Whole frames of noise, and a few pixels here and there.
    let noise = [2, 2, 1000, 300, 100, 30, 10, 3].map(|rarity| pixels(|| rng.u32(..rarity) == 0));
    let frames: Vec<_> = [0, 1, 2, 30, 31, 400].map(scene).into_iter().chain(noise).collect();
    for address in [0x3C, 0x3D] {
        let line = Line::to(Controller::at(address));
        let mut panel = Ssd1306::new(Bus::new(&line));
        for (number, frame) in frames.iter().enumerate() {
            // It is found by its first frame, at the second address by its second.
            for _ in 0..if number == 0 { 2 } else { 1 } {
                assert_eq!(panel.flush(frame), Ok(()));
                line.borrow_mut().run(LONG);
            }
            assert!(line.borrow().panel.shows(&Bitmap::from(frame)), "frame {number}, at {address:#04x}");
        }
    }
}

#[test]
fn what_has_not_changed_is_not_sent() {
    let line = Line::to(Controller::at(0x3C));
    let mut panel = Ssd1306::new(Bus::new(&line));
    let mut canvas = scene(30);
    for changed in [&[][..], &[], &[20], &[20, 90]] {
        changed.iter().for_each(|&x| canvas.update(x, 7, |grey| 15 - grey));
        assert_eq!(panel.flush(&canvas), Ok(()));
        line.borrow_mut().run(LONG);
    }
    assert_eq!(line.borrow().sent, 3, "the second frame was the first");
    // Twice an address, what follows, and the window; an address, what follows, and one byte; the stop.
    assert_eq!(line.borrow().taken, 2 * ((1 + 8 * BYTE) + (1 + 3 * BYTE)) + 1);
}

/// Frames of each scene: 5 s.
const FRAMES: u32 = 5 * TICK_RATE;

/// A frame is held back by nothing but the bus: by what the one before has left to send when it comes.
#[test]
fn as_many_frames_are_shown_as_the_bus_can_carry() {
    for &name in SceneName::ALL {
        let line = Line::to(Controller::at(0x3C));
        let mut panel = Ssd1306::new(Bus::new(&line));
        let mut scene = Show::on(STM32F405, name, &name.first_settings()).expect("a scene of the catalogue");
        assert_eq!(panel.flush(&scene.frame()), Ok(()));
        line.borrow_mut().run(LONG);
        let (mut shown, mut most, mut held) = (0, 0, Bitmap::from(&scene.frame()));
        for frame in 0..FRAMES {
            scene.tick();
            let canvas = scene.frame();
            let (was_idle, sent) = (line.borrow().is_idle(), line.borrow().sent);
            let _ = panel.flush(&canvas);
            if was_idle {
                assert!(line.borrow().panel.shows(&held), "{}, frame {frame}", name.name());
                (shown, held) = (shown + 1, Bitmap::from(&canvas));
            } else {
                assert_eq!(line.borrow().sent, sent, "{}, frame {frame} disturbs the one before", name.name());
            }
            line.borrow_mut().run(TICK);
            if line.borrow().sent != sent {
                most = most.max(line.borrow().taken);
            }
        }
        line.borrow_mut().run(LONG);
        assert!(line.borrow().panel.shows(&held), "{}", name.name());
        let rate = f64::from(shown * TICK_RATE) / f64::from(FRAMES);
        println!("{:12} {rate:.1} frames a second, {:.1} ms at most", name.name(), f64::from(most) / 400.0);
        assert_eq!(shown, FRAMES, "{}", name.name());
    }
}

#[test]
fn a_panel_whose_bus_is_too_slow_says_so() {
    let mut rng = Rng::with_seed(2);
    let line = Line::to(Controller::at(0x3C));
    let mut panel = Ssd1306::new(Bus::new(&line));
    let mut second = |is_noisy: bool| {
        let mut still = Canvas::default();
        let mut told: Vec<_> = (0..2 * TICK_RATE)
            .map(|_| {
                if is_noisy {
                    still = pixels(|| rng.bool());
                }
                let told = panel.flush(&still);
                line.borrow_mut().run(TICK);
                told
            })
            .collect();
        told.pop().expect("a frame")
    };
    assert_eq!(second(false), Ok(()));
    // A whole frame takes a tick and a half, and the next one comes after two.
    assert_eq!(second(true), Err(Ssd1306Error::Slow { shown: TICK_RATE / 2 }));
    assert_eq!(second(false), Ok(()));
}

#[test]
fn an_absent_panel_is_looked_for_once_a_second_and_may_come_and_go() {
    let line = Line::to(Controller { plugged_in: false, ..Controller::at(0x3C) });
    let plug = |plugged_in| line.borrow_mut().panel = Controller { plugged_in, ..Controller::at(0x3C) };
    let mut panel = Ssd1306::new(Bus::new(&line));
    let mut flush = |ticks| {
        let told = panel.flush(&scene(ticks));
        line.borrow_mut().run(TICK);
        told
    };
    let absent = Err(Ssd1306Error::Absent(SILENCE));
    assert_eq!(
        [flush(1), flush(1), flush(1)],
        [Ok(()), Ok(()), absent],
        "nobody at the first address, nor at the second"
    );
    for _ in 0..TICK_RATE {
        assert_eq!(flush(1), absent);
    }
    assert_eq!(line.borrow().sent, 2, "no other try within the second");
    assert_eq!(flush(1), absent);
    assert_eq!(line.borrow().sent, 3);

    plug(true);
    let told: Vec<_> = (0..TICK_RATE + 5).map(|_| flush(1)).collect();
    assert!(told.contains(&absent) && told.last() == Some(&Ok(())), "within a second");
    assert!(line.borrow().panel.shows(&Bitmap::from(&scene(1))));

    plug(false);
    assert_eq!([flush(2), flush(3)], [Ok(()), Err(Ssd1306Error::Lost)]);
    plug(true);
    let told: Vec<_> = (0..TICK_RATE + 5).map(|_| flush(4)).collect();
    assert!(told.contains(&Err(Ssd1306Error::Lost)) && told.last() == Some(&Ok(())));
    assert!(line.borrow().panel.shows(&Bitmap::from(&scene(4))));
}

#[test]
fn a_bus_that_hangs_holds_up_nothing_and_is_freed() {
    let line = Line::to(Controller::at(0x3C));
    let mut panel = Ssd1306::new(Bus::new(&line));
    let mut flush = |ticks| {
        let told = panel.flush(&scene(ticks));
        line.borrow_mut().run(TICK);
        told
    };
    (0..5).for_each(|ticks| assert_eq!(flush(ticks), Ok(())));
    line.borrow_mut().hangs = true;
    let told: Vec<_> = (5..20).map(&mut flush).collect();
    assert!(told.starts_with(&[Ok(()); 5]) && told.ends_with(&[Err(Ssd1306Error::Lost); 5]), "{told:?}");
    assert_eq!(line.borrow().freed, 1);
    // As long as it hangs it is freed once a second.
    for _ in 0..2 * TICK_RATE {
        let _ = flush(20);
    }
    assert_eq!((flush(20), line.borrow().freed), (Err(Ssd1306Error::Absent(ErrorKind::Other)), 2));
    line.borrow_mut().hangs = false;
    let told: Vec<_> = (0..TICK_RATE + 10).map(|_| flush(21)).collect();
    assert_eq!(told.last(), Some(&Ok(())));
    assert!(line.borrow().panel.shows(&Bitmap::from(&scene(21))));
}
