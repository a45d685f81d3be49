//! The double pendulum on a board with an STM32F405 or F407, and in QEMU's `netduinoplus2`: the same image.
#![no_std]
#![no_main]

use firmware::app::App;
use firmware::board::{self, stm32f405::Board};
use firmware::settings::Settings;

#[cortex_m_rt::entry]
fn main() -> ! {
    let Some(board) = Board::take() else { panic!("the board was taken before") };
    defmt::info!("boot: stm32f405, {} Hz, {}", board.hertz, board.place);
    let mut panel = board.panel;
    if let Err(error) = panel.init() {
        defmt::warn!("no panel: {}", defmt::Debug2Format(&error));
    }
    match App::new(Settings::default(), panel, board.link, board.keys) {
        Ok(app) => board::run(app, board.receiver, board.clock),
        Err(error) => {
            defmt::error!("{}", error);
            panic!("the first settings describe no pendulum")
        }
    }
}
