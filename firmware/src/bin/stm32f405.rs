//! The double pendulum on a board with an STM32F405 or F407, and in QEMU's `netduinoplus2`: the same image.
#![no_std]
#![no_main]

use core::mem::MaybeUninit;

use firmware::app::App;
use firmware::board;
use firmware::board::stm32f405::{Board, Keys, Panel, Uart};
use firmware::config::STM32F405;
use firmware::graphics::frame_buffers::FrameBuffers;

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut SHEETS: FrameBuffers = FrameBuffers::BLANK;
    static mut APP: MaybeUninit<App<'static, Panel, Uart, Keys>> = MaybeUninit::uninit();

    let Some(board) = Board::take() else { panic!("the board was taken before") };
    defmt::info!("boot: stm32f405, {} Hz, {}", board.hertz, board.place);
    let app = board::application(APP, SHEETS, board.panel, board.link, board.keys, STM32F405);
    board::run(app, board.receiver, board.instruments, board.clock, board.watchdog)
}
