//! What a scene may ask for and the engine cannot do today: refused, never passed over.

use super::error::Findings;
use souple_scene::Scene;

/// Notes everything in the scene that would have no effect, with what to use instead.
pub(super) fn refuse(scene: &Scene, findings: &mut Findings) {
    for body in &scene.bodies {
        for material in &body.materials {
            if let Some(viscosity) = &material.viscosity {
                let message = "viscosity is not supported yet; remove it, or damp the motion with `velocity_damping` \
                               or `rayleigh` in [integrator]";
                findings.problem(&viscosity.at, message);
            }
        }
        for pressure in &body.pressures {
            let message = "pressure that follows the surface is not supported yet; use [[body.traction]], a load of \
                           constant direction";
            findings.problem(&pressure.at, message);
        }
    }
    for tie in &scene.ties {
        let message = "ties are not supported yet; join the bodies in one mesh with common nodes";
        findings.problem(&tie.at, message);
    }
}
