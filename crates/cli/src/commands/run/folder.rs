//! The folder of results: `BODY_0000.vtu`, …, `BODY.pvd`, `checkpoint.bin`, `last_good.vtu`, `summary.json`.
//!
//! The list of frames is written anew after each frame, so that what is on disk can be opened at any time.

use crate::failure::{Failure, input};
use crate::files;
use anyhow::Context as _;
use souple_simulation::Simulation;
use souple_simulation::mesh::formats::{PvdEntry, write_pvd};
use std::path::{Path, PathBuf};

pub(super) struct Folder {
    path: PathBuf,
    /// Whether frames are written at all.
    pub(super) pictures: bool,
    /// Times of the frames; a frame's number is its position.
    times: Vec<f64>,
    last_good: Vec<PathBuf>,
}

impl Folder {
    /// Makes the folder where there is none.
    pub(super) fn open(path: PathBuf) -> Result<Folder, Failure> {
        std::fs::create_dir_all(&path).with_context(|| format!("cannot make the folder {}", path.display()))?;
        Ok(Folder { path, pictures: true, times: Vec::new(), last_good: Vec::new() })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the present state of each body, unless that has been done for this time.
    pub(super) fn frame(&mut self, simulation: &mut Simulation) -> Result<(), Failure> {
        let time = simulation.time();
        if !self.pictures || self.times.last() == Some(&time) {
            return Ok(());
        }
        let frames = simulation.frame().map_err(input)?;
        let number = self.times.len();
        self.times.push(time);
        for (body, bytes) in &frames {
            files::write(&self.path.join(picture(body, number)), bytes)?;
        }
        // The lists last: they name only what exists.
        for (body, _) in &frames {
            let entries: Vec<PvdEntry> = self
                .times
                .iter()
                .enumerate()
                .map(|(number, &time)| PvdEntry { time, file: picture(body, number) })
                .collect();
            files::write(&self.path.join(format!("{body}.pvd")), write_pvd(&entries).as_bytes())?;
        }
        Ok(())
    }

    pub(super) fn checkpoint_path(&self) -> PathBuf {
        self.path.join("checkpoint.bin")
    }

    pub(super) fn checkpoint(&self, simulation: &Simulation) -> Result<(), Failure> {
        files::write(&self.checkpoint_path(), &simulation.checkpoint())
    }

    /// Puts the simulation back to the folder's checkpoint, and continues the folder's frames.
    pub(super) fn resume(&mut self, simulation: &mut Simulation) -> Result<(), Failure> {
        let path = self.checkpoint_path();
        if !path.is_file() {
            return Err(input(format!(
                "--resume: there is no {}; run with --checkpoint-every first, or name the folder with --out",
                path.display()
            )));
        }
        let bytes = files::read(&path)?;
        simulation.restore(&bytes).map_err(|e| input(format!("{}: {e}", path.display())))?;
        let changes = simulation.changed_by_hand();
        if !changes.is_empty() {
            eprintln!("{}: goes on with what was changed by hand: {}", path.display(), changes.words().join(", "));
        }
        let bodies = simulation.scene().bodies.iter().map(|b| &b.value.name.value);
        if let Some(list) = bodies.map(|name| self.path.join(format!("{name}.pvd"))).find(|p| p.is_file()) {
            self.times = times(&files::read_text(&list)?);
        }
        // Frames from after the checkpoint will be computed again.
        self.times.retain(|&t| t <= simulation.time());
        Ok(())
    }

    /// Writes what is left after a failure.
    pub(super) fn last_good(&mut self, simulation: &mut Simulation) -> Result<(), Failure> {
        self.checkpoint(simulation)?;
        let frames = simulation.frame().map_err(input)?;
        for (body, bytes) in &frames {
            let name = if frames.len() == 1 { "last_good.vtu".to_owned() } else { format!("last_good_{body}.vtu") };
            let path = self.path.join(name);
            files::write(&path, bytes)?;
            self.last_good.push(path);
        }
        Ok(())
    }

    pub(super) fn last_good_name(&self) -> String {
        self.last_good.iter().map(|p| p.display().to_string()).collect::<Vec<_>>().join(", ")
    }

    pub(super) fn summary(&self, json: &serde_json::Value) -> Result<(), Failure> {
        let text = serde_json::to_string_pretty(json).context("cannot write the summary as JSON")?;
        files::write(&self.path.join("summary.json"), text.as_bytes())
    }
}

fn picture(body: &str, number: usize) -> String {
    format!("{body}_{number:04}.vtu")
}

/// Times of the entries of a `.pvd` file that this program wrote.
fn times(pvd: &str) -> Vec<f64> {
    let values = pvd.split("timestep=\"").skip(1);
    values.filter_map(|rest| rest.split('"').next()?.parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The times of a list are read back as they were written, to the last bit.
    #[test]
    fn times_are_read_back() {
        let written = [0.0, 0.1 + 0.2, 1e-300, 12345.678];
        let entries: Vec<PvdEntry> = written.iter().map(|&time| PvdEntry { time, file: "a.vtu".into() }).collect();
        assert_eq!(times(&write_pvd(&entries)), written);
    }
}
