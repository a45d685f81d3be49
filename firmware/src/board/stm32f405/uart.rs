//! The serial port.

use stm32f4xx_hal::gpio::{PB10, PB11};
use stm32f4xx_hal::pac::{Interrupt, NVIC, USART3};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::config::{Config, InvalidConfig};
use stm32f4xx_hal::serial::{Event, Tx};

use crate::board::serial::receiver::{Inlet, Taken};
use crate::board::serial::transmitter::{Outlet, Transmitter};
use crate::config::BAUD;

pub(super) fn start(
    port: USART3,
    (out, inwards): (PB10, PB11),
    rcc: &mut Rcc,
) -> Result<Transmitter<Tx<USART3>>, InvalidConfig> {
    let mut port = port.serial((out, inwards), Config::default().baudrate(BAUD.bps()), rcc)?;
    port.listen(Event::RxNotEmpty);
    Ok(Transmitter(port.split().0))
}

impl Outlet for Tx<USART3> {
    fn is_ready(&self) -> bool {
        self.is_tx_empty()
    }

    fn put(&mut self, byte: u8) {
        // Refused only by a port that is not ready.
        let _ = self.write(byte);
    }
}

pub(super) const INLET: Inlet = Inlet { clear: |_| (), take };

/// To read a byte ends its interrupt; there is nothing else to clear.
fn take() -> Taken {
    // SAFETY: of these registers the outward direction uses other bits, and reading does not change those.
    let port = unsafe { &*USART3::ptr() };
    let status = port.sr().read();
    // A byte that came before the last one was read is lost, and interrupts until the data are read.
    let (has_byte, overrun) = (status.rxne().bit_is_set(), status.ore().bit_is_set());
    let data = (has_byte || overrun).then(|| port.dr().read().dr().bits() as u8);
    Taken { byte: data.filter(|_| has_byte), overrun }
}

pub(super) fn enable_receiver() {
    // SAFETY: no critical section relies on this interrupt being masked.
    unsafe { NVIC::unmask(Interrupt::USART3) };
}
