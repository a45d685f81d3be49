//! Motions computed on request, by any method.
//!
//! A [`Request`] names a [`Method`](double_pendulum::Method) and a motion. The service on the boards answers it step by step
//! ([`Job`]), `cargo simulate` all at once ([`Request::readings`]); `cargo count` counts its steps, and its bits on host and
//! chip are compared, by [`Request::crc`]. It is the same code wherever it runs, so that errors may be computed on the host
//! and costs counted on the chip.

mod answer;
mod comparison;
mod request;
mod run;
mod table;

pub use answer::{Job, JobError};
pub use request::{CRC, Reading, Request};
pub use run::Run;
pub use table::{AnyRun, ON_BOARDS, OnBoards};
