//! A group of simulations as data: a base scene, parameters with their values, bars, devices.
//!
//! What it is not: the simulations themselves, which [`crate::plan`] makes of it by crossing everything with everything.

use std::fmt;
use std::path::PathBuf;

/// A family of simulations.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Its name in the database.
    pub name: String,
    /// What it was read from.
    pub source: Source,
    /// The base scene.
    pub scene: BaseScene,
    /// The parameters; the first one varies most quickly.
    pub parameters: Vec<Parameter>,
    /// Number of samples of the Latin hypercube; 1 where no parameter takes part in one.
    pub samples: usize,
    /// Sets of changes that belong together; none: nothing changes but the parameters. With cases, the first parameter
    /// is [`CASE`], whose values are their names.
    pub cases: Vec<Case>,
    /// Bars to put into the base scene; none: the base scene as it stands.
    pub bars: Vec<Bar>,
    /// Devices to compute on, by name; at least one.
    pub devices: Vec<String>,
}

/// Name of the parameter whose values are the names of the cases.
pub const CASE: &str = "case";

/// Changes of the base scene that belong together, such as a mesh and what it must give.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Its name.
    pub name: String,
    /// Keys of the scene and their values as TOML, in the order in which they are set.
    pub set: Vec<(String, String)>,
    /// How its simulations must end.
    pub ends: Ending,
}

/// How a simulation must end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// At its end or at rest, with all its `[[expect]]` met.
    Finished,
    /// It diverges.
    Failed,
    /// Its scene is refused.
    Invalid,
}

/// Which description a group was read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// `campaign.toml`: parameters are keys of the scene.
    Toml,
    /// `params.csv`, `barres.csv`, `Barre/NAME.csv`: parameters have their own names.
    Folder,
}

/// The scene that all simulations of a group start from.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseScene {
    /// Its file; none for a scene that comes with the program.
    pub path: Option<PathBuf>,
    /// Its text.
    pub text: String,
}

/// Something that varies.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its name: a key of the scene (`material.0.young`), or one of the folder's.
    pub name: String,
    /// How its values were described.
    pub variation: Variation,
    /// Its values in their order; of a parameter of the Latin hypercube one per sample.
    pub values: Vec<Value>,
}

/// How the values of a parameter are described.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Variation {
    /// One by one.
    List,
    /// From `from` on, adding `step` each time.
    Adding {
        /// First value.
        from: f64,
        /// Bound of the last one.
        to: f64,
        /// What is added.
        step: f64,
    },
    /// From `from` on, multiplying by `factor` each time.
    Multiplying {
        /// First value.
        from: f64,
        /// Bound of the last one.
        to: f64,
        /// What is multiplied by.
        factor: f64,
    },
    /// Drawn between two bounds, together with the others of its kind.
    LatinHypercube {
        /// Lower bound.
        low: f64,
        /// Upper bound.
        high: f64,
    },
}

/// A value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A whole number.
    Whole(i64),
    /// A number.
    Number(f64),
    /// Anything else, as it stands in TOML.
    Toml(String),
}

impl Value {
    /// The value as a number, where it is one.
    pub fn number(&self) -> Option<f64> {
        match self {
            Value::Whole(x) => Some(*x as f64),
            Value::Number(x) => Some(*x),
            Value::Toml(_) => None,
        }
    }
}

/// As TOML; a number reads back to the same bits.
impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Whole(x) => write!(f, "{x}"),
            Value::Number(x) => write!(f, "{x:?}"),
            Value::Toml(text) => f.write_str(text),
        }
    }
}

/// A bar of sections along x.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// Its name.
    pub name: String,
    /// The device that it asks for; none: the group's.
    pub device: Option<String>,
    /// Its sections, one after the other; at least one.
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
    /// Quadrature of the element, as TOML; none: the element's default.
    pub quadrature: Option<String>,
    /// Further keys of the section's material: name and value as TOML.
    pub parameters: Vec<(String, String)>,
}
