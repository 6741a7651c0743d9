//! All elements of a model as one operator on nodal vectors.
//!
//! Vectors are flat, [node, axis], with as many axes as space has dimensions.
//! Each block writes the contributions of its elements into its own array, in lane order; then each node sums the
//! contributions of its elements in a fixed order (the first thesis' partial and total influence). So the result is the
//! same to the last bit for any number of threads.

use crate::assembly::Wave;
use crate::averages::{Average, Mean};
use crate::companion::{Carried, Companion, Family};
use crate::derive::{Association, Derived, derive, derive_averages};
use crate::{BlockSpec, Tangent, Threads};
use souple_forms::Loops;
use souple_kernels::{Aligned, Backend, CompileError, Input, Kernel, LANES, Scratch};
use souple_laws::check::{Inversion, inversion};
use souple_program::{Buffer, Costs, Program};
use std::sync::Arc;

/// Groups that one task runs through: enough to forget the cost of starting it.
const TASK: usize = 64;

/// Everything that the elements of a model compute.
pub struct Elements {
    pub(crate) dimension: usize,
    node_count: usize,
    pub(crate) blocks: Vec<Block>,
    pub(crate) tangent: Tangent,
    /// Contributions per node: `places[starts[n]..starts[n + 1]]` are (block, first place) pairs.
    starts: Vec<usize>,
    places: Vec<(u32, u32)>,
    pub(crate) threads: Arc<Threads>,
    pub(crate) scratch: Vec<Scratch>,
    /// Memory of the threads that assemble.
    pub(crate) waves: Vec<Wave>,
}

pub(crate) struct Block {
    pub(crate) spec: BlockSpec,
    pub(crate) derived: Arc<Derived>,
    pub(crate) groups: usize,
    /// Rest positions of all nodes, [node, axis].
    pub(crate) rest: Arc<Vec<f64>>,
    /// Node of each lane, [group][node][lane]; lanes beyond the last element repeat it.
    rows: Vec<u32>,
    kernels: Kernels,
    pub(crate) carried: Carried,
    pub(crate) inversion: Inversion,
    pub(crate) viscous: Option<Companion>,
    pub(crate) projected: Option<Companion>,
    /// Contributions to nodal vectors, [group][node, axis][lane].
    partial: Aligned,
    /// Energy or other outputs per element, [group][place][lane].
    small: Aligned,
}

struct Kernels {
    energy: Arc<dyn Kernel>,
    force: Arc<dyn Kernel>,
    linearise: Option<Arc<dyn Kernel>>,
    tangent_apply: Arc<dyn Kernel>,
    tangent_blocks: Arc<dyn Kernel>,
    volume_ratio: Arc<dyn Kernel>,
    volume: Arc<dyn Kernel>,
    /// Compiled when asked for.
    stress: Option<Arc<dyn Kernel>>,
    /// Likewise.
    strain: Option<Arc<dyn Kernel>>,
}

impl Kernels {
    fn average(&mut self, average: Average) -> &mut Option<Arc<dyn Kernel>> {
        match average {
            Average::Stress => &mut self.stress,
            Average::Strain => &mut self.strain,
        }
    }
}

/// Masses that the elements give to the nodes.
#[derive(Clone, Debug)]
pub struct Masses {
    /// ∫ρN in kg, [node]: the consistent load of a unit acceleration.
    pub shape: Vec<f64>,
    /// Lumped masses in kg, [node].
    pub lumped: Vec<f64>,
}

