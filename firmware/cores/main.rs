//! Runs every method of the kernel for 2,560 steps and prints the CRC of its bits, one line each. For cores that no board here
//! has: all it needs of a machine is a way to print and a way to exit.
#![no_std]
#![no_main]

use core::fmt::{self, Write};

use double_pendulum::Method;
use firmware::job::Request;

/// Prints all lines.
fn say(output: &mut impl Write) -> fmt::Result {
    Method::ALL
        .iter()
        .try_for_each(|&method| match Request::on_any_core(method).crc() {
            Ok(crc) => writeln!(output, "{} {crc:08x}", method.name()),
            Err(error) => writeln!(output, "{} {error}", method.name()),
        })
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    machine::end(false)
}

/// A Cortex-M, by semihosting.
#[cfg(target_arch = "arm")]
mod machine {
    use cortex_m_semihosting::{debug, hio};

    #[cortex_m_rt::entry]
    fn main() -> ! {
        end(hio::hstdout().is_ok_and(|mut output| super::say(&mut output).is_ok()))
    }

    pub fn end(is_success: bool) -> ! {
        loop {
            debug::exit(if is_success {
                debug::EXIT_SUCCESS
            } else {
                debug::EXIT_FAILURE
            });
        }
    }
}

/// A RISC-V under Linux, whose calls QEMU's user mode serves.
#[cfg(target_arch = "riscv32")]
mod machine {
    use core::arch::asm;
    use core::fmt;

    const WRITE: usize = 64;
    const EXIT: usize = 93;
    const OUTPUT: usize = 1;

    struct Output;

    fn call(number: usize, [a, b, c]: [usize; 3]) -> isize {
        let result;
        // SAFETY: `write` reads the bytes of a living `str`, `exit` takes a number, and both keep all registers but the first.
        unsafe {
            asm!("ecall", in("a7") number, inlateout("a0") a => result, in("a1") b, in("a2") c)
        };
        result
    }

    impl fmt::Write for Output {
        fn write_str(&mut self, text: &str) -> fmt::Result {
            let written = call(WRITE, [OUTPUT, text.as_ptr() as usize, text.len()]);
            if usize::try_from(written) == Ok(text.len()) {
                Ok(())
            } else {
                Err(fmt::Error)
            }
        }
    }

    // SAFETY: this name is the program's first address; Linux has put the stack pointer where it must be.
    #[unsafe(no_mangle)]
    extern "C" fn _start() -> ! {
        end(super::say(&mut Output).is_ok())
    }

    pub fn end(is_success: bool) -> ! {
        loop {
            call(EXIT, [usize::from(!is_success), 0, 0]);
        }
    }
}
