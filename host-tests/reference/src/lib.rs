//! The exact motion, which everything is held against, by two roads that have nothing in common but the book: a set that it is proved
//! to be in, and, many times faster, about 30 digits of it.

#![forbid(unsafe_code)]

pub mod enclosure;
pub mod taylor;

pub use twofloat;
