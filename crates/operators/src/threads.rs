//! Work shared between threads such that the result does not depend on their number: every task writes its own part of
//! the output, and what a part contains is fixed by the data alone.

use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

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

    /// Does `work` while the threads stay awake, so that handing them tasks costs less than a microsecond instead of the
    /// tens that waking takes. They look for tasks all the time: for the length of a step, not for waiting.
    pub fn awake<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        let Some(pool) = &self.pool else { return work() };
        let done = AtomicBool::new(false);
        let done = &done;
        pool.scope(|scope| {
            let own = rayon::current_thread_index();
            scope.spawn_broadcast(move |_, context| {
                if Some(context.index()) != own {
                    look_for_tasks(done);
                }
            });
            // Also when `work` panics: the others must not look for ever.
            let _end = OnDrop(|| done.store(true, Ordering::Release));
            work()
        })
    }

    /// Runs every task, in any order and place.
    pub fn run<T: Send>(&self, tasks: &mut [T], work: impl Fn(&mut T) + Sync) {
        match &self.pool {
            Some(pool) if tasks.len() > 1 => pool.install(|| tasks.par_iter_mut().for_each(&work)),
            _ => tasks.iter_mut().for_each(work),
        }
    }
}

/// Idle looks after which the processor is offered to whoever else wants it.
const PATIENCE: u32 = 64;

fn look_for_tasks(done: &AtomicBool) {
    let mut idle = 0;
    while !done.load(Ordering::Acquire) {
        if rayon::yield_now() == Some(rayon::Yield::Executed) {
            idle = 0;
            continue;
        }
        idle += 1;
        if idle % PATIENCE == 0 {
            std::thread::yield_now();
        } else {
            std::hint::spin_loop();
        }
    }
}

struct OnDrop<F: FnMut()>(F);

impl<F: FnMut()> Drop for OnDrop<F> {
    fn drop(&mut self) {
        (self.0)();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tasks inside and outside of `awake`, also nested, are all run, and its result comes back.
    #[test]
    fn everything_runs_while_awake() {
        for count in 1..=4 {
            let threads = Threads::new(count).expect("a few threads");
            let squares = |threads: &Threads| -> Vec<usize> {
                let mut tasks: Vec<usize> = (0..100).collect();
                threads.run(&mut tasks, |task| *task *= *task);
                tasks
            };
            let expected: Vec<usize> = (0..100).map(|n| n * n).collect();
            assert_eq!(squares(&threads), expected);
            let inside = threads.awake(|| (squares(&threads), threads.awake(|| squares(&threads))));
            assert_eq!(inside, (expected.clone(), expected), "{count} threads");
        }
    }

    /// A panic while awake comes out, and the threads can be used again.
    #[test]
    fn a_panic_ends_being_awake() {
        let threads = Threads::new(3).expect("a few threads");
        let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| threads.awake(|| panic!("on purpose"))));
        assert!(caught.is_err());
        assert_eq!(threads.awake(|| 7), 7);
    }
}
