//! Files of the machine.

use std::path::{Path, PathBuf};

/// A file's content.
///
/// # Errors
/// That it cannot be read, with its name and the system's reason.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, String> {
    std::fs::read(path).map_err(|e| format!("cannot read {}: {e}", path.display()))
}

/// The scenes in the folder `scenes` here or above, in order of their names.
pub(crate) fn scenes() -> Vec<PathBuf> {
    let here = std::env::current_dir().ok();
    let root = here.as_deref().and_then(|here| here.ancestors().find(|folder| folder.join("scenes").is_dir()));
    let listed = root.map(|root| std::fs::read_dir(root.join("scenes")));
    let mut paths: Vec<PathBuf> = listed.into_iter().flatten().flatten().flatten().map(|entry| entry.path()).collect();
    paths.retain(|p| p.extension().is_some_and(|e| e == "toml"));
    paths.sort();
    paths
}

/// The picture of a bundled scene as a PNG file, if there is one.
pub(crate) fn picture(scene: &Path) -> Option<Vec<u8>> {
    let root = scene.parent()?.parent()?;
    let name = scene.file_stem()?.to_string_lossy();
    std::fs::read(root.join("docs/pictures/scenes").join(format!("{name}.png"))).ok()
}
