//! Machine code in memory: written while it cannot run, then made executable and never writable again.

use super::emit::Assembly;
use memmap2::{Mmap, MmapMut};

/// Executable code with its pool of constants behind it.
#[derive(Debug)]
pub(crate) struct Pages {
    map: Mmap,
    /// Offset of the pool.
    pool: usize,
}

impl Pages {
    /// Puts code into pages of its own.
    ///
    /// # Errors
    /// When the system gives no memory or forbids executing it.
    pub(crate) fn new(assembly: &Assembly) -> std::io::Result<Pages> {
        let pool = assembly.code.len().next_multiple_of(64);
        let mut map = MmapMut::map_anon(pool + assembly.pool.len().max(1))?;
        map[..assembly.code.len()].copy_from_slice(&assembly.code);
        map[pool..pool + assembly.pool.len()].copy_from_slice(&assembly.pool);
        Ok(Pages { map: map.make_exec()?, pool })
    }

    /// Address of the pool.
    pub(crate) fn pool(&self) -> u64 {
        self.map.as_ptr().expose_provenance() as u64 + self.pool as u64
    }

    /// Runs the code on a frame.
    ///
    /// # Safety
    /// The processor must have the instructions of the code's target. The frame must be as [`super::emit`] lays it
    /// out: counters of at least one, and pointers to memory that is as long as the groups need, of which the code may
    /// write its outputs' and the frame itself.
    pub(crate) unsafe fn run(&self, frame: *mut u64) {
        // SAFETY: the map holds code emitted for this calling convention, begins with its entry, and is executable.
        let entry: extern "sysv64" fn(*mut u64) = unsafe { std::mem::transmute(self.map.as_ptr()) };
        entry(frame);
    }
}
