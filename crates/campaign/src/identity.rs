//! The hash of a simulation: SHA-256 of everything that determines what it gives.
//!
//! hash(program, processor, device, scene in canonical form, hashes of the files of its meshes).
//!
//! The program is its bytes, because one version may be built in several ways; the processor counts because times are
//! results too. A scene that cannot be read is determined by its text and changes, and so is its refusal.

use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use souple_simulation::scene::{Catalogue, Scene, canonical_json, mesh::Mesh, parse_with_overrides};
use std::path::{Path, PathBuf};

/// Changes whenever the meaning of the hash does.
const VERSION: &str = "souple campaign 2";

/// What all simulations of a run have in common.
#[derive(Debug)]
pub struct Surroundings<'a> {
    /// SHA-256 of the program.
    pub program: String,
    /// Name of the processor.
    pub processor: String,
    /// Laws that scenes may name.
    pub catalogue: Catalogue,
    /// Text of the base scene.
    pub scene: &'a str,
}

/// A file that a simulation reads, as it was when the simulation was hashed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Source {
    /// Where it lies.
    pub path: PathBuf,
    /// SHA-256 of its bytes; none: it could not be read.
    pub hash: Option<String>,
}

impl Source {
    /// The file at a path as it is now.
    pub fn now(path: &Path) -> Source {
        let hash = std::fs::read(path).ok().map(|bytes| sha256(&bytes));
        Source { path: path.to_owned(), hash }
    }
}

/// SHA-256 of bytes, in hexadecimal digits.
pub fn sha256(bytes: &[u8]) -> String {
    hexadecimal(Sha256::new_with_prefix(bytes))
}

fn hexadecimal(hasher: Sha256) -> String {
    hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// What is known of a simulation before it runs.
#[derive(Debug)]
pub struct Identity {
    /// Its hash.
    pub hash: String,
    /// Its scene, where that can be read.
    pub scene: Option<Scene>,
    /// The files of its meshes.
    pub sources: Vec<Source>,
}

/// The hash of a simulation, with what it is of.
///
/// `files` gives the files of the mesh at the path written in the scene.
pub fn identify(
    surroundings: &Surroundings<'_>,
    overrides: &[String],
    device: &str,
    files: &mut dyn FnMut(&str) -> Vec<Source>,
) -> Identity {
    let mut hasher = Sha256::new();
    // Lengths keep the parts apart.
    let mut add = |part: &[u8]| {
        hasher.update((part.len() as u64).to_le_bytes());
        hasher.update(part);
    };
    for part in [VERSION, &surroundings.program, &surroundings.processor, device] {
        add(part.as_bytes());
    }
    let changes: Vec<&str> = overrides.iter().map(String::as_str).collect();
    let scene = parse_with_overrides(surroundings.scene, "scene", &changes, &surroundings.catalogue).ok();
    let scene = scene.map(|(scene, _)| scene);
    let mut sources = Vec::new();
    match &scene {
        Some(scene) => {
            add(canonical_json(scene).as_bytes());
            for body in &scene.bodies {
                if let Mesh::File(file) = &body.value.mesh.value {
                    sources.extend(files(&file.path.value));
                }
            }
            sources.iter().for_each(|s| add(s.hash.as_deref().unwrap_or("no such file").as_bytes()));
        }
        None => {
            add(surroundings.scene.as_bytes());
            changes.iter().for_each(|c| add(c.as_bytes()));
        }
    }
    Identity { hash: hexadecimal(hasher), scene, sources }
}
