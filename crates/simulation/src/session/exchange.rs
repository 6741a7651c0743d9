//! Three buffers between one writer and one reader: neither ever waits for the other's work.
//!
//! ```text
//! writer's own ◄─swap─► the middle one ◄─swap─► reader's own
//! ```
//!
//! A lock is held for the swap of two pointers only.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The middle buffer, and whether the reader has not seen it.
struct Middle<T> {
    buffer: Box<T>,
    fresh: bool,
}

type Shared<T> = Arc<Mutex<Middle<T>>>;

/// The writer's end.
pub(crate) struct Writer<T> {
    /// What is written next.
    pub(crate) own: Box<T>,
    middle: Shared<T>,
}

/// The reader's end.
pub(crate) struct Reader<T> {
    own: Box<T>,
    middle: Shared<T>,
}

/// Both ends.
pub(crate) fn exchange<T: Default>() -> (Writer<T>, Reader<T>) {
    let middle = Arc::new(Mutex::new(Middle { buffer: Box::default(), fresh: false }));
    (Writer { own: Box::default(), middle: middle.clone() }, Reader { own: Box::default(), middle })
}

fn lock<T>(middle: &Shared<T>) -> MutexGuard<'_, Middle<T>> {
    // A panic between lock and unlock is impossible: nothing but pointers is swapped there.
    middle.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<T> Writer<T> {
    /// Offers what was written; the buffer that comes back holds something older.
    pub(crate) fn publish(&mut self) {
        let mut middle = lock(&self.middle);
        std::mem::swap(&mut self.own, &mut middle.buffer);
        middle.fresh = true;
    }

    /// Whether the reader has taken the last one.
    pub(crate) fn was_taken(&self) -> bool {
        !lock(&self.middle).fresh
    }
}

impl<T> Reader<T> {
    /// The newest.
    pub(crate) fn newest(&mut self) -> &T {
        let mut middle = lock(&self.middle);
        if middle.fresh {
            std::mem::swap(&mut self.own, &mut middle.buffer);
            middle.fresh = false;
        }
        drop(middle);
        &self.own
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The reader sees the newest, keeps it while there is none newer, and the writer knows when it was taken.
    #[test]
    fn the_newest_is_seen() {
        let (mut writer, mut reader) = exchange::<u32>();
        assert_eq!(*reader.newest(), 0);
        for value in [1, 2] {
            *writer.own = value;
            writer.publish();
        }
        assert!(!writer.was_taken());
        assert_eq!((*reader.newest(), *reader.newest()), (2, 2));
        assert!(writer.was_taken());
    }

    /// With both ends busy, what is read never goes back.
    #[test]
    fn what_is_read_never_goes_back() {
        let (mut writer, mut reader) = exchange::<u64>();
        let thread = std::thread::spawn(move || {
            for value in 1..=20_000 {
                *writer.own = value;
                writer.publish();
            }
        });
        let mut last = 0;
        while last < 20_000 {
            let now = *reader.newest();
            assert!(now >= last, "{now} after {last}");
            last = now;
        }
        thread.join().unwrap();
    }
}
