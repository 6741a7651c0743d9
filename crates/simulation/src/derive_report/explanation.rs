//! What a simulation will compute: each kind of element with its cost, and how its systems are solved.

use super::{Association, Costs, Loops, derive, report};
use crate::Simulation;
use souple_scene::Named as _;
use souple_scene::linear_solver::{LinearMethod, Operator};

/// The text: one paragraph per block of like elements, then totals, then integrator and solver.
pub fn explanation(simulation: &mut Simulation) -> String {
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
        out.push_str(&products(simulation));
    }
    out
}

/// How products with the matrix of a step are made, why, and what the other way would cost.
fn products(simulation: &mut Simulation) -> String {
    let times = simulation.system.measure_products();
    let solver = &simulation.scene().linear_solver;
    let free = format!("without a matrix: {:.3} ms to linearise, {:.3} ms per product", times.linearise, times.product);
    let Some(matrix) = &times.matrix else {
        return format!("measured {free}\nproducts are made without a matrix, as the scene says\n");
    };
    let with = format!(
        "with a matrix of {} blocks, {:.1} MB: {:.3} ms to assemble, {:.3} ms per product",
        matrix.blocks,
        matrix.bytes as f64 * 1e-6,
        matrix.assemble,
        matrix.product
    );
    let why = match (solver.method.value, solver.operator.value) {
        (LinearMethod::Direct, _) => "factors need the matrix".to_owned(),
        (_, Operator::MatrixFree) => {
            "products are made without a matrix, as the scene says; the preconditioner reads its diagonal".to_owned()
        }
        (_, Operator::Assembled) => "products are made with the matrix, as the scene says".to_owned(),
        (_, Operator::Auto) => {
            let saved = times.product - matrix.product;
            let extra = matrix.assemble - times.linearise;
            let pays = if saved <= 0.0 {
                "here it never pays: try operator = \"matrix-free\" with preconditioner = \"none\"".to_owned()
            } else {
                format!("here it pays from {} iterations per step on", (extra / saved).ceil().max(1.0))
            };
            format!("`auto` makes products with the matrix, so that results never depend on a measurement; {pays}")
        }
    };
    format!("measured {with}\nmeasured {free}\n{why}\n")
}
