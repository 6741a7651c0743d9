//! What steps on a graphics device do not do: refused with what to do instead, before anything is computed.

use crate::run::LoadError;
use souple_operators::Elements;
use souple_scene::Scene;
use souple_scene::integrator::{Method, Tangent};
use souple_scene::linear_solver::{LinearMethod, Operator, Precision, Preconditioner};

/// Methods that steps on a device make.
const METHODS: [Method; 4] =
    [Method::ImplicitEuler, Method::ImplicitMidpoint, Method::SymplecticEuler, Method::ExplicitEuler];

/// Says everything about a scene that a device cannot compute; the texts beside the result are of what it computes in
/// another way than the scene says.
#[cfg_attr(not(feature = "gpu"), expect(dead_code, reason = "a build without devices refuses them by name"))]
pub(super) fn refuse(
    scene: &Scene,
    file: &str,
    elements: &Elements,
    followers: usize,
) -> Result<Vec<String>, LoadError> {
    let (integrator, solver) = (&scene.integrator, &scene.linear_solver);
    let mut problems = Vec::new();
    let mut warnings = Vec::new();
    let method = integrator.method.value;
    if !METHODS.contains(&method) {
        problems.push(format!(
            "{}: `{method}` steps are not made on a graphics device; use one of {}, or --device cpu",
            integrator.method.at.in_file(file),
            METHODS.map(|m| m.to_string()).join(", ")
        ));
    } else if !method.is_explicit() {
        if integrator.newton_iterations > 1 {
            problems.push(format!(
                "{file}: steps on a graphics device are linearised once and the scene asks for up to {} Newton \
                 iterations; set integrator.newton_iterations = 1, or use --device cpu",
                integrator.newton_iterations
            ));
        }
        if integrator.tangent == Tangent::Projected {
            problems.push(format!(
                "{file}: projected tangents are not computed on a graphics device; set integrator.tangent = \"exact\", \
                 or use --device cpu"
            ));
        }
        if solver.method.value == LinearMethod::Direct {
            problems.push(format!(
                "{}: there is no direct solver on a graphics device; use linear_solver.method = \"cg\", or --device cpu",
                solver.method.at.in_file(file)
            ));
        } else {
            if solver.preconditioner.value == Preconditioner::IncompleteCholesky {
                warnings.push(format!(
                    "{}: no matrix is factored on a graphics device: the preconditioner is block-jacobi",
                    solver.preconditioner.at.in_file(file)
                ));
            }
            if solver.operator.value == Operator::Assembled {
                warnings.push(format!(
                    "{}: no matrix is assembled on a graphics device: products are made element by element",
                    solver.operator.at.in_file(file)
                ));
            }
            if solver.precision.value == Precision::Mixed {
                warnings.push(format!(
                    "{}: a graphics device computes in single precision throughout",
                    solver.precision.at.in_file(file)
                ));
            }
        }
    }
    if elements.is_viscous() {
        problems.push(format!(
            "{file}: viscous materials are not computed on a graphics device; use integrator.rayleigh or \
             velocity_damping instead of `viscosity`, or --device cpu"
        ));
    }
    if followers > 0 {
        problems.push(format!(
            "{file}: {followers} nodes follow others (ties, hanging nodes), which a graphics device does not compute; make \
             the mesh conforming, or use --device cpu"
        ));
    }
    if problems.is_empty() { Ok(warnings) } else { Err(LoadError::Refused(problems.join("\n"))) }
}
