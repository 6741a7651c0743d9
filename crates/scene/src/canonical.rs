//! One text per simulation, for hashing.

use crate::scene::Scene;

/// Changes whenever the meaning of the canonical text does.
const VERSION: u32 = 1;

/// The scene as JSON in which equal scenes have equal text, and different scenes different text.
///
/// Keys stand in the order of the structs, numbers in their shortest form that reads back to the same bits, units are
/// converted, defaults written out, and places (lines, overrides) left out.
/// It does not contain the bytes of mesh files: whoever hashes it adds them.
pub fn canonical_json(scene: &Scene) -> String {
    let scene = serde_json::to_string(scene).expect("a scene has only text keys and finite numbers");
    format!("{{\"souple_scene\":{VERSION},\"scene\":{scene}}}")
}
