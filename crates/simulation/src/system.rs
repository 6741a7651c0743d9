//! A model as the solvers see it: forces, products and constraints on flat vectors.
//!
//! Unknowns are [node, axis] with as many axes as the elements have dimensions.
//!
//! ```text
//! F(t, u, v) = f(u) + g + p(t) − (α M + β K + C) v      internal, gravity, loads, Rayleigh damping, viscosity
//! M            lumped masses
//! P            zero on fixed and moved unknowns, and on those that follow others
//! T            u = T û: nodes that follow others ([`Elimination`])
//! ```
//!
//! The solvers see F̂(û) = Tᵀ F(T û) and K̂ = Tᵀ K T on vectors of full length whose entries on following nodes are idle:
//! what stands there is overwritten by [`SecondOrder::prescribe`] and never read. Masses, gravity and loads of following
//! nodes are given to their masters once, at the start.

mod assembled;
mod product_times;

use crate::interaction::Touch;
use crate::motion::Motion;
use crate::phases::{Phases, WatchedOperator};
use assembled::Assembled;
use souple_operators::{AssemblyMap, Elements, Masses, Tangent, Threads};
use souple_scene::linear_solver::{LinearMethod, LinearSolver, Operator, Precision, Preconditioner as Choice};
use souple_solver::refinement::{RefinementWorkspace, refined_cg};
use souple_solver::vector::norm;
use souple_solver::{
    BlockJacobi, CgOptions, CgWorkspace, Combination, CondensationMap, Csr, DirectSolver, Elimination, Failure,
    Identity, IncompleteCholesky, Jacobi, LinearOperator, LinearReport, LoadProblem, NewtonProblem, Preconditioner,
    ProductBuffers, Projector, SecondOrder, Serial, Shift, SkylineLdlt, SymmetricBlocks, cg, solve_directly,
};
use std::cell::RefCell;
use std::sync::Arc;

/// A load as the system keeps it: values per unknown and a factor of time.
pub(crate) struct FlatLoad {
    pub(crate) forces: Vec<(usize, f64)>,
    pub(crate) factor: Vec<(f64, f64)>,
}

/// A model ready to be integrated.
pub(crate) struct System {
    pub(crate) elements: Elements,
    pub(crate) dimension: usize,
    /// Mass per unknown in kg.
    pub(crate) mass: Vec<f64>,
    /// Gravity per unknown in N.
    pub(crate) gravity: Vec<f64>,
    pub(crate) loads: Vec<FlatLoad>,
    /// Whether each unknown is prescribed.
    pub(crate) prescribed: Vec<bool>,
    /// Whether each unknown is prescribed or follows others: where P is zero.
    pub(crate) held: Vec<bool>,
    /// Nodes that follow others.
    pub(crate) elimination: Elimination,
    pub(crate) motions: Vec<Motion>,
    /// Forces of hands and tools, and what they hold.
    pub(crate) touch: Touch,
    /// Rayleigh coefficients α in 1/s and β in s.
    pub(crate) rayleigh: [f64; 2],
    /// Rest positions of all nodes, [node][axis].
    pub(crate) nodes: Vec<[f64; 3]>,
    /// A displacement beyond this many metres is a divergence.
    pub(crate) reach: f64,
    /// Share of gravity and loads that acts (quasi-static loading).
    pub(crate) load_share: f64,
    /// Time of the loads and motions (quasi-static loading).
    pub(crate) load_time: f64,
    /// Start and end of the current quasi-static step.
    pub(crate) load_span: [f64; 2],
    /// Whether the current quasi-static step raises gravity and loads from nothing.
    pub(crate) raising: bool,
    solver: LinearSolver,
    matrices: Option<Matrices>,
    /// Displacement of the last linearisation, and whether the elements still hold it.
    linearised: Vec<f64>,
    stale: bool,
    /// Whether the elements' viscous products are those of another state than the last linearisation.
    damping_stale: bool,
    workspace: CgWorkspace,
    refinement: RefinementWorkspace,
    /// The matrix of the products in single precision; empty unless the scene wants mixed precision.
    singles: Vec<f32>,
    scratch: Vec<f64>,
    /// T û of what is evaluated; empty when no node follows another.
    expanded: Vec<f64>,
    pub(crate) threads: Arc<Threads>,
    direct: Option<SkylineLdlt>,
    incomplete: Option<IncompleteCholesky>,
    /// Where times are summed up, when somebody watches.
    pub(crate) phases: Option<Arc<Phases>>,
}

