//! Finds the elements (`src/elements/*.rs`) and the quadrature rules (`rules/*.rule`) by looking into their folders,
//! so that adding one is adding one file.

#![allow(
    clippy::disallowed_methods,
    clippy::disallowed_macros,
    reason = "a build script reads folders and speaks to cargo by printing"
)]

use std::fmt::Write as _;
use std::{env, fs, path::Path};

fn main() {
    let root = env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
    let out = env::var("OUT_DIR").expect("cargo sets OUT_DIR");
    let root = Path::new(&root);
    let mut code = String::new();

    println!("cargo::rerun-if-changed=src/elements");
    let elements = files(&root.join("src/elements"), "rs");
    for (stem, path) in &elements {
        writeln!(code, "#[path = {path:?}]\npub mod {stem};").expect("writing to a string cannot fail");
    }
    let all: String = elements.iter().map(|(stem, _)| format!("&{stem}::ELEMENT, ")).collect();
    writeln!(code, "static ALL: &[&crate::Element] = &[{all}];").expect("writing to a string cannot fail");

    println!("cargo::rerun-if-changed=rules");
    let mut rules = String::new();
    for (stem, path) in files(&root.join("rules"), "rule") {
        writeln!(rules, "    ({stem:?}, include_str!({path:?})),").expect("writing to a string cannot fail");
    }
    writeln!(code, "static RULE_TEXTS: &[(&str, &str)] = &[\n{rules}];").expect("writing to a string cannot fail");

    fs::write(Path::new(&out).join("scanned.rs"), code).expect("the build folder is writable");
}

/// Stem and absolute path of every file of a folder with this extension, sorted by name.
fn files(folder: &Path, extension: &str) -> Vec<(String, String)> {
    let mut found: Vec<(String, String)> = fs::read_dir(folder)
        .unwrap_or_else(|e| panic!("{}: {e}", folder.display()))
        .map(|entry| entry.expect("a listed file can be read").path())
        .filter(|path| path.extension().is_some_and(|e| e == extension))
        .map(|path| {
            let stem = path.file_stem().expect("a file has a name").to_string_lossy().into_owned();
            (stem, path.to_string_lossy().into_owned())
        })
        .collect();
    found.sort();
    found
}
