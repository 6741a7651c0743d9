//! Finds the bundled scenes (`scenes/*.toml`), the meshes beside them and their pictures by looking into the folders, so
//! that adding a scene is adding its files: pages have them built in.

#![allow(
    clippy::disallowed_methods,
    clippy::disallowed_macros,
    reason = "a build script reads folders and speaks to cargo by printing"
)]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Folder of the scenes, from that of the repository; the meshes of `NAME.toml` lie in `NAME`.
const SCENES: &str = "scenes";
/// The same for their pictures.
const PICTURES: &str = "docs/pictures/scenes";

fn main() {
    let package = env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
    let out = env::var("OUT_DIR").expect("cargo sets OUT_DIR");
    let root = Path::new(&package).join("../..");
    let mut names = Vec::new();
    for folder in [SCENES, PICTURES] {
        println!("cargo::rerun-if-changed=../../{folder}");
    }
    for scene in files(&root.join(SCENES), |ending| ending == "toml") {
        let stem = scene.file_stem().expect("a file has a name").to_string_lossy().into_owned();
        names.push(format!("{SCENES}/{stem}.toml"));
        // Beside the meshes lie the programs that made them.
        for mesh in files(&root.join(SCENES).join(&stem), |ending| ending != "py") {
            let name = mesh.file_name().expect("a file has a name").to_string_lossy();
            names.push(format!("{SCENES}/{stem}/{name}"));
        }
        let picture = format!("{PICTURES}/{stem}.png");
        if root.join(&picture).is_file() {
            names.push(picture);
        }
    }
    let mut code = String::from("const FILES: &[(&str, &[u8])] = &[\n");
    for name in names {
        let path = root.join(&name);
        writeln!(code, "({name:?}, include_bytes!({:?})),", path.to_string_lossy()).expect("strings can be written to");
    }
    code.push_str("];\n");
    fs::write(Path::new(&out).join("embedded.rs"), code).expect("the build folder is writable");
}

/// The files of a folder with such an ending, in order of their names; none where there is no folder.
fn files(folder: &Path, wanted: fn(&str) -> bool) -> Vec<PathBuf> {
    let listed = fs::read_dir(folder).into_iter().flatten();
    let mut paths: Vec<_> = listed.map(|entry| entry.expect("a listed file can be read").path()).collect();
    paths.retain(|path| path.extension().and_then(|e| e.to_str()).is_some_and(wanted));
    paths.sort();
    paths
}
