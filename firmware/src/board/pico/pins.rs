//! The pins by their numbers, which depend on the panel.
//!
//! Source: RP2040 data sheet, 2.3.1 and 2.19.

use rp2040_hal::pac::{IO_BANK0, PADS_BANK0, SIO};

/// The functions of a pin.
#[cfg(lcd)]
const SPI: u8 = 1;
const BY_PROGRAM: u8 = 5;

#[cfg(lcd)]
/// Connects a pin to its SPI block.
pub fn use_for_spi(pin: usize) {
    connect(pin, SPI);
}

#[cfg(lcd)]
/// Makes a pin an output, low.
pub fn use_for_output(pin: usize) {
    set(pin, false);
    // SAFETY: the register only acts on bits that are 1, and this pin has no other owner.
    unsafe { (*SIO::ptr()).gpio_oe_set().write(|w| w.bits(1 << pin)) };
    connect(pin, BY_PROGRAM);
}

/// Makes a pin an input with a pull-up resistor.
pub fn use_for_input(pin: usize) {
    // SAFETY: this pin has no other owner.
    let pads = unsafe { &*PADS_BANK0::ptr() };
    pads.gpio(pin)
        .modify(|_, w| w.ie().set_bit().pue().set_bit().pde().clear_bit());
    connect(pin, BY_PROGRAM);
}

#[cfg(lcd)]
/// Sets the level of an output.
pub fn set(pin: usize, is_high: bool) {
    // SAFETY: these registers only act on bits that are 1.
    unsafe {
        let sio = &*SIO::ptr();
        if is_high {
            sio.gpio_out_set().write(|w| w.bits(1 << pin));
        } else {
            sio.gpio_out_clr().write(|w| w.bits(1 << pin));
        }
    }
}

/// Returns true if an input is low.
pub fn is_low(pin: usize) -> bool {
    // SAFETY: reading has no effect.
    let levels = unsafe { (*SIO::ptr()).gpio_in().read().bits() };
    levels >> pin & 1 == 0
}

fn connect(pin: usize, function: u8) {
    // SAFETY: this pin has no other owner, and both functions exist.
    unsafe {
        (*IO_BANK0::ptr())
            .gpio(pin)
            .gpio_ctrl()
            .write(|w| w.funcsel().bits(function))
    };
}
