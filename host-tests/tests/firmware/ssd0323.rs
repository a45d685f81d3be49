//! The panel's driver against a controller that is stricter than the real one; QEMU's shows every scene (test `boards scenes`).

use std::cell::RefCell;
use std::collections::VecDeque;
use std::convert::Infallible;

use embedded_hal::digital::{self, OutputPin};
use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};
use firmware::display::{Display, Ssd0323};
use firmware::graphics::Canvas;

/// How many arguments a command takes, from the data sheet's command table.
fn arguments(command: u8) -> usize {
    match command {
        0x84..=0x86 | 0xA4 | 0xAE | 0xAF => 0,
        0x81 | 0xA0..=0xA2 | 0xA8 | 0xAD | 0xB1..=0xB3 | 0xBC | 0xBE | 0xBF => 1,
        0x15 | 0x75 => 2,
        0xB8 => 8,
        _ => panic!("{command:#04x} is no command"),
    }
}

/// An SSD0323: panics on anything that the data sheet does not allow.
#[derive(Default)]
struct Controller {
    /// The data/command pin, unknown until driven.
    data: Option<bool>,
    columns: Option<(u8, u8)>,
    rows: Option<(u8, u8)>,
    at: (u8, u8),
    memory: Vec<Option<u8>>,
    on: bool,
    /// Bytes and commands taken since the last look.
    received: usize,
    /// Writes taken until the bus fails.
    fails_after: Option<usize>,
}

impl Controller {
    fn new() -> Self {
        Self { memory: vec![None; 64 * 64], ..Self::default() }
    }

    fn receive(&mut self, bytes: &[u8]) {
        self.received += bytes.len();
        match self.data.expect("data or command must be chosen first") {
            false => self.commands(&mut bytes.iter().copied().collect()),
            true => bytes.iter().for_each(|&byte| self.store(byte)),
        }
    }

    fn commands(&mut self, bytes: &mut VecDeque<u8>) {
        while let Some(command) = bytes.pop_front() {
            let mut arguments = bytes.drain(..arguments(command));
            match command {
                0x15 => {
                    let columns = window(&mut arguments, 63);
                    (self.columns, self.at.0) = (Some(columns), columns.0);
                }
                0x75 => {
                    let rows = window(&mut arguments, 63);
                    (self.rows, self.at.1) = (Some(rows), rows.0);
                }
                0xAE => self.on = false,
                0xAF => {
                    assert!(self.memory.iter().all(Option::is_some), "switched on with noise in memory");
                    self.on = true;
                }
                _ => {}
            }
        }
    }

    /// Along the row, then to the next; beyond the last row is an error here.
    fn store(&mut self, byte: u8) {
        let ((first, last), (_, last_row)) = (self.columns.expect("columns first"), self.rows.expect("rows first"));
        let (column, row) = self.at;
        assert!(row <= last_row, "more data than the window holds");
        self.memory[usize::from(row) * 64 + usize::from(column)] = Some(byte);
        self.at = if column == last { (first, row + 1) } else { (column + 1, row) };
    }
}

fn window(arguments: &mut impl Iterator<Item = u8>, most: u8) -> (u8, u8) {
    let (first, last) = (arguments.next().expect("first"), arguments.next().expect("last"));
    assert!(first <= last && last <= most);
    (first, last)
}

const BUS_ERROR: ErrorKind = ErrorKind::Other;

struct Bus<'a>(&'a RefCell<Controller>);

impl ErrorType for Bus<'_> {
    type Error = ErrorKind;
}

impl SpiDevice for Bus<'_> {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        let mut controller = self.0.borrow_mut();
        for operation in operations {
            match controller.fails_after.as_mut() {
                Some(0) => return Err(BUS_ERROR),
                Some(left) => *left -= 1,
                None => {}
            }
            match operation {
                Operation::Write(bytes) => controller.receive(bytes),
                other => panic!("the panel has no data to give: {other:?}"),
            }
        }
        Ok(())
    }
}

/// The pin for data (high) or command.
struct Pin<'a>(&'a RefCell<Controller>);

impl digital::ErrorType for Pin<'_> {
    type Error = Infallible;
}

impl OutputPin for Pin<'_> {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.borrow_mut().data = Some(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.borrow_mut().data = Some(true);
        Ok(())
    }
}

fn panel<'a>(controller: &'a RefCell<Controller>, memory: &'a mut Canvas) -> Ssd0323<'a, Bus<'a>, Pin<'a>> {
    Ssd0323::new(Bus(controller), Pin(controller), memory)
}

fn shown(controller: &RefCell<Controller>) -> Vec<u8> {
    controller.borrow().memory.iter().map(|byte| byte.expect("written")).collect()
}

#[test]
fn switches_on_with_a_black_frame() {
    let controller = RefCell::new(Controller::new());
    panel(&controller, &mut Canvas::default()).init().expect("the bus works");
    assert!(controller.borrow().on);
    assert_eq!(shown(&controller), [0; 4096]);
}

#[test]
fn hands_on_the_error_of_the_bus() {
    let controller = RefCell::new(Controller { fails_after: Some(0), ..Controller::new() });
    let mut memory = Canvas::default();
    let mut panel = panel(&controller, &mut memory);
    assert_eq!(panel.init(), Err(BUS_ERROR));
    assert_eq!(panel.flush(&Canvas::default()), Err(BUS_ERROR));
}

/// What has not changed is not sent: of a row the words between two that have changed are. A row below one that was sent needs
/// no address of its own.
#[test]
fn sends_what_has_changed() {
    let (controller, mut memory, mut canvas) = (RefCell::new(Controller::new()), Canvas::default(), Canvas::default());
    let mut panel = panel(&controller, &mut memory);
    panel.init().expect("the bus works");
    let mut sent = |canvas: &Canvas| {
        controller.borrow_mut().received = 0;
        panel.flush(canvas).expect("the bus works");
        assert_eq!(shown(&controller), canvas.bytes().collect::<Vec<_>>());
        controller.borrow().received
    };
    assert_eq!(sent(&canvas), 0);
    canvas.update(127, 63, |_| 9);
    assert_eq!(sent(&canvas), 6 + 4);
    canvas.update(8, 3, |_| 1);
    canvas.update(31, 3, |_| 1);
    canvas.update(0, 4, |_| 1);
    canvas.update(5, 6, |_| 1);
    assert_eq!(sent(&canvas), 6 + 12 + 3 + 4 + 6 + 4);
    assert_eq!(sent(&canvas), 0);
}

/// A bus that fails in the middle of a frame leaves who knows what in the panel: the next frame is sent whole.
#[test]
fn shows_the_frame_after_one_that_failed() {
    let (controller, mut memory, mut canvas) = (RefCell::new(Controller::new()), Canvas::default(), Canvas::default());
    let mut panel = panel(&controller, &mut memory);
    panel.init().expect("the bus works");
    (0..64).for_each(|y| canvas.update(y, y, |_| 15));
    controller.borrow_mut().fails_after = Some(21);
    assert_eq!(panel.flush(&canvas), Err(BUS_ERROR));
    *controller.borrow_mut() = Controller { memory: vec![Some(7); 64 * 64], ..Controller::new() };
    assert_eq!(panel.flush(&canvas), Ok(()));
    assert_eq!(shown(&controller), canvas.bytes().collect::<Vec<_>>());
}
