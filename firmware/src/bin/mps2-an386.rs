//! The double pendulum on the MPS2 board with image AN386: no panel, no buttons, but the serial
//! link.
#![no_std]
#![no_main]

firmware::program!(mps2_an386::Mps2An386 on PROCESSOR);
