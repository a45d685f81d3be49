//! The parts that all panels share: the defaults of the drivers, names, errors, and the outbox.

use crate::bench::blank;
use embedded_hal::i2c::{ErrorKind, NoAcknowledgeSource};
use firmware::display::{BusFault, Controller, Display, NoDisplay, Outbox, PanelOptions};

#[test]
fn a_board_without_a_panel_owes_no_frame_and_refuses_a_choice() {
    let mut panel = NoDisplay;
    assert!(!panel.catch_up(&blank()));
    assert!(!panel.choose(PanelOptions::default()));
}

#[test]
fn the_build_names_a_controller_as_a_command_does() {
    for &controller in Controller::ALL {
        assert_eq!(Controller::named(controller.name()), Some(controller));
    }
    for other in ["", "SSD1306", "sh110", "sh11066"] {
        assert_eq!(Controller::named(other), None, "{other:?}");
    }
}

#[test]
fn errors_of_the_bus_have_three_causes() {
    for (error, fault) in [
        (
            ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address),
            BusFault::NoAnswer,
        ),
        (ErrorKind::ArbitrationLoss, BusFault::Disturbed),
        (ErrorKind::Bus, BusFault::Stuck),
        (ErrorKind::Overrun, BusFault::Stuck),
        (ErrorKind::Other, BusFault::Stuck),
    ] {
        assert_eq!(BusFault::from(error), fault, "{error:?}");
    }
}

#[test]
fn a_full_outbox_drops_a_message() {
    let body = [0; 254];
    for (last, fits) in [(102, true), (103, false)] {
        let mut outbox = Outbox::default();
        (0..4).for_each(|_| outbox.put(0x40, &body));
        outbox.put(0x40, &body[..last]);
        if fits {
            outbox.put(0x00, &[]);
        }
        let bytes = outbox.count();
        let expected = 4 * 255 + if fits { 1 + last } else { 0 };
        assert_eq!(bytes, expected, "{last}");
    }
}
