//! The hash of a simulation: SHA-256 of everything that determines what it gives.
//!
//! hash(program, processor, device, scene in canonical form, bytes of its meshes).
//!
//! The program is its bytes, because one version may be built in several ways; the processor counts because times are
//! results too. A scene that cannot be read is determined by its text and changes, and so is its refusal.

use sha2::{Digest as _, Sha256};
use souple_simulation::scene::{Catalogue, Scene, canonical_json, mesh::Mesh, parse_with_overrides};

/// Changes whenever the meaning of the hash does.
const VERSION: &str = "souple campaign 1";

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

/// SHA-256 of bytes, in hexadecimal digits.
pub fn sha256(bytes: &[u8]) -> String {
    hexadecimal(Sha256::new_with_prefix(bytes))
}

fn hexadecimal(hasher: Sha256) -> String {
    hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The hash of a simulation, and its scene where that can be read.
///
/// `read` gives the bytes of a mesh file by the path written in the scene.
pub fn identify(
    surroundings: &Surroundings<'_>,
    overrides: &[String],
    device: &str,
    read: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
) -> (String, Option<Scene>) {
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
    match &scene {
        Some((scene, _)) => {
            add(canonical_json(scene).as_bytes());
            for body in &scene.bodies {
                if let Mesh::File(file) = &body.value.mesh.value {
                    match read(&file.path.value) {
                        Ok(bytes) => add(&bytes),
                        Err(_) => add(b"no such file"),
                    }
                }
            }
        }
        None => {
            add(surroundings.scene.as_bytes());
            changes.iter().for_each(|c| add(c.as_bytes()));
        }
    }
    (hexadecimal(hasher), scene.map(|(scene, _)| scene))
}
