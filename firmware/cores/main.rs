//! Prints the golden bits of every method as this core computes them. For cores that no board here
//! has: all it needs of a machine is a way to print and a way to end.
#![no_std]
#![no_main]

use firmware::job::write_golden;

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
        end(hio::hstdout().is_ok_and(|mut output| super::write_golden(&mut output).is_ok()))
    }

    /// Ends the program with an exit status of success or failure. Without a debugger, the call is
    /// a fault.
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

/// A program under Linux, whose calls QEMU's user mode serves.
#[cfg(any(target_arch = "riscv32", target_arch = "aarch64"))]
mod machine {
    use core::arch::asm;
    use core::fmt;

    /// The numbers of the system calls, and the file of the standard output.
    const WRITE: usize = 64;
    const EXIT: usize = 93;
    const OUTPUT: usize = 1;

    struct Output;

    /// Makes a system call with three arguments. Returns its result, which is negative for an
    /// error.
    #[cfg(target_arch = "riscv32")]
    fn call(number: usize, [a, b, c]: [usize; 3]) -> isize {
        let result;
        // SAFETY: `write` reads the bytes of a living `str`, `exit` takes a number, and both keep
        // all registers but the first.
        unsafe {
            asm!("ecall", in("a7") number, inlateout("a0") a => result, in("a1") b, in("a2") c)
        };
        result
    }

    #[cfg(target_arch = "aarch64")]
    fn call(number: usize, [a, b, c]: [usize; 3]) -> isize {
        let result;
        // SAFETY: as above; the calls have the same numbers.
        unsafe {
            asm!("svc #0", in("x8") number, inlateout("x0") a => result, in("x1") b, in("x2") c)
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

    // SAFETY: this name is the program's first address; Linux has put the stack pointer where it
    // must be.
    #[unsafe(no_mangle)]
    extern "C" fn _start() -> ! {
        end(super::write_golden(&mut Output).is_ok())
    }

    /// Ends the program with the exit status 0, or 1 after a failure.
    pub fn end(is_success: bool) -> ! {
        loop {
            call(EXIT, [usize::from(!is_success), 0, 0]);
        }
    }
}

/// A WebAssembly module, whose host prints (`host-tests/boards/wasm.js`).
#[cfg(target_arch = "wasm32")]
mod machine {
    use core::arch::wasm32::unreachable;
    use core::fmt;

    #[link(wasm_import_module = "host")]
    unsafe extern "C" {
        /// Prints this number of bytes of UTF-8 text.
        fn print(text: *const u8, bytes: usize);
    }

    struct Output;

    impl fmt::Write for Output {
        fn write_str(&mut self, text: &str) -> fmt::Result {
            // SAFETY: the host only reads the bytes of this living `str`.
            unsafe { print(text.as_ptr(), text.len()) };
            Ok(())
        }
    }

    // SAFETY: no other function has this name.
    #[unsafe(no_mangle)]
    extern "C" fn start() {
        if super::write_golden(&mut Output).is_err() {
            end(false);
        }
    }

    /// Traps. It is called after a failure only: a module that succeeds returns.
    pub fn end(_is_success: bool) -> ! {
        unreachable()
    }
}