/// The stiffness matrix and the matrix of the linear system, with the same pattern.
struct Matrices {
    /// The stiffness of all nodes, where some follow others, and how it is condensed.
    full: Option<(SymmetricBlocks, CondensationMap)>,
    stiffness: SymmetricBlocks,
    /// Of viscous elements, where there are any.
    viscosity: Option<SymmetricBlocks>,
    system: SymmetricBlocks,
    map: AssemblyMap,
    /// Memory for products with any of them.
    buffers: RefCell<ProductBuffers>,
}

impl System {
    pub(crate) fn new(
        elements: Elements,
        masses: &Masses,
        gravity: [f64; 3],
        nodes: Vec<[f64; 3]>,
        elimination: Elimination,
        solver: LinearSolver,
        threads: Arc<Threads>,
    ) -> System {
        let d = elements.dimension();
        let len = elements.len();
        let spread = |values: &[f64], axis_factor: &dyn Fn(usize) -> f64| -> Vec<f64> {
            (0..len).map(|k| values[k / d] * axis_factor(k % d)).collect()
        };
        let mut lumped = masses.lumped.clone();
        elimination.lump(&mut lumped);
        let mut weight = spread(&masses.shape, &|axis| gravity[axis]);
        elimination.restrict(&mut weight);
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        for node in &nodes {
            for axis in 0..3 {
                low[axis] = low[axis].min(node[axis]);
                high[axis] = high[axis].max(node[axis]);
            }
        }
        let size = (0..3).map(|k| (high[k] - low[k]).powi(2)).sum::<f64>().sqrt();
        let refined = if solver.precision.value == Precision::Mixed { len } else { 0 };
        let mut system = System {
            dimension: d,
            mass: spread(&lumped, &|_| 1.0),
            gravity: weight,
            loads: Vec::new(),
            prescribed: vec![false; len],
            held: vec![false; len],
            motions: Vec::new(),
            touch: Touch::default(),
            rayleigh: [0.0; 2],
            nodes,
            reach: 1e3 * size,
            load_share: 1.0,
            load_time: 0.0,
            load_span: [0.0; 2],
            raising: false,
            solver,
            matrices: None,
            linearised: vec![0.0; len],
            stale: true,
            damping_stale: true,
            refinement: RefinementWorkspace::new(refined),
            singles: Vec::new(),
            workspace: CgWorkspace::new(len),
            scratch: vec![0.0; len],
            expanded: vec![0.0; if elimination.is_empty() { 0 } else { len }],
            elimination,
            threads,
            direct: None,
            incomplete: None,
            phases: None,
            elements,
        };
        if system.needs_matrix() {
            let (pattern, map) = system.elements.pattern();
            let (full, stiffness) = if system.elimination.is_empty() {
                (None, pattern)
            } else {
                let (condensed, condensation) = system.elimination.pattern(&pattern);
                (Some((pattern, condensation)), condensed)
            };
            let viscosity = system.elements.is_viscous().then(|| stiffness.clone());
            let buffers = RefCell::new(stiffness.product_buffers());
            system.matrices = Some(Matrices { full, system: stiffness.clone(), stiffness, viscosity, map, buffers });
        }
        system
    }

    /// The row after the last of each part in which products with the matrix are made; none without a matrix.
    pub(crate) fn ends_of_parts(&self) -> Vec<usize> {
        self.matrices.as_ref().map_or(Vec::new(), |m| m.stiffness.parts().iter().map(|p| p.end).collect())
    }

    /// Settles which unknowns the solvers leave alone, once all are prescribed that will be. A following node cannot be
    /// prescribed: it does what its masters do.
    pub(crate) fn settle(&mut self) {
        let d = self.dimension;
        for &row in self.elimination.rows() {
            self.prescribed[row as usize * d..(row as usize + 1) * d].fill(false);
        }
        self.held.copy_from_slice(&self.prescribed);
        for &row in self.elimination.rows() {
            self.held[row as usize * d..(row as usize + 1) * d].fill(true);
        }
    }

