//! From blocks of elements to the batches of a device.

use crate::system::System;
use souple_kernels_gpu::resident::{Batch, Model, Preconditioner, Source};
use souple_laws::check::Inversion;
use souple_operators::{Part, derive_diagonal};
use souple_program::{Costs, Program};
use souple_scene::linear_solver;

/// Which programs a method needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Needs {
    /// Forces alone.
    Forces,
    /// Forces and products.
    Products,
}

/// Programs that no block has by itself, by block.
pub(super) struct Diagonals(Vec<Option<Program>>);

/// Derives the diagonal blocks of each block's association, once per association.
pub(super) fn diagonals(system: &System, preconditioner: Preconditioner, needs: Needs) -> Diagonals {
    if preconditioner == Preconditioner::None || needs == Needs::Forces {
        return Diagonals(system.elements.parts().map(|_| None).collect());
    }
    let mut known: Vec<(*const souple_operators::Derived, Program)> = Vec::new();
    let of = |part: Part<'_>| {
        let key = std::ptr::from_ref(part.derived);
        if let Some((_, program)) = known.iter().find(|(k, _)| *k == key) {
            return Some(program.clone());
        }
        let program = derive_diagonal(part.derived, Costs::default());
        known.push((key, program.clone()));
        Some(program)
    };
    Diagonals(system.elements.parts().map(of).collect())
}

/// The preconditioner of a device for that of a scene.
pub(super) fn preconditioner(wanted: linear_solver::Preconditioner) -> Preconditioner {
    match wanted {
        linear_solver::Preconditioner::None => Preconditioner::None,
        linear_solver::Preconditioner::Jacobi => Preconditioner::Diagonal,
        linear_solver::Preconditioner::BlockJacobi | linear_solver::Preconditioner::IncompleteCholesky => {
            Preconditioner::Blocks
        }
    }
}

/// The model of a system; `moved` are its moved unknowns, ascending.
pub(super) fn model<'a>(
    system: &'a System,
    diagonals: &'a Diagonals,
    preconditioner: Preconditioner,
    needs: Needs,
    moved: &[u32],
) -> Model<'a> {
    // Loads that never change are constant forces.
    let mut constant = system.gravity.clone();
    let mut loads = Vec::new();
    for load in system.loads.iter().filter(|l| !l.forces.is_empty()) {
        if load.factor.is_empty() {
            load.forces.iter().for_each(|&(unknown, force)| constant[unknown] += force);
        } else {
            loads.push(load.forces.iter().map(|&(unknown, force)| (unknown as u32, force)).collect());
        }
    }
    let batches = system.elements.parts().zip(&diagonals.0).map(|(part, d)| batch(part, d.as_ref(), needs)).collect();
    Model {
        axes: system.dimension,
        mass: system.mass.clone(),
        constant,
        loads,
        held: system.held.clone(),
        moved: moved.to_vec(),
        batches,
        preconditioner,
        reach: system.reach,
    }
}

/// Factors of those loads of [`model`] that change, at time `t`.
pub(super) fn factors(system: &System, t: f64) -> Vec<f64> {
    let changing = system.loads.iter().filter(|l| !l.forces.is_empty() && !l.factor.is_empty());
    changing.map(|l| crate::system::factor_at(&l.factor, t)).collect()
}

fn batch<'a>(part: Part<'a>, diagonal: Option<&'a Program>, needs: Needs) -> Batch<'a> {
    let spec = part.spec;
    let staged = &part.derived.staged;
    let program = |name: &str| staged.program(name).expect("every association has this program");
    let carries = staged.step_to_apply != (0, 0);
    let force = if needs == Needs::Products && carries { "linearise" } else { "force" };
    let [once, each] = part.setup;
    let inputs = [
        ("displacement", Source::State),
        ("direction", Source::Direction),
        ("rest", Source::Rows(part.rest)),
        ("parameters", Source::Uniform(spec.parameters.clone())),
        ("density", Source::Uniform(vec![spec.density])),
        ("section", Source::Uniform(vec![spec.section])),
        ("setup_values", Source::Lanes(once)),
        ("setup_point_values", Source::Lanes(each)),
    ];
    Batch {
        items: spec.len(),
        places: spec.element.node_count(),
        rows: spec.connectivity.clone(),
        force: program(force),
        product: (needs == Needs::Products).then(|| program("tangent_apply")),
        diagonal,
        check: (part.inversion == Inversion::Fatal).then(|| program("volume_ratio")),
        inputs: inputs.map(|(name, source)| (name.to_owned(), source)).into(),
    }
}
