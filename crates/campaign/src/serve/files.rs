//! The files of a simulation, among the results.
//!
//! What is asked for is compared with what lies there, and never made into a path: nothing outside can be named.

use super::{Answer, Body, HTML, JSON, ok};
use crate::report::page::escaped;
use std::fs;
use std::path::{Path, PathBuf};

/// A part of an address (RFC 3986).
pub fn percent_encoded(part: &str) -> String {
    let plain = |b: u8| b.is_ascii_alphanumeric() || b"-._~".contains(&b);
    part.bytes().map(|b| if plain(b) { char::from(b).to_string() } else { format!("%{b:02X}") }).collect()
}

/// Names and paths of the files of a simulation in their order; none where there is no such folder.
fn files(results: &Path, hash: &str) -> Option<Vec<(String, PathBuf)>> {
    let is_hash = hash.len() == 64 && hash.bytes().all(|b| b.is_ascii_hexdigit());
    let entries = is_hash.then(|| fs::read_dir(results.join(hash)).ok()).flatten()?.flatten();
    // Links lead elsewhere.
    let entries = entries.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_file()));
    let mut all: Vec<_> = entries.map(|e| (e.file_name().to_string_lossy().into_owned(), e.path())).collect();
    all.sort();
    Some(all)
}

/// A page with the files of a simulation.
pub(super) fn list(results: &Path, hash: &str) -> Option<Answer> {
    let row =
        |name: &str| format!("<li><a href=\"/results/{hash}/{}\">{}</a></li>", percent_encoded(name), escaped(name));
    let rows: String = files(results, hash)?.iter().map(|(name, _)| row(name)).collect();
    let text = format!(
        "<!DOCTYPE html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">\
         <meta name=\"color-scheme\" content=\"light dark\"><link rel=\"icon\" href=\"data:,\"><title>Results</title>\
         <style>body {{ font: 16px/1.6 system-ui, sans-serif; max-width: 40em; margin: 3em auto; padding: 0 1em }}</style>\
         <h1>Results</h1><p><code>{}…</code></p><ul>{rows}</ul>",
        &hash[..16]
    );
    Some(ok(HTML, text.into_bytes()))
}

/// A file of a simulation.
pub(super) fn file(results: &Path, hash: &str, asked: &str) -> Option<Answer> {
    let (_, path) = files(results, hash)?.into_iter().find(|(name, _)| percent_encoded(name) == asked)?;
    let kind = match path.extension().and_then(|extension| extension.to_str()) {
        Some("png") => "image/png",
        Some("json") => JSON,
        Some("txt" | "toml" | "csv") => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    };
    Some(Answer { body: Body::File(path), ..ok(kind, Vec::new()) })
}
