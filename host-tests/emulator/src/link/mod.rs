//! The serial link to a board, emulated or real: the decoding of bytes into messages, and the
//! serial port. The user names the port, or it is the only port of a USB device.

mod inbox;
mod panel;
mod port;
mod restarts;

use serialport::{SerialPortInfo, SerialPortType, UsbPortInfo};

pub use inbox::{Counts, Inbox, refusal};
pub use panel::{is_well, panel};
pub use port::{BAUD_OF_BOOT_LOADER, Port, touch};
pub use restarts::{Restarts, describe_restart};

/// The name that selects the only serial port over USB. The USB ids are not used, because the ids
/// of the Pico are shared with other devices, which only differ by their names.
const AUTO: &str = "auto";

/// The names in the USB descriptor of a board with its own USB port (`board/pico/usb.rs`).
const MANUFACTURER: &str = "double-pendulum";
const PRODUCT: &str = "Double pendulum";

/// Returns the name of the port of the only board that runs this firmware and has its own USB port,
/// without an adapter.
///
/// The board is recognised by its manufacturer and product, which must be exactly the firmware's,
/// because its USB ids are shared with every device that distinguishes itself by names (rule 7 of
/// V-USB's `USB-IDs-for-free.txt`). Returns `None` if no port has these names, or more than one.
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

/// Returns the USB description of a port, if it has one.
fn usb(port: &SerialPortInfo) -> Option<&UsbPortInfo> {
    match &port.port_type {
        SerialPortType::UsbPort(usb) => Some(usb),
        _ => None,
    }
}

/// A USB device that was at a port and may return under another name. Linux assigns a new name
/// while a program still has the old node open.
#[derive(Clone, Debug)]
struct Device {
    usb: UsbPortInfo,
    /// The other ports that existed when the device went.
    others: Vec<String>,
}

impl Device {
    /// Returns the device at the port `name` if it is a USB device.
    fn at(name: &str, ports: &[SerialPortInfo]) -> Option<Self> {
        let port = ports.iter().find(|port| port.port_name == name)?;
        Some(Self {
            usb: usb(port)?.clone(),
            others: Vec::new(),
        })
    }

    /// Stores the ports that exist while the device at `name` is absent.
    fn gone(&mut self, name: &str, ports: Vec<SerialPortInfo>) {
        let names = ports.into_iter().map(|port| port.port_name);
        self.others = names.filter(|other| other != name).collect();
    }

    /// Returns the port of the device after its return: the only new port with the same ids and
    /// names.
    fn back<'a>(&self, ports: &'a [SerialPortInfo]) -> Option<&'a str> {
        let is_it = |port: &&SerialPortInfo| {
            usb(port) == Some(&self.usb) && !self.others.contains(&port.port_name)
        };
        match ports.iter().filter(is_it).collect::<Vec<_>>()[..] {
            [port] => Some(&port.port_name),
            _ => None,
        }
    }
}

/// Returns the name of the only port over USB, or the reason in one line if it finds no port or
/// several.
fn choose(ports: &[SerialPortInfo]) -> Result<String, String> {
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
            "{AUTO}: no board and no serial adapter found on USB; name the port, as in --port \
             /dev/ttyUSB0"
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

    /// `auto` takes the only port over USB and ignores built-in ports. With none it is an error,
    /// and with two it is an error that names both.
    #[test]
    fn the_one_adapter_that_is_plugged_in_is_taken() {
        let built_in = SerialPortInfo {
            port_name: "/dev/ttyS0".to_owned(),
            port_type: SerialPortType::Unknown,
        };
        let [pico, other] = [
            usb("/dev/ttyACM0", Some("Double pendulum")),
            usb("/dev/ttyUSB0", None),
        ];
        // A built-in port is not taken, even if it is the only one.
        assert!(choose(std::slice::from_ref(&built_in)).is_err());
        assert_eq!(
            choose(&[built_in, pico.clone()]),
            Ok("/dev/ttyACM0".to_owned())
        );
        let several =
            "auto: several were found; name one: /dev/ttyACM0 (Double pendulum), /dev/ttyUSB0 (no \
             name)"
                .to_owned();
        assert_eq!(choose(&[pico, other]), Err(several));
    }

    /// A device is gone and returns, with its old or a new name. A twin that was there meanwhile,
    /// and a device with another name in its descriptor, are not taken for it.
    #[test]
    fn a_device_that_comes_back_is_found_under_its_new_name_and_no_other_is_taken_for_it() {
        let [old, new] = ["/dev/ttyACM0", "/dev/ttyACM1"].map(|name| usb(name, Some("Pico")));
        let [twin, foreign] = [
            usb("/dev/ttyACM2", Some("Pico")),
            usb("/dev/ttyACM3", Some("modem")),
        ];
        let mut device = Device::at("/dev/ttyACM0", &[old.clone(), twin.clone()]).expect("it is");

        // While the device is absent, neither its twin nor a foreign device is taken for it.
        device.gone("/dev/ttyACM0", vec![old.clone(), twin.clone()]);
        assert_eq!(device.back(&[twin.clone(), foreign.clone()]), None);
        // The device is back, under its old or under a new name.
        for back in [old, new] {
            let ports = [twin.clone(), foreign.clone(), back.clone()];
            assert_eq!(device.back(&ports), Some(&*back.port_name));
        }
    }

    /// A port is a running board only if both its manufacturer and its product are right. With two
    /// such ports there is no result.
    #[test]
    fn a_running_board_is_known_by_its_names() {
        let mut board = usb("/dev/ttyACM0", Some(PRODUCT));

        // The USB ids alone do not identify the board; both names must be right.
        assert_eq!(running_board(std::slice::from_ref(&board)), None);
        if let SerialPortType::UsbPort(usb) = &mut board.port_type {
            usb.manufacturer = Some(MANUFACTURER.to_owned());
        }

        // Two such boards are ambiguous.
        let ports = [usb("/dev/ttyUSB0", None), board.clone()];
        assert_eq!(running_board(&ports), Some("/dev/ttyACM0"));
        assert_eq!(running_board(&[board.clone(), board]), None, "which?");
    }
}
