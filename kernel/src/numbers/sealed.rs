//! What no other crate may implement.

/// Keeps a public trait to the types of this crate, so that it may get new methods.
pub trait Sealed {}
