//! A series for ParaView, written while a session runs: `BODY_0000.vtu`, …, and `BODY.pvd` that lists them.

use crate::run::{RunError, Simulation};
use souple_mesh::formats::{PvdEntry, write_pvd};
use std::path::PathBuf;

/// A recording that goes on.
#[derive(Debug)]
pub(crate) struct Recorder {
    folder: PathBuf,
    every: f64,
    next: f64,
    times: Vec<f64>,
}

impl Recorder {
    /// Makes the folder; the present state becomes the first frame.
    pub(crate) fn start(folder: PathBuf, every: f64, simulation: &mut Simulation) -> Result<Recorder, RunError> {
        let refuse = |message: String| RunError { message };
        if !(every >= 0.0 && every.is_finite()) {
            return Err(refuse(format!("a recording needs a time between frames of at least 0 s, found {every}")));
        }
        std::fs::create_dir_all(&folder)
            .map_err(|e| refuse(format!("cannot make the folder {}: {e}", folder.display())))?;
        let mut recorder = Recorder { folder, every, next: simulation.time(), times: Vec::new() };
        recorder.note(simulation)?;
        Ok(recorder)
    }

    /// Writes a frame when it is due.
    pub(crate) fn note(&mut self, simulation: &mut Simulation) -> Result<(), RunError> {
        let time = simulation.time();
        if time < self.next * (1.0 - 1e-12) {
            return Ok(());
        }
        self.next = time + self.every;
        let write = |name: String, bytes: &[u8]| {
            let path = self.folder.join(name);
            std::fs::write(&path, bytes)
                .map_err(|e| RunError { message: format!("cannot write {}: {e}", path.display()) })
        };
        let number = self.times.len();
        let frames = simulation.frame()?;
        self.times.push(time);
        for (body, bytes) in &frames {
            write(format!("{body}_{number:04}.vtu"), bytes)?;
        }
        // The lists last: they name only what exists.
        for (body, _) in &frames {
            let file = |number: usize| format!("{body}_{number:04}.vtu");
            let entries: Vec<PvdEntry> =
                self.times.iter().enumerate().map(|(n, &time)| PvdEntry { time, file: file(n) }).collect();
            write(format!("{body}.pvd"), write_pvd(&entries).as_bytes())?;
        }
        Ok(())
    }

    /// Frames written so far.
    pub(crate) fn frames(&self) -> usize {
        self.times.len()
    }
}
