//! What a form carries, as words to keep and to go on from.

use core::fmt;

use crate::real::Real;

/// Why words are refused that a motion should go on from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum RestoreError {
    /// Not as many words as this form saves.
    WrongLength {
        /// How many there are.
        words: usize,
        /// How many it saves.
        expected: usize,
    },
    /// Saved by another form, with another pendulum or another step; or damaged since.
    NotSavedHere,
}

impl fmt::Display for RestoreError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RestoreError::WrongLength { words, expected } => write!(f, "{words} words: a checkpoint has {expected}"),
            RestoreError::NotSavedHere => f.write_str("not a checkpoint of this form, pendulum and step, or damaged"),
        }
    }
}

impl core::error::Error for RestoreError {}

/// A check word: FNV-1a over 64-bit words, which notices every change of a single one.
#[derive(Clone, Copy)]
pub(crate) struct Check(u64);

impl Check {
    /// Of nothing but the `kind` of form.
    pub fn new(kind: u64) -> Self {
        Self(0xcbf2_9ce4_8422_2325).with(kind)
    }

    /// With one more word.
    pub fn with(self, word: u64) -> Self {
        Self((self.0 ^ word).wrapping_mul(0x0000_0100_0000_01b3))
    }

    /// With more words.
    pub fn with_all(self, words: impl IntoIterator<Item = u64>) -> Self {
        words.into_iter().fold(self, Self::with)
    }

    /// The words that `feed` gives, N - 1 of them, behind a check of this form and them.
    pub fn save<const N: usize>(self, feed: impl FnOnce(&mut dyn FnMut(u64))) -> [u64; N] {
        let mut words = [0; N];
        let mut places = words.iter_mut().skip(1);
        feed(&mut |word| {
            if let Some(place) = places.next() {
                *place = word;
            }
        });
        let check = self.with_all(words.into_iter().skip(1));
        words[0] = check.0;
        words
    }

    /// The words behind the check, if it is theirs and this form's.
    pub fn open<const N: usize>(self, saved: &[u64]) -> Result<Words<'_>, RestoreError> {
        match saved {
            [check, words @ ..] if saved.len() == N => {
                let is_theirs = self.with_all(words.iter().copied()).0 == *check;
                if is_theirs { Ok(Words(words.iter())) } else { Err(RestoreError::NotSavedHere) }
            }
            _ => Err(RestoreError::WrongLength { words: saved.len(), expected: N }),
        }
    }
}

/// The words of a checkpoint, one after the other.
pub(crate) struct Words<'a>(core::slice::Iter<'a, u64>);

impl Words<'_> {
    /// The next word.
    pub fn word(&mut self) -> Result<u64, RestoreError> {
        self.0.next().copied().ok_or(RestoreError::NotSavedHere)
    }

    /// The number that the next word is the bit pattern of.
    pub fn number<R: Real>(&mut self) -> Result<R, RestoreError> {
        R::from_bits(self.word()?).ok_or(RestoreError::NotSavedHere)
    }

    /// What `each` makes of the words that follow, N times.
    pub fn each<T: Copy, const N: usize>(
        &mut self,
        mut each: impl FnMut(&mut Self) -> Result<T, RestoreError>,
    ) -> Result<[T; N], RestoreError> {
        let first = each(self)?;
        let mut all = [first; N];
        for next in all.iter_mut().skip(1) {
            *next = each(self)?;
        }
        Ok(all)
    }
}
