//! The serial link to a board, emulated or real.

mod inbox;
mod panel;
mod port;

use firmware::protocol::{Cause, Restarted};
use serialport::{SerialPortInfo, SerialPortType, UsbPortInfo};

pub use inbox::{Counts, Inbox, refusal};
pub use panel::{is_well, panel};
pub use port::{BAUD_OF_BOOT_LOADER, Port, touch};

/// The name that selects the board with its own USB port, or else the only serial port over USB.
const AUTO: &str = "auto";

const MANUFACTURER: &str = "double-pendulum";
const PRODUCT: &str = "Double pendulum";

/// Returns the port of the only board that runs this firmware and has its own USB port. It is
/// recognised by its manufacturer and product, because its USB ids are shared with every device
/// that distinguishes itself by names (rule 7 of V-USB's `USB-IDs-for-free.txt`).
pub fn running_board(ports: &[SerialPortInfo]) -> Option<&str> {
    let is_it = |port: &&SerialPortInfo| {
        usb(port).is_some_and(|usb| {
            usb.manufacturer.as_deref() == Some(MANUFACTURER)
                && usb.product.as_deref() == Some(PRODUCT)
        })
    };
    match ports.iter().filter(is_it).collect::<Vec<_>>()[..] {
        [port] => Some(&port.port_name),
        _ => None,
    }
}

fn usb(port: &SerialPortInfo) -> Option<&UsbPortInfo> {
    match &port.port_type {
        SerialPortType::UsbPort(usb) => Some(usb),
        _ => None,
    }
}

fn choose(ports: &[SerialPortInfo]) -> Result<String, String> {
    if let Some(name) = running_board(ports) {
        return Ok(name.to_owned());
    }
    let over_usb = |port: &SerialPortInfo| {
        Some((
            port.port_name.clone(),
            usb(port)?
                .product
                .clone()
                .unwrap_or_else(|| "no name".to_owned()),
        ))
    };

    // Several ports are an error, because a guess could open another device.
    match &ports.iter().filter_map(over_usb).collect::<Vec<_>>()[..] {
        [] => Err(format!(
            "{AUTO}: no board and no serial adapter found on USB; plug the board in (a new Pico is \
             flashed by cargo pico), or name the port, as in --port /dev/ttyACM0"
        )),
        [(name, _)] => Ok(name.clone()),
        several => {
            let named: Vec<_> = several
                .iter()
                .map(|(name, product)| format!("{name} ({product})"))
                .collect();
            Err(format!(
                "{AUTO}: several were found; name one: {}",
                named.join(", ")
            ))
        }
    }
}

pub fn describe_restart(end: &Restarted) -> String {
    let place = match end.pc {
        0 => String::new(),
        pc => format!(", pc {pc:#010x}, lr {:#010x}", end.lr),
    };
    format!(
        "the board has restarted after a {} in {end}{place} (in a row: {})",
        end.cause.map_or("reset", Cause::name),
        end.restarts
    )
}

#[cfg(test)]
mod tests {
    use serialport::UsbPortInfo;

    use super::*;

    fn usb(name: &str, product: Option<&str>) -> SerialPortInfo {
        let product = product.map(str::to_owned);
        let usb = UsbPortInfo {
            vid: 0x16c0,
            pid: 0x27dd,
            serial_number: None,
            manufacturer: None,
            product,
        };
        SerialPortInfo {
            port_name: name.to_owned(),
            port_type: SerialPortType::UsbPort(usb),
        }
    }

    fn ours(name: &str) -> SerialPortInfo {
        let mut board = usb(name, Some(PRODUCT));
        if let SerialPortType::UsbPort(usb) = &mut board.port_type {
            usb.manufacturer = Some(MANUFACTURER.to_owned());
        }
        board
    }

    #[test]
    fn auto_prefers_our_board_and_otherwise_takes_the_only_port_over_usb() {
        let built_in = SerialPortInfo {
            port_name: "/dev/ttyS0".to_owned(),
            port_type: SerialPortType::Unknown,
        };
        let [probe, adapter] = [
            usb("/dev/ttyACM0", Some("Debug Probe")),
            usb("/dev/ttyUSB0", None),
        ];
        let none = choose(std::slice::from_ref(&built_in)).expect_err("a built-in port");
        assert!(none.contains("cargo pico") && none.contains("/dev/ttyACM0"));
        let only = [built_in, adapter.clone()];
        assert_eq!(choose(&only), Ok("/dev/ttyUSB0".to_owned()));
        let several = "auto: several were found; name one: /dev/ttyACM0 (Debug Probe), \
                       /dev/ttyUSB0 (no name)";
        let foreign = [probe.clone(), adapter.clone()];
        assert_eq!(choose(&foreign), Err(several.to_owned()));
        let with_ours = [probe, ours("/dev/ttyACM1"), adapter];
        assert_eq!(choose(&with_ours), Ok("/dev/ttyACM1".to_owned()));
    }

    #[test]
    fn a_running_board_is_known_by_its_names() {
        let board = ours("/dev/ttyACM0");
        assert_eq!(running_board(&[usb("/dev/ttyACM0", Some(PRODUCT))]), None);
        assert_eq!(
            running_board(std::slice::from_ref(&board)),
            Some("/dev/ttyACM0")
        );
        assert_eq!(running_board(&[board.clone(), board]), None, "which?");
    }
}