impl Elements {
    /// Derives, compiles and sets up all blocks, in a space of `dimension` axes.
    ///
    /// # Errors
    /// When the backend refuses a program.
    ///
    /// # Panics
    /// When an element has more dimensions than space, its law cannot be embedded where it has fewer, or a node index is
    /// out of range: the caller has checked the mesh.
    pub fn new(
        dimension: usize,
        nodes: &[[f64; 3]],
        specs: Vec<BlockSpec>,
        backend: &dyn Backend,
        threads: Arc<Threads>,
        costs: Costs,
    ) -> Result<(Elements, Masses), CompileError> {
        let rest: Arc<Vec<f64>> = Arc::new(nodes.iter().flat_map(|n| n[..dimension].iter().copied()).collect());
        let mut families: Vec<(Association, Arc<Derived>)> = Vec::new();
        let mut blocks = Vec::new();
        let mut masses = Masses { shape: vec![0.0; nodes.len()], lumped: vec![0.0; nodes.len()] };
        for spec in specs.into_iter().filter(|s| !s.is_empty()) {
            let BlockSpec { element, law, rule, .. } = spec;
            let association = Association { element, law, rule, loops: Loops::Rolled, dimension };
            let same =
                |a: &Association| (a.element.id, a.law.id, a.rule.id) == (spec.element.id, spec.law.id, spec.rule.id);
            let derived = match families.iter().find(|f| same(&f.0)) {
                Some(known) => known.1.clone(),
                None => {
                    let derived = Arc::new(derive(association, costs));
                    families.push((association, derived.clone()));
                    derived
                }
            };
            blocks.push(Block::new(spec, derived, backend, &rest, dimension, &mut masses)?);
        }
        let (starts, places) = contributions(&blocks, nodes.len(), dimension);
        let mut elements = Elements {
            dimension,
            node_count: nodes.len(),
            blocks,
            tangent: Tangent::Exact,
            starts,
            places,
            threads,
            scratch: Vec::new(),
            waves: Vec::new(),
        };
        elements.set_up_viscosity(backend, costs)?;
        Ok((elements, masses))
    }

