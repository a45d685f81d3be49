//! The double pendulum on the MPS2 board with image AN386: no panel, no buttons, but the serial link.
#![no_std]
#![no_main]

use firmware::app::App;
use firmware::board::{self, mps2_an386::Board};
use firmware::controls::NoButtons;
use firmware::display::NoDisplay;
use firmware::settings::Settings;

#[cortex_m_rt::entry]
fn main() -> ! {
    let Some(board) = Board::take() else { panic!("the board was taken before") };
    defmt::info!("boot: mps2-an386, {} Hz", board.hertz);
    match App::new(Settings::default(), NoDisplay, board.link, NoButtons) {
        Ok(app) => board::run(app, board.receiver, board.clock),
        Err(error) => {
            defmt::error!("{}", error);
            panic!("the first settings describe no pendulum")
        }
    }
}
