//! States to go back to, in bounded memory: when it is full, every other one is forgotten.
//!
//! So the past is remembered evenly, less densely the longer it is; what lies between two states is computed again.

use crate::interaction::Controls;
use std::sync::Arc;

/// A state to go back to.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub(crate) step: u64,
    pub(crate) checkpoint: Vec<u8>,
    pub(crate) controls: Arc<Controls>,
}

/// Steps that can be gone back to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HistoryRange {
    /// The last step that was made; those from the beginning can be gone back to.
    pub last: u64,
    /// Memory in bytes.
    pub bytes: usize,
    /// Steps from one state that is kept to the next.
    pub stride: u64,
}

/// States in the order of their steps; the first one is the beginning and is never forgotten.
#[derive(Debug)]
pub(crate) struct History {
    entries: Vec<Entry>,
    bytes: usize,
    limit: usize,
    stride: u64,
    last: u64,
}

impl History {
    pub(crate) fn new(limit: usize, first: Entry) -> History {
        let bytes = first.checkpoint.len();
        History { last: first.step, entries: vec![first], bytes, limit, stride: 1 }
    }

    /// Takes note of a step, and keeps its state when it is due.
    pub(crate) fn note(&mut self, step: u64, state: impl FnOnce() -> Entry) {
        self.last = step;
        if !step.is_multiple_of(self.stride) {
            return;
        }
        let entry = state();
        self.bytes += entry.checkpoint.len();
        self.entries.push(entry);
        while self.bytes > self.limit && self.entries.len() > 2 {
            self.stride *= 2;
            let stride = self.stride;
            let first = self.entries[0].step;
            self.entries.retain(|e| e.step == first || e.step.is_multiple_of(stride));
            self.bytes = self.entries.iter().map(|e| e.checkpoint.len()).sum();
        }
    }

    /// The last state at or before a step.
    pub(crate) fn before(&self, step: u64) -> &Entry {
        let after = self.entries.partition_point(|e| e.step <= step);
        &self.entries[after.saturating_sub(1)]
    }

    /// Forgets what came after a step.
    pub(crate) fn forget_after(&mut self, step: u64) {
        let first = self.entries[0].step;
        self.entries.retain(|e| e.step == first || e.step <= step);
        self.bytes = self.entries.iter().map(|e| e.checkpoint.len()).sum();
        self.last = step;
    }

    pub(crate) fn range(&self) -> HistoryRange {
        HistoryRange { last: self.last, bytes: self.bytes, stride: self.stride }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interaction::Controls;
    use std::collections::{BTreeMap, BTreeSet};

    fn entry(step: u64) -> Entry {
        let controls = Arc::new(Controls {
            gravity: [0.0; 3],
            step: 0.01,
            velocity_damping: 0.0,
            parameters: Vec::new(),
            pulls: BTreeMap::new(),
            tool: None,
            held: BTreeMap::new(),
            freed: BTreeSet::new(),
        });
        Entry { step, checkpoint: vec![0; 100], controls }
    }

    /// However long a run is, memory stays within its bound, the beginning is kept, and some state lies before any step.
    #[test]
    fn memory_is_bounded() {
        let mut history = History::new(1000, entry(0));
        for step in 1..=5000 {
            history.note(step, || entry(step));
            assert!(history.bytes <= 1000);
        }
        assert_eq!(history.entries[0].step, 0);
        for step in [0, 1, 777, 5000] {
            let found = history.before(step).step;
            assert!(found <= step && step - found < 2 * history.stride, "{found} for {step}");
        }
        history.forget_after(1234);
        assert_eq!(history.range().last, 1234);
        assert!(history.entries.iter().all(|e| e.step <= 1234));
    }
}
