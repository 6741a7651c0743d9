//! What whole operators cost per element: kernels with gathering, and the sums at the nodes.
//!
//! The matrix-free product runs the kernel and sums contributions; the assembled one multiplies a matrix of blocks in
//! compressed rows, which has to be assembled first. Which of them pays depends on how many products follow one
//! linearisation; this measurement gives both sides.

use crate::batch::{BatchError, bar, displacement, parameters};
use crate::machine::{Machine, machine};
use crate::stopwatch::{Effort, Spread, race};
use serde::Serialize;
use souple_elements::Element;
use souple_kernels::Backend;
use souple_kernels::conformance::Random;
use souple_laws::Law;
use souple_operators::{BlockSpec, Elements, Threads};
use souple_program::Costs;
use std::sync::Arc;

/// What to measure.
pub struct Request<'a> {
    /// The elements.
    pub elements: Vec<&'static Element>,
    /// The laws; each goes with each element.
    pub laws: Vec<&'static Law>,
    /// What runs the programs.
    pub backend: &'a dyn Backend,
    /// Threads that share the work; at least 1.
    pub threads: usize,
    /// Number of elements of each model.
    pub count: usize,
    /// How long.
    pub effort: Effort,
}

/// One element with one law; times in ns per element.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Id of the element.
    pub element: &'static str,
    /// Id of the law.
    pub law: &'static str,
    /// Number of elements.
    pub elements: usize,
    /// Number of nodes.
    pub nodes: usize,
    /// Forces, f(u).
    pub force: Spread,
    /// Preparation of products; nothing to do for linear laws.
    pub linearise: Spread,
    /// (∂f/∂u) v without a matrix.
    pub matrix_free_product: Spread,
    /// K v with the matrix; one thread.
    pub assembled_product: Spread,
    /// Blocks computed and added into the matrix.
    pub assembly: Spread,
    /// Stored blocks of the matrix, on and above the diagonal, per element.
    pub blocks_per_element: f64,
}

/// What was measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// On what.
    pub machine: Machine,
    /// Name and description of the backend.
    pub device: String,
    /// Threads that shared the work of everything but the assembled product.
    pub threads: usize,
    /// The figures.
    pub rows: Vec<Row>,
}

/// Measures. `progress` is told what comes next.
///
/// # Errors
/// When a mesh cannot be made, the backend refuses a program, or threads cannot be started.
pub fn measure(request: &Request<'_>, progress: &mut dyn FnMut(&str)) -> Result<Report, BatchError> {
    let threads = Arc::new(Threads::new(request.threads).map_err(BatchError::Threads)?);
    let mut rows = Vec::new();
    for element in &request.elements {
        for law in &request.laws {
            progress(&format!("{} with {}", element.id, law.id));
            // As in a step, where threads are kept awake.
            rows.push(threads.awake(|| row(element, law, request, threads.clone()))?);
        }
    }
    let about = request.backend.about();
    let device = format!("{}: {}", about.name, about.description);
    Ok(Report { machine: machine(), device, threads: threads.count(), rows })
}

fn row(
    element: &'static Element,
    law: &'static Law,
    request: &Request<'_>,
    threads: Arc<Threads>,
) -> Result<Row, BatchError> {
    let mut random = Random::new(1);
    let (nodes, mut connectivity) = bar(element, request.count, &mut random)?;
    connectivity.truncate(request.count * element.node_count());
    let spec = BlockSpec {
        element,
        law,
        rule: element.default_rule(),
        parameters: parameters(law),
        density: 1.0,
        viscosity: None,
        section: 1.0,
        connectivity,
        ids: (0..request.count as u32).collect(),
    };
    let (mut elements, _) =
        Elements::new(element.dimension(), &nodes, vec![spec], request.backend, threads, Costs::default())?;
    let u = displacement(&nodes, element.dimension(), &mut random);
    let v: Vec<f64> = u.iter().map(|_| random.between(-1.0, 1.0)).collect();
    let (mut matrix, map) = elements.pattern();
    elements.linearise(&u);
    elements.assemble(&u, &map, &mut matrix);
    let (mut f, mut y) = (vec![0.0; u.len()], vec![0.0; u.len()]);

    // They share the elements, so that each runs its rounds alone; ratios between them are of medians.
    let per_element = 1e9 / request.count as f64;
    let ns = |contender: &mut dyn FnMut()| {
        let seconds = race(request.effort, &mut [contender]);
        Spread::of(&seconds[0].iter().map(|s| s * per_element).collect::<Vec<_>>())
    };
    let force = ns(&mut || elements.add_force(&u, &mut f));
    let linearise = ns(&mut || elements.linearise(&u));
    let matrix_free_product = ns(&mut || elements.add_tangent(1.0, &v, &mut f));
    let assembly = ns(&mut || elements.assemble(&u, &map, &mut matrix));
    let mut buffers = matrix.product_buffers();
    let assembled_product = ns(&mut || {
        matrix.load(&v, &mut buffers);
        for part in 0..matrix.parts().len() {
            matrix.run_part_in_place(None, part, &mut buffers);
        }
        matrix.finish_rows(0..matrix.row_count(), None, &v, &buffers, &mut y);
    });
    Ok(Row {
        element: element.id,
        law: law.id,
        elements: request.count,
        nodes: nodes.len(),
        force,
        linearise,
        matrix_free_product,
        assembled_product,
        assembly,
        blocks_per_element: matrix.slot_count() as f64 / request.count as f64,
    })
}
