//! A panel that holds the bus's data line low is clocked until it lets go.

use std::cell::RefCell;
use std::convert::Infallible;

use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use firmware::display::i2c_recovery::free_bus;

/// Two lines with a pull-up each, and a panel that holds the data line for some more bits.
#[derive(Debug)]
struct Wires {
    clock: bool,
    /// What the board drives the data line to.
    data: bool,
    /// Clocks until the panel lets go.
    held_for: u32,
    clocks: u32,
    stops: u32,
}

impl Wires {
    fn new(held_for: u32) -> RefCell<Self> {
        RefCell::new(Self { clock: true, data: true, held_for, clocks: 0, stops: 0 })
    }

    fn is_high(&self) -> bool {
        self.data && self.held_for == 0
    }

    fn set_clock(&mut self, high: bool) {
        if self.clock && !high {
            self.clocks += 1;
            self.held_for = self.held_for.saturating_sub(1);
        }
        self.clock = high;
    }

    fn set_data(&mut self, high: bool) {
        let before = self.is_high();
        self.data = high;
        if self.clock && before && !self.is_high() {
            panic!("a start where a stop is due");
        }
        self.stops += u32::from(self.clock && !before && self.is_high());
    }
}

struct Clock<'a>(&'a RefCell<Wires>);
struct Data<'a>(&'a RefCell<Wires>);

impl ErrorType for Clock<'_> {
    type Error = Infallible;
}

impl ErrorType for Data<'_> {
    type Error = Infallible;
}

impl OutputPin for Clock<'_> {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.borrow_mut().set_clock(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.borrow_mut().set_clock(true);
        Ok(())
    }
}

impl OutputPin for Data<'_> {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.borrow_mut().set_data(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.borrow_mut().set_data(true);
        Ok(())
    }
}

impl InputPin for Data<'_> {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(self.0.borrow().is_high())
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(!self.0.borrow().is_high())
    }
}

/// Whether the bus came free, and the wires after it; with the waits that there were.
fn freed(held_for: u32) -> (bool, Wires, u32) {
    let wires = Wires::new(held_for);
    let mut waits = 0;
    let is_free = free_bus(&mut Clock(&wires), &mut Data(&wires), || waits += 1);
    (is_free, wires.into_inner(), waits)
}

#[test]
fn a_free_bus_is_left_alone() {
    let (is_free, wires, waits) = freed(0);
    assert!(is_free);
    assert_eq!((wires.clocks, wires.stops, waits), (0, 0, 0));
}

#[test]
fn a_panel_in_the_middle_of_a_byte_is_clocked_to_its_end_and_stopped() {
    for held_for in 1..=9 {
        let (is_free, wires, waits) = freed(held_for);
        assert!(is_free, "{held_for}");
        // The stop takes a clock of its own.
        assert_eq!((wires.clocks, wires.stops), (held_for + 1, 1), "{held_for}");
        assert!(waits >= 2 * wires.clocks, "a level lasts half a clock");
        assert!(wires.clock && wires.data, "both lines are let go");
    }
}

#[test]
fn a_panel_that_never_lets_go_is_given_up() {
    let (is_free, wires, _) = freed(u32::MAX);
    assert!(!is_free);
    assert_eq!((wires.clocks, wires.stops), (9 + 1, 0));
    assert!(wires.clock && wires.data, "both lines are let go");
}
