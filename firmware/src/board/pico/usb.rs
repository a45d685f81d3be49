//! The serial port at the USB socket (CDC-ACM): the same stream, for a host that has opened it. It never waits for the host: a
//! message that does not fit into the queue is dropped whole.

use cortex_m::asm::delay;
use cortex_m::singleton;
use heapless::Deque;
use rp2040_hal::clocks::UsbClock;
use rp2040_hal::pac::{RESETS, USBCTRL_DPRAM, USBCTRL_REGS};
use rp2040_hal::rom_data::reset_to_usb_boot;
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
/// The control endpoint's packet. With the library's 8 bytes a descriptor takes many packets, each
/// to be answered in time, and some hosts give up ("Set Address Failed", rp-rs/rp-hal#937).
const CONTROL_PACKET: u8 = 64;
/// The time for which the pull-up stays off at a start, processor cycles at 125 MHz: 12 ms.
///
/// A restart leaves the pull-up on (SYSRESETREQ resets the processors only; RP2040 data sheet,
/// 2.12), so the host goes on talking to an address that nobody has any more. A reset of the
/// controller disconnects, but for microseconds, and a hub may miss that: it reports changes when
/// it is asked, every few milliseconds.
const ABSENCE: u32 = 1_500_000;
/// The speed at which a host opens and closes the port to restart the chip in its boot loader.
const BOOT_LOADER_BAUD: u32 = 1200;
/// Interrupts in a row that leave something pending after which the interrupt is masked: each takes
/// some 8 us, so the main loop loses half a millisecond. In a sound connection one or two follow
/// each other at most, since a packet takes 50 us.
const MOST_FUTILE: u8 = 64;

struct Usb {
    device: UsbDevice<'static, UsbBus>,
    port: CdcAcmClass<'static, UsbBus>,
    leaving: Deque<u8, USB_QUEUE>,
    /// A program has the port open.
    is_open: bool,
    /// Interrupts in a row that left something pending.
    futile: u8,
}

static USB: Shared<Option<&'static mut Usb>> = Shared::new(None);

/// Begins to show the board to a host; `None` the second time.
pub(super) fn start(
    registers: USBCTRL_REGS,
    memory: USBCTRL_DPRAM,
    clock: UsbClock,
    resets: &mut RESETS,
) -> Option<()> {
    // The block's reset switches the pull-up off, and `UsbBus::new` leaves it so.
    resets.reset().modify(|_, w| w.usbctrl().set_bit());
    delay(ABSENCE);
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
        .max_packet_size_0(CONTROL_PACKET)
        .ok()?
        .build();
    let usb = singleton!(: Usb = Usb {
        device,
        port,
        leaving: Deque::new(),
        is_open: false,
        futile: 0,
    })?;
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

/// Does what the device's interrupt asks for; takes a packet only if there is room for it. Returns
/// true if the interrupt may stay on: there was room, and it does not come again and again in vain.
pub(super) fn poll(inbox: &mut Inbox) -> bool {
    let has_room = room(&inbox.received) >= PACKET;
    let is_served = with(|usb| {
        usb.device.poll(&mut [&mut usb.port]);
        usb.obey_speed();
        let mut packet = [0; PACKET];
        if has_room && let Ok(length) = usb.port.read_packet(&mut packet) {
            packet
                .into_iter()
                .take(length)
                .for_each(|byte| inbox.push(byte));
        }
        usb.pass_on();
        usb.futile = if is_pending() {
            usb.futile.saturating_add(1)
        } else {
            0
        };
        usb.futile < MOST_FUTILE
    });
    has_room && is_served != Some(false)
}

/// Returns true if the device asks for an interrupt, except for a reset of the bus, which lasts.
///
/// The libraries leave an unexpected packet to the control endpoint where it is until the next
/// request of the host: a data packet of a request that is longer than their buffer of 128 bytes,
/// or the data of one that the host has broken off.
fn is_pending() -> bool {
    // SAFETY: the register is only read; nothing else reads it for its side effects.
    let interrupts = unsafe { &*USBCTRL_REGS::ptr() }.ints().read();
    interrupts.bits() != 0 && interrupts.bus_reset().bit_is_clear()
}

impl Usb {
    /// Restarts the chip in its boot loader if the port was closed at the speed that asks for it.
    fn obey_speed(&mut self) {
        let was_open = core::mem::replace(&mut self.is_open, self.port.dtr());
        let is_asked = self.port.line_coding().data_rate() == BOOT_LOADER_BAUD;
        if was_open && !self.is_open && is_asked {
            // No pin shows its activity; it offers the drive and the interface of picotool.
            reset_to_usb_boot(0, 0);
        }
    }

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
