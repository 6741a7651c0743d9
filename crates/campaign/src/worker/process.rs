//! A process whose end is noticed at once.
//!
//! Its output ends when the system closes what an ending process had open, some microseconds before the system says that
//! it has ended: who is woken by the one and asks for the other comes too early nearly every time, and would otherwise
//! wait for its next look. So the first question after the end of the output is repeated until it is answered.
//!
//! What it is not: a wait without end. A program that closes its output and works on is asked as often as any other.

use std::io;
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Time that passes at most between the end of the output and the end of the process.
const ENDING: Duration = Duration::from_millis(10);

/// A process with its output.
#[derive(Debug)]
pub(super) struct Process {
    child: Child,
    /// Set when its output has ended, until we have asked what that means.
    silent: Arc<AtomicBool>,
}

/// Starts a program; the calling thread is unparked when its output ends. What it says there is not kept.
///
/// # Errors
///
/// When the system cannot start it.
pub(super) fn spawn(command: &mut Command) -> io::Result<Process> {
    let mut child = command.stdout(Stdio::piped()).spawn()?;
    let silent = Arc::new(AtomicBool::new(false));
    if let Some(mut output) = child.stdout.take() {
        let (waiting, ended) = (std::thread::current(), silent.clone());
        std::thread::spawn(move || {
            // An output that cannot be read has ended for us.
            let _ = io::copy(&mut output, &mut io::sink());
            ended.store(true, Ordering::Release);
            waiting.unpark();
        });
    }
    Ok(Process { child, silent })
}

impl Process {
    /// How it ended, if it has.
    ///
    /// # Errors
    ///
    /// When the system does not tell.
    pub(super) fn ended(&mut self) -> io::Result<Option<ExitStatus>> {
        let closing = self.silent.swap(false, Ordering::Acquire);
        let since = Instant::now();
        loop {
            let status = self.child.try_wait()?;
            if status.is_some() || !closing || since.elapsed() > ENDING {
                return Ok(status);
            }
            std::thread::yield_now();
        }
    }

    /// Its standard input, once, where that is a pipe.
    pub(super) fn take_input(&mut self) -> Option<ChildStdin> {
        self.child.stdin.take()
    }

    /// Ends it, if it has not ended by itself, and waits until it has.
    ///
    /// # Errors
    ///
    /// When the system does not tell.
    pub(super) fn end(&mut self) -> io::Result<()> {
        // It may have ended just now.
        let _ = self.child.kill();
        self.child.wait().map(|_| ())
    }
}
