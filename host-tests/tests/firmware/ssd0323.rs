//! The panel's driver with a controller that is stricter than the real one. QEMU's panel shows
//! every scene (test `boards scenes`).

use std::cell::RefCell;
use std::convert::Infallible;

use crate::bench::{blank, places};
use embedded_hal::digital::{self, OutputPin};
use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};
use firmware::display::{Display, Memory, Ssd0323};
use firmware::graphics::Canvas;

fn arguments(command: u8) -> usize {
    match command {
        0x84..=0x86 | 0xA4 | 0xAE | 0xAF => 0,
        0x81 | 0xA0..=0xA2 | 0xA8 | 0xAD | 0xB1..=0xB3 | 0xBC | 0xBE | 0xBF => 1,
        0x15 | 0x75 => 2,
        0xB8 => 8,
        _ => panic!("{command:#04x} is no command"),
    }
}

/// An SSD0323 that panics on anything that the data sheet does not allow.
struct Controller {
    data: Option<bool>,
    columns: Option<(u8, u8)>,
    rows: Option<(u8, u8)>,
    at: (u8, u8),
    memory: Vec<Option<u8>>,
    on: bool,
    received: usize,
    fails_after: usize,
}

impl Controller {
    fn holding(byte: Option<u8>, fails_after: usize) -> Self {
        let memory = vec![byte; 64 * 64];
        Self {
            data: None,
            columns: None,
            rows: None,
            at: (0, 0),
            memory,
            on: false,
            received: 0,
            fails_after,
        }
    }

    fn commands(&mut self, mut bytes: &[u8]) {
        while let [command, rest @ ..] = bytes {
            let (arguments, rest) = rest.split_at(arguments(*command));
            match command {
                0x15 | 0x75 => {
                    let &[first, last] = arguments else {
                        panic!("a window has two ends")
                    };
                    assert!(first <= last && last <= 63);
                    // A window also moves the write position to its first column or row.
                    let is_column = *command == 0x15;
                    *(if is_column {
                        &mut self.columns
                    } else {
                        &mut self.rows
                    }) = Some((first, last));
                    *(if is_column {
                        &mut self.at.0
                    } else {
                        &mut self.at.1
                    }) = first;
                }
                0xAE => self.on = false,
                0xAF => {
                    assert!(
                        self.memory.iter().all(Option::is_some),
                        "switched on with noise in memory"
                    );
                    self.on = true;
                }
                _ => {}
            }
            bytes = rest;
        }
    }

    /// Beyond the last row is an error here.
    fn store(&mut self, byte: u8) {
        let (first, last) = self.columns.expect("columns first");
        let (_, last_row) = self.rows.expect("rows first");
        let (column, row) = self.at;
        assert!(row <= last_row, "more data than the window holds");
        self.memory[usize::from(row) * 64 + usize::from(column)] = Some(byte);
        self.at = if column == last {
            (first, row + 1)
        } else {
            (column + 1, row)
        };
    }

    fn shows(&self, canvas: &Canvas) -> bool {
        let greys: Vec<u8> = places()
            .map(|(x, y)| canvas.get(x, y).expect("inside"))
            .collect();
        let pairs = greys.chunks(2).map(|pair| Some(pair[0] << 4 | pair[1]));
        self.on && self.memory.iter().copied().eq(pairs)
    }
}

const BUS_ERROR: ErrorKind = ErrorKind::Other;

struct Wires<'a>(&'a RefCell<Controller>);

impl ErrorType for Wires<'_> {
    type Error = ErrorKind;
}

impl SpiDevice for Wires<'_> {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        let mut controller = self.0.borrow_mut();
        for operation in operations {
            let Operation::Write(bytes) = operation else {
                panic!("the panel has no data to give: {operation:?}")
            };
            controller.fails_after = controller.fails_after.checked_sub(1).ok_or(BUS_ERROR)?;
            controller.received += bytes.len();
            match controller
                .data
                .expect("data or command must be chosen first")
            {
                false => controller.commands(bytes),
                true => bytes.iter().for_each(|&byte| controller.store(byte)),
            }
        }
        Ok(())
    }
}

impl digital::ErrorType for Wires<'_> {
    type Error = Infallible;
}

impl OutputPin for Wires<'_> {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.borrow_mut().data = Some(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.borrow_mut().data = Some(true);
        Ok(())
    }
}

/// Up to two unchanged cells between two changed ones are sent, too.
#[test]
fn switches_on_with_a_black_frame_and_sends_what_has_changed() {
    let controller = RefCell::new(Controller::holding(None, usize::MAX));
    let mut canvas = blank();
    canvas.on_ink();
    let mut memory = Memory::UNKNOWN;
    let mut panel = Ssd0323::new(Wires(&controller), Wires(&controller), &mut memory);
    panel.init().expect("the bus works");
    canvas.settle();
    assert!(controller.borrow().shows(&canvas));

    for (changed, bytes) in [
        (&[][..], 0),
        (&[(127, 63)], 6 + 4),
        (&[(8, 3), (32, 3), (64, 3), (0, 4)], 6 + 16 + 6 + 4 + 6 + 4),
        (&[], 0),
    ] {
        changed
            .iter()
            .for_each(|&(x, y)| canvas.on_ink().update(x, y, |grey| grey + 9));
        canvas.on_clear_foreground();
        controller.borrow_mut().received = 0;
        panel.flush(&canvas).expect("the bus works");
        canvas.settle();
        assert!(controller.borrow().shows(&canvas));
        assert_eq!(controller.borrow().received, bytes);
    }
}

/// The contents of the panel are unknown after a failure in the middle of a frame.
#[test]
fn the_error_of_the_bus_is_returned_and_the_next_frame_is_sent_completely() {
    let controller = RefCell::new(Controller::holding(None, 0));
    let mut canvas = blank();
    canvas.on_ink();
    let mut memory = Memory::UNKNOWN;
    let mut panel = Ssd0323::new(Wires(&controller), Wires(&controller), &mut memory);
    assert_eq!(
        (panel.init(), panel.flush(&canvas)),
        (Err(BUS_ERROR), Err(BUS_ERROR))
    );

    controller.borrow_mut().fails_after = usize::MAX;
    panel.init().expect("the bus works");
    (0..64).for_each(|y| canvas.update(y, y, |_| 15));
    canvas.on_clear_foreground();
    controller.borrow_mut().fails_after = 21;
    assert_eq!(panel.flush(&canvas), Err(BUS_ERROR));
    canvas.touch_all();
    *controller.borrow_mut() = Controller {
        on: true,
        ..Controller::holding(Some(7), usize::MAX)
    };
    assert_eq!(panel.flush(&canvas), Ok(()));
    assert!(controller.borrow().shows(&canvas));
}