    /// Number of axes per node.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.node_count
    }

    /// Length of nodal vectors.
    pub fn len(&self) -> usize {
        self.dimension * self.node_count
    }

    /// Whether there is nothing to compute.
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// What the blocks are made of, with the programs derived for them.
    pub fn blocks(&self) -> impl Iterator<Item = (&BlockSpec, &Derived)> {
        self.blocks.iter().map(|b| (&b.spec, &*b.derived))
    }

    /// Gives the elements of one block other parameters of their law; masses do not change.
    ///
    /// What was linearised before is of the old parameters: linearise again.
    ///
    /// # Errors
    /// When the backend refuses the set-up program.
    ///
    /// # Panics
    /// When there is no such block, or its law has another number of parameters.
    pub fn set_parameters(
        &mut self,
        block: usize,
        parameters: &[f64],
        backend: &dyn Backend,
    ) -> Result<(), CompileError> {
        let block = &mut self.blocks[block];
        assert_eq!(parameters.len(), block.spec.parameters.len(), "one value per parameter of the law");
        block.spec.parameters.copy_from_slice(parameters);
        block.inversion = inversion(block.spec.law, parameters);
        let setup = block.derived.staged.program("setup").expect("every association has every program");
        let kernel = backend.compile(setup)?;
        let rest = block.rest.clone();
        let unused = || vec![0.0; self.node_count];
        block.set_up(&*kernel, &rest, self.dimension, &mut Masses { shape: unused(), lumped: unused() });
        if let Some(mut viscous) = block.viscous.take() {
            block.set_up_companion(&mut viscous);
            block.viscous = Some(viscous);
        }
        if let Some(mut projected) = block.projected.take() {
            block.set_up_companion(&mut projected);
            block.projected = Some(projected);
        }
        Ok(())
    }

    /// Total strain energy in J at displacement `u`.
    pub fn energy(&mut self, u: &[f64]) -> f64 {
        let mut total = 0.0;
        self.each_energy(u, |_, energy| total += energy);
        total
    }

    /// Strain energy of each element in J, with its number, in the order of the blocks.
    pub fn each_energy(&mut self, u: &[f64], mut give: impl FnMut(u32, f64)) {
        for block in &mut self.blocks {
            let kernel = block.kernels.energy.clone();
            block.run(&kernel, Family::Elastic, Some(u), None, Destination::Small, &self.threads, &mut self.scratch);
            block.spec.ids.iter().zip(&block.small).for_each(|(&id, &energy)| give(id, energy));
        }
    }

    /// Deformed volume of each element in m³, with its number, in the order of the blocks.
    pub fn each_volume(&mut self, u: &[f64], mut give: impl FnMut(u32, f64)) {
        for block in &mut self.blocks {
            let kernel = block.kernels.volume.clone();
            block.run(&kernel, Family::Elastic, Some(u), None, Destination::Small, &self.threads, &mut self.scratch);
            block.spec.ids.iter().zip(&block.small).for_each(|(&id, &volume)| give(id, volume));
        }
    }

    /// Prepares [`Elements::each_mean`] for these averages: derives and compiles what is not there yet.
    ///
    /// # Errors
    /// When the backend refuses a program.
    pub fn prepare_means(
        &mut self,
        averages: &[Average],
        backend: &dyn Backend,
        costs: Costs,
    ) -> Result<(), CompileError> {
        if averages.is_empty() {
            return Ok(());
        }
        // Blocks of one association share one derivation, and so do these programs.
        let mut known: Vec<Arc<Derived>> = Vec::new();
        let mut compiled: Vec<Vec<Arc<dyn Kernel>>> = Vec::new();
        for block in &mut self.blocks {
            let family = known.iter().position(|k| Arc::ptr_eq(k, &block.derived)).unwrap_or(known.len());
            if family == known.len() {
                let staged = derive_averages(&block.derived, costs);
                let program = |a: &Average| staged.program(a.program()).expect("both averages are derived");
                let kernels: Result<Vec<_>, _> = averages.iter().map(|a| backend.compile(program(a))).collect();
                known.push(block.derived.clone());
                compiled.push(kernels?);
            }
            for (&average, kernel) in averages.iter().zip(&compiled[family]) {
                *block.kernels.average(average) = Some(kernel.clone());
            }
        }
        Ok(())
    }

    /// Mean stress or strain of each element at `u`, with its number, in the order of the blocks.
    ///
    /// # Panics
    /// When [`Elements::prepare_means`] was not asked for this average before.
    pub fn each_mean(&mut self, average: Average, u: &[f64], mut give: impl FnMut(u32, Mean)) {
        for block in &mut self.blocks {
            let kernel = block.kernels.average(average).clone().expect("`prepare_means` was called for this average");
            block.run(&kernel, Family::Elastic, Some(u), None, Destination::Small, &self.threads, &mut self.scratch);
            for (element, &id) in block.spec.ids.iter().enumerate() {
                let at = element / LANES * Mean::ROWS * LANES + element % LANES;
                let value = |row: usize| block.small[at + row * LANES];
                give(id, Mean { tensor: std::array::from_fn(value), volume: value(Mean::ROWS - 1) });
            }
        }
    }

    /// `out += f(u)`, internal forces in N.
    pub fn add_force(&mut self, u: &[f64], out: &mut [f64]) {
        for block in &mut self.blocks {
            let kernel = block.kernels.force.clone();
            block.run(&kernel, Family::Elastic, Some(u), None, Destination::Partial, &self.threads, &mut self.scratch);
        }
        self.collect(1.0, out);
    }

    /// Forces of each element alone on its nodes in N, [local node], axes beyond those of the space being zero, with its
    /// number, in the order of the blocks.
    pub fn each_nodal_force(&mut self, u: &[f64], mut give: impl FnMut(u32, &[[f64; 3]])) {
        let mut forces = Vec::new();
        let d = self.dimension;
        for block in &mut self.blocks {
            let kernel = block.kernels.force.clone();
            block.run(&kernel, Family::Elastic, Some(u), None, Destination::Partial, &self.threads, &mut self.scratch);
            let n = block.spec.element.node_count();
            for (element, &id) in block.spec.ids.iter().enumerate() {
                let (group, lane) = (element / LANES, element % LANES);
                let value = |row: usize| block.partial[(group * n * d + row) * LANES + lane];
                forces.clear();
                forces.extend(
                    (0..n).map(|a| -> [f64; 3] { std::array::from_fn(|k| if k < d { value(a * d + k) } else { 0.0 }) }),
                );
                give(id, &forces);
            }
        }
    }

    /// Prepares [`Elements::add_tangent`] at `u`.
    pub fn linearise(&mut self, u: &[f64]) {
        if self.tangent == Tangent::Projected {
            self.project_moduli(u);
            return;
        }
        for block in &mut self.blocks {
            if let Some(kernel) = block.kernels.linearise.clone() {
                block.run(&kernel, Family::Elastic, Some(u), None, Destination::Step, &self.threads, &mut self.scratch);
            }
        }
    }

    /// `out += scale · (∂f/∂u) v` at the linearised state.
    pub fn add_tangent(&mut self, scale: f64, v: &[f64], out: &mut [f64]) {
        for block in &mut self.blocks {
            let (kernel, family) = match &block.projected {
                Some(projected) => (projected.apply.clone(), Family::Projected),
                None => (block.kernels.tangent_apply.clone(), Family::Elastic),
            };
            block.run(&kernel, family, None, Some(v), Destination::Partial, &self.threads, &mut self.scratch);
        }
        self.collect(scale, out);
    }

    /// Elements whose volume ratio J at some quadrature point is at most `limit` or not a number, with the worst ratio,
    /// worst first.
    pub fn crushed(&mut self, u: &[f64], limit: f64) -> Vec<(u32, f64)> {
        self.crushed_where(u, limit, |_| true)
    }

    /// Elements inside out (J ≤ 0 or not a number at some quadrature point) whose law has no meaning there
    /// ([`Inversion::Fatal`]), with the worst ratio, worst first.
    pub fn fatally_inverted(&mut self, u: &[f64]) -> Vec<(u32, f64)> {
        self.crushed_where(u, 0.0, |inversion| inversion == Inversion::Fatal)
    }

    fn crushed_where(&mut self, u: &[f64], limit: f64, wanted: impl Fn(Inversion) -> bool) -> Vec<(u32, f64)> {
        let mut found = Vec::new();
        for block in self.blocks.iter_mut().filter(|b| wanted(b.inversion)) {
            let kernel = block.kernels.volume_ratio.clone();
            block.run(&kernel, Family::Elastic, Some(u), None, Destination::Small, &self.threads, &mut self.scratch);
            let program = kernel.program();
            let rows = program.outputs[0].total(program.points);
            for (element, &id) in block.spec.ids.iter().enumerate() {
                let (group, lane) = (element / LANES, element % LANES);
                let ratios = (0..rows).map(|r| block.small[(group * rows + r) * LANES + lane]);
                // `min` of the standard library skips NaN, which is what must not be skipped here.
                let worst = ratios.fold(f64::INFINITY, |w, j| if j.is_nan() || j < w { j } else { w });
                if worst.is_nan() || worst <= limit {
                    found.push((id, worst));
                }
            }
        }
        found.sort_by(|a, b| b.1.is_nan().cmp(&a.1.is_nan()).then(a.1.total_cmp(&b.1)).then(a.0.cmp(&b.0)));
        found
    }

    /// Each node sums the contributions of its elements, in the order of the blocks.
    pub(crate) fn collect(&mut self, scale: f64, out: &mut [f64]) {
        let d = self.dimension;
        let (starts, places, blocks) = (&self.starts, &self.places, &self.blocks);
        let per_task = self.node_count.div_ceil(4 * self.threads.count()).max(512);
        let mut tasks: Vec<(usize, &mut [f64])> = out.chunks_mut(per_task * d).enumerate().collect();
        self.threads.run(&mut tasks, |(task, out)| {
            for (k, node) in out.chunks_mut(d).enumerate() {
                let n = *task * per_task + k;
                let mut sum = [0.0; 3];
                for &(block, place) in &places[starts[n]..starts[n + 1]] {
                    let partial = &blocks[block as usize].partial[place as usize..];
                    for (axis, s) in sum[..d].iter_mut().enumerate() {
                        *s += partial[axis * LANES];
                    }
                }
                for (o, s) in node.iter_mut().zip(sum) {
                    *o += scale * s;
                }
            }
        });
    }
}

