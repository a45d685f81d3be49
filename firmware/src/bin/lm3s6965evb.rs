//! The double pendulum on the LM3S6965 evaluation board.
#![no_std]
#![no_main]

use firmware::app::App;
use firmware::board::{self, lm3s6965evb::Board};
use firmware::settings::Settings;

#[cortex_m_rt::entry]
fn main() -> ! {
    let Some(board) = Board::take() else { panic!("the board was taken before") };
    defmt::info!("boot: lm3s6965evb, {} Hz", board.hertz);
    let mut panel = board.panel;
    if panel.init().is_err() {
        defmt::error!("the panel does not answer");
    }
    match App::new(Settings::default(), panel, board.link, board.keys) {
        Ok(app) => board::run(app, board.receiver, board.clock),
        Err(error) => {
            defmt::error!("{}", error);
            panic!("the first settings describe no pendulum")
        }
    }
}
