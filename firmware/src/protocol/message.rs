//! What a message is: a kind, and fields in [postcard](https://postcard.jamesmunns.com)'s format.

use serde::Serialize;
use serde::de::DeserializeOwned;

pub const MAX_FIELDS: usize = 96;

pub trait Message: Serialize + DeserializeOwned {
    const KIND: u8;

    /// Reads the fields; `None` unless `bytes` holds just these.
    fn read(bytes: &[u8]) -> Option<Self> {
        postcard::take_from_bytes(bytes).ok().filter(|(_, rest)| rest.is_empty()).map(|(message, _)| message)
    }

    /// The fields: the front of `bytes`. All messages fit (test `link`).
    fn write<'b>(&self, bytes: &'b mut [u8; MAX_FIELDS]) -> &'b [u8] {
        postcard::to_slice(self, bytes).map_or(&[], |fields| fields)
    }
}

/// The number of the command whose fields begin `bytes`, which may be one of unknown kind.
pub fn request(bytes: &[u8]) -> u16 {
    postcard::take_from_bytes(bytes).map_or(0, |(request, _)| request)
}

/// Declares messages: `Name = kind { field: type, ... }`.
macro_rules! messages {
    ($($(#[$doc:meta])* $name:ident = $kind:literal { $($(#[$field_doc:meta])* $field:ident: $type:ty,)* })*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
        pub struct $name { $($(#[$field_doc])* pub $field: $type,)* }

        impl $crate::protocol::Message for $name {
            const KIND: u8 = $kind;
        }
    )*};
}

/// Declares commands or answers: messages that begin with a number.
macro_rules! numbered {
    ($($(#[$doc:meta])* $name:ident = $kind:literal { $($fields:tt)* })*) => {
        $crate::protocol::message::messages! {$(
            $(#[$doc])* $name = $kind {
                /// Chosen by the host; every answer repeats it.
                request: u16,
                $($fields)*
            }
        )*}
    };
}

pub(super) use {messages, numbered};
