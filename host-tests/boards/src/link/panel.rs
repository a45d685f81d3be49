//! The state of a board's panel in words, with the remedy.

use firmware::config::TICK_RATE;
use firmware::display::{BusFault, Controller, Found, PanelReport, PanelState};
use firmware::graphics::PanelName;

/// Returns the panel that the firmware is built for and its state, or `None` if the board reports
/// neither.
pub fn panel(report: &PanelReport) -> Option<String> {
    let line = match report.state {
        PanelState::Unknown if report.name == PanelName::Oled => return None,
        PanelState::Unknown => report.name.text().to_owned(),
        PanelState::Starting => "not found yet".to_owned(),
        PanelState::Absent(fault) => format!("absent: {}: {}", fault.name(), remedy(fault)),
        PanelState::Shown(found) => format!("{}, {}", identified(&found), frames(report)),
    };
    Some(format!("built for {}: {line}", report.name.name()))
}

fn identified(found: &Found) -> String {
    let Found {
        controller,
        by,
        status,
    } = found;
    let status = status.map_or(String::new(), |status| format!(" (status {status:#04x})"));
    let tried = if *controller == Controller::Sh1107 {
        "; only panels of 128 x 128 are supported"
    } else {
        ""
    };
    format!("{} {}{status}{tried}", controller.name(), by.name())
}

fn frames(report: &PanelReport) -> String {
    let shown = report.shown;
    match u32::from(shown) {
        0 => "frame rate not known yet".to_owned(),
        TICK_RATE => format!("{shown} frames/s"),
        _ => format!(
            "{shown} of {TICK_RATE} frames/s, as many as the bus carries; more with 2.2 kOhm from \
             SCL and SDA to 3.3 V and short wires"
        ),
    }
}

fn remedy(fault: BusFault) -> &'static str {
    match fault {
        BusFault::NoAnswer => {
            "check the wiring; some modules do not acknowledge because SDAout is not connected"
        }
        BusFault::Disturbed => "remove other devices from the bus; check SDA for a short circuit",
        BusFault::Stuck => {
            "check SCL and SDA for a short circuit, and their resistors to 3.3 V: 4.7 kOhm or less"
        }
    }
}

/// A panel that does not report its state counts as well.
pub fn is_well(report: &PanelReport) -> bool {
    matches!(report.state, PanelState::Unknown | PanelState::Shown(_))
}

#[cfg(test)]
mod tests {
    use firmware::display::By;

    use super::*;

    fn line(state: PanelState, shown: u8) -> String {
        let report = PanelReport {
            state,
            shown,
            ..PanelReport::default()
        };
        panel(&report).unwrap_or_default()
    }

    #[test]
    fn panel_is_reported_with_its_remedy() {
        assert_eq!(line(PanelState::Unknown, 0), "");
        let colour = PanelReport {
            name: PanelName::Lcd13,
            ..PanelReport::default()
        };
        assert_eq!(
            panel(&colour).as_deref(),
            Some("built for lcd-1.3: Waveshare Pico-LCD-1.3, 240 x 240")
        );
        assert_eq!(
            line(PanelState::Absent(BusFault::NoAnswer), 0),
            "built for oled: absent: no answer at 0x3C and 0x3D: check the wiring; some modules do not acknowledge \
             because SDAout is not connected"
        );
        let found = Found {
            controller: Controller::Sh1106,
            by: By::Memory,
            status: Some(0x48),
        };
        assert_eq!(
            line(PanelState::Shown(found), 60),
            "built for oled: sh1106 by reading its memory back (status 0x48), 60 frames/s"
        );
        let slow = line(PanelState::Shown(found), 30);
        assert!(slow.contains("30 of 60 frames/s, as many as"), "{slow}");
    }
}
