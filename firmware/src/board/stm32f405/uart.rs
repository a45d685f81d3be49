//! The serial port. The support library sets it up; bytes are sent and taken here.

use stm32f4xx_hal::gpio::{PB10, PB11};
use stm32f4xx_hal::pac::usart1::RegisterBlock;
use stm32f4xx_hal::pac::{Interrupt, NVIC, USART3};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::Event;
use stm32f4xx_hal::serial::config::{Config, InvalidConfig};

use crate::board::serial::{self, Port, Receiver, Taken, Transmitter};
use crate::config::BAUD;

pub(super) fn start(port: USART3, pins: (PB10, PB11), rcc: &mut Rcc) -> Result<(Transmitter, Receiver), InvalidConfig> {
    let mut port = port.serial::<u8>(pins, Config::default().baudrate(BAUD.bps()), rcc)?;
    port.listen(Event::RxNotEmpty);
    let put = |byte: u8| {
        registers().dr().write(|w| w.dr().set(byte.into()));
    };
    let link =
        serial::start(Port { clear: |_| (), take, is_ready: || registers().sr().read().txe().bit_is_set(), put });
    // SAFETY: no critical section relies on this interrupt being masked.
    unsafe { NVIC::unmask(Interrupt::USART3) };
    Ok(link)
}

fn registers() -> &'static RegisterBlock {
    // SAFETY: the support library has let go of them; of these either direction uses other bits, and reading does not change the
    // other's.
    unsafe { &*USART3::ptr() }
}

/// To read a byte ends its interrupt; there is nothing else to clear.
fn take() -> Taken {
    let status = registers().sr().read();
    // A byte that came before the last one was read is lost, and interrupts until the data are read.
    let (has_byte, overrun) = (status.rxne().bit_is_set(), status.ore().bit_is_set());
    let data = (has_byte || overrun).then(|| registers().dr().read().dr().bits() as u8);
    Taken { byte: data.filter(|_| has_byte), overrun }
}
