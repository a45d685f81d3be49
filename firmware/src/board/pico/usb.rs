//! The serial port at the USB socket (CDC-ACM): the same stream, for a host that has opened it. It never waits for the host: a
//! message that does not fit into the queue is dropped whole.

use cortex_m::singleton;
use heapless::Deque;
use rp2040_hal::clocks::UsbClock;
use rp2040_hal::pac::{RESETS, USBCTRL_DPRAM, USBCTRL_REGS};
use rp2040_hal::usb::UsbBus;
use usb_device::bus::UsbBusAllocator;
use usb_device::device::{StringDescriptors, UsbDevice, UsbDeviceBuilder, UsbDeviceState, UsbVidPid};
use usbd_serial::{CdcAcmClass, USB_CLASS_CDC};

use crate::board::cortex_m::interrupt::Shared;
use crate::config::USB_QUEUE;

/// What anybody may use for a serial port (V-USB's shared ids). Without a serial number, as long as no program goes by them to find
/// the board (rule 7 of V-USB's `USB-IDs-for-free.txt`): none of ours does.
const IDS: UsbVidPid = UsbVidPid(0x16c0, 0x27dd);
pub(super) const PACKET: usize = 64;

struct Usb {
    device: UsbDevice<'static, UsbBus>,
    port: CdcAcmClass<'static, UsbBus>,
    leaving: Deque<u8, USB_QUEUE>,
    arrived: Deque<u8, PACKET>,
}

static USB: Shared<Option<&'static mut Usb>> = Shared::new(None);

/// Begins to show the board to a host; `None` the second time.
pub(super) fn start(
    registers: USBCTRL_REGS,
    memory: USBCTRL_DPRAM,
    clock: UsbClock,
    resets: &mut RESETS,
) -> Option<()> {
    let bus = UsbBus::new(registers, memory, clock, true, resets);
    let bus = singleton!(: UsbBusAllocator<UsbBus> = UsbBusAllocator::new(bus))?;
    let port = CdcAcmClass::new(bus, PACKET as u16);
    let names = StringDescriptors::default().manufacturer("double-pendulum").product("Double pendulum");
    let device = UsbDeviceBuilder::new(bus, IDS).strings(&[names]).ok()?.device_class(USB_CLASS_CDC).build();
    let usb = singleton!(: Usb = Usb { device, port, leaving: Deque::new(), arrived: Deque::new() })?;
    USB.with(|place| *place = Some(usb))
}

/// Does something with the device, undisturbed by its interrupt; `None` before the start.
fn with<T>(act: impl FnOnce(&mut Usb) -> T) -> Option<T> {
    USB.with(|usb| usb.as_deref_mut().map(act)).flatten()
}

/// Sends a message, if somebody listens and there is room for all of it.
#[inline(never)] // the libraries may panic, and the main loop may not (test `no_panic`)
pub(super) fn send(message: &[u8]) {
    with(|usb| usb.send(message));
}

/// Does what the device's interrupt asks for; takes a packet only if there is room for it.
pub(super) fn poll(has_room: bool) {
    with(|usb| usb.poll(has_room));
}

pub(super) fn take() -> Option<u8> {
    with(|usb| usb.arrived.pop_front()).flatten()
}

impl Usb {
    fn send(&mut self, message: &[u8]) {
        let is_heard = self.device.state() == UsbDeviceState::Configured && self.port.dtr();
        if !is_heard {
            self.leaving.clear();
        } else if self.leaving.capacity().saturating_sub(self.leaving.len()) >= message.len() {
            for byte in message {
                let _ = self.leaving.push_back(*byte);
            }
            self.pass_on();
        }
    }

    fn poll(&mut self, has_room: bool) {
        self.device.poll(&mut [&mut self.port]);
        let mut packet = [0; PACKET];
        if has_room
            && self.arrived.is_empty()
            && let Ok(length) = self.port.read_packet(&mut packet)
        {
            for byte in packet.into_iter().take(length) {
                let _ = self.arrived.push_back(byte);
            }
        }
        self.pass_on();
    }

    /// Gives the device its next packet, if it has sent the last. No packet is a full one: after that the host would wait for more.
    fn pass_on(&mut self) {
        let mut packet = [0; PACKET - 1];
        let length = packet.iter_mut().zip(&self.leaving).map(|(place, byte)| *place = *byte).count();
        if length > 0 && self.port.write_packet(packet.get(..length).unwrap_or_default()).is_ok() {
            for _ in 0..length {
                self.leaving.pop_front();
            }
        }
    }
}
