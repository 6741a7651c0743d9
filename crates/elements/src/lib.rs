//! What a finite element is, and each one.
//!
//! An element is one file in `src/elements/`: its reference geometry, nodes, shape functions (as expressions, never
//! their derivatives), faces, edges, quadratures, and its names in the mesh formats.
//! A quadrature rule is one file in `rules/`.
//! Both folders are scanned by `build.rs`; there is no list to keep.
//!
//! Node order is VTK's everywhere inside Souple; readers and writers permute (see [`Exchange`]).
//! Reference coordinates: simplices on the unit simplex; edges, quadrangles and hexahedra on [−1, 1]^d; prism = unit
//! triangle × [−1, 1]; pyramid with base [−1, 1]² at ζ = 0 and apex at ζ = 1.

mod rule;

pub use rule::{Rule, rules};
use souple_symbols::{Expr, Graph};

include!(concat!(env!("OUT_DIR"), "/scanned.rs"));

/// The shape of a reference cell, whatever the degree of interpolation on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Family {
    /// [−1, 1].
    Edge,
    /// The unit triangle.
    Triangle,
    /// [−1, 1]².
    Quadrangle,
    /// The unit tetrahedron.
    Tetrahedron,
    /// [−1, 1]³.
    Hexahedron,
    /// Unit triangle × [−1, 1] (a wedge).
    Prism,
    /// Base [−1, 1]² at ζ = 0, apex at ζ = 1.
    Pyramid,
}

impl Family {
    /// Every family, in order of dimension.
    pub const ALL: [Family; 7] = [
        Family::Edge,
        Family::Triangle,
        Family::Quadrangle,
        Family::Tetrahedron,
        Family::Hexahedron,
        Family::Prism,
        Family::Pyramid,
    ];

    /// Number of reference coordinates.
    pub fn dimension(self) -> usize {
        match self {
            Family::Edge => 1,
            Family::Triangle | Family::Quadrangle => 2,
            Family::Tetrahedron | Family::Hexahedron | Family::Prism | Family::Pyramid => 3,
        }
    }

    /// Number of corners; corner nodes come first in every element of the family.
    pub fn corner_count(self) -> usize {
        match self {
            Family::Edge => 2,
            Family::Triangle => 3,
            Family::Quadrangle | Family::Tetrahedron => 4,
            Family::Hexahedron => 8,
            Family::Prism => 6,
            Family::Pyramid => 5,
        }
    }

    /// The name used in commands, rule files and messages.
    pub fn name(self) -> &'static str {
        match self {
            Family::Edge => "edge",
            Family::Triangle => "triangle",
            Family::Quadrangle => "quadrangle",
            Family::Tetrahedron => "tetrahedron",
            Family::Hexahedron => "hexahedron",
            Family::Prism => "prism",
            Family::Pyramid => "pyramid",
        }
    }

    /// Length, area or volume of the reference cell.
    pub fn reference_measure(self) -> f64 {
        match self {
            Family::Edge => 2.0,
            Family::Triangle => 0.5,
            Family::Quadrangle => 4.0,
            Family::Tetrahedron => 1.0 / 6.0,
            Family::Hexahedron => 8.0,
            Family::Prism => 1.0,
            Family::Pyramid => 4.0 / 3.0,
        }
    }
}

/// A face or an edge of an element: a lower element on some of its nodes.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// Id of the lower element (`"tri3"`, `"quad4"`, `"edge2"`, …).
    pub element: &'static str,
    /// Local nodes of the parent, in the lower element's own node order; for a face of a solid the corners turn
    /// counter-clockwise seen from outside.
    pub nodes: &'static [u8],
}

/// What an element is called elsewhere.
///
/// A permutation is `None` where the format's node order is VTK's.
#[derive(Clone, Copy, Debug)]
pub struct Exchange {
    /// VTK cell type number; cubic elements use the Lagrange cells, which are told apart by their number of nodes.
    pub vtk: u8,
    /// Gmsh element type number.
    pub gmsh: u32,
    /// `ours[i] = gmsh[p[i]]`.
    pub gmsh_order: Option<&'static [u8]>,
    /// Abaqus / CalculiX element names with our node order, without the suffixes for reduced or hybrid variants; empty
    /// where there is no such element or it has another order.
    pub abaqus: &'static [&'static str],
    /// MEDIT keyword, where the format has the element with our node order.
    pub medit: Option<&'static str>,
}

/// A finite element: geometry, interpolation, quadratures and names.
#[derive(Clone, Copy, Debug)]
pub struct Element {
    /// The id used everywhere: scenes, commands, files (`"hex8"`).
    pub id: &'static str,
    /// Shape of the reference cell.
    pub family: Family,
    /// Degree of the complete polynomials that the interpolation contains.
    pub degree: u32,
    /// Reference coordinates of the nodes, [node, axis]; unused axes are 0.
    pub nodes: &'static [[f64; 3]],
    /// Shape functions at the reference point (ξ, η, ζ), one expression per node.
    pub shape: fn(&mut Graph, [Expr; 3]) -> Vec<Expr>,
    /// Sides of dimension one less: faces of a solid, edges of a surface element, ends of an edge (none listed).
    pub faces: &'static [Side],
    /// Edges; none listed for an edge itself.
    pub edges: &'static [Side],
    /// Quadrature rules by file name; the first one is the default: the cheapest that passes the patch test on a distorted
    /// mesh and leaves no deformation without energy. The consistent mass may need another one of the list.
    pub quadratures: &'static [&'static str],
    /// Names in mesh formats.
    pub exchange: Exchange,
}

impl Element {
    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// Number of reference coordinates.
    pub fn dimension(&self) -> usize {
        self.family.dimension()
    }

    /// The rule used when a scene names none.
    pub fn default_rule(&self) -> &'static Rule {
        Rule::by_id(self.quadratures[0]).expect("a test checks that every listed rule exists")
    }

    /// A rule of this element by its id (`"hexahedron-8"`) or by its number of points (`"8"`).
    pub fn rule(&self, name: &str) -> Option<&'static Rule> {
        self.quadratures
            .iter()
            .filter_map(|id| Rule::by_id(id))
            .find(|r| r.id == name || r.points.len().to_string() == name)
    }
}

/// Every element, in order of dimension, then family, then number of nodes.
pub fn all() -> &'static [&'static Element] {
    static SORTED: std::sync::LazyLock<Vec<&'static Element>> = std::sync::LazyLock::new(|| {
        let mut sorted = ALL.to_vec();
        sorted.sort_by_key(|e| (e.dimension(), e.family, e.node_count()));
        sorted
    });
    &SORTED
}

/// The element with this id.
pub fn by_id(id: &str) -> Option<&'static Element> {
    ALL.iter().copied().find(|e| e.id == id)
}
