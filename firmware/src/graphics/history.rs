//! The last values of a series.

/// The last `N` values written; the oldest is forgotten first. Nothing in it can panic.
#[derive(Clone, Debug)]
pub struct History<T, const N: usize> {
    values: [T; N],
    /// Where the next value goes.
    next: usize,
    written: usize,
}

impl<T: Copy, const N: usize> History<T, N> {
    /// Nothing yet; `filler` stands where nothing is written and is never given out.
    pub fn new(filler: T) -> Self {
        Self { values: [filler; N], next: 0, written: 0 }
    }

    /// Adds the newest value.
    pub fn write(&mut self, value: T) {
        if let Some(place) = self.values.get_mut(self.next) {
            *place = value;
        }
        self.next = if self.next + 1 < N { self.next + 1 } else { 0 };
        self.written = self.written.saturating_add(1).min(N);
    }

    /// How many values are kept.
    pub fn len(&self) -> usize {
        self.written
    }

    /// Whether nothing is kept.
    pub fn is_empty(&self) -> bool {
        self.written == 0
    }

    /// The values from the oldest to the newest.
    pub fn oldest_first(&self) -> impl Iterator<Item = &T> + Clone {
        let (newer, older) = self.values.split_at_checked(self.next).unwrap_or_default();
        older.iter().chain(newer).skip(N.saturating_sub(self.written))
    }
}
