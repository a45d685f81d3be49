//! Messages as tables: one row per field gives the struct, its length, its encoding and its decoding.

/// A number with a fixed little-endian layout.
pub trait WireNumber: Copy {
    /// Bytes on the wire.
    const SIZE: usize;
    /// Takes the field off the front of `bytes`; `None` if there are too few.
    fn take(bytes: &mut &[u8]) -> Option<Self>;
    /// Writes the field at the front of `bytes` and moves past it; `None` if there is no room.
    fn put(self, bytes: &mut &mut [u8]) -> Option<()>;
}

macro_rules! little_endian {
    ($($number:ty),*) => {$(
        impl WireNumber for $number {
            const SIZE: usize = size_of::<$number>();

            fn take(bytes: &mut &[u8]) -> Option<Self> {
                let (field, rest) = bytes.split_first_chunk()?;
                *bytes = rest;
                Some(<$number>::from_le_bytes(*field))
            }

            fn put(self, bytes: &mut &mut [u8]) -> Option<()> {
                let (field, rest) = core::mem::take(bytes).split_first_chunk_mut()?;
                *field = self.to_le_bytes();
                *bytes = rest;
                Some(())
            }
        }
    )*};
}
little_endian!(u8, u16, u32, u64, f32, f64);

impl<F: WireNumber + Default, const N: usize> WireNumber for [F; N] {
    const SIZE: usize = F::SIZE * N;

    fn take(bytes: &mut &[u8]) -> Option<Self> {
        let mut fields = [F::default(); N];
        for field in &mut fields {
            *field = F::take(bytes)?;
        }
        Some(fields)
    }

    fn put(self, bytes: &mut &mut [u8]) -> Option<()> {
        self.into_iter().try_for_each(|field| field.put(bytes))
    }
}

/// A message with a fixed layout.
pub trait Message: Sized {
    /// Tells it from the other messages.
    const KIND: u8;
    /// Bytes of all its fields.
    const SIZE: usize;
    /// Reads the fields; `None` unless `bytes` holds exactly [`SIZE`](Self::SIZE) of them.
    fn read(bytes: &[u8]) -> Option<Self>;
    /// Writes the fields to the front of `bytes`; `None` if there is no room.
    fn write(&self, bytes: &mut &mut [u8]) -> Option<()>;
}

/// Declares a message: `Name = kind { field: type, ... }`, the fields in the order they have on the wire.
#[macro_export]
macro_rules! message {
    ($(#[$doc:meta])* $name:ident = $kind:literal { $($(#[$field_doc:meta])* $field:ident: $type:ty,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct $name { $($(#[$field_doc])* pub $field: $type,)* }

        impl $crate::protocol::Message for $name {
            const KIND: u8 = $kind;
            const SIZE: usize = 0 $(+ <$type as $crate::protocol::WireNumber>::SIZE)*;

            fn read(mut bytes: &[u8]) -> Option<Self> {
                use $crate::protocol::WireNumber;
                let message = Self { $($field: <$type>::take(&mut bytes)?,)* };
                bytes.is_empty().then_some(message)
            }

            fn write(&self, bytes: &mut &mut [u8]) -> Option<()> {
                use $crate::protocol::WireNumber;
                $(self.$field.put(bytes)?;)*
                Some(())
            }
        }
    };
}
