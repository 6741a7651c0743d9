//! What a bar is made of, what can be wrong with that, and what the generator tells about it.

use super::pattern::MismatchKind;
use souple_elements::{Element, Family};

/// A bar along x, from `origin` to `origin + size`.
///
/// Its dimension is that of the sections' elements: in 2D the bar lies in the plane z = `origin[2]` and `size[2]`,
/// `cells[2]` are not looked at; in 1D the same holds for y.
#[derive(Clone, Debug)]
pub struct BarSpec {
    /// Lengths in metres, `[axis]`. Positive.
    pub size: [f64; 3],
    /// Number of cells, `[axis]`. At least 1.
    pub cells: [usize; 3],
    /// Lower corner in metres, `[axis]`.
    pub origin: [f64; 3],
    /// The sections in order of x.
    pub sections: Vec<Section>,
    /// What to do where the faces of two sections do not meet.
    pub transition: Transition,
}

/// A part of the bar's length filled with elements of one kind.
#[derive(Clone, Copy, Debug)]
pub struct Section {
    /// Where it ends, as a fraction of the length; it begins where the previous one ends. Rounded to the nearest plane
    /// between cells. The last one is 1.
    pub until: f64,
    /// What fills it.
    pub element: &'static Element,
    /// How cells become such elements.
    pub split: Split,
}

/// A coordinate axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Axis {
    /// The first.
    X,
    /// The second.
    Y,
    /// The third.
    Z,
}

/// How a cell is subdivided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Split {
    /// The usual one of the family: `Whole`, `Tetrahedra6`, `Prisms(Axis::X)`, `Pyramids`, `TrianglesForward`.
    #[default]
    Usual,
    /// One element: hexahedron, quadrangle, edge.
    Whole,
    /// Six tetrahedra around the diagonal (0,0,0)–(1,1,1) of every cell (Kuhn's subdivision).
    Tetrahedra6,
    /// Kuhn's subdivision mirrored from cell to cell: no preferred direction, diagonals of faces alternate.
    Tetrahedra6Mirrored,
    /// Five tetrahedra: a central one and four corners; alternates from cell to cell so that diagonals meet.
    Tetrahedra5,
    /// Two prisms whose triangles are normal to this axis.
    Prisms(Axis),
    /// Six pyramids with the faces of the cell as bases and its centre as apex.
    Pyramids,
    /// Two triangles on the diagonal (0,0)–(1,1).
    TrianglesForward,
    /// Two triangles on the diagonal (1,0)–(0,1).
    TrianglesBackward,
    /// Two triangles, the diagonal alternating from cell to cell, forward in the first.
    TrianglesAlternating,
}

impl Split {
    /// The subdivision meant by [`Split::Usual`] for a family; any other is returned as it is.
    pub fn resolved(self, family: Family) -> Split {
        match (self, family) {
            (Split::Usual, Family::Edge | Family::Quadrangle | Family::Hexahedron) => Split::Whole,
            (Split::Usual, Family::Triangle) => Split::TrianglesForward,
            (Split::Usual, Family::Tetrahedron) => Split::Tetrahedra6,
            (Split::Usual, Family::Prism) => Split::Prisms(Axis::X),
            (Split::Usual, Family::Pyramid) => Split::Pyramids,
            (split, _) => split,
        }
    }

    fn fits(self, family: Family) -> bool {
        match self {
            Split::Usual => true,
            Split::Whole => matches!(family, Family::Edge | Family::Quadrangle | Family::Hexahedron),
            Split::Tetrahedra5 | Split::Tetrahedra6 | Split::Tetrahedra6Mirrored => family == Family::Tetrahedron,
            Split::Prisms(_) => family == Family::Prism,
            Split::Pyramids => family == Family::Pyramid,
            Split::TrianglesForward | Split::TrianglesBackward | Split::TrianglesAlternating => {
                family == Family::Triangle
            }
        }
    }
}

/// What to do where the faces of two sections do not meet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Transition {
    /// Leave the faces as they are and count them in the report.
    #[default]
    Keep,
    /// Replace the last layer of cells on the side with the quadrangles by cells subdivided about their centre:
    /// pyramids on quadrangles, two tetrahedra on a face that follows the neighbour's diagonal.
    InsertPyramids,
}

