//! What a constitutive law is, and each one.
//!
//! A law is one file in `src/laws/`: its parameters and its energy density, written once as an expression of the
//! deformation. Stresses and tangents are derived, never written. The folder is scanned by `build.rs`.
//! Laws can also be read from text ([`user`]), and every law can be looked at with numbers ([`Response`]), judged and
//! drawn ([`check`]).

pub mod check;
mod kinematics;
mod parameter;
pub mod response;
pub mod user;

pub use kinematics::{Kinematics, TangentStrain};
pub use parameter::{BULK, Bound, ISOTROPIC, POISSON, Parameter, YOUNG, lame_from_young_poisson};
pub use response::Response;
use souple_symbols::{Expr, Graph, Matrix, Time};
use std::fmt;

include!(concat!(env!("OUT_DIR"), "/scanned.rs"));

/// A constitutive law.
#[derive(Clone, Copy)]
pub struct Law {
    /// The id used in scenes and commands (`"stvk"`).
    pub id: &'static str,
    /// Name in full.
    pub name: &'static str,
    /// One sentence: what it is good for and where it stops being so.
    pub about: &'static str,
    /// Energy density as people write it.
    pub formula: &'static str,
    /// Where it comes from.
    pub references: &'static [&'static str],
    /// Parameters, in the order in which programs read them.
    pub parameters: &'static [Parameter],
    /// Whether a superposed rotation leaves the energy unchanged; false for small-strain laws.
    pub objective: bool,
    /// Energy per reference volume, in J/m³.
    pub energy: &'static Energy,
}

/// Writes an energy density into the graph of the given measures of deformation: a function of a law file, or one that
/// walks the text of a user law. Equal measures must give equal expressions.
pub type Energy = dyn Fn(&mut Kinematics<'_>) -> Expr + Send + Sync;

/// What a person gives for a law: one number, or a direction that is three parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Argument {
    /// The parameter of this name.
    Number(&'static Parameter),
    /// The three consecutive parameters `name_x`, `name_y` and `name_z`, not all zero.
    Direction {
        /// The name without the axis.
        name: &'static str,
        /// The first of them.
        x: &'static Parameter,
    },
}

impl Law {
    /// What the law asks for, in the order of its parameters.
    pub fn arguments(&self) -> Vec<Argument> {
        let parameters = self.parameters;
        let mut arguments = Vec::new();
        let mut at = 0;
        while at < parameters.len() {
            let axis = |k: usize, suffix| parameters.get(at + k).and_then(|p: &Parameter| p.name.strip_suffix(suffix));
            let direction = axis(0, "_x").filter(|&name| axis(1, "_y") == Some(name) && axis(2, "_z") == Some(name));
            let x = &parameters[at];
            arguments.push(direction.map_or(Argument::Number(x), |name| Argument::Direction { name, x }));
            at += if direction.is_some() { 3 } else { 1 };
        }
        arguments
    }

    /// Whether the law can be used on surfaces and lines in space, where F is not known: whether its energy is written
    /// in C, E, ε, J and invariants alone.
    pub fn embeddable(&self) -> bool {
        let mut graph = Graph::new();
        let g = &mut graph;
        let parameters: Vec<(String, Expr)> =
            self.parameters.iter().map(|p| (p.name.to_owned(), g.symbol(p.name, Time::Setup))).collect();
        let entries: Vec<Expr> = (0..9).map(|k| g.symbol(format!("E{k}"), Time::Step)).collect();
        let strain = Matrix::from_fn(3, |i, j| entries[3 * i.min(j) + i.max(j)]);
        let tangents = vec![[entries[0]; 3]];
        let strain = TangentStrain { E: strain.clone(), epsilon: strain, J: entries[8], tangents };
        let mut kinematics = Kinematics::in_tangent_frame(g, strain, parameters);
        (self.energy)(&mut kinematics);
        !kinematics.gradient_missed()
    }
}

impl fmt::Debug for Law {
    /// The id alone: it names the law.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Law({})", self.id)
    }
}

/// Every law, sorted by id.
pub fn all() -> &'static [&'static Law] {
    static SORTED: std::sync::LazyLock<Vec<&'static Law>> = std::sync::LazyLock::new(|| {
        let mut sorted = ALL.to_vec();
        sorted.sort_by_key(|l| l.id);
        sorted
    });
    &SORTED
}

/// The law with this id.
pub fn by_id(id: &str) -> Option<&'static Law> {
    ALL.iter().copied().find(|l| l.id == id)
}