    /// `act` with T x.
    fn with_expanded(&mut self, x: &[f64], act: impl FnOnce(&mut System, &[f64])) {
        if self.elimination.is_empty() {
            return act(self, x);
        }
        let mut expanded = std::mem::take(&mut self.expanded);
        expanded.copy_from_slice(x);
        self.elimination.expand(&mut expanded);
        act(self, &expanded);
        self.expanded = expanded;
    }

    /// Whether products use the matrix. `auto` does: for linear elements no other product costs less per iteration.
    fn assembled_product(&self) -> bool {
        self.solver.operator.value != Operator::MatrixFree
    }

    /// Whether a matrix is kept at all: for products, for factors, or for the blocks of a preconditioner.
    fn needs_matrix(&self) -> bool {
        self.assembled_product()
            || self.solver.method.value == LinearMethod::Direct
            || self.solver.preconditioner.value != Choice::None
    }

    /// out ← external forces at time `t`.
    pub(crate) fn external(&self, t: f64, out: &mut [f64]) {
        for (o, g) in out.iter_mut().zip(&self.gravity) {
            *o = self.load_share * g;
        }
        for load in &self.loads {
            let factor = self.load_share * factor_at(&load.factor, t);
            for &(unknown, force) in &load.forces {
                out[unknown] += factor * force;
            }
        }
    }

    /// out ← f(u) + external forces at time `t`.
    pub(crate) fn unbalanced(&mut self, t: f64, u: &[f64], out: &mut [f64]) {
        self.external(t, out);
        self.with_expanded(u, |system, u| system.elements.add_force(u, out));
        self.elimination.restrict(out);
        self.touch.add_force(self.dimension, u, out);
    }

    /// Forgets factors of matrices: to call when other unknowns are prescribed.
    pub(crate) fn forget_factors(&mut self) {
        self.direct = None;
        self.incomplete = None;
    }

    fn linearise_at(&mut self, u: &[f64]) {
        self.linearised.copy_from_slice(u);
        self.elimination.expand(&mut self.linearised);
        // With a matrix, what an application reads is made only if one follows; a projection is what a matrix is made from.
        self.stale = self.assembled_product() && self.elements.tangent() == Tangent::Exact;
        if !self.stale {
            self.elements.linearise(&self.linearised);
        }
        match &mut self.matrices {
            None => {}
            Some(Matrices { full: None, stiffness, viscosity, map, .. }) => {
                self.elements.assemble(&self.linearised, map, stiffness);
                if let Some(viscosity) = viscosity {
                    self.elements.assemble_damping(&self.linearised, map, viscosity);
                }
            }
            Some(Matrices { full: Some((full, condensation)), stiffness, viscosity, map, .. }) => {
                self.elements.assemble(&self.linearised, map, full);
                condensation.condense(full, stiffness);
                if let Some(viscosity) = viscosity {
                    self.elements.assemble_damping(&self.linearised, map, full);
                    condensation.condense(full, viscosity);
                }
            }
        }
        if let Some(matrices) = &mut self.matrices {
            self.touch.add_blocks(self.dimension, &mut matrices.stiffness);
        }
        self.damping_stale = true;
    }

    /// y ← y + C x at the linearised state.
    fn add_viscosity(&mut self, x: &[f64], y: &mut [f64]) {
        if !self.elements.is_viscous() {
            return;
        }
        if self.damping_stale {
            self.elements.linearise_damping(&self.linearised);
            self.damping_stale = false;
        }
        self.with_expanded(x, |system, x| system.elements.add_damping(1.0, x, y));
        self.elimination.restrict(y);
    }

