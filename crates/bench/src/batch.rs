//! Elements of one kind with everything that their kernels read, in the layouts of
//! [`souple_kernels`](souple_kernels::LANES): the data of every measurement.
//!
//! The elements are those of a bar whose inner nodes are moved a little, so that no two are alike; the displacement is a
//! homogeneous deformation with noise, small enough that no element is inside out.

use souple_elements::{Element, Family};
use souple_kernels::conformance::Random;
use souple_kernels::{Aligned, Backend, CompileError, Input, Kernel, LANES, Scratch};
use souple_laws::{Bound, Law, Parameter};
use souple_mesh::bar::{BarSpec, Section, Split, Transition, generate};
use souple_operators::{Association, Derived, derive};
use souple_program::{Costs, LINEARISE, Program, SETUP};
use std::ops::Range;
use thiserror::Error;

/// Why there is no batch.
#[derive(Debug, Error)]
pub enum BatchError {
    /// The bar could not be made.
    #[error("no mesh of {element}: {why}")]
    Mesh {
        /// Id of the element.
        element: &'static str,
        /// What the generator says.
        why: String,
    },
    /// The device refused a program.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// Threads could not be started.
    #[error("{0}")]
    Threads(String),
    /// No instruction set with vectors was found.
    #[error("this measurement needs a processor with AVX2 and FMA, or AVX-512")]
    NoVectors,
}

/// Values that programs carry, by the name of the buffer.
type Carried = Vec<(String, Aligned)>;

/// A batch.
#[derive(Clone, Debug)]
pub struct Batch {
    /// The programs.
    pub derived: Derived,
    /// Number of groups of [`LANES`] elements.
    pub groups: usize,
    /// Number of nodes.
    pub nodes: usize,
    /// Rest positions in m, [node, axis].
    pub rest: Vec<f64>,
    /// Displacements in m, [node, axis].
    pub displacement: Vec<f64>,
    /// Direction of products, [node, axis].
    pub direction: Vec<f64>,
    /// The law's parameters.
    pub parameters: Vec<f64>,
    /// Node of each lane, [group][node][lane].
    pub rows: Vec<u32>,
    carried: Carried,
}

/// Derives an element that fills its space with a law, on its default quadrature.
pub fn association(element: &'static Element, law: &'static Law) -> Derived {
    derive(Association::new(element, law), Costs::default())
}

impl Batch {
    /// At least this many elements, filled up to whole groups, set up and linearised on `backend`.
    ///
    /// # Errors
    /// When there is no such mesh or the backend refuses a program.
    pub fn new(derived: Derived, elements: usize, backend: &dyn Backend) -> Result<Batch, BatchError> {
        let element = derived.association.element;
        let d = element.dimension();
        let groups = elements.max(1).div_ceil(LANES);
        let mut random = Random::new(1);
        let (nodes, connectivity) = bar(element, groups * LANES, &mut random)?;
        let n = element.node_count();
        let mut rows = Vec::with_capacity(groups * LANES * n);
        for group in connectivity[..groups * LANES * n].chunks(LANES * n) {
            for a in 0..n {
                rows.extend((0..LANES).map(|lane| group[lane * n + a]));
            }
        }
        let rest: Vec<f64> = nodes.iter().flat_map(|x| x[..d].iter().copied()).collect();
        let displacement = displacement(&nodes, d, &mut random);
        let direction = rest.iter().map(|_| random.between(-1.0, 1.0)).collect();
        let parameters = parameters(derived.association.law);
        let carried = carried(&derived, groups);
        let nodes = nodes.len();
        let mut batch = Batch { derived, groups, nodes, rest, displacement, direction, parameters, rows, carried };
        batch.prepare(SETUP, backend)?;
        if batch.derived.staged.step_to_apply != (0, 0) {
            batch.prepare(LINEARISE, backend)?;
        }
        Ok(batch)
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.groups * LANES
    }

