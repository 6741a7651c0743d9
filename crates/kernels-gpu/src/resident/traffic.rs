//! Bytes between host and device, by what they were for: a step must cost the same for a large model as for a small one,
//! and whoever doubts it reads it here.
//!
//! Every transfer of a [`Resident`](super::Resident) after its making names its purpose, so that the purposes add up to
//! what the device counts in all.

use crate::device::Transfers;
use std::sync::atomic::{AtomicU64, Ordering};

/// What bytes were moved for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    /// The numbers of a step and the record of its solve.
    Step,
    /// Rows that were asked for, and which.
    Rows,
    /// Whole states.
    State,
}

/// Counters of a model on a device.
#[derive(Debug, Default)]
pub(super) struct Counters([[AtomicU64; 2]; 3]);

/// Bytes moved since the model was put on its device, by purpose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Numbers of steps, there; records of solves, back. Grows with the number of steps, loads and moved unknowns.
    pub step: Transfers,
    /// Numbers of rows that somebody wants, there, once; these rows, back. Grows with their number.
    pub rows: Transfers,
    /// Whole states. Grows with the model.
    pub state: Transfers,
}

impl Counters {
    pub(super) fn sent(&self, purpose: Purpose, bytes: usize) {
        self.0[purpose as usize][0].fetch_add(bytes as u64, Ordering::Relaxed);
    }

    pub(super) fn came_back(&self, purpose: Purpose, bytes: usize) {
        self.0[purpose as usize][1].fetch_add(bytes as u64, Ordering::Relaxed);
    }

    pub(super) fn read(&self) -> Traffic {
        let of = |purpose: Purpose| {
            let [uploaded, downloaded] = &self.0[purpose as usize];
            Transfers { uploaded: uploaded.load(Ordering::Relaxed), downloaded: downloaded.load(Ordering::Relaxed) }
        };
        Traffic { step: of(Purpose::Step), rows: of(Purpose::Rows), state: of(Purpose::State) }
    }
}