    /// y ← K x at the linearised state.
    fn stiffness(&mut self, x: &[f64], y: &mut [f64]) {
        if self.assembled_product()
            && let Some(m) = &self.matrices
        {
            Assembled::new(&m.stiffness, &m.buffers, &self.threads).apply(x, y);
            return;
        }
        if self.stale {
            let u = std::mem::take(&mut self.linearised);
            self.elements.linearise(&u);
            self.linearised = u;
            self.stale = false;
        }
        y.fill(0.0);
        self.with_expanded(x, |system, x| system.elements.add_tangent(-1.0, x, y));
        self.elimination.restrict(y);
        self.touch.add_product(self.dimension, x, y);
    }

    /// Solves (m M + k K + c C) x = rhs on the free unknowns.
    fn solve_system(&mut self, [m, k, c]: [f64; 3], rhs: &[f64], x: &mut [f64]) -> LinearReport {
        let d = self.dimension;
        if self.needs_sum(c) {
            self.write_sum([m, k, c]);
        }
        if self.solver.method.value == LinearMethod::Direct {
            return self.solve_by_factors(rhs, x);
        }
        let options = CgOptions {
            relative_tolerance: self.solver.tolerance,
            absolute_tolerance: self.solver.absolute_tolerance,
            max_iterations: self.solver.max_iterations as usize,
        };
        let preconditioner = self.preconditioner([m, k, c]);
        let phases = self.phases.clone();
        let watched = |operator| WatchedOperator { operator, phases: phases.as_deref() };
        let mut workspace = std::mem::take(&mut self.workspace);
        let projector = Mask::new(&self.held);
        let report = if self.assembled_product() {
            let matrices = self.matrices.as_ref().expect("an assembled product has its matrix");
            let shift = if self.needs_sum(c) { None } else { Some([k, m]) };
            let matrix = if shift.is_some() { &matrices.stiffness } else { &matrices.system };
            let shift = shift.map(|[k, m]| Shift { k, m, diagonal: &self.mass });
            let operator = Assembled { shift, ..Assembled::new(matrix, &matrices.buffers, &self.threads) };
            if self.solver.precision.value == Precision::Mixed && d == 3 {
                matrix.write_single_values(&mut self.singles);
                let cheap = Assembled { singles: Some(&self.singles), ..operator };
                let refinement = &mut self.refinement;
                refined_cg(
                    &watched(&operator),
                    &watched(&cheap),
                    &*preconditioner,
                    &projector,
                    &Serial,
                    rhs,
                    x,
                    &options,
                    &mut workspace,
                    refinement,
                )
            } else {
                cg(&watched(&operator), &*preconditioner, &projector, &Serial, rhs, x, &options, &mut workspace)
            }
        } else {
            let operator = MatrixFree { system: RefCell::new(&mut *self), m, k, c };
            cg(&watched(&operator), &*preconditioner, &projector, &Serial, rhs, x, &options, &mut workspace)
        };
        self.workspace = workspace;
        report
    }

    /// Whether the sum m M + k K + c C is needed as a matrix: for factors, or where there is more to add than a diagonal.
    /// Products need only K, and diagonal blocks are few.
    fn needs_sum(&self, c: f64) -> bool {
        self.matrices.is_some()
            && (self.solver.method.value == LinearMethod::Direct
                || self.solver.preconditioner.value == Choice::IncompleteCholesky
                || c != 0.0)
    }

    fn write_sum(&mut self, [m, k, c]: [f64; 3]) {
        let d = self.dimension;
        let Some(matrices) = &mut self.matrices else { return };
        for (s, value) in matrices.system.values_mut().iter_mut().zip(matrices.stiffness.values()) {
            *s = k * value;
        }
        if let Some(viscosity) = matrices.viscosity.as_ref().filter(|_| c != 0.0) {
            for (s, value) in matrices.system.values_mut().iter_mut().zip(viscosity.values()) {
                *s += c * value;
            }
        }
        let values = matrices.system.values_mut();
        for (node, &slot) in matrices.stiffness.row_starts()[..self.mass.len() / d].iter().enumerate() {
            for axis in 0..d {
                values[slot * d * d + axis * (d + 1)] += m * self.mass[node * d + axis];
            }
        }
        if let Some((_, condensation)) = &matrices.full {
            condensation.write_idle(&mut matrices.system);
        }
    }

