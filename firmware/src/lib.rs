//! The double-pendulum application.
//!
//! All but `board` is portable: it is built and tested on the host as well as on the chip.
//!
//! Data flows one way: [`controls`] and the serial link give [`command`]s, they choose what the [`player`] plays: one of
//! the [`scenes`] with its [`settings`]. The [`scene`] moves and draws itself on the [`canvas`], a [`display`] shows that,
//! and the [`protocol`] carries the numbers to the host; [`app`] does all this once per tick. A [`service`] computes a
//! [`job`] for the host in the time that is left.
#![cfg_attr(not(test), no_std)]

pub mod app;
pub mod bitmap;
#[cfg(target_os = "none")]
pub mod board;
pub mod brush;
pub mod canvas;
mod choice;
pub mod command;
pub mod config;
pub mod controls;
pub mod display;
pub mod fault;
pub mod history;
pub mod ink;
pub mod job;
pub mod label;
pub mod measure;
pub mod planner;
pub mod player;
pub mod plot;
pub mod protocol;
pub mod scene;
pub mod scenes;
pub mod service;
pub mod settings;
pub mod sheets;
pub mod simulation;
pub mod soft_float;
pub mod survivor;
pub mod swing;
pub mod text;
pub mod trail;
pub mod trust;
pub mod unit;
pub mod view;