/// Faces of two sections that do not meet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mismatch {
    /// The two sections, in order of x.
    pub sections: [usize; 2],
    /// The ids of their elements.
    pub elements: [&'static str; 2],
    /// In what they differ.
    pub kind: MismatchKind,
    /// Number of faces of cells (of edges in 2D, of points in 1D) concerned.
    pub faces: usize,
}

/// What the generator did.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BarReport {
    /// Interfaces that do not conform; empty when the mesh is conforming.
    pub mismatches: Vec<Mismatch>,
    /// Number of layers of cells along x in each section.
    pub section_cells: Vec<usize>,
    /// Number of cells replaced by transition cells.
    pub transition_cells: usize,
}

impl BarReport {
    /// Faces of cells that do not meet, over all interfaces.
    pub fn mismatched_faces(&self) -> usize {
        self.mismatches.iter().map(|m| m.faces).sum()
    }

    /// One sentence for each interface that does not conform, for a person to read.
    pub fn warnings(&self) -> Vec<String> {
        self.mismatches
            .iter()
            .map(|m| {
                let ([a, b], [from, to]) = (m.sections, m.elements);
                let place = format!("section_{a} ({from}) and section_{b} ({to}): on {} faces", m.faces);
                let (what, cure) = match m.kind {
                    MismatchKind::QuadrangleAgainstTriangles => {
                        ("a quadrangle meets two triangles", "insert a transition layer of pyramids")
                    }
                    MismatchKind::CrossedDiagonals => {
                        ("two triangles meet two triangles on the other diagonal", "choose the same subdivision in both or insert a transition layer of pyramids")
                    }
                    MismatchKind::DifferentInterpolation => {
                        return format!(
                            "{place} the two sides interpolate differently; a scene makes the richer side follow the other, \
                             others may not"
                        );
                    }
                };
                format!("{place} {what}, so displacements are not continuous there; {cure}")
            })
            .collect()
    }
}

/// A bar that cannot be generated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BarError {
    /// No section.
    #[error("the bar has no section; give at least one, ending at 1")]
    NoSection,
    /// A length that is not a positive number.
    #[error("size[{axis}] = {value}: expected a positive length in metres")]
    Size {
        /// Index into `size`.
        axis: usize,
        /// What was given.
        value: f64,
    },
    /// A coordinate that is not a number.
    #[error("origin[{axis}] = {value}: expected a finite coordinate in metres")]
    Origin {
        /// Index into `origin`.
        axis: usize,
        /// What was given.
        value: f64,
    },
    /// A number of cells of 0.
    #[error("cells[{axis}] = 0: expected at least 1")]
    Cells {
        /// Index into `cells`.
        axis: usize,
    },
    /// More nodes than 32-bit indices can name.
    #[error("{cells:?} cells need more than {} nodes; use fewer cells", u32::MAX / 2)]
    TooMany {
        /// What was given.
        cells: [usize; 3],
    },
    /// Fractions that do not increase.
    #[error("section {section} ends at {until}: expected a fraction above {previous}, where it begins, and at most 1")]
    Until {
        /// Index of the section.
        section: usize,
        /// What was given.
        until: f64,
        /// Where the section begins.
        previous: f64,
    },
    /// The last section does not reach the end.
    #[error("the last section ends at {until}: expected 1, or add a section for the rest of the bar")]
    Unfilled {
        /// What was given.
        until: f64,
    },
    /// A section between the same two planes.
    #[error(
        "section {section} ({element}), from {from} to {until} of the length, gets none of the {cells} cells along x; use more cells or a longer section"
    )]
    EmptySection {
        /// Index of the section.
        section: usize,
        /// Its element.
        element: &'static str,
        /// Where it begins.
        from: f64,
        /// Where it ends.
        until: f64,
        /// Number of cells along x.
        cells: usize,
    },
    /// Elements of several dimensions.
    #[error(
        "section {section} has elements of dimension {dimension} ({element}), section 0 of dimension {first}: a bar has one dimension"
    )]
    MixedDimensions {
        /// Index of the section.
        section: usize,
        /// Its element.
        element: &'static str,
        /// Dimension of its element.
        dimension: usize,
        /// Dimension of the first section.
        first: usize,
    },
    /// A subdivision that gives other shapes.
    #[error("section {section}: the subdivision {split:?} does not give elements of the family {family} ({element})")]
    Split {
        /// Index of the section.
        section: usize,
        /// What was given.
        split: Split,
        /// Its element.
        element: &'static str,
        /// The element's family.
        family: &'static str,
    },
    /// A transition was asked for between sections whose faces carry different nodes.
    #[error(
        "section_{} ({}) and section_{} ({}) interpolate their common faces differently, which no layer of cells joins; give both sections elements of the same degree, or keep the mismatch",
        .sections[0], .elements[0], .sections[1], .elements[1]
    )]
    DifferentInterpolation {
        /// The two sections.
        sections: [usize; 2],
        /// Their elements.
        elements: [&'static str; 2],
    },
    /// The element registry has nothing that fits between two sections.
    #[error(
        "no {family} has the faces {faces} that a transition between section_{} ({}) and section_{} ({}) needs; give both sections elements of the same degree, or keep the mismatch",
        .sections[0], .elements[0], .sections[1], .elements[1]
    )]
    NoTransition {
        /// The two sections.
        sections: [usize; 2],
        /// Their elements.
        elements: [&'static str; 2],
        /// The family that was looked for.
        family: &'static str,
        /// The faces that it should have.
        faces: String,
    },
}

