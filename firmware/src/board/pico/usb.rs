//! The serial port at the USB socket (CDC-ACM): the same stream, for a host that has opened it. It never waits for the host: a
//! message that does not fit into the queue is dropped whole.

use cortex_m::singleton;
use heapless::Deque;
use rp2040_hal::clocks::UsbClock;
use rp2040_hal::pac::{RESETS, USBCTRL_DPRAM, USBCTRL_REGS};
use rp2040_hal::usb::UsbBus;
use usb_device::bus::UsbBusAllocator;
use usb_device::device::{
    StringDescriptors, UsbDevice, UsbDeviceBuilder, UsbDeviceState, UsbVidPid,
};
use usbd_serial::{CdcAcmClass, USB_CLASS_CDC};

use crate::board::cortex_m::interrupt::Shared;
use crate::board::serial::Inbox;
use crate::config::USB_QUEUE;

/// What anybody may use for a serial port (V-USB's shared ids). Without a serial number, as long as no program goes by them to find
/// the board (rule 7 of V-USB's `USB-IDs-for-free.txt`): none of ours does.
const IDS: UsbVidPid = UsbVidPid(0x16c0, 0x27dd);
const PACKET: usize = 64;

struct Usb {
    device: UsbDevice<'static, UsbBus>,
    port: CdcAcmClass<'static, UsbBus>,
    leaving: Deque<u8, USB_QUEUE>,
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
    let names = StringDescriptors::default()
        .manufacturer("double-pendulum")
        .product("Double pendulum");
    let device = UsbDeviceBuilder::new(bus, IDS)
        .strings(&[names])
        .ok()?
        .device_class(USB_CLASS_CDC)
        .build();
    let usb = singleton!(: Usb = Usb { device, port, leaving: Deque::new() })?;
    USB.with(|place| *place = Some(usb))
}

/// Does something with the device, undisturbed by its interrupt; `None` before the start.
fn with<T>(act: impl FnOnce(&mut Usb) -> T) -> Option<T> {
    USB.with(|usb| usb.as_deref_mut().map(act)).flatten()
}

/// Sends a message, if somebody listens and there is room for all of it.
#[inline(never)] // the libraries may panic, and the main loop may not (test `no_panic`)
pub(super) fn send(message: &[u8]) {
    with(|usb| {
        let is_heard = usb.device.state() == UsbDeviceState::Configured && usb.port.dtr();
        if !is_heard {
            usb.leaving.clear();
        } else if put(&mut usb.leaving, message) {
            usb.pass_on();
        }
    });
}

/// Does what the device's interrupt asks for; takes a packet only if there is room for it, and says whether there is.
pub(super) fn poll(inbox: &mut Inbox) -> bool {
    let has_room = room(&inbox.received) >= PACKET;
    with(|usb| {
        usb.device.poll(&mut [&mut usb.port]);
        let mut packet = [0; PACKET];
        if has_room && let Ok(length) = usb.port.read_packet(&mut packet) {
            packet
                .into_iter()
                .take(length)
                .for_each(|byte| inbox.push(byte));
        }
        usb.pass_on();
    });
    has_room
}

impl Usb {
    /// Gives the device its next packet, if it has sent the last. No packet is a full one: after that the host would wait for more.
    fn pass_on(&mut self) {
        let mut packet = [0; PACKET - 1];
        let length = packet
            .iter_mut()
            .zip(&self.leaving)
            .map(|(place, byte)| *place = *byte)
            .count();
        if length > 0
            && self
                .port
                .write_packet(packet.get(..length).unwrap_or_default())
                .is_ok()
        {
            for _ in 0..length {
                self.leaving.pop_front();
            }
        }
    }
}

fn room<const N: usize>(queue: &Deque<u8, N>) -> usize {
    queue.capacity().saturating_sub(queue.len())
}

/// Puts a message into a queue if there is room for all of it; whether there was.
pub(super) fn put<const N: usize>(queue: &mut Deque<u8, N>, message: &[u8]) -> bool {
    room(queue) >= message.len() && message.iter().all(|byte| queue.push_back(*byte).is_ok())
}
