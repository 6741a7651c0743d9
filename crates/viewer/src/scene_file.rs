//! A scene file as a simulation; mesh files are read beside it.

use souple_simulation::{RunOptions, Simulation};
use std::path::Path;

/// Reads a scene and builds its simulation; the second result are warnings.
///
/// # Errors
/// What is wrong, in words, with the place in the scene.
pub fn load(path: &Path, overrides: &[String], options: &RunOptions) -> Result<(Simulation, Vec<String>), String> {
    let text = std::fs::read_to_string(path).map_err(|e| format!("cannot read {}: {e}", path.display()))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut read = |file: &str| {
        let path = folder.join(file);
        std::fs::read(&path).map_err(|e| format!("cannot read {}: {e}", path.display()))
    };
    Simulation::load(&text, &path.display().to_string(), overrides, &mut read, options).map_err(|e| e.to_string())
}
