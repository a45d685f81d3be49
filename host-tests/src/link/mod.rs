//! The serial link to a board, emulated or real: bytes to messages, and the port that they come through, the one named or the only
//! one that is a USB device's.

mod inbox;
mod panel;
mod port;

use serialport::{SerialPortInfo, SerialPortType};

pub use inbox::{Counts, Inbox, refusal};
pub use panel::{is_well, panel};
pub use port::Port;

/// The word that stands for the only serial port over USB. Not the only one of some ids, for those of the Pico are lent to whoever
/// does not go by them.
const AUTO: &str = "auto";

fn choose(ports: &[SerialPortInfo]) -> Result<String, String> {
    let over_usb = |port: &SerialPortInfo| {
        let SerialPortType::UsbPort(usb) = &port.port_type else {
            return None;
        };
        Some((
            port.port_name.clone(),
            usb.product.clone().unwrap_or_else(|| "no name".to_owned()),
        ))
    };
    match &ports.iter().filter_map(over_usb).collect::<Vec<_>>()[..] {
        [] => Err(format!(
            "{AUTO}: no board and no serial adapter found on USB; name the port, as in --port /dev/ttyUSB0"
        )),
        [(name, _)] => Ok(name.clone()),
        several => {
            let named: Vec<_> = several
                .iter()
                .map(|(name, product)| format!("{name} ({product})"))
                .collect();
            Err(format!(
                "{AUTO}: there are several, name one: {}",
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
        assert!(choose(std::slice::from_ref(&built_in)).is_err());
        assert_eq!(
            choose(&[built_in, pico.clone()]),
            Ok("/dev/ttyACM0".to_owned())
        );
        let several =
            "auto: there are several, name one: /dev/ttyACM0 (Double pendulum), /dev/ttyUSB0 (no name)".to_owned();
        assert_eq!(choose(&[pico, other]), Err(several));
    }
}
