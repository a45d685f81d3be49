//! The page's pendulum on a Raspberry Pi Pico and a colour panel: an ST7789 of 240 x 240 pixels on
//! SPI, driven by `mipidsi`.
//!
//! GPIO 18 clock, 19 data, 17 select, 20 data/command, 21 reset. Not tried on silicon.
//! `cargo build --release --package firmware --example colour_panel --features colour-panel,pico
//! --target thumbv6m-none-eabi`
#![no_std]
#![no_main]

use core::convert::Infallible;

use embedded_graphics_core::geometry::Point;
use embedded_graphics_core::pixelcolor::Rgb565;
use embedded_hal_bus::spi::ExclusiveDevice;
use firmware::board::cortex_m::clock;
use firmware::config::PROCESSOR;
use firmware::display::{AnyPanel, Display};
use firmware::graphics::FrameBuffers;
use firmware::motion::Settings;
use firmware::{app::Player, scenes::SceneName};
use mipidsi::interface::SpiInterface;
use mipidsi::options::ColorInversion;
use mipidsi::{Builder, models::ST7789};
use rp2040_hal::clocks::{Clock, init_clocks_and_plls};
use rp2040_hal::fugit::RateExtU32;
use rp2040_hal::gpio::{FunctionSpi, Pins};
use rp2040_hal::{Sio, Spi, Timer, Watchdog, pac};

/// The Pico's crystal, Hz.
const CRYSTAL: u32 = 12_000_000;
/// The clock of the panel's bus, Hz: a frame takes 2 ms there.
const SPEED: u32 = 62_500_000;
/// The frame's upper left corner on the panel: in the middle.
const CORNER: Point = Point::new((240 - 128) / 2, (240 - 64) / 2);

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut BUFFERS: FrameBuffers = FrameBuffers::BLANK;
    static mut BATCH: [u8; 512] = [0; 512];
    match play(BUFFERS, BATCH)
        .expect("the chip, its clock and the panel start, and the panel does not fail") {}
}

/// Plays for ever. Returns `None` if a part does not start or fails.
fn play(buffers: &mut FrameBuffers, batch: &mut [u8]) -> Option<Infallible> {
    let core = cortex_m::Peripherals::take()?;
    let mut chip = pac::Peripherals::take()?;
    let resets = &mut chip.RESETS;
    let mut watchdog = Watchdog::new(chip.WATCHDOG);
    let clocks = init_clocks_and_plls(
        CRYSTAL,
        chip.XOSC,
        chip.CLOCKS,
        chip.PLL_SYS,
        chip.PLL_USB,
        resets,
        &mut watchdog,
    )
    .ok()?;

    // The panel is at SPI0.
    let pins = Pins::new(
        chip.IO_BANK0,
        chip.PADS_BANK0,
        Sio::new(chip.SIO).gpio_bank0,
        resets,
    );
    let wires = (
        pins.gpio19.into_function::<FunctionSpi>(),
        pins.gpio18.into_function::<FunctionSpi>(),
    );
    let bus = Spi::<_, _, _, 8>::new(chip.SPI0, wires);
    let bus = bus.init(
        resets,
        clocks.peripheral_clock.freq(),
        SPEED.Hz(),
        embedded_hal::spi::MODE_3,
    );

    let device = ExclusiveDevice::new_no_delay(bus, pins.gpio17.into_push_pull_output()).ok()?;
    let interface = SpiInterface::new(device, pins.gpio20.into_push_pull_output(), batch);
    // The panel's own driver resets it and sets it up.
    let mut timer = Timer::new(chip.TIMER, resets, &clocks);
    let target = Builder::new(ST7789, interface)
        .reset_pin(pins.gpio21.into_push_pull_output())
        .display_size(240, 240)
        .invert_colors(ColorInversion::Inverted)
        .init(&mut timer)
        .ok()?;

    let mut panel = AnyPanel {
        target,
        corner: CORNER,
        colour: Rgb565::from,
    };
    let mut player = Player::new(PROCESSOR, &mut buffers.ink);
    player.play(SceneName::Page, Settings::default()).ok()?;

    // Show a frame in every tick.
    clock::start(core.SYST, clocks.system_clock.freq().to_Hz());
    let mut now = clock::ticks();
    loop {
        now = clock::wait_after(now);
        player.tick(|_| ());
        player.draw(&mut buffers.canvas);
        panel.flush(&buffers.canvas).ok()?;
    }
}
