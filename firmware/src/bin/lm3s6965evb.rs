//! The double pendulum on the LM3S6965 evaluation board.
#![no_std]
#![no_main]

firmware::program!(lm3s6965evb::Lm3s6965evb on PROCESSOR);
