//! The laws of a scene with their parameters, to be looked at without meshes.

use super::catalogue::{catalogue, read};
use super::error::{Findings, PrepareError};
use super::parameters::parameters;
use souple_laws::response::Response;
use souple_scene::material::{Material, USER_LAW};
use souple_scene::{Catalogue, Scene};

/// The catalogue for scenes whose laws are to be judged: laws written in them are read, and not refused yet.
pub fn permissive_catalogue() -> Catalogue {
    Catalogue { user_law: None, ..catalogue() }
}

/// Every material's law of a scene, under the name of its body and law.
///
/// # Errors
/// Every law that cannot be read, and every parameter that is missing or out of range, with its place.
pub fn laws(scene: &Scene, scene_file: &str) -> Result<Vec<(String, Response)>, PrepareError> {
    let mut findings = Findings::default();
    let mut found = Vec::new();
    for body in &scene.bodies {
        for (index, material) in body.materials.iter().enumerate() {
            if let Some(response) = response(&material.value, &mut findings) {
                found.push((format!("{}: material {index}, {}", *body.name, *material.law), response));
            }
        }
    }
    findings.outcome(scene_file)?;
    Ok(found)
}

fn response(material: &Material, findings: &mut Findings) -> Option<Response> {
    if let (USER_LAW, Some(energy)) = (material.law.value.as_str(), &material.energy) {
        let given = material.parameters.iter().map(|p| (p.name.as_str(), &p.value.value));
        return match read(energy, given) {
            Ok(law) => Some(law.response()),
            Err(fault) => {
                findings.problem(&energy.at, format!("{fault}\n{}", fault.excerpt()));
                None
            }
        };
    }
    let law = souple_laws::by_id(&material.law)?;
    let values = parameters(law, material, findings)?;
    Some(Response::new(law, &values).expect("parameters come in the law's number"))
}
