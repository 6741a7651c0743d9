//! Finds the laws (`src/laws/*.rs`) by looking into their folder, so that adding one is adding one file.

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
    let folder = Path::new(&root).join("src/laws");
    println!("cargo::rerun-if-changed=src/laws");
    let mut files: Vec<_> = fs::read_dir(&folder)
        .unwrap_or_else(|e| panic!("{}: {e}", folder.display()))
        .map(|entry| entry.expect("a listed file can be read").path())
        .filter(|path| path.extension().is_some_and(|e| e == "rs"))
        .collect();
    files.sort();
    let mut code = String::new();
    let mut all = String::new();
    for path in files {
        let stem = path.file_stem().expect("a file has a name").to_string_lossy();
        writeln!(code, "#[path = {:?}]\npub mod {stem};", path.to_string_lossy()).expect("strings can be written to");
        write!(all, "&{stem}::LAW, ").expect("strings can be written to");
    }
    writeln!(code, "static ALL: &[&crate::Law] = &[{all}];").expect("strings can be written to");
    fs::write(Path::new(&out).join("scanned.rs"), code).expect("the build folder is writable");
}