    /// Diagonal blocks of m M + k K + c C, [node][row][column].
    fn diagonal_blocks(&self, matrices: &Matrices, [m, k, c]: [f64; 3]) -> Vec<f64> {
        let d = self.dimension;
        let (size, summed) = (d * d, self.needs_sum(c));
        let mut blocks = vec![0.0; self.mass.len() * d];
        if summed {
            matrices.system.diagonal_blocks(&mut blocks);
            return blocks;
        }
        matrices.stiffness.diagonal_blocks(&mut blocks);
        blocks.iter_mut().for_each(|value| *value *= k);
        for (unknown, mass) in self.mass.iter().enumerate() {
            blocks[unknown / d * size + unknown % d * (d + 1)] += m * mass;
        }
        blocks
    }

    fn preconditioner(&mut self, combination: [f64; 3]) -> Box<dyn Preconditioner> {
        let d = self.dimension;
        let Some(matrices) = &self.matrices else { return Box::new(Identity) };
        match self.solver.preconditioner.value {
            Choice::None => Box::new(Identity),
            Choice::Jacobi => {
                let blocks = self.diagonal_blocks(matrices, combination);
                let diagonal: Vec<f64> =
                    (0..self.mass.len()).map(|k| blocks[(k / d) * d * d + (k % d) * (d + 1)]).collect();
                Box::new(Jacobi::new(&diagonal))
            }
            Choice::BlockJacobi => {
                let mut blocks = self.diagonal_blocks(matrices, combination);
                decouple(&mut blocks, &self.held, d);
                Box::new(BlockJacobi::new(d, &blocks))
            }
            Choice::IncompleteCholesky => {
                let matrix = fixed_csr(&matrices.system, &self.held);
                let factors = match self.incomplete.take() {
                    Some(mut known) => known.update(&matrix).map(|()| known),
                    None => IncompleteCholesky::new(&matrix),
                };
                match factors {
                    Ok(factors) => {
                        self.incomplete = Some(factors.clone());
                        Box::new(factors)
                    }
                    // A matrix that no shift makes positive: the diagonal blocks still precondition something.
                    Err(_) => Box::new(BlockJacobi::new(d, &self.diagonal_blocks(matrices, combination))),
                }
            }
        }
    }

    /// Refuses states in which an element is inside out whose law has no meaning there.
    fn refuse_inversion(&mut self, u: &[f64]) -> Result<(), Failure> {
        let mut inverted = Vec::new();
        self.with_expanded(u, |system, u| inverted = system.elements.fatally_inverted(u));
        let Some(&(id, ratio)) = inverted.first() else { return Ok(()) };
        Err(Failure::inadmissible(
            None,
            format!(
                "element {id} is inside out (volume ratio {ratio:.3}), where its law has no meaning ({} such elements)",
                inverted.len()
            ),
        ))
    }

    fn solve_by_factors(&mut self, rhs: &[f64], x: &mut [f64]) -> LinearReport {
        let matrices = self.matrices.as_ref().expect("a direct solver has its matrix");
        let matrix = fixed_csr(&matrices.system, &self.held);
        let solver = self.direct.get_or_insert_with(|| SkylineLdlt::analyse(&matrix));
        let mut right = rhs.to_vec();
        for (r, &held) in right.iter_mut().zip(&self.held) {
            if held {
                *r = 0.0;
            }
        }
        if let Err(fault) = solver.factor(&matrix) {
            return LinearReport { status: fault.status(), ..LinearReport::direct(norm(&right)) };
        }
        solve_directly(solver, &matrix, &right, x, &mut self.scratch)
    }
}

/// The matrix with identity rows for held unknowns.
fn fixed_csr(matrix: &SymmetricBlocks, held: &[bool]) -> Csr {
    let fixed: Vec<usize> = (0..held.len()).filter(|&k| held[k]).collect();
    let mut csr = matrix.to_csr();
    csr.fix_unknowns(&fixed);
    csr
}

