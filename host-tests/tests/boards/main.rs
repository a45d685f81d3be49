//! The firmware on emulated boards: bits, frames, faults, costs.

mod all_scenes;
mod browser;
mod budgets;
mod colour;
mod cores;
mod count;
mod identity;
mod late;
mod mass_ratio;
mod no_panic;
mod pico;
mod qemu_buttons;
mod qemu_host;
mod qemu_lm3s6965evb;
mod qemu_plan;
mod qemu_restart;
mod qemu_stm32f405;
mod steps;
#[path = "../support/mod.rs"]
mod support;