    /// Rest positions of one element in m, [node][axis], zero beyond the dimension.
    pub fn rest_of(&self, group: usize, lane: usize) -> Vec<[f64; 3]> {
        let element = self.derived.association.element;
        let (n, d) = (element.node_count(), element.dimension());
        let rows = &self.rows[group * n * LANES..(group + 1) * n * LANES];
        let position = |a: usize| {
            let at = rows[a * LANES + lane] as usize * d;
            let mut x = [0.0; 3];
            x[..d].copy_from_slice(&self.rest[at..at + d]);
            x
        };
        (0..n).map(position).collect()
    }

    /// Length of an output of a program for this many groups.
    pub fn output_len(program: &Program, output: usize, groups: usize) -> usize {
        program.outputs[output].total(program.points) * groups * LANES
    }

    /// Arrays for the outputs of a program for this many groups. They are written once, so that the system has given
    /// their pages before anything is measured (zeros would be given when first touched), and what a kernel leaves out
    /// stays seen.
    pub fn outputs(program: &Program, groups: usize) -> Vec<Aligned> {
        (0..program.outputs.len()).map(|o| Aligned::filled(Batch::output_len(program, o, groups), f64::NAN)).collect()
    }

    /// Inputs of a program for these groups, in its order.
    pub fn inputs(&self, program: &Program, groups: &Range<usize>) -> Vec<Input<'_>> {
        let element = self.derived.association.element;
        let n = element.node_count();
        let rows = &self.rows[groups.start * n * LANES..groups.end * n * LANES];
        let gathered = |values| Input::Gathered { values, rows, width: element.dimension() };
        let input = |b: &souple_program::Buffer| match b.name.as_str() {
            "rest" => gathered(&self.rest),
            "displacement" => gathered(&self.displacement),
            "direction" => gathered(&self.direction),
            "parameters" => Input::Uniform(&self.parameters),
            "density" | "section" => Input::Uniform(&[1.0]),
            name => {
                let values = &self.carried.iter().find(|c| c.0 == name).expect("programs read what others carry").1;
                let rows = b.total(program.points);
                Input::Lanes(&values[groups.start * rows * LANES..groups.end * rows * LANES])
            }
        };
        program.inputs.iter().map(input).collect()
    }

    /// The parts of outputs that belong to these groups.
    pub fn slices<'a>(program: &Program, groups: &Range<usize>, outputs: &'a mut [Aligned]) -> Vec<&'a mut [f64]> {
        let part = |(o, values): (usize, &'a mut Aligned)| {
            let first = Batch::output_len(program, o, groups.start);
            &mut values[first..Batch::output_len(program, o, groups.end)]
        };
        outputs.iter_mut().enumerate().map(part).collect()
    }

    /// Runs a kernel on these groups; `outputs` are those of [`Batch::outputs`] from the first group on.
    pub fn run(&self, kernel: &dyn Kernel, scratch: &mut Scratch, groups: Range<usize>, outputs: &mut [Aligned]) {
        let inputs = self.inputs(kernel.program(), &groups);
        let mut outputs = Batch::slices(kernel.program(), &groups, outputs);
        kernel.run(scratch, groups.len(), &inputs, &mut outputs);
    }

    /// Bytes that a program reads and writes per element: lanes, rows, its share of the nodal vectors, outputs.
    pub fn bytes(&self, program: &Program) -> f64 {
        let element = self.derived.association.element;
        let shared = |width: usize| (self.nodes * width * 8) as f64 / self.elements() as f64;
        let input = |b: &souple_program::Buffer| match b.name.as_str() {
            "rest" | "displacement" | "direction" => (4 * element.node_count()) as f64 + shared(element.dimension()),
            "parameters" | "density" | "section" => 0.0,
            _ => (8 * b.total(program.points)) as f64,
        };
        let written: usize = program.outputs.iter().map(|b| 8 * b.total(program.points)).sum();
        program.inputs.iter().map(input).sum::<f64>() + written as f64
    }

    /// Runs the program that carries values to later ones.
    fn prepare(&mut self, name: &str, backend: &dyn Backend) -> Result<(), BatchError> {
        let program = self.derived.staged.program(name).expect("every association has it").clone();
        let kernel = backend.compile(&program)?;
        let mut outputs = Batch::outputs(&program, self.groups);
        self.run(&*kernel, &mut Scratch::default(), 0..self.groups, &mut outputs);
        for (buffer, values) in program.outputs.iter().zip(outputs) {
            if let Some(carried) = self.carried.iter_mut().find(|c| c.0 == buffer.name) {
                carried.1 = values;
            }
        }
        Ok(())
    }
}