/// Makes held axes of diagonal blocks independent of the free ones, so that their inverse acts on the free ones
/// as the inverse of the free part.
fn decouple(blocks: &mut [f64], held: &[bool], d: usize) {
    for (node, block) in blocks.chunks_mut(d * d).enumerate() {
        for axis in (0..d).filter(|a| held[node * d + a]) {
            for other in (0..d).filter(|&o| o != axis) {
                block[axis * d + other] = 0.0;
                block[other * d + axis] = 0.0;
            }
        }
    }
}

/// A factor of time: linear between keys, held outside, one without keys.
pub(crate) fn factor_at(keys: &[(f64, f64)], t: f64) -> f64 {
    let next = keys.partition_point(|k| k.0 <= t);
    match (next.checked_sub(1).map(|k| keys[k]), keys.get(next)) {
        (None, None) => 1.0,
        (Some(last), None) => last.1,
        (None, Some(first)) => first.1,
        (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (t - a.0) / (b.0 - a.0),
    }
}

/// Zero on the unknowns that are not free.
struct Mask {
    /// Their indices, ascending: there are few of them.
    held: Vec<usize>,
}

impl Mask {
    fn new(held: &[bool]) -> Mask {
        Mask { held: (0..held.len()).filter(|&k| held[k]).collect() }
    }
}

impl Projector for Mask {
    fn project(&self, v: &mut [f64]) {
        self.held.iter().for_each(|&k| v[k] = 0.0);
    }

    fn project_part(&self, first: usize, v: &mut [f64]) -> bool {
        let from = self.held.partition_point(|&k| k < first);
        let end = first + v.len();
        self.held[from..].iter().take_while(|&&k| k < end).for_each(|&k| v[k - first] = 0.0);
        true
    }
}

/// `m M + k K + c C` without a matrix. The elements keep scratch memory, hence the cell; nothing is shared between threads.
struct MatrixFree<'a> {
    system: RefCell<&'a mut System>,
    m: f64,
    k: f64,
    c: f64,
}

impl LinearOperator for MatrixFree<'_> {
    fn len(&self) -> usize {
        self.system.borrow().mass.len()
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        let mut system = self.system.borrow_mut();
        system.stiffness(x, y);
        // (k K + c C) x as k (K x + (c/k) C x): the viscous product adds to what is there.
        if self.c != 0.0 {
            y.iter_mut().for_each(|y| *y *= self.k / self.c);
            system.add_viscosity(x, y);
            y.iter_mut().for_each(|y| *y *= self.c);
        } else {
            y.iter_mut().for_each(|y| *y *= self.k);
        }
        for ((y, x), mass) in y.iter_mut().zip(x).zip(&system.mass) {
            *y += self.m * mass * x;
        }
    }
}

impl SecondOrder for System {
    fn len(&self) -> usize {
        self.mass.len()
    }

    fn force(&mut self, t: f64, u: &[f64], v: &[f64], out: &mut [f64]) -> Result<(), Failure> {
        self.unbalanced(t, u, out);
        let [alpha, beta] = self.rayleigh;
        if alpha != 0.0 {
            for ((o, v), m) in out.iter_mut().zip(v).zip(&self.mass) {
                *o -= alpha * m * v;
            }
        }
        if beta != 0.0 {
            self.with_expanded(u, |system, u| {
                system.elements.linearise(u);
                system.stale = system.linearised != u;
            });
            self.with_expanded(v, |system, v| system.elements.add_tangent(beta, v, out));
            self.elimination.restrict(out);
        }
        if self.elements.is_viscous() {
            self.with_expanded(u, |system, u| {
                system.elements.linearise_damping(u);
                system.damping_stale = system.linearised != u;
            });
            self.with_expanded(v, |system, v| system.elements.add_damping(-1.0, v, out));
            self.elimination.restrict(out);
        }
        Ok(())
    }

    fn mass_apply(&mut self, x: &[f64], y: &mut [f64]) {
        for ((y, x), m) in y.iter_mut().zip(x).zip(&self.mass) {
            *y = m * x;
        }
    }

    fn mass_solve(&mut self, rhs: &[f64], x: &mut [f64]) -> LinearReport {
        for (k, x) in x.iter_mut().enumerate() {
            *x = if self.held[k] { 0.0 } else { rhs[k] / self.mass[k] };
        }
        LinearReport::direct(0.0)
    }

