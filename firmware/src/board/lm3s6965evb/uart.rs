//! The serial port (PL011).

use super::gpio;
use crate::board::cortex_m::interrupt::Interrupt;
use crate::board::register::{Device, Register};
use crate::board::serial::{self, Inward, Receiver, Taken, Transmitter};
use crate::config::BAUD;

// SAFETY: UART0 of the data sheet, chapter 12; without DMA it cannot break memory safety.
const UART0: Device = unsafe { Device::at(0x4000_C000) };
const DATA: Register = UART0.register(0x000);
const RECEIVE_STATUS: Register = UART0.register(0x004);
const FLAGS: Register = UART0.register(0x018);
const DIVISOR: Register = UART0.register(0x024);
const DIVISOR_FRACTION: Register = UART0.register(0x028);
const LINE_CONTROL: Register = UART0.register(0x02c);
const CONTROL: Register = UART0.register(0x030);
const INTERRUPT_MASK: Register = UART0.register(0x038);
const INTERRUPT_CLEAR: Register = UART0.register(0x044);

const OVERRUN: u32 = 1 << 3;
const RECEIVER_EMPTY: u32 = 1 << 4;
const TRANSMITTER_FULL: u32 = 1 << 5;
const EIGHT_BITS_QUEUED: u32 = 0b11 << 5 | 1 << 4;
const ENABLE: u32 = 1 << 9 | 1 << 8 | 1 << 0;
const RECEIVED: u32 = 1 << 6 | 1 << 4;

const INTERRUPT: Interrupt = Interrupt(5);

pub(super) fn start(hertz: u32) -> (Transmitter, Receiver) {
    gpio::A.use_for_device(1 << 0 | 1 << 1);
    CONTROL.write(0);
    // The divisor hertz/(16 baud) in 64ths, rounded: 50 MHz / (16 x 460,800) = 6 + 50/64, 0.005 % off.
    let divisor = (4 * hertz + BAUD / 2) / BAUD;
    DIVISOR.write(divisor / 64);
    DIVISOR_FRACTION.write(divisor % 64);
    LINE_CONTROL.write(EIGHT_BITS_QUEUED);
    CONTROL.write(ENABLE);
    let receiver = serial::receive_from(Inward { clear: |_| INTERRUPT_CLEAR.write(RECEIVED), take });
    INTERRUPT_MASK.write(RECEIVED);
    INTERRUPT.unmask();
    (Transmitter { is_ready: || FLAGS.read() & TRANSMITTER_FULL == 0, put: |byte| DATA.write(byte.into()) }, receiver)
}

fn take() -> Taken {
    let overrun = RECEIVE_STATUS.read() & OVERRUN != 0;
    if overrun {
        RECEIVE_STATUS.write(0); // Any write clears it.
    }
    Taken { byte: (FLAGS.read() & RECEIVER_EMPTY == 0).then(|| DATA.read() as u8), overrun }
}
