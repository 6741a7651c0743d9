//! Compiled pipelines on disk, one file per adapter, interface and driver.
//!
//! Inside, the driver finds a program's pipeline by the program; whatever it does not know it compiles.
//! A cache that cannot be read or written is no error: compiling again is all that is lost. A damaged one is ignored with
//! a note, and written anew.

use souple_kernels_gpu::{Description, cache};
use std::path::PathBuf;

/// The file for a device; `None` where there is no folder for caches.
fn file(d: &Description) -> Option<PathBuf> {
    let folder = match std::env::var_os("XDG_CACHE_HOME") {
        Some(folder) => PathBuf::from(folder),
        None => PathBuf::from(std::env::var_os("HOME")?).join(".cache"),
    };
    let name: String = cache::key(d)
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() || c == '-' || c == '.' { c } else { '_' })
        .collect();
    Some(folder.join("souple").join(format!("pipelines-{name}.bin")))
}

/// What an earlier run kept for a device, and what is wrong with it if something is.
pub(super) fn read(d: &Description) -> (Option<Vec<u8>>, Option<String>) {
    let Some(file) = file(d) else { return (None, None) };
    let Ok(bytes) = std::fs::read(&file) else { return (None, None) };
    match cache::unpack(d, &bytes) {
        Ok(data) => (Some(data.to_vec()), None),
        Err(why) => {
            let note =
                format!("the compiled pipelines in {} are not used: {why}; they are compiled again", file.display());
            (None, Some(note))
        }
    }
}

/// Keeps what a device compiled, if it is other than before.
pub(super) fn write(d: &Description, data: &[u8]) {
    let Some(file) = file(d) else { return };
    let content = cache::pack(d, data);
    if std::fs::read(&file).is_ok_and(|before| before == content) {
        return;
    }
    let Some(folder) = file.parent() else { return };
    // Two programs may write at once: each writes a file of its own and puts it in place whole.
    let part = file.with_extension(format!("{}.part", std::process::id()));
    let done = std::fs::create_dir_all(folder).and_then(|()| std::fs::write(&part, &content));
    if done.and_then(|()| std::fs::rename(&part, &file)).is_err() {
        // There may be nothing to remove; either way nobody reads it.
        let _ = std::fs::remove_file(&part);
    }
}
