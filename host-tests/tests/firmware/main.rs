//! The portable firmware on the host: motion, scenes, protocol, panels.

mod app;
mod canvas;
mod commands;
mod controls;
mod fault;
mod history;
mod horizon;
mod i2c_recovery;
mod link;
mod misprint;
mod planner;
mod scenes;
mod service;
mod ssd0323;
mod ssd1306;
mod warm_restart;
