//! The arithmetics under measurement, and the request that runs one of them: the same code on the host and on the chip,
//! so that errors may be computed on the host and costs counted on the chip.

mod request;
mod subject;
mod textbook;

pub use request::{Outcome, Request, RequestError};
pub use subject::{CLOSED_FORM, SUBJECTS, Subject};
pub use textbook::Textbook;