/// Where in the blocks' partial arrays each node finds its contributions.
fn contributions(blocks: &[Block], node_count: usize, d: usize) -> (Vec<usize>, Vec<(u32, u32)>) {
    let mut starts = vec![0usize; node_count + 1];
    for node in blocks.iter().flat_map(|b| &b.spec.connectivity) {
        starts[*node as usize + 1] += 1;
    }
    for n in 0..node_count {
        starts[n + 1] += starts[n];
    }
    let mut next = starts.clone();
    let mut places = vec![(0, 0); starts[node_count]];
    for (b, block) in blocks.iter().enumerate() {
        let n = block.spec.element.node_count();
        for (element, nodes) in block.spec.connectivity.chunks(n).enumerate() {
            let (group, lane) = (element / LANES, element % LANES);
            for (a, &node) in nodes.iter().enumerate() {
                let place = (group * n + a) * d * LANES + lane;
                places[next[node as usize]] =
                    (b as u32, u32::try_from(place).expect("a block has less than 2³² values"));
                next[node as usize] += 1;
            }
        }
    }
    (starts, places)
}

/// What a kernel writes.
pub(crate) enum Destination {
    /// Contributions to nodal vectors.
    Partial,
    /// Values carried to applications.
    Step,
    /// One output per element.
    Small,
    /// Moduli of the projected family.
    Moduli,
}

