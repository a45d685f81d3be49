//! Which port: the one named, or the one that a board is on by its USB id.

use serialport::{SerialPortInfo, SerialPortType};

/// The word that stands for whichever port a board is on.
pub const AUTO: &str = "auto";

/// USB ids, vendor and product, of what a board's serial link comes in by; no product: any of the vendor's.
const ADAPTERS: [(u16, Option<u16>, &str); 9] = [
    (0x16c0, Some(0x27dd), "Raspberry Pi Pico that plays"),
    (0x0403, None, "FTDI adapter"),
    (0x10c4, Some(0xea60), "CP210x adapter"),
    (0x1a86, None, "CH34x adapter"),
    (0x067b, None, "PL2303 adapter"),
    (0x0483, None, "ST-LINK"),
    (0x1366, None, "J-Link"),
    (0x0d28, Some(0x0204), "CMSIS-DAP probe"),
    (0x2e8a, None, "Raspberry Pi probe"),
];

/// Why no port can be chosen.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoPort {
    /// None.
    #[error("{AUTO}: no USB serial adapter is plugged in; name the port, as in --port /dev/ttyUSB0")]
    None,
    /// More than one.
    #[error("{AUTO}: there are several, name one: {0}")]
    Several(String),
}

/// The port that `name` means.
pub fn find(name: &str) -> Result<String, NoPort> {
    if name != AUTO {
        return Ok(name.to_owned());
    }
    choose(&serialport::available_ports().unwrap_or_default())
}

/// The only one of `ports` that a board may be on.
fn choose(ports: &[SerialPortInfo]) -> Result<String, NoPort> {
    let known = |port: &SerialPortInfo| {
        let SerialPortType::UsbPort(usb) = &port.port_type else { return None };
        let is_it =
            |vendor, product: Option<u16>| usb.vid == vendor && product.is_none_or(|product| usb.pid == product);
        let (.., kind) = ADAPTERS.into_iter().find(|(vendor, product, _)| is_it(*vendor, *product))?;
        Some((port.port_name.clone(), kind))
    };
    match &ports.iter().filter_map(known).collect::<Vec<_>>()[..] {
        [] => Err(NoPort::None),
        [(name, _)] => Ok(name.clone()),
        several => {
            let named: Vec<_> = several.iter().map(|(name, kind)| format!("{name} ({kind})")).collect();
            Err(NoPort::Several(named.join(", ")))
        }
    }
}

#[cfg(test)]
mod tests {
    use serialport::UsbPortInfo;

    use super::*;

    fn usb(name: &str, vid: u16, pid: u16) -> SerialPortInfo {
        let usb = UsbPortInfo { vid, pid, serial_number: None, manufacturer: None, product: None };
        SerialPortInfo { port_name: name.to_owned(), port_type: SerialPortType::UsbPort(usb) }
    }

    #[test]
    fn the_one_adapter_that_is_plugged_in_is_taken() {
        let modem = usb("/dev/ttyACM3", 0x1199, 0x9071);
        let built_in = SerialPortInfo { port_name: "/dev/ttyS0".to_owned(), port_type: SerialPortType::Unknown };
        let [ftdi, st_link] = [usb("/dev/ttyUSB0", 0x0403, 0x6001), usb("/dev/ttyACM0", 0x0483, 0x374b)];
        assert_eq!(choose(&[modem.clone(), built_in.clone()]), Err(NoPort::None));
        assert_eq!(choose(&[modem, built_in, ftdi.clone()]), Ok("/dev/ttyUSB0".to_owned()));
        let several = "/dev/ttyUSB0 (FTDI adapter), /dev/ttyACM0 (ST-LINK)".to_owned();
        assert_eq!(choose(&[ftdi, st_link]), Err(NoPort::Several(several)));
    }
}
