//! A panel that holds the bus's data line low receives clock pulses until it releases the line.

use firmware::display::free_bus;

/// Two lines with a pull-up each, and a panel that holds the data line for some more bits.
#[derive(Debug)]
struct Wires {
    clock: bool,
    data: bool,
    held_for: u32,
    clocks: u32,
    stops: u32,
}

impl Wires {
    fn is_data_high(&self) -> bool {
        self.data && self.held_for == 0
    }

    fn drive(&mut self, clock: bool, data: bool) -> bool {
        if self.clock && !clock {
            self.clocks += 1;
            self.held_for = self.held_for.saturating_sub(1);
        }
        self.clock = clock;
        let before = self.is_data_high();
        self.data = data;
        assert!(
            !clock || !before || self.is_data_high(),
            "a start where a stop is due"
        );
        // A stop is a rise of the data line while the clock is high.
        self.stops += u32::from(clock && !before && self.is_data_high());
        self.is_data_high()
    }
}

#[test]
fn a_panel_is_clocked_until_it_releases_the_line_or_nine_bits_have_passed() {
    // The stop takes a clock of its own. A free bus is left alone.
    let cases = (1..=9)
        .map(|bits| (bits, true, bits + 1, 1))
        .chain([(0, true, 0, 0), (u32::MAX, false, 9 + 1, 0)]);
    for (held_for, is_free, clocks, stops) in cases {
        let mut wires = Wires {
            clock: true,
            data: true,
            held_for,
            clocks: 0,
            stops: 0,
        };
        assert_eq!(
            free_bus(|clock, data| wires.drive(clock, data)),
            is_free,
            "{held_for}"
        );
        assert_eq!((wires.clocks, wires.stops), (clocks, stops), "{held_for}");
        assert!(wires.clock && wires.data, "both lines are let go");
    }
}
