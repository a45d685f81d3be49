//! Runs one [`Request`] from the semihosting command line and prints the CRC of its bits, and the
//! ticks it took, as one line. With the word `golden`, prints the golden bits of every method.
#![no_std]
#![no_main]

use core::fmt::Write;

use cortex_m::peripheral::{Peripherals, SYST, syst::SystClkSource};
use cortex_m_semihosting::{debug, hio};
use firmware::board::cortex_m::command_line;
use firmware::job::{Request, write_golden};

/// SysTick counts processor cycles down from here; a run must take fewer. These are the ticks that
/// are printed.
const FULL: u32 = 0x00ff_ffff;

#[cortex_m_rt::entry]
fn main() -> ! {
    debug::exit(run(&mut [0; 256]));
    loop {
        cortex_m::asm::wfi();
    }
}

/// Computes the request and prints its line, or prints the golden bits. If the kernel refuses the
/// request, prints the reason and returns an error. Also returns an error if there is no debugger,
/// or if the command line is no request. The command line must fit into `buffer`.
fn run(buffer: &mut [u8]) -> Result<(), ()> {
    let mut output = hio::hstdout()?;
    let line = command_line(buffer).ok_or(())?;
    if line == "golden" {
        return write_golden(&mut output).map_err(|_| ());
    }
    let mut peripherals = Peripherals::take().ok_or(())?;
    let clock = &mut peripherals.SYST;
    clock.set_clock_source(SystClkSource::Core);
    clock.set_reload(FULL);
    clock.clear_current();
    clock.enable_counter();
    let outcome = Request::parse(line).ok_or(())?.crc();
    let ticks = FULL - SYST::get_current();
    match outcome {
        Ok(crc) => writeln!(output, "{crc:08x} {ticks}").map_err(|_| ()),
        Err(error) => writeln!(output, "{error}").map_err(|_| ()).and(Err(())),
    }
}
