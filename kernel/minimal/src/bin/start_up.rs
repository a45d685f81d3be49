//! The start-up of a program without a motion. Its size is part of that of all others.
#![no_std]
#![no_main]

#[cortex_m_rt::entry]
fn main() -> ! {
    minimal::end(Ok(()))
}
