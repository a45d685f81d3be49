//! The double pendulum on the LM3S6965 evaluation board.
#![no_std]
#![no_main]

use core::mem::MaybeUninit;

use firmware::app::App;
use firmware::board;
use firmware::board::lm3s6965evb::{Board, Keys, Panel, Uart};
use firmware::config::PROCESSOR;
use firmware::graphics::frame_buffers::FrameBuffers;

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut SHEETS: FrameBuffers = FrameBuffers::BLANK;
    static mut APP: MaybeUninit<App<'static, Panel, Uart, Keys>> = MaybeUninit::uninit();

    let Some(board) = Board::take() else { panic!("the board was taken before") };
    defmt::info!("boot: lm3s6965evb, {} Hz", board.hertz);
    let mut panel = board.panel;
    if panel.init().is_err() {
        defmt::error!("the panel does not answer");
    }
    let app = board::application(APP, SHEETS, panel, board.link, board.keys, PROCESSOR);
    board::run(app, board.receiver, board.instruments, board.clock, board.watchdog)
}