/// Room for carried values.
fn carried(derived: &Derived, groups: usize) -> Carried {
    let points = derived.association.rule.points.len();
    let (setup, step) = (derived.staged.setup_to_step, derived.staged.step_to_apply);
    [
        ("setup_values", setup.0),
        ("setup_point_values", setup.1 * points),
        ("step_values", step.0),
        ("step_point_values", step.1 * points),
    ]
    .map(|(name, places)| (name.to_owned(), Aligned::zeros(places * groups * LANES)))
    .into()
}

/// Rest positions and connectivity of at least this many elements.
pub(crate) fn bar(
    element: &'static Element,
    elements: usize,
    random: &mut Random,
) -> Result<(Vec<[f64; 3]>, Vec<u32>), BatchError> {
    let per_cell = match element.family {
        Family::Tetrahedron | Family::Pyramid => 6,
        Family::Prism | Family::Triangle => 2,
        _ => 1,
    };
    let cells = elements.div_ceil(per_cell);
    let d = element.dimension();
    // A beam of square section, four times as long as it is thick where the dimension allows one.
    let thick = ((cells as f64 / 4.0).powf(1.0 / d as f64).round() as usize).max(1);
    let across: usize = thick.pow(d as u32 - 1);
    let counts = [cells.div_ceil(across), thick, thick];
    let spec = BarSpec {
        size: counts.map(|c| c as f64),
        cells: counts,
        origin: [0.0; 3],
        sections: vec![Section { until: 1.0, element, split: Split::Usual }],
        transition: Transition::Keep,
    };
    let (mut mesh, _) = generate(&spec).map_err(|e| BatchError::Mesh { element: element.id, why: e.to_string() })?;
    // Nodes of elements of higher degree stand closer together.
    let noise = 0.04 / f64::from(element.degree.max(1));
    for x in &mut mesh.nodes {
        x[..d].iter_mut().for_each(|c| *c += noise * random.between(-1.0, 1.0));
    }
    let block = mesh.blocks.iter().find(|b| b.element.id == element.id).expect("the bar is made of this element");
    Ok((mesh.nodes.clone(), block.connectivity.clone()))
}

/// A homogeneous deformation with noise, [node, axis] in m.
pub(crate) fn displacement(nodes: &[[f64; 3]], d: usize, random: &mut Random) -> Vec<f64> {
    let gradient: [[f64; 3]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| random.between(-0.08, 0.08)));
    let mut u = Vec::with_capacity(nodes.len() * d);
    for x in nodes {
        for row in &gradient[..d] {
            let homogeneous: f64 = row[..d].iter().zip(x).map(|(h, x)| h * x).sum();
            u.push(homogeneous + 0.02 * random.between(-1.0, 1.0));
        }
    }
    u
}

/// Parameters well inside their ranges, in the law's order: defaults where there are any that are not zero.
pub(crate) fn parameters(law: &Law) -> Vec<f64> {
    let limit = |b: Bound| match b {
        Bound::None | Bound::NonZero => None,
        Bound::Open(v) | Bound::Closed(v) => Some(v),
    };
    let inside = |p: &Parameter| match (limit(p.minimum), limit(p.maximum)) {
        (Some(low), Some(high)) => low + 0.87 * (high - low),
        (Some(low), None) => low + 1.25,
        (None, Some(high)) => high - 1.25,
        (None, None) => 0.75,
    };
    // A default of zero would leave out what it multiplies.
    let default = |p: &Parameter| p.default.filter(|&value| value != 0.0);
    law.parameters.iter().map(|p| default(p).unwrap_or_else(|| inside(p))).collect()
}
