//! The double pendulum on the MPS2 board with image AN386: no panel, no buttons, but the serial link.
#![no_std]
#![no_main]

use core::mem::MaybeUninit;

use firmware::app::App;
use firmware::app::controls::NoButtons;
use firmware::board;
use firmware::board::mps2_an386::{Board, Uart};
use firmware::config::PROCESSOR;
use firmware::display::NoDisplay;
use firmware::graphics::frame_buffers::FrameBuffers;

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut SHEETS: FrameBuffers = FrameBuffers::BLANK;
    static mut APP: MaybeUninit<App<'static, NoDisplay, Uart, NoButtons>> = MaybeUninit::uninit();

    let Some(board) = Board::take() else { panic!("the board was taken before") };
    defmt::info!("boot: mps2-an386, {} Hz", board.hertz);
    let app = board::application(APP, SHEETS, NoDisplay, board.link, NoButtons, PROCESSOR);
    board::run(app, board.receiver, board.instruments, board.clock, board.watchdog)
}
