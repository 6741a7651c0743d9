//! Averages of stress and strain over an element, as numbers.

/// What can be averaged over an element; [`souple_forms::averages()`] says how.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Average {
    /// Cauchy stress in Pa over the deformed volume; of small-strain laws, their stress over the volume at rest.
    Stress,
    /// Green–Lagrange strain over the volume at rest.
    Strain,
}

impl Average {
    /// Name of the program that computes it, and of that program's output.
    pub(crate) fn program(self) -> &'static str {
        match self {
            Average::Stress => "stress",
            Average::Strain => "strain",
        }
    }
}

/// A mean over an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mean {
    /// Entries xx, yy, zz, xy, yz, zx of a symmetric tensor; strains are those of the tensor, not engineering shears.
    pub tensor: [f64; 6],
    /// The volume in m³ that it is the mean of: the weight of this element in a mean over several.
    pub volume: f64,
}

impl Mean {
    /// Numbers that a program gives for it: the tensor, the volume.
    pub(crate) const ROWS: usize = 7;
}
