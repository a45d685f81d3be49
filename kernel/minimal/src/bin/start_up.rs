//! A program without a motion, whose size is part of that of all others.
#![no_std]
#![no_main]

#[cortex_m_rt::entry]
fn main() -> ! {
    minimal::end(Ok(()))
}
