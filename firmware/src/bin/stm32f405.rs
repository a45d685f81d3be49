//! The double pendulum on a board with an STM32F405 or F407, and in QEMU's `netduinoplus2`: the
//! same image.
#![no_std]
#![no_main]

firmware::program!(stm32f405::Stm32f405 on STM32F405);
