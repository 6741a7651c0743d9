//! No finite-element word below the border: expressions, programs and kernels serve anything that computes.
//!
//! The words are looked for in code, comments and strings alike, in whole and inside identifiers; plurals count.
//! A word that belongs to other fields too is not in the list, and the list says so.

use crate::rust_source::{identifiers, words};
use crate::stages::Outcome;
use crate::workspace::Workspace;

/// Folders that know nothing of finite elements.
const FOLDERS: &[&str] =
    &["crates/symbols/", "crates/program/", "crates/kernels/", "crates/kernels-cpu/", "crates/kernels-gpu/"];

/// What may not be said there, and what to say instead.
///
/// Not in the list: `node` (of a graph), `point`, `table`, `shape` (of an array), `body` (of a loop), `rest` (of a
/// list), `force` and `field`, which are words of other fields too.
const WORDS: &[(&str, &str)] = &[
    ("element", "an instance of a program is an item; an entry of an array is an entry"),
    ("law", "what is differentiated is an expression"),
    ("stress", "a derivative of an expression is a derivative"),
    ("strain", "a value computed from inputs is a value"),
    ("stiffness", "a second derivative is a second derivative"),
    ("displacement", "inputs have no meaning here, only a binding time"),
    ("deformation", "inputs have no meaning here, only a binding time"),
    ("mesh", "indices come from a gather table"),
    ("particle", "what a program gathers from is a buffer"),
    ("nodal", "a value per index is a value per index"),
    ("connectivity", "indices come from a gather table"),
    ("fem", "say what is computed"),
    ("tetra", "sizes are numbers"),
    ("tetrahedron", "sizes are numbers"),
    ("tetrahedral", "sizes are numbers"),
    ("hexahedron", "sizes are numbers"),
    ("hexahedral", "sizes are numbers"),
    ("prism", "sizes are numbers"),
    ("pyramid", "sizes are numbers"),
    ("quadrature", "a sum over points is a point sum"),
    ("gauss", "a sum over points is a point sum"),
    ("young", "parameters are symbols"),
    ("poisson", "parameters are symbols"),
    ("lame", "parameters are symbols"),
    ("lamé", "parameters are symbols"),
    ("elastic", "say what is computed"),
    ("elasticity", "say what is computed"),
    ("hyperelastic", "say what is computed"),
    ("corotational", "say what is computed"),
    ("hooke", "say what is computed"),
    ("stvk", "say what is computed"),
];

/// Ids of elements: a kind and a number of nodes (`tet4`, `hex20`).
const KINDS: &[&str] = &["tet", "hex", "tri", "quad", "prism", "wedge", "pyramid"];

/// Where a word may stand all the same.
struct Exception {
    /// File.
    file: &'static str,
    /// Word, as in [`WORDS`].
    word: &'static str,
    /// Part of the line.
    line: &'static str,
    /// Why.
    reason: &'static str,
}

const EXCEPTIONS: &[Exception] = &[];

pub(crate) fn run(workspace: &Workspace) -> Outcome {
    let mut findings = Vec::new();
    let mut used = vec![false; EXCEPTIONS.len()];
    let files: Vec<&str> = FOLDERS
        .iter()
        .flat_map(|folder| ["rs", "toml", "md", "wgsl", "prog"].into_iter().flat_map(|e| workspace.files_in(folder, e)))
        .collect();
    for file in &files {
        let text = match workspace.read(file) {
            Ok(text) => text,
            Err(complaint) => {
                findings.push(complaint);
                continue;
            }
        };
        for (number, line) in text.lines().enumerate() {
            for (word, instead) in found(line) {
                let exception =
                    EXCEPTIONS.iter().position(|e| e.file == *file && e.word == word && line.contains(e.line));
                match exception {
                    Some(k) => used[k] = true,
                    None => findings.push(format!("{file}:{}: `{word}`: {instead}", number + 1)),
                }
            }
        }
    }
    for (exception, _) in EXCEPTIONS.iter().zip(&used).filter(|(_, used)| !**used) {
        let Exception { file, word, reason, .. } = exception;
        findings.push(format!("the exception for `{word}` in {file} ({reason}) is no longer needed: remove it"));
    }
    Outcome::of(findings, || format!("{} files, {} exceptions", files.len(), EXCEPTIONS.len()))
}

/// The forbidden words of a line with what to say instead.
fn found(line: &str) -> Vec<(&'static str, &'static str)> {
    let mut found = Vec::new();
    for word in identifiers(line).flat_map(words) {
        let singular =
            [word.as_str(), word.strip_suffix('s').unwrap_or(&word), word.strip_suffix("es").unwrap_or(&word)];
        if let Some(&entry) = WORDS.iter().find(|(w, _)| singular.contains(w)) {
            found.push(entry);
        } else if KINDS
            .iter()
            .any(|k| word.strip_prefix(k).is_some_and(|n| !n.is_empty() && n.chars().all(|c| c.is_ascii_digit())))
        {
            found.push(("element id", "sizes are numbers"));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The words are found in every style and number, and not inside other words.
    #[test]
    fn words_are_found_and_only_they() {
        for line in
            ["/// of the elements", "let ElementCount = 3", "mesh_size", "TET4", "hex20_force", "stresses", "`meshes`"]
        {
            assert_eq!(found(line).len(), 1, "{line}");
        }
        for line in [
            "elementary",
            "flaw",
            "lawful",
            "a node of the graph",
            "triangle",
            "quad",
            "tri",
            "constrained",
            "distress",
        ] {
            assert_eq!(found(line), [], "{line}");
        }
    }
}
