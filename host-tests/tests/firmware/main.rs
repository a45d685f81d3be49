//! The portable firmware on the host: motion, scenes, protocol, panels.

mod app;
mod bench;
mod canvas;
mod commands;
mod controls;
mod display;
mod fault;
mod golden;
mod horizon;
mod i2c_recovery;
mod link;
mod misprint;
mod oled_i2c;
mod planner;
mod scenes;
mod service;
#[path = "../support/snapshot.rs"]
mod snapshot;
mod ssd0323;
mod sweep;
mod tick_timer;
mod warm_restart;
