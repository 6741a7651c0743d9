//! A group as plain data: what reports, exports and comparisons are made of.
//!
//! What it is not: a database. [`super::read`] fills these structs and is the only place here that knows tables.

/// A group with all of its simulations.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Its name.
    pub name: String,
    /// Where it was described.
    pub folder: String,
    /// Which description: `campaign.toml` or `params.csv`.
    pub source: String,
    /// Text of the base scene.
    pub scene: String,
    /// What varies; the first one varies most quickly.
    pub parameters: Vec<Parameter>,
    /// Bars, where there are any.
    pub bars: Vec<Bar>,
    /// Machines that computed something of it.
    pub machines: Vec<Machine>,
    /// Its simulations in the order of their numbers.
    pub simulations: Vec<Simulation>,
}

/// Something that varies.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Key of the scene, or name in `params.csv`.
    pub name: String,
    /// `list`, `adding`, `multiplying` or `latin hypercube`.
    pub variation: String,
    /// First value or lower bound; of a list none.
    pub first: Option<f64>,
    /// Last value or upper bound; of a list none.
    pub last: Option<f64>,
    /// What is added or multiplied.
    pub step: Option<f64>,
    /// Number of values.
    pub count: usize,
}

/// A bar of sections.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// Its name.
    pub name: String,
    /// Its sections along x.
    pub sections: Vec<Section>,
}

/// A part of a bar.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Where it ends, as a fraction of the length.
    pub until: f64,
    /// Id of its law.
    pub law: String,
    /// Id of its element.
    pub element: String,
    /// Its quadrature as TOML, where it is not the element's default.
    pub quadrature: Option<String>,
}

/// Where simulations ran.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Machine {
    /// Its name.
    pub host: String,
    /// Its processor.
    pub processor: String,
    /// Number of its threads.
    pub cores: usize,
    /// Its operating system.
    pub system: String,
}

/// A place in the group.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulation {
    /// Its number, from 0.
    pub number: usize,
    /// Index of its bar.
    pub bar: Option<usize>,
    /// Its device.
    pub device: String,
    /// Its value of each parameter, as TOML; none where the database has none.
    pub values: Vec<Option<String>>,
    /// What became of it; none while it is to do.
    pub done: Option<Done>,
}

/// What became of a simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct Done {
    /// Of everything that determines it.
    pub hash: String,
    /// `finished`, `at rest`, `failed`, `invalid`, `crashed`, ….
    pub status: String,
    /// Why it did not come to its end; else empty.
    pub reason: String,
    /// SHA-256 of the program.
    pub program: String,
    /// Threads.
    pub threads: usize,
    /// Index of its machine.
    pub machine: usize,
    /// Time of the process (s).
    pub wall_s: f64,
    /// Steps made.
    pub steps: Option<i64>,
    /// Simulated time (s).
    pub simulated_s: Option<f64>,
    /// Nodes.
    pub nodes: Option<i64>,
    /// Elements by kind.
    pub elements: Vec<(String, i64)>,
    /// Phases of a step and their times (ms per step).
    pub timings: Vec<(String, f64)>,
    /// Single numbers of probes.
    pub measurements: Vec<Measurement>,
    /// Lists of probes.
    pub curves: Vec<Curve>,
    /// What the scene's `[[expect]]` compared.
    pub expectations: Vec<Expectation>,
    /// Materials of its bodies.
    pub materials: Vec<Material>,
}

impl Done {
    /// Whether it came to its end.
    pub fn succeeded(&self) -> bool {
        ["finished", "at rest"].contains(&self.status.as_str())
    }
}

/// A number that a probe gave.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// The probe.
    pub probe: String,
    /// The quantity.
    pub quantity: String,
    /// Component of a vector or tensor; of a number empty.
    pub component: String,
    /// In SI units.
    pub value: f64,
}

/// A list that a probe gave.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The probe.
    pub probe: String,
    /// The quantity.
    pub quantity: String,
    /// Its points (m), [point, axis].
    pub points: Vec<[f64; 3]>,
}

/// Something that the scene expected.
#[derive(Clone, Debug, PartialEq)]
pub struct Expectation {
    /// What.
    pub name: String,
    /// How far it is from that.
    pub difference: Option<f64>,
    /// How far it may be.
    pub tolerance: f64,
}

/// A material of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Id of its law.
    pub law: String,
    /// Its parameters, as JSON.
    pub parameters: String,
}
