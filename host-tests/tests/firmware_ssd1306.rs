//! The one-colour panel: its frame, and its driver against a controller that is stricter than the real one.

use std::cell::RefCell;

use embedded_hal::i2c::{ErrorKind, ErrorType, I2c, NoAcknowledgeSource, Operation};
use firmware::app::player::Player;
use firmware::config::TICK_RATE;
use firmware::display::{Display, Ssd1306, Ssd1306Error};
use firmware::graphics::bitmap::Bitmap;
use firmware::graphics::canvas::{Canvas, HEIGHT, WIDTH};
use firmware::graphics::frame_buffers::FrameBuffers;
use firmware::motion::settings::Settings;

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
    /// Bytes on the bus, with addresses.
    bytes: usize,
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
            bytes: 0,
        }
    }

    fn command(&mut self, bytes: &[u8]) {
        let (command, arguments) = bytes.split_first().expect("an empty command");
        if *command == 0xE3 {
            return;
        }
        let known = COMMANDS.iter().find(|(known, _)| known == command);
        let (_, count) = known.unwrap_or_else(|| panic!("unknown command {command:#04x}"));
        assert_eq!(arguments.len(), *count, "arguments of {command:#04x}");
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

    fn shows(&self, frame: &Bitmap) -> bool {
        self.on && self.memory.iter().copied().eq(frame.pages().as_flattened().iter().copied().map(Some))
    }
}

/// The controller's end of the bus.
struct Bus<'a>(&'a RefCell<Controller>);

impl ErrorType for Bus<'_> {
    type Error = ErrorKind;
}

impl I2c for Bus<'_> {
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), ErrorKind> {
        let mut controller = self.0.borrow_mut();
        let [Operation::Write(bytes)] = operations else { panic!("not one write") };
        controller.bytes += 1 + bytes.len();
        if !controller.plugged_in || address != controller.address {
            return Err(SILENCE);
        }
        match bytes {
            [0x00, command @ ..] => controller.command(command),
            [0x40, data @ ..] => data.iter().for_each(|byte| controller.data(*byte)),
            _ => panic!("neither commands nor data"),
        }
        Ok(())
    }
}

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
    let share = |grey: u8| {
        let mut canvas = Canvas::default();
        (0..HEIGHT as i32).for_each(|y| (0..WIDTH as i32).for_each(|x| canvas.update(x, y, |_| grey)));
        let bitmap = Bitmap::from(&canvas);
        bitmap.pages().as_flattened().iter().map(|byte| byte.count_ones()).sum::<u32>() as usize * 16 / (WIDTH * HEIGHT)
    };
    let shares: Vec<_> = (0..16).map(share).collect();
    assert_eq!(shares, [0, 0, 0, 3, 6, 8, 11, 14, 16, 16, 16, 16, 16, 16, 16, 16], "lit pixels of 16");
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

#[test]
fn the_panel_shows_each_picture_at_either_address() {
    for address in [0x3C, 0x3D] {
        let controller = RefCell::new(Controller::at(address));
        let mut panel = Ssd1306::new(Bus(&controller));
        panel.init().expect("it answers");
        assert!(controller.borrow().shows(&Bitmap::default()));
        for ticks in [0, 1, 2, 30, 31, 400] {
            panel.flush(&scene(ticks)).expect("it answers");
            assert!(controller.borrow().shows(&Bitmap::from(&scene(ticks))), "after {ticks} ticks, at {address:#04x}");
        }
    }
}

#[test]
fn a_picture_leaves_time_in_its_tick() {
    /// Bits that 400 kHz carry in half a tick.
    const HALF_A_TICK: usize = 400_000 / TICK_RATE as usize / 2;
    let controller = RefCell::new(Controller::at(0x3C));
    let mut panel = Ssd1306::new(Bus(&controller));
    panel.init().expect("it answers");
    panel.flush(&scene(0)).expect("it answers");
    for ticks in 1..300 {
        controller.borrow_mut().bytes = 0;
        panel.flush(&scene(ticks)).expect("it answers");
        assert!(
            9 * controller.borrow().bytes < HALF_A_TICK,
            "after {ticks} ticks: {} bytes",
            controller.borrow().bytes
        );
    }
}

#[test]
fn an_absent_panel_is_looked_for_once_a_second_and_may_come_and_go() {
    let controller = RefCell::new(Controller::at(0x3C));
    let plug = |plugged_in| *controller.borrow_mut() = Controller { plugged_in, ..Controller::at(0x3C) };
    plug(false);
    let mut panel = Ssd1306::new(Bus(&controller));
    let absent = Err(Ssd1306Error::Absent(SILENCE));
    assert_eq!(panel.init(), absent);
    let try_of_both_addresses = controller.borrow().bytes;
    for _ in 0..TICK_RATE {
        assert_eq!(panel.flush(&scene(1)), absent);
    }
    assert_eq!(controller.borrow().bytes, try_of_both_addresses, "no other try within the second");
    assert_eq!(panel.flush(&scene(1)), absent);
    assert_eq!(controller.borrow().bytes, 2 * try_of_both_addresses);

    plug(true);
    let shown = (0..=TICK_RATE).filter(|_| panel.flush(&scene(1)).is_ok()).count();
    assert_eq!(shown, 1, "within a second");
    assert!(controller.borrow().shows(&Bitmap::from(&scene(1))));

    plug(false);
    assert_eq!(panel.flush(&scene(2)), Err(Ssd1306Error::Lost));
}
