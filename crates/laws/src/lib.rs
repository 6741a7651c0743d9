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

pub use kinematics::Kinematics;
pub use parameter::{BULK, Bound, ISOTROPIC, POISSON, Parameter, YOUNG, lame_from_young_poisson};
pub use response::Response;
use souple_symbols::Expr;
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
