//! Arrays of lanes that begin where a line of the cache begins.
//!
//! A group's place is 64 bytes of doubles, one line; in an array that begins elsewhere each place straddles two lines,
//! and every vector that does so is read or written twice.
//! Kernels take any slice: this is about speed only.

use crate::Number;
use std::ops::{Deref, DerefMut};

/// Bytes of a line of the cache, and of the widest vector.
const LINE: usize = 64;

/// Numbers that begin at a multiple of 64 bytes; otherwise like a vector of fixed length.
#[derive(Debug, Default)]
pub struct Aligned<T = f64> {
    /// The numbers, with room before the first.
    block: Vec<T>,
    first: usize,
}

impl<T: Number> Aligned<T> {
    /// So many zeros.
    pub fn zeros(count: usize) -> Aligned<T> {
        Aligned::filled(count, T::ZERO)
    }

    /// So many times the same.
    pub fn filled(count: usize, value: T) -> Aligned<T> {
        if count == 0 {
            return Aligned { block: Vec::new(), first: 0 };
        }
        let most = LINE / T::SIZE - 1;
        let mut block = vec![value; count + most];
        // Where memory is only pretended the distance may be unknown; any place will do then.
        let first = block.as_ptr().align_offset(LINE);
        let first = if first <= most { first } else { 0 };
        block.truncate(first + count);
        Aligned { block, first }
    }

    /// Makes it this long, keeping nothing of what it holds unless it is that long already.
    pub fn set_len(&mut self, count: usize) {
        if self.len() != count {
            *self = Aligned::zeros(count);
        }
    }
}

impl<T: Number> Clone for Aligned<T> {
    fn clone(&self) -> Aligned<T> {
        let mut copy = Aligned::zeros(self.len());
        copy.copy_from_slice(self);
        copy
    }
}

impl<T> Deref for Aligned<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.block[self.first..]
    }
}

impl<T> DerefMut for Aligned<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.block[self.first..]
    }
}

impl<'a, T> IntoIterator for &'a Aligned<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Arrays of any length begin at a line, copies too, and copies hold the same.
    #[test]
    fn arrays_begin_at_a_line() {
        for count in [1, 7, 8, 9, 1000, 100_000] {
            let mut array = Aligned::<f64>::zeros(count);
            array[count - 1] = 3.0;
            let copy = array.clone();
            for a in [&array, &copy] {
                assert_eq!((a.len(), a.as_ptr() as usize % LINE), (count, 0));
            }
            assert_eq!(array[..], copy[..]);
            assert_eq!(Aligned::<f32>::filled(count, 1.0).as_ptr() as usize % LINE, 0);
        }
        assert!(Aligned::<f64>::zeros(0).is_empty());
    }

    /// A change of length gives zeros, none keeps the numbers.
    #[test]
    fn only_a_new_length_makes_zeros() {
        let mut array = Aligned::<f64>::filled(5, 2.0);
        array.set_len(5);
        assert_eq!(array[..], [2.0; 5]);
        array.set_len(6);
        assert_eq!(array[..], [0.0; 6]);
    }
}
