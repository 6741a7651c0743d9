//! What a scene may ask for and the engine cannot do today: refused, never passed over.

use super::error::Findings;
use souple_scene::Scene;

/// Notes everything in the scene that would have no effect, with what to use instead.
pub(super) fn refuse(scene: &Scene, findings: &mut Findings) {
    for body in &scene.bodies {
        for material in &body.materials {
            if let Some(term) = material.viscosity.as_ref().and_then(|v| v.prony.first()) {
                let message =
                    "relaxation is not supported yet; use `shear` and `bulk`, the viscosities of Kelvin–Voigt";
                findings.problem(&term.at, message);
            }
        }
        for pressure in &body.pressures {
            let message = "pressure that follows the surface is not supported yet; use [[body.traction]], a load of \
                           constant direction";
            findings.problem(&pressure.at, message);
        }
    }
}