impl Block {
    fn new(
        spec: BlockSpec,
        derived: Arc<Derived>,
        backend: &dyn Backend,
        rest: &Arc<Vec<f64>>,
        d: usize,
        masses: &mut Masses,
    ) -> Result<Block, CompileError> {
        let n = spec.element.node_count();
        let groups = spec.len().div_ceil(LANES);
        let mut rows = Vec::with_capacity(groups * n * LANES);
        for group in 0..groups {
            for a in 0..n {
                rows.extend((0..LANES).map(|lane| {
                    let element = (group * LANES + lane).min(spec.len() - 1);
                    spec.connectivity[element * n + a]
                }));
            }
        }
        let compile = |name: &str| {
            let program = derived.staged.program(name).expect("every association has every program");
            backend.compile(program)
        };
        let kernels = Kernels {
            energy: compile("energy")?,
            force: compile("force")?,
            // A law that is linear carries nothing from a state.
            linearise: if derived.staged.step_to_apply == (0, 0) { None } else { Some(compile("linearise")?) },
            tangent_apply: compile("tangent_apply")?,
            tangent_blocks: compile("tangent_blocks")?,
            volume_ratio: compile("volume_ratio")?,
            volume: compile("volume")?,
            stress: None,
            strain: None,
        };
        let points = kernels.force.program().points;
        let mut block = Block {
            groups,
            rest: rest.clone(),
            rows,
            carried: Carried::sized(&derived.staged, points, groups * LANES),
            inversion: inversion(spec.law, &spec.parameters),
            viscous: None,
            projected: None,
            partial: Aligned::zeros(groups * n * d * LANES),
            small: Aligned::default(),
            kernels,
            spec,
            derived: derived.clone(),
        };
        block.set_up(&*compile("setup")?, rest, d, masses);
        Ok(block)
    }

    /// Runs the set-up program: carried values stay here, masses go to the nodes.
    fn set_up(&mut self, kernel: &dyn Kernel, rest: &[f64], d: usize, masses: &mut Masses) {
        let n = self.spec.element.node_count();
        let (density, section) = ([self.spec.density], [self.spec.section]);
        let program = kernel.program();
        let inputs: Vec<Input<'_>> = program
            .inputs
            .iter()
            .map(|b| match b.name.as_str() {
                "rest" => Input::Gathered { values: rest, rows: &self.rows, width: d },
                "parameters" => Input::Uniform(&self.spec.parameters),
                "density" => Input::Uniform(&density),
                "section" => Input::Uniform(&section),
                other => unreachable!("a set-up program reads no `{other}`"),
            })
            .collect();
        let [mut shape, mut lumped] = [vec![0.0; self.groups * n * LANES], vec![0.0; self.groups * n * LANES]];
        let [once, each] = &mut self.carried.setup;
        let (mut shape_out, mut lumped_out) = (Some(&mut shape[..]), Some(&mut lumped[..]));
        let (mut once, mut each) = (Some(&mut once[..]), Some(&mut each[..]));
        let mut outputs: Vec<&mut [f64]> = program
            .outputs
            .iter()
            .map(|b| {
                let slot = match b.name.as_str() {
                    "shape_mass" => &mut shape_out,
                    "lumped_mass" => &mut lumped_out,
                    "setup_values" => &mut once,
                    _ => &mut each,
                };
                slot.take().expect("buffers of a program have different names")
            })
            .collect();
        kernel.run(&mut Scratch::default(), self.groups, &inputs, &mut outputs);
        for (element, nodes) in self.spec.connectivity.chunks(n).enumerate() {
            let (group, lane) = (element / LANES, element % LANES);
            for (a, &node) in nodes.iter().enumerate() {
                masses.shape[node as usize] += shape[(group * n + a) * LANES + lane];
                masses.lumped[node as usize] += lumped[(group * n + a) * LANES + lane];
            }
        }
    }

    /// Makes the contributions to nodal vectors zero.
    pub(crate) fn forget_contributions(&mut self) {
        self.partial.fill(0.0);
    }