    fn linearise(&mut self, _t: f64, u: &[f64], _v: &[f64]) -> Result<(), Failure> {
        self.linearise_at(u);
        Ok(())
    }

    fn stiffness_apply(&mut self, x: &[f64], y: &mut [f64]) {
        self.stiffness(x, y);
    }

    fn damping_apply(&mut self, x: &[f64], y: &mut [f64]) {
        let [alpha, beta] = self.rayleigh;
        if beta == 0.0 {
            y.fill(0.0);
        } else {
            self.stiffness(x, y);
        }
        for ((y, x), m) in y.iter_mut().zip(x).zip(&self.mass) {
            *y = beta * *y + alpha * m * x;
        }
        self.add_viscosity(x, y);
    }

    fn solve(&mut self, c: Combination, rhs: &[f64], x: &mut [f64]) -> LinearReport {
        let [alpha, beta] = self.rayleigh;
        let viscous = if self.elements.is_viscous() { c.damping } else { 0.0 };
        self.solve_system([c.mass + c.damping * alpha, c.stiffness + c.damping * beta, viscous], rhs, x)
    }

    fn project(&self, v: &mut [f64]) {
        for (v, &held) in v.iter_mut().zip(&self.held) {
            *v = if held { 0.0 } else { *v };
        }
    }

    fn prescribe(&self, t: f64, u: &mut [f64], v: &mut [f64]) {
        for (k, _) in self.prescribed.iter().enumerate().filter(|(_, p)| **p) {
            u[k] = 0.0;
            v[k] = 0.0;
        }
        for motion in &self.motions {
            motion.prescribe(t, &self.nodes, self.dimension, u, v);
        }
        for &(k, displacement) in &self.touch.held {
            u[k] = displacement;
            v[k] = 0.0;
        }
        self.elimination.expand(u);
        self.elimination.expand(v);
    }

    fn admissible(&mut self, t: f64, u: &[f64], _v: &[f64]) -> Result<(), Failure> {
        match u.iter().position(|x| x.abs() > self.reach || !x.is_finite()) {
            None => self.refuse_inversion(u),
            Some(k) => Err(Failure::inadmissible(
                Some(k),
                format!(
                    "node {} moved by {:.3e} m at t = {t} s, more than {:.3e} m, a thousand times the size of the bodies",
                    k / self.dimension,
                    u[k],
                    self.reach
                ),
            )),
        }
    }
}

impl NewtonProblem for System {
    fn len(&self) -> usize {
        self.mass.len()
    }

    fn residual(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), Failure> {
        self.refuse_inversion(x)?;
        self.unbalanced(self.load_time, x, out);
        for (o, &held) in out.iter_mut().zip(&self.held) {
            *o = if held { 0.0 } else { -*o };
        }
        Ok(())
    }

    fn energy(&mut self, x: &[f64]) -> Result<Option<f64>, Failure> {
        self.refuse_inversion(x)?;
        let mut external = std::mem::take(&mut self.scratch);
        self.external(self.load_time, &mut external);
        let work: f64 = external.iter().zip(x).map(|(f, u)| f * u).sum();
        self.scratch = external;
        let mut energy = 0.0;
        self.with_expanded(x, |system, x| energy = system.elements.energy(x));
        Ok(Some(energy - work + self.touch.energy(self.dimension, x)))
    }

    fn linearise(&mut self, x: &[f64]) -> Result<(), Failure> {
        self.linearise_at(x);
        Ok(())
    }

    fn solve_linear(&mut self, rhs: &[f64], dx: &mut [f64]) -> LinearReport {
        self.solve_system([0.0, 1.0, 0.0], rhs, dx)
    }
}

impl LoadProblem for System {
    fn set_load(&mut self, factor: f64, x: &mut [f64]) -> Result<(), Failure> {
        let [start, end] = self.load_span;
        self.load_time = start + factor * (end - start);
        self.load_share = if self.raising { factor } else { 1.0 };
        let mut unused = vec![0.0; x.len()];
        self.prescribe(self.load_time, x, &mut unused);
        Ok(())
    }
}
