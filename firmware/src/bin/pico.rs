//! The double pendulum on the Raspberry Pi Pico.
#![no_std]
#![no_main]

firmware::program!(pico::Pico on PROCESSOR);