/// The checked grid: what the specification says once fractions are planes.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    pub dimension: usize,
    /// Number of cells, `[axis]`; 1 along the axes that the dimension lacks.
    pub cells: [usize; 3],
    /// Plane of x where each section begins, and the last plane, `[section + 1]`.
    pub planes: Vec<usize>,
}

impl Layout {
    /// Number of grid points, `[axis]`.
    pub(super) fn points(&self) -> [usize; 3] {
        std::array::from_fn(|a| if a < self.dimension { self.cells[a] + 1 } else { 1 })
    }
}

pub(super) fn layout(spec: &BarSpec) -> Result<Layout, BarError> {
    let first = spec.sections.first().ok_or(BarError::NoSection)?.element.dimension();
    for (s, section) in spec.sections.iter().enumerate() {
        let element = section.element;
        if element.dimension() != first {
            let dimension = element.dimension();
            return Err(BarError::MixedDimensions { section: s, element: element.id, dimension, first });
        }
        if !section.split.fits(element.family) {
            let (split, family) = (section.split, element.family.name());
            return Err(BarError::Split { section: s, split, element: element.id, family });
        }
    }
    for axis in 0..3 {
        if !spec.origin[axis].is_finite() {
            return Err(BarError::Origin { axis, value: spec.origin[axis] });
        }
        if axis < first && !(spec.size[axis].is_finite() && spec.size[axis] > 0.0) {
            return Err(BarError::Size { axis, value: spec.size[axis] });
        }
        if axis < first && spec.cells[axis] == 0 {
            return Err(BarError::Cells { axis });
        }
    }
    let cells = std::array::from_fn(|a| if a < first { spec.cells[a] } else { 1 });
    // Grid points and a centre per cell: at most twice the grid; half the range leaves room for mid-side nodes.
    let points = cells.iter().try_fold(2usize, |n, &c| n.checked_mul(c.checked_add(1)?));
    if points.is_none_or(|n| n > (u32::MAX / 2) as usize) {
        return Err(BarError::TooMany { cells: spec.cells });
    }

    let mut planes = vec![0];
    let mut previous = 0.0;
    for (s, section) in spec.sections.iter().enumerate() {
        let until = section.until;
        if !(until > previous && until <= 1.0 + 1e-9) {
            return Err(BarError::Until { section: s, until, previous });
        }
        let last = s + 1 == spec.sections.len();
        if last && until < 1.0 - 1e-9 {
            return Err(BarError::Unfilled { until });
        }
        let plane = (until.min(1.0) * cells[0] as f64).round() as usize;
        if plane == planes[s] {
            let (element, from, cells) = (section.element.id, previous, cells[0]);
            return Err(BarError::EmptySection { section: s, element, from, until, cells });
        }
        planes.push(plane);
        previous = until;
    }
    Ok(Layout { dimension: first, cells, planes })
}
