//! What is stepped: masses, forces, rows that are held or moved, and batches of items with their programs.
//!
//! ```text
//! M ü = Σ contributions(u) + constant + Σ factor(t) load − (α M + β K) v,     K v = −Σ products(u, v)
//! ```
//!
//! Unknowns are [row, axis]. Numbers are doubles here and become singles on the device.

use souple_program::Program;

/// A system as the host describes it.
#[derive(Clone, Debug, Default)]
pub struct Model<'a> {
    /// Unknowns per row, at most 3.
    pub axes: usize,
    /// Mass per unknown.
    pub mass: Vec<f64>,
    /// Force per unknown that does not change.
    pub constant: Vec<f64>,
    /// Loads with a factor that changes: unknowns, each once, and their forces at the factor one.
    pub loads: Vec<Vec<(u32, f64)>>,
    /// Unknowns that nothing moves, or that the caller moves.
    pub held: Vec<bool>,
    /// Of these, those that the caller moves.
    pub moved: Vec<u32>,
    /// The items.
    pub batches: Vec<Batch<'a>>,
    /// What the solver divides by.
    pub preconditioner: Preconditioner,
    /// An unknown further than this from zero is a divergence.
    pub reach: f64,
}

/// What approximates the inverse of the matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preconditioner {
    /// Nothing.
    #[default]
    None,
    /// The inverse of its diagonal.
    Diagonal,
    /// The inverses of its diagonal blocks, one per row.
    Blocks,
}

/// Items with the same programs and uniform inputs.
#[derive(Clone, Debug)]
pub struct Batch<'a> {
    /// Number of items.
    pub items: usize,
    /// Rows that an item reads and contributes to.
    pub places: usize,
    /// Their numbers, [item][place].
    pub rows: Vec<u32>,
    /// Contributions to forces, [place, axis], first output; further outputs are kept for the other programs.
    pub force: &'a Program,
    /// Contributions to −K v, first output.
    pub product: Option<&'a Program>,
    /// Contributions to the diagonal blocks of K, [place, axis, axis], first output.
    pub diagonal: Option<&'a Program>,
    /// Numbers that must be positive in any state.
    pub check: Option<&'a Program>,
    /// Where input buffers come from, by name; one that is not named is what the force program kept under that name.
    pub inputs: Vec<(String, Source<'a>)>,
}

/// Where an input buffer of a program comes from.
#[derive(Clone, Debug)]
pub enum Source<'a> {
    /// Rows of u.
    State,
    /// Rows of v, or of whatever is multiplied.
    Direction,
    /// Rows of a vector that does not change, [row, axis].
    Rows(&'a [f64]),
    /// The same for all items.
    Uniform(Vec<f64>),
    /// Per item, in the lane order of [`souple_kernels::Input::Lanes`].
    Lanes(&'a [f64]),
}

impl Batch<'_> {
    /// The programs that it has.
    pub(super) fn programs(&self) -> impl Iterator<Item = &Program> {
        [Some(self.force), self.product, self.diagonal, self.check].into_iter().flatten()
    }

    /// Where an input comes from; `None` for what the force program keeps.
    pub(super) fn source(&self, name: &str) -> Option<&Source<'_>> {
        self.inputs.iter().find(|(n, _)| n == name).map(|(_, s)| s)
    }
}
