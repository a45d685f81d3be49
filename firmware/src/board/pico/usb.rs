//! The serial port at the USB socket (CDC-ACM). It sends the same bytes as the UART to a host that
//! has opened it.
//!
//! It never waits for the host. A message that does not fit into the queue is dropped as a whole.

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

/// The USB ids, which are V-USB's shared ids for serial ports.
///
/// A serial number is not required, because no program of ours finds the board by its ids (rule 7
/// of V-USB's `USB-IDs-for-free.txt`).
const IDS: UsbVidPid = UsbVidPid(0x16c0, 0x27dd);
/// The size of a packet of data, bytes.
const PACKET: usize = 64;
/// The packet size of the control endpoint, bytes. With the library's 8 bytes a descriptor takes
/// many packets. Each must be answered in time, and some hosts give up ("Set Address Failed",
/// rp-rs/rp-hal#937).
const CONTROL_PACKET: u8 = 64;
/// The time without the pull-up at a start, processor cycles at 125 MHz: 12 ms.
///
/// A restart leaves the pull-up on (SYSRESETREQ resets the processors only; RP2040 data sheet,
/// 2.12). So the host would continue to use an address that the device no longer has. A reset of
/// the controller disconnects for microseconds only. A hub may miss that, because it reports
/// changes when it is polled, every few milliseconds.
const ABSENCE: u32 = 1_500_000;
/// The speed that requests the boot loader: a host opens and closes the port with it.
const BOOT_LOADER_BAUD: u32 = 1200;
/// The number of interrupts in a row with something still pending, but no reset of the bus, after
/// which the interrupt is masked. Each takes some 8 us, so that the main loop loses half a
/// millisecond. In an intact connection one or two follow each other at most, because a packet
/// takes 50 us.
const MOST_FUTILE: u16 = 64;
/// The number of interrupts in a row with a reset of the bus still pending, after which the
/// interrupt is masked. They take 0.13 s, in which the main loop does not run.
///
/// The limit is high because `rp2040-hal` leaves a reset pending on the revisions B0 and B1 until
/// it ends (erratum RP2040-E5). A host ends it after 10 to 50 ms, and may wait only 10 ms more for
/// the device. A hub without a host may never end it.
const MOST_IN_RESET: u16 = 16_384;

struct Usb {
    device: UsbDevice<'static, UsbBus>,
    port: CdcAcmClass<'static, UsbBus>,
    leaving: Deque<u8, USB_QUEUE>,
    is_open: bool,
    futile: u16,
    in_reset: u16,
}

static USB: Shared<Option<&'static mut Usb>> = Shared::new(None);

/// Connects the board to a host. The device answers only while its interrupt is unmasked and calls
/// [`poll`].
pub(super) fn start(
    registers: USBCTRL_REGS,
    memory: USBCTRL_DPRAM,
    clock: UsbClock,
    resets: &mut RESETS,
) -> Option<()> {
    // The reset of the block switches the pull-up off, and `UsbBus::new` does not switch it on.
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

    // The device lives for ever.
    let usb = singleton!(: Usb = Usb {
        device,
        port,
        leaving: Deque::new(),
        is_open: false,
        futile: 0,
        in_reset: 0,
    })?;
    USB.with(|place| *place = Some(usb))
}

fn with<T>(act: impl FnOnce(&mut Usb) -> T) -> Option<T> {
    USB.with(|usb| usb.as_deref_mut().map(act)).flatten()
}

/// Sends a message if a program has the port open and the queue has room for all of it. Otherwise
/// the message is dropped.
#[inline(never)] // The libraries may panic; the main loop must not (test `no_panic`).
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

/// Handles the device's interrupt. Takes a packet only if the queue has room for it. If it returns
/// false, the caller masks the interrupt and calls this function again later.
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

        let (is_pending, is_in_reset) = pending();
        count(&mut usb.futile, is_pending && !is_in_reset);
        count(&mut usb.in_reset, is_in_reset);
        usb.futile < MOST_FUTILE && usb.in_reset < MOST_IN_RESET
    });
    has_room && is_served != Some(false)
}

/// Returns true if any interrupt is pending, and true if a reset of the bus is.
///
/// The libraries leave an unexpected packet to the control endpoint in place until the next request
/// of the host. Such a packet belongs to a request that the host has abandoned, or to a request
/// that is longer than their buffer of 128 bytes.
fn pending() -> (bool, bool) {
    // SAFETY: the register is only read; no other code reads it for its side effects.
    let interrupts = unsafe { &*USBCTRL_REGS::ptr() }.ints().read();
    (interrupts.bits() != 0, interrupts.bus_reset().bit_is_set())
}

fn count(in_a_row: &mut u16, has_happened: bool) {
    *in_a_row = if has_happened {
        in_a_row.saturating_add(1)
    } else {
        0
    };
}

impl Usb {
    /// Restarts the chip in its boot loader if the port was closed at the speed that requests it.
    fn obey_speed(&mut self) {
        let was_open = core::mem::replace(&mut self.is_open, self.port.dtr());
        let is_asked = self.port.line_coding().data_rate() == BOOT_LOADER_BAUD;
        if was_open && !self.is_open && is_asked {
            // No pin shows the activity of the boot loader. It offers the drive and the interface
            // of picotool.
            reset_to_usb_boot(0, 0);
        }
    }

    /// Passes the next packet to the device, if the last one is sent. No packet is full, because
    /// after a full packet the host would wait for more.
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

/// Puts a message into a queue if it has room for all of it.
pub(super) fn put<const N: usize>(queue: &mut Deque<u8, N>, message: &[u8]) -> bool {
    room(queue) >= message.len() && message.iter().all(|byte| queue.push_back(*byte).is_ok())
}
