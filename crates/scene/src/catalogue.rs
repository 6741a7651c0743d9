//! What a scene may refer to and this crate does not know: constitutive laws, by name and parameters.
//!
//! The laws live elsewhere; whoever parses a scene hands their names in.
//! Elements and their quadratures come from the registry of `souple-elements`.

use serde::Serialize;

use crate::range::{Bound, Range};

/// The laws that a scene may name.
#[derive(Clone, Debug, Default)]
pub struct Catalogue {
    /// Every law except `user`, in the order in which lists show them.
    pub laws: Vec<LawEntry>,
    /// Reads the energy of a `law = "user"` material; without it such an energy is accepted as it stands.
    pub user_law: Option<UserLawCheck>,
}

/// A law: its id and its parameters.
#[derive(Clone, Debug)]
pub struct LawEntry {
    /// The word in the scene: `"neo-hookean"`.
    pub id: String,
    /// Its parameters, in the order in which a scene keeps them.
    pub parameters: Vec<ParameterEntry>,
    /// Checks what single ranges cannot say (two lists of equal length); called with every parameter, defaults
    /// included, when each is valid alone.
    pub check: Option<LawCheck>,
}

/// A parameter of a law.
///
/// A law that has both `young` and `poisson` is isotropic: it also accepts the pairs (`lambda`, `mu`) and (`bulk`,
/// `mu`) in their place, unless it has parameters of these names itself.
#[derive(Clone, Debug)]
pub struct ParameterEntry {
    /// The key in the scene: `"young"`.
    pub name: String,
    /// Unit of a plain number, such as `"Pa"`; empty or `"1"` for a pure number.
    ///
    /// Texts with units ("4 kPa") are accepted where this unit can be read by [`crate::units::unit`].
    pub unit: String,
    /// Number, list or direction.
    pub shape: ParameterShape,
    /// Least value (of each number of a list).
    pub minimum: Option<Bound>,
    /// Largest value.
    pub maximum: Option<Bound>,
    /// The value of a scene that does not give it; `None` makes it compulsory.
    pub default: Option<ParameterValue>,
    /// What it is: "Young's modulus".
    pub about: String,
}

impl ParameterEntry {
    /// Both bounds.
    pub fn range(&self) -> Range {
        Range { minimum: self.minimum, maximum: self.maximum }
    }
}

/// How many numbers a parameter has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterShape {
    /// One number.
    Number,
    /// A list of numbers, of a given length or of any length from one.
    List {
        /// The length, where the law fixes it.
        length: Option<usize>,
    },
    /// Three numbers, not all zero; not normalised here.
    Direction,
}

/// The value of a parameter, in SI units.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ParameterValue {
    /// One number.
    Number(f64),
    /// A list or a direction.
    List(Vec<f64>),
}

/// Checks the parameters of a law together: (name, value), in the law's order.
pub type LawCheck = fn(&[(&str, &ParameterValue)]) -> Result<(), LawRefusal>;

/// Checks a user law: its energy and its parameters (name, value), sorted by name.
pub type UserLawCheck = fn(&str, &[(&str, &ParameterValue)]) -> Result<(), LawRefusal>;

/// Why a law refuses its parameters or its energy.
#[derive(Clone, Debug, PartialEq)]
pub struct LawRefusal {
    /// The parameter at fault; `None` for the energy of a user law, or the law as a whole.
    pub parameter: Option<String>,
    /// What is wrong, what was expected and what to do.
    pub message: String,
}
