//! The parts that all panels share: names.

use firmware::display::Controller;

/// The build variable `PANEL` names a controller as a command does, and nothing else.
#[test]
fn the_build_names_a_controller_as_a_command_does() {
    for &controller in Controller::ALL {
        assert_eq!(Controller::named(controller.name()), Some(controller));
    }
    for other in ["", "SSD1306", "sh110", "sh11066"] {
        assert_eq!(Controller::named(other), None, "{other:?}");
    }
}
