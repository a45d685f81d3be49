//! The one error of an emulated board that the code tells from others: behind a broken connection may be QEMU's end.

use std::io;

/// The connection called so broke. It is no `io::Error`: that may be a closed output, which is none.
#[derive(Debug, thiserror::Error)]
#[error("the connection to QEMU's {0} broke: {1}")]
pub(super) struct Broken(&'static str, io::Error);

/// For `map_err` on the connection called `name`.
pub(super) fn broken(name: &'static str) -> impl Fn(io::Error) -> anyhow::Error {
    move |source| Broken(name, source).into()
}