    /// Runs the set-up of a companion.
    pub(crate) fn set_up_companion(&self, companion: &mut Companion) {
        let Some(kernel) = &companion.setup else { return };
        let density = [self.spec.density];
        let viscosity = self.spec.viscosity.unwrap_or_default();
        let program = kernel.program();
        let inputs: Vec<Input<'_>> = program
            .inputs
            .iter()
            .map(|b| match b.name.as_str() {
                "rest" => Input::Gathered {
                    values: &self.rest,
                    rows: &self.rows,
                    width: b.len / self.spec.element.node_count(),
                },
                "parameters" => Input::Uniform(&self.spec.parameters),
                "viscosity" => Input::Uniform(&viscosity),
                "density" => Input::Uniform(&density),
                other => unreachable!("a set-up program reads no `{other}`"),
            })
            .collect();
        let [once, each] = &mut companion.carried.setup;
        let (mut once, mut each) = (Some(&mut once[..]), Some(&mut each[..]));
        let mut outputs: Vec<&mut [f64]> = program
            .outputs
            .iter()
            .map(|b| {
                let slot = if b.name == "setup_values" { &mut once } else { &mut each };
                slot.take().expect("buffers of a program have different names")
            })
            .collect();
        kernel.run(&mut Scratch::default(), self.groups, &inputs, &mut outputs);
    }

    pub(crate) fn run(
        &mut self,
        kernel: &Arc<dyn Kernel>,
        family: Family,
        u: Option<&[f64]>,
        v: Option<&[f64]>,
        destination: Destination,
        threads: &Threads,
        scratch: &mut Vec<Scratch>,
    ) {
        let program = kernel.program();
        let points = program.points;
        let rows_of: Vec<usize> = program.outputs.iter().map(|b| b.total(points)).collect();
        let (groups, n) = (self.groups, self.spec.element.node_count());
        if matches!(destination, Destination::Small) {
            self.small.set_len(groups * rows_of[0] * LANES);
        }
        let (carried, moduli) = match family {
            Family::Elastic => (&mut self.carried, None),
            Family::Viscous => {
                let companion = self.viscous.as_mut().expect("the caller checked that the block is viscous");
                (&mut companion.carried, None)
            }
            Family::Projected => {
                let companion = self.projected.as_mut().expect("the caller checked that the block is projected");
                (&mut companion.carried, Some(&mut companion.given))
            }
        };
        let [step_once, step_each] = &mut carried.step;
        // A linearisation writes the step values that an application reads; the two never meet in one program.
        let mut written: Vec<&mut [f64]> = Vec::new();
        let (mut step_read, mut partial, mut small) = (None, Some(&mut self.partial[..]), Some(&mut self.small[..]));
        let mut given: Option<&[f64]> = None;
        if matches!(destination, Destination::Step) {
            let (mut once, mut each) = (Some(&mut step_once[..]), Some(&mut step_each[..]));
            for b in &program.outputs {
                let slot = match b.name.as_str() {
                    "force" => &mut partial,
                    "step_values" => &mut once,
                    _ => &mut each,
                };
                written.push(slot.take().expect("buffers of a program have different names"));
            }
        } else if matches!(destination, Destination::Moduli) {
            let moduli = moduli.expect("moduli belong to the projected family");
            moduli.set_len(groups * rows_of[0] * LANES);
            written.push(moduli);
        } else {
            let slot = if matches!(destination, Destination::Partial) { &mut partial } else { &mut small };
            written.push(slot.take().expect("taken once"));
            step_read = Some([&step_once[..], &step_each[..]]);
            given = moduli.map(|m| &m[..]);
        }
        let source = Sources {
            u,
            v,
            rest: Some(&self.rest),
            parameters: &self.spec.parameters,
            viscosity: self.spec.viscosity.as_ref().map_or(&[], |v| &v[..]),
            moduli: given,
            section: std::slice::from_ref(&self.spec.section),
            rows: &self.rows,
            setup: [&carried.setup[0], &carried.setup[1]],
            step: step_read,
            nodes: n,
        };
        run_tasks(kernel, &source, 0, groups, &mut written, &rows_of, threads, scratch);
    }

    /// The program of the tangent blocks.
    pub(crate) fn tangent_blocks(&self) -> Arc<dyn Kernel> {
        self.kernels.tangent_blocks.clone()
    }

