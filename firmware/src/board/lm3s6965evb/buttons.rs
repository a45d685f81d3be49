//! The five buttons.

use super::gpio;
use crate::app::{Buttons, Pressed};

const UP: u8 = 1 << 0;
const DOWN: u8 = 1 << 1;
const LEFT: u8 = 1 << 2;
const RIGHT: u8 = 1 << 3;
const SELECT: u8 = 1 << 1;

/// PE0 to PE3 and PF1, each low while pressed.
#[derive(Debug)]
pub struct Keys(());

impl Keys {
    pub(super) fn start() -> Self {
        gpio::E.use_for_input(UP | DOWN | LEFT | RIGHT);
        gpio::F.use_for_input(SELECT);
        Self(())
    }
}

impl Buttons for Keys {
    fn read(&mut self) -> Pressed {
        let low = !gpio::E.read(UP | DOWN | LEFT | RIGHT);
        Pressed {
            up: low & UP != 0,
            down: low & DOWN != 0,
            left: low & LEFT != 0,
            right: low & RIGHT != 0,
            select: !gpio::F.read(SELECT) & SELECT != 0,
        }
    }
}
