//! The double pendulum on the Raspberry Pi Pico.
#![no_std]
#![no_main]

use core::mem::MaybeUninit;

use firmware::app::App;
use firmware::board;
use firmware::board::pico::{Board, Keys, Link, Panel};
use firmware::config::PROCESSOR;
use firmware::graphics::frame_buffers::FrameBuffers;

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut SHEETS: FrameBuffers = FrameBuffers::BLANK;
    static mut APP: MaybeUninit<App<'static, Panel, Link, Keys>> = MaybeUninit::uninit();

    let Some(board) = Board::take() else { panic!("the board was taken before") };
    defmt::info!("boot: pico, {} Hz", board.hertz);
    let app = board::application(APP, SHEETS, board.panel, board.link, board.keys, PROCESSOR);
    board::run(app, board.receiver, board.instruments, board.clock, board.watchdog)
}