    /// What the program of the tangent blocks of a family reads at `u`.
    pub(crate) fn blocks_source<'a>(&'a self, family: Family, u: &'a [f64]) -> Sources<'a> {
        let (carried, moduli) = match family {
            Family::Elastic => (&self.carried, None),
            Family::Viscous => (&self.viscous.as_ref().expect("the caller checked").carried, None),
            Family::Projected => {
                let companion = self.projected.as_ref().expect("the caller checked");
                (&companion.carried, Some(&companion.given[..]))
            }
        };
        Sources {
            u: Some(u),
            v: None,
            rest: Some(&self.rest),
            parameters: &self.spec.parameters,
            viscosity: self.spec.viscosity.as_ref().map_or(&[], |v| &v[..]),
            moduli,
            section: std::slice::from_ref(&self.spec.section),
            rows: &self.rows,
            setup: [&carried.setup[0], &carried.setup[1]],
            step: None,
            nodes: self.spec.element.node_count(),
        }
    }
}

/// Where the input buffers of a program are found.
pub(crate) struct Sources<'a> {
    u: Option<&'a [f64]>,
    v: Option<&'a [f64]>,
    rest: Option<&'a [f64]>,
    parameters: &'a [f64],
    viscosity: &'a [f64],
    moduli: Option<&'a [f64]>,
    section: &'a [f64],
    rows: &'a [u32],
    setup: [&'a [f64]; 2],
    step: Option<[&'a [f64]; 2]>,
    nodes: usize,
}

impl<'a> Sources<'a> {
    /// The input buffers of `groups` groups from `first` on.
    pub(crate) fn inputs(&self, program: &Program, first: usize, groups: usize) -> Vec<Input<'a>> {
        let points = program.points;
        let of_buffer = |b: &Buffer| {
            let part = |rows: usize| first * rows * LANES..(first + groups) * rows * LANES;
            let lanes = || part(b.total(points));
            match b.name.as_str() {
                "displacement" | "direction" | "rest" => {
                    let values = match b.name.as_str() {
                        "displacement" => self.u,
                        "direction" => self.v,
                        _ => self.rest,
                    };
                    let values = values.expect("the caller gives what its programs read");
                    let rows = &self.rows[part(self.nodes)];
                    Input::Gathered { values, rows, width: b.len / self.nodes }
                }
                "parameters" => Input::Uniform(self.parameters),
                "viscosity" => Input::Uniform(self.viscosity),
                "moduli" => Input::Lanes(&self.moduli.expect("moduli come before what reads them")[lanes()]),
                "section" => Input::Uniform(self.section),
                "setup_values" => Input::Lanes(&self.setup[0][lanes()]),
                "setup_point_values" => Input::Lanes(&self.setup[1][lanes()]),
                name => {
                    let step = self.step.expect("only applications read what a step carries");
                    let values = if name == "step_values" { step[0] } else { step[1] };
                    Input::Lanes(&values[lanes()])
                }
            }
        };
        program.inputs.iter().map(of_buffer).collect()
    }
}

/// Runs a kernel over `count` groups from `first`, in tasks.
fn run_tasks(
    kernel: &Arc<dyn Kernel>,
    source: &Sources<'_>,
    first: usize,
    count: usize,
    outputs: &mut [&mut [f64]],
    rows_of: &[usize],
    threads: &Threads,
    scratch: &mut Vec<Scratch>,
) {
    struct Task<'a> {
        first: usize,
        groups: usize,
        outputs: Vec<&'a mut [f64]>,
        scratch: Scratch,
    }
    let per_task = TASK.min(count.div_ceil(threads.count())).max(1);
    let mut tasks: Vec<Task<'_>> = Vec::with_capacity(count.div_ceil(per_task));
    let mut left: Vec<&mut [f64]> = outputs.iter_mut().map(|o| &mut **o).collect();
    let mut at = 0;
    while at < count {
        let groups = per_task.min(count - at);
        let mut own = Vec::with_capacity(left.len());
        for (slice, rows) in left.iter_mut().zip(rows_of) {
            let (head, tail) = std::mem::take(slice).split_at_mut(groups * rows * LANES);
            own.push(head);
            *slice = tail;
        }
        tasks.push(Task { first: first + at, groups, outputs: own, scratch: scratch.pop().unwrap_or_default() });
        at += groups;
    }
    threads.run(&mut tasks, |task| {
        let inputs = source.inputs(kernel.program(), task.first, task.groups);
        kernel.run(&mut task.scratch, task.groups, &inputs, &mut task.outputs);
    });
    scratch.extend(tasks.into_iter().map(|t| t.scratch));
}
