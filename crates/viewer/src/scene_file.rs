//! A scene file as a simulation; mesh files are read beside it.

use crate::files;
use souple_simulation::{RunOptions, Simulation};
use std::path::Path;

/// Reads a scene and builds its simulation; the second result are warnings.
///
/// # Errors
/// What is wrong, in words, with the place in the scene.
pub fn load(path: &Path, overrides: &[String], options: &RunOptions) -> Result<(Simulation, Vec<String>), String> {
    let text = String::from_utf8(files::read(path)?)
        .map_err(|e| format!("cannot read {}: it is not text in UTF-8 ({e})", path.display()))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut read = |file: &str| files::read(&folder.join(file));
    Simulation::load(&text, &path.display().to_string(), overrides, &mut read, options).map_err(|e| e.to_string())
}
