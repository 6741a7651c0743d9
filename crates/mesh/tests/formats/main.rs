//! The mesh formats: what other programs write is read, what is written is read back, and nothing panics.
#![allow(clippy::disallowed_methods, reason = "the samples that other programs wrote are files")]

mod errors;
mod menagerie;
mod mutation;
mod round_trip;
mod samples;
mod surfaces;
mod vtu_fields;

use souple_mesh::formats::{FormatError, ImportReport, ReadOptions, read};
use souple_mesh::{Mesh, Region};

/// A file of the data folder.
fn sample(name: &str) -> Vec<u8> {
    let path = format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read(&path).unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// All mesh files of the data folder, by name.
fn samples() -> Vec<(String, Vec<u8>)> {
    let folder = format!("{}/tests/data", env!("CARGO_MANIFEST_DIR"));
    let mut names: Vec<String> = std::fs::read_dir(&folder)
        .unwrap_or_else(|e| panic!("{folder}: {e}"))
        .map(|entry| entry.expect("a listed file can be looked at").file_name().to_string_lossy().into_owned())
        .filter(|name| !name.ends_with(".py"))
        .collect();
    names.sort();
    assert!(names.len() > 40, "the samples are missing");
    names.into_iter().map(|name| (name.clone(), sample(&name))).collect()
}

fn read_sample(name: &str) -> (Mesh, ImportReport) {
    read(name, &sample(name), ReadOptions::default()).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn read_text(name: &str, text: &str) -> Result<(Mesh, ImportReport), FormatError> {
    read(name, text.as_bytes(), ReadOptions::default())
}

/// Number of elements of a kind.
fn count(mesh: &Mesh, id: &str) -> usize {
    mesh.blocks.iter().filter(|b| b.element.id == id).map(|b| b.len()).sum()
}

fn region<'m>(mesh: &'m Mesh, name: &str) -> &'m Region {
    mesh.regions.get(name).unwrap_or_else(|| panic!("no region {name} among {:?}", mesh.regions.keys()))
}

/// Checks that two meshes are the same to the last bit and in the same order.
fn assert_same(a: &Mesh, b: &Mesh, what: &str) {
    assert_eq!(a.nodes, b.nodes, "{what}: nodes");
    let blocks = |m: &Mesh| -> Vec<(&str, Vec<u32>)> {
        m.blocks.iter().map(|b| (b.element.id, b.connectivity.clone())).collect()
    };
    assert_eq!(blocks(a), blocks(b), "{what}: elements");
    assert_eq!(a.regions, b.regions, "{what}: regions");
}
