//! Motions computed on request: one table of arithmetics, and what runs its rows.
//!
//! A [`Request`] names a [`Row`] of the [table](ROWS) and a motion. The service on the boards answers it step by step
//! ([`Job`]), `cargo simulate` all at once ([`Request::readings`]); `cargo count` counts its steps, and its bits on host and
//! chip are compared, by [`Request::crc`]. It is the same code wherever it runs, so that errors may be computed on the host
//! and costs counted on the chip.

mod answer;
mod canonical;
mod choice;
mod counted;
mod formed;
mod linear;
mod reading;
mod request;
mod row;
mod run;
mod table;
mod textbook;

pub use answer::{Job, JobError};
pub use choice::{Arithmetic, Formulation, Integrator, Model};
pub use reading::Reading;
pub use request::Request;
pub use row::{Row, Wanted};
pub use run::Run;
pub use table::{ON_BOARDS, OnBoards, ROWS};
