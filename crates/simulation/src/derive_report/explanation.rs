//! What a simulation will compute: each kind of element with its cost, and how its systems are solved.

use super::{Association, Costs, Loops, derive, report};
use crate::Simulation;
use souple_scene::Named as _;

/// The text: one paragraph per block of like elements, then totals, then integrator and solver.
pub fn explanation(simulation: &Simulation) -> String {
    let mut out = String::new();
    let (mut force, mut product, mut stored) = (0, 0, 0);
    for block in &simulation.prepared.blocks {
        let association = Association {
            element: block.element,
            law: block.law,
            rule: block.rule,
            loops: Loops::Rolled,
            dimension: simulation.prepared.dimension,
        };
        let r = report(&derive(association, Costs::default()));
        let values: Vec<String> =
            block.law.parameters.iter().zip(&block.parameters).map(|(p, v)| format!("{} {v}", p.name)).collect();
        let carried = r.carried.detail.setup_to_step.per_element + r.carried.detail.step_to_apply.per_element;
        out.push_str(&format!(
            "{} {} with {} ({}), quadrature {}:\n  operations per element: force {}, linearise {}, product with the tangent {}; \
             {carried} values stored\n",
            block.len(),
            r.element,
            r.law,
            values.join(", "),
            r.quadrature,
            r.operations["force"],
            r.operations["linearise"],
            r.operations["tangent_apply"],
        ));
        force += block.len() * r.operations["force"];
        product += block.len() * r.operations["tangent_apply"];
        stored += block.len() * carried;
    }
    let scene = simulation.scene();
    out.push_str(&format!(
        "all elements: force {:.3} million operations, product {:.3} million, {:.1} MB of stored values\n",
        force as f64 * 1e-6,
        product as f64 * 1e-6,
        stored as f64 * 8e-6
    ));
    out.push_str(&format!("device {}\n", simulation.device));
    out.push_str(&format!(
        "integrator {}, at most {} Newton iterations per step",
        scene.integrator.method.value.name(),
        scene.integrator.newton_iterations
    ));
    if scene.integrator.method.value.is_explicit() {
        out.push_str("; no system is solved\n");
    } else {
        let solver = &scene.linear_solver;
        out.push_str(&format!(
            "; linear solver {}, preconditioner {}, tolerance {:e}, at most {} iterations\n",
            solver.method.name(),
            solver.preconditioner.name(),
            solver.tolerance,
            solver.max_iterations
        ));
    }
    out
}
