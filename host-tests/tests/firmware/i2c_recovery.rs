//! A panel that holds the bus's data line low is clocked until it lets go.

use firmware::display::{Lines, free_bus};

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
    waits: u32,
}

impl Lines for Wires {
    fn set_clock(&mut self, high: bool) {
        if self.clock && !high {
            self.clocks += 1;
            self.held_for = self.held_for.saturating_sub(1);
        }
        self.clock = high;
    }

    fn set_data(&mut self, high: bool) {
        let before = self.is_data_high();
        self.data = high;
        if self.clock && before && !self.is_data_high() {
            panic!("a start where a stop is due");
        }
        self.stops += u32::from(self.clock && !before && self.is_data_high());
    }

    fn is_data_high(&mut self) -> bool {
        self.data && self.held_for == 0
    }

    fn wait(&mut self) {
        self.waits += 1;
    }
}

/// Whether the bus came free, and the wires after it.
fn freed(held_for: u32) -> (bool, Wires) {
    let mut wires = Wires { clock: true, data: true, held_for, clocks: 0, stops: 0, waits: 0 };
    (free_bus(&mut wires), wires)
}

#[test]
fn a_panel_in_the_middle_of_a_byte_is_clocked_to_its_end_and_stopped() {
    let (is_free, wires) = freed(0);
    assert_eq!((is_free, wires.clocks, wires.stops, wires.waits), (true, 0, 0, 0), "a free bus is left alone");
    for held_for in 1..=9 {
        let (is_free, wires) = freed(held_for);
        assert!(is_free, "{held_for}");
        // The stop takes a clock of its own.
        assert_eq!((wires.clocks, wires.stops), (held_for + 1, 1), "{held_for}");
        assert!(wires.waits >= 2 * wires.clocks, "a level lasts half a clock");
        assert!(wires.clock && wires.data, "both lines are let go");
    }
}

#[test]
fn a_panel_that_never_lets_go_is_given_up() {
    let (is_free, wires) = freed(u32::MAX);
    assert!(!is_free);
    assert_eq!((wires.clocks, wires.stops), (9 + 1, 0));
    assert!(wires.clock && wires.data, "both lines are let go");
}
