//! Copies of the repository to try things on, below the target folder.
//!
//! A copy is brought up to date rather than made anew: a file that is the same keeps its time, so that cargo rebuilds in
//! a copy only what changed since the last run.

use crate::workspace::Workspace;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Brings the copy `name` up to date: the files of the repository, and `added` (path relative to the root, content) in
/// addition. Whatever else lies there is removed.
///
/// # Errors
/// Names the file that cannot be read or written, or the added file that the repository has already.
pub(crate) fn copy(workspace: &Workspace, name: &str, added: &[(String, String)]) -> Result<PathBuf, String> {
    let root = workspace.target.join("xtask").join("newcomer").join(name);
    fs::create_dir_all(&root).map_err(|e| format!("{}: {e}", root.display()))?;
    let mut wanted = BTreeSet::new();
    for file in &workspace.files {
        let from = workspace.root.join(file);
        let content = fs::read(&from).map_err(|e| format!("{file}: {e}"))?;
        write(&root.join(file), &content)?;
        wanted.insert(file.as_str());
    }
    for (file, content) in added {
        if !wanted.insert(file) {
            return Err(format!("{file} is in the repository already: choose another newcomer"));
        }
        write(&root.join(file), content.as_bytes())?;
    }
    for file in crate::workspace::files_below(&root)?.iter().filter(|f| !wanted.contains(f.as_str())) {
        fs::remove_file(root.join(file)).map_err(|e| format!("{}: {e}", root.join(file).display()))?;
    }
    Ok(root)
}

/// Writes a file unless it holds this content.
fn write(path: &Path, content: &[u8]) -> Result<(), String> {
    if fs::read(path).is_ok_and(|there| there == content) {
        return Ok(());
    }
    let folder = path.parent().expect("a file has a folder");
    fs::create_dir_all(folder).and_then(|()| fs::write(path, content)).map_err(|e| format!("{}: {e}", path.display()))
}
