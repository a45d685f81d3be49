//! The text form of a request.

use core::fmt;

use heapless::Vec;

use super::Request;

/// The largest size of a request in the postcard format, bytes.
const MAX_BYTES: usize = 1 + 10 * 8 + 2 * 5;

impl Request {
    /// Returns the request in `text`: its bytes in the postcard format, each as two hexadecimal
    /// digits.
    pub fn parse(text: &str) -> Option<Self> {
        let mut bytes = Vec::<u8, MAX_BYTES>::new();
        let byte = |digits: &[u8]| u8::from_str_radix(core::str::from_utf8(digits).ok()?, 16).ok();
        for digits in text.as_bytes().chunks(2) {
            bytes.push(byte(digits)?).ok()?;
        }

        postcard::take_from_bytes(&bytes)
            .ok()
            .filter(|(_, rest)| rest.is_empty())
            .map(|(request, _)| request)
    }
}

impl fmt::Display for Request {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bytes = &mut [0; MAX_BYTES];
        let bytes = postcard::to_slice(self, bytes).map_err(|_| fmt::Error)?;
        bytes.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}
