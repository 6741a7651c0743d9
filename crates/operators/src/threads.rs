//! Work shared between threads such that the result does not depend on their number: every task writes its own part of
//! the output, and what a part contains is fixed by the data alone.

use rayon::prelude::*;

/// A fixed number of threads.
#[derive(Debug)]
pub struct Threads {
    pool: Option<rayon::ThreadPool>,
    count: usize,
}

impl Threads {
    /// This many threads; one means the calling thread.
    ///
    /// # Errors
    /// When the system does not give that many threads; the message says so.
    pub fn new(count: usize) -> Result<Threads, String> {
        let count = count.max(1);
        if count == 1 {
            return Ok(Threads { pool: None, count });
        }
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(count)
            .build()
            .map_err(|e| format!("{count} threads could not be started: {e}"))?;
        Ok(Threads { pool: Some(pool), count })
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Runs every task, in any order and place.
    pub fn run<T: Send>(&self, tasks: &mut [T], work: impl Fn(&mut T) + Sync) {
        match &self.pool {
            Some(pool) if tasks.len() > 1 => pool.install(|| tasks.par_iter_mut().for_each(&work)),
            _ => tasks.iter_mut().for_each(work),
        }
    }
}
