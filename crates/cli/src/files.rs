//! Files: every failure names the path and the reason.

use crate::failure::Failure;
use anyhow::Context as _;
use std::io::Read as _;
use std::path::Path;

/// The bytes of a file; `-` is standard input.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    if path == Path::new("-") {
        let mut bytes = Vec::new();
        std::io::stdin().read_to_end(&mut bytes).context("cannot read standard input")?;
        return Ok(bytes);
    }
    Ok(std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?)
}

/// The text of a file; `-` is standard input.
pub(crate) fn read_text(path: &Path) -> Result<String, Failure> {
    let bytes = read(path)?;
    Ok(String::from_utf8(bytes).with_context(|| format!("{} is not UTF-8 text", path.display()))?)
}

/// Writes a file, making its folder where there is none.
///
/// The content goes to a neighbour first and takes the file's name when it is complete: a full disk or an interruption
/// leaves no half file under the name, and what was there before stays until then.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    put(path, bytes).map_err(Failure::Output)
}

fn put(path: &Path, bytes: &[u8]) -> Result<(), anyhow::Error> {
    let context = || format!("cannot write {}", path.display());
    if let Some(folder) = path.parent().filter(|f| !f.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).with_context(|| format!("cannot make the folder {}", folder.display()))?;
    }
    // What is no plain file (a device, a pipe) cannot be replaced; it is written to.
    if std::fs::metadata(path).is_ok_and(|m| !m.is_file()) {
        std::fs::write(path, bytes).with_context(context)?;
        return Ok(());
    }
    let mut name = path.file_name().map(ToOwned::to_owned).unwrap_or_default();
    name.push(".part");
    let part = path.with_file_name(name);
    let written = std::fs::write(&part, bytes).and_then(|()| std::fs::rename(&part, path));
    if written.is_err() {
        // The reason that matters is the first one.
        let _ = std::fs::remove_file(&part);
    }
    written.with_context(context)
}
