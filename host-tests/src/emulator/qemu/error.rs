//! The one error of an emulated board that the code tells from others: behind a broken connection may be QEMU's end.

use std::{fmt, io};

/// The connection called so broke. It is no `io::Error`: that may be a closed output, which is none.
#[derive(Debug)]
pub(super) struct Broken(&'static str, io::Error);

impl fmt::Display for Broken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the connection to QEMU's {} broke: {}", self.0, self.1)
    }
}

impl std::error::Error for Broken {}

/// For `map_err` on the connection called `name`.
pub(super) fn broken(name: &'static str) -> impl Fn(io::Error) -> anyhow::Error {
    move |source| Broken(name, source).into()
}
