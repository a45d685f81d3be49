//! A panel that holds the bus's data line low is clocked until it lets go.

use std::cell::RefCell;

use firmware::display::free_bus;

use crate::bench::Pin;

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

/// Whether the bus came free, and the wires after it; with the waits that there were.
fn freed(held_for: u32) -> (bool, Wires, u32) {
    let wires = Wires::new(held_for);
    let mut waits = 0;
    let mut clock = Pin(|high| wires.borrow_mut().set_clock(high), ());
    let mut data = Pin(|high| wires.borrow_mut().set_data(high), || wires.borrow().is_high());
    let is_free = free_bus(&mut clock, &mut data, || waits += 1);
    (is_free, wires.into_inner(), waits)
}

#[test]
fn a_panel_in_the_middle_of_a_byte_is_clocked_to_its_end_and_stopped() {
    let (is_free, wires, waits) = freed(0);
    assert_eq!((is_free, wires.clocks, wires.stops, waits), (true, 0, 0, 0), "a free bus is left alone");
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
