//! From the element types of the formats to the elements of the registry, and back.
//!
//! The registry says what each element is called elsewhere; only what it does not have stands here: complete
//! second-order elements that are read as the element without their face and centre nodes. In every format the nodes
//! to drop come last.

use souple_elements::{Element, Family, all};

/// How an element type of a file becomes an element.
#[derive(Clone, Debug)]
pub(super) struct Kind {
    pub(super) element: &'static Element,
    /// Nodes that the file lists; those after the element's own are dropped.
    pub(super) listed: usize,
    /// `ours[i] = theirs[order[i]]`.
    pub(super) order: Option<Vec<usize>>,
    /// What the file calls it, when nodes are dropped.
    pub(super) reduced_from: Option<&'static str>,
}

impl Kind {
    fn plain(element: &'static Element) -> Self {
        Kind { element, listed: element.node_count(), order: None, reduced_from: None }
    }

    fn reduced(self, from: &'static str, listed: usize) -> Self {
        Kind { listed, reduced_from: Some(from), ..self }
    }
}

/// The registry's element of this Gmsh number.
fn gmsh_own(number: u32) -> Option<Kind> {
    let element = all().iter().copied().find(|e| e.exchange.gmsh == number)?;
    let order = element.exchange.gmsh_order.map(|p| p.iter().map(|&i| i as usize).collect());
    Some(Kind { order, ..Kind::plain(element) })
}

/// A complete element that the registry may lack.
struct Complete {
    number: u32,
    nodes: usize,
    name: &'static str,
    /// Number of the element that remains without the last nodes.
    without: u32,
}

const GMSH_COMPLETE: [Complete; 4] = [
    Complete { number: 10, nodes: 9, name: "quad9", without: 16 },
    Complete { number: 12, nodes: 27, name: "hex27", without: 17 },
    Complete { number: 13, nodes: 18, name: "prism18", without: 18 },
    Complete { number: 14, nodes: 14, name: "pyramid14", without: 19 },
];

/// The element of a Gmsh type number, if there is one.
pub(super) fn gmsh_kind(number: i64) -> Option<Kind> {
    let number = u32::try_from(number).ok()?;
    gmsh_own(number).or_else(|| {
        let complete = GMSH_COMPLETE.iter().find(|c| c.number == number)?;
        Some(gmsh_own(complete.without)?.reduced(complete.name, complete.nodes))
    })
}

/// Number of nodes of the Gmsh types that are not ours, to step over them: (first number, nodes of it and the next).
const GMSH_NODE_COUNTS: [(i64, &[usize]); 5] = [
    (8, &[3, 6, 9, 10, 27, 18, 14, 1, 8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5, 6, 20, 35, 56, 22, 28]),
    (36, &[16, 25, 36, 12, 16, 20, 28, 36, 45, 55, 66, 49, 64, 81, 100, 121, 18, 21, 24, 27, 30, 24, 28, 32, 36, 40]),
    (62, &[7, 8, 9, 10, 11]),
    (71, &[84, 120, 165, 220, 286]),
    // Prisms and pyramids of high degree fill gaps between the hexahedra.
    (
        79,
        &[
            34, 40, 46, 52, 58, 1, 1, 1, 1, 1, 1, 40, 75, 64, 125, 216, 343, 512, 729, 1000, 32, 44, 56, 68, 80, 92,
            104, 126, 196, 288, 405, 550, 24, 33, 42, 51, 60, 69, 78, 30, 55, 91, 140, 204, 285, 385, 21, 29, 37, 45,
            53, 61, 69,
        ],
    ),
];

/// Number of nodes of any fixed-size Gmsh type; `None` when Gmsh defines no such type.
pub(super) fn gmsh_node_count(number: i64) -> Option<usize> {
    if let Some(kind) = gmsh_kind(number) {
        return Some(kind.listed);
    }
    GMSH_NODE_COUNTS
        .iter()
        .find_map(|(first, counts)| counts.get(usize::try_from(number.checked_sub(*first)?).ok()?).copied())
}

/// What a VTK cell is to us.
pub(super) enum VtkCell {
    Element(Kind),
    /// Consecutive pairs are edges.
    Polyline,
    /// Consecutive triples are triangles, every second one turned.
    TriangleStrip,
    /// Known to VTK, not an element here: why.
    NotOurs(&'static str),
    /// The type has another number of nodes.
    WrongCount(usize),
    /// Not a VTK type.
    Unknown,
}

const VTK_COMPLETE: [Complete; 6] = [
    Complete { number: 28, nodes: 9, name: "quad9", without: 23 },
    Complete { number: 29, nodes: 27, name: "hex27", without: 25 },
    Complete { number: 32, nodes: 18, name: "prism18", without: 26 },
    Complete { number: 33, nodes: 24, name: "hex24", without: 25 },
    Complete { number: 34, nodes: 7, name: "tri7", without: 22 },
    Complete { number: 37, nodes: 19, name: "pyramid19", without: 27 },
];

/// The first Lagrange type; one per family follows, in the order of [`Family::ALL`].
const VTK_FIRST_LAGRANGE: u32 = 68;
/// Highest type number that VTK defines.
const VTK_LAST: u32 = 81;

/// What to do with a VTK cell of this type and number of nodes.
pub(super) fn vtk_cell(cell_type: i64, nodes: usize) -> VtkCell {
    let Some(number) = u32::try_from(cell_type).ok().filter(|&n| n <= VTK_LAST) else {
        return VtkCell::Unknown;
    };
    let same_type = || all().iter().copied().filter(move |e| u32::from(e.exchange.vtk) == number);
    if let Some(element) = same_type().find(|e| e.node_count() == nodes) {
        return VtkCell::Element(Kind::plain(element));
    }
    if let Some(at) = number.checked_sub(VTK_FIRST_LAGRANGE).filter(|&at| (at as usize) < Family::ALL.len()) {
        let family = Family::ALL[at as usize];
        if let Some(element) = all().iter().copied().find(|e| e.family == family && e.node_count() == nodes) {
            return VtkCell::Element(Kind::plain(element));
        }
        // A Lagrange wedge of 18 nodes starts like the quadratic wedge.
        let complete = VTK_COMPLETE.iter().find(|c| c.nodes == nodes && vtk_family(c.without) == Some(family));
        return match complete.and_then(|c| vtk_reduced(c, nodes)) {
            Some(kind) => VtkCell::Element(kind),
            None => VtkCell::NotOurs("no Lagrange element of this degree here; use a lower degree"),
        };
    }
    if let Some(element) = same_type().next() {
        return VtkCell::WrongCount(element.node_count());
    }
    if let Some(complete) = VTK_COMPLETE.iter().find(|c| c.number == number) {
        return match vtk_reduced(complete, nodes) {
            Some(kind) => VtkCell::Element(kind),
            None => VtkCell::WrongCount(complete.nodes),
        };
    }
    let (quadrangle, hexahedron) = (linear(Family::Quadrangle), linear(Family::Hexahedron));
    match (number, nodes) {
        (1 | 2, _) => VtkCell::NotOurs("a vertex is a node, not an element"),
        (4, 2..) => VtkCell::Polyline,
        (6, 3..) => VtkCell::TriangleStrip,
        (7, 3) => VtkCell::Element(Kind::plain(linear(Family::Triangle))),
        (7, 4) => VtkCell::Element(Kind::plain(quadrangle)),
        (7, 5..) => VtkCell::NotOurs("no polygon of more than four sides here; triangulate it"),
        (35, 4) => match all().iter().copied().find(|e| e.family == Family::Edge && e.node_count() == 4) {
            Some(cubic) => VtkCell::Element(Kind::plain(cubic)),
            None => VtkCell::NotOurs("no such element here"),
        },
        // Pixels and voxels count along the axes instead of around.
        (8, 4) => VtkCell::Element(Kind { order: Some(vec![0, 1, 3, 2]), ..Kind::plain(quadrangle) }),
        (11, 8) => VtkCell::Element(Kind { order: Some(vec![0, 1, 3, 2, 4, 5, 7, 6]), ..Kind::plain(hexahedron) }),
        (8, _) => VtkCell::WrongCount(4),
        (11, _) => VtkCell::WrongCount(8),
        (0, _) => VtkCell::NotOurs("it is an empty cell"),
        (41 | 42, _) => VtkCell::NotOurs("no polyhedron here; split it into tetrahedra"),
        _ => VtkCell::NotOurs("no such element here"),
    }
}

fn vtk_family(number: u32) -> Option<Family> {
    all().iter().find(|e| u32::from(e.exchange.vtk) == number).map(|e| e.family)
}

fn vtk_reduced(complete: &Complete, nodes: usize) -> Option<Kind> {
    let element = all().iter().copied().find(|e| u32::from(e.exchange.vtk) == complete.without)?;
    (nodes == complete.nodes).then(|| Kind::plain(element).reduced(complete.name, nodes))
}

/// The element of a family with corner nodes only.
pub(super) fn linear(family: Family) -> &'static Element {
    all()
        .iter()
        .copied()
        .find(|e| e.family == family && e.node_count() == family.corner_count())
        .expect("the registry holds the linear element of every family")
}

/// The element of an Abaqus TYPE, whatever its suffix for reduced integration, hybrid formulation and the like.
pub(super) fn abaqus_kind(name: &str) -> Option<Kind> {
    let name = name.to_ascii_uppercase();
    let fits = |known: &str| {
        // What follows the name must not be a digit: C3D20 is not a C3D2.
        name.strip_prefix(known).is_some_and(|rest| !rest.starts_with(|c: char| c.is_ascii_digit()))
    };
    let mut candidates = all().iter().copied().flat_map(|e| e.exchange.abaqus.iter().map(move |n| (e, *n)));
    Some(Kind::plain(candidates.find(|(_, known)| fits(known))?.0))
}

const MEDIT_COMPLETE: [(&str, usize, &str, u32); 2] =
    [("PrismsP2", 18, "prism18", 26), ("PyramidsP2", 14, "pyramid14", 27)];

/// Keywords that other programs write for the same thing.
const MEDIT_ALIASES: [(&str, &str); 4] =
    [("Wedges", "Prisms"), ("Pentahedra", "Prisms"), ("Hexaedra", "Hexahedra"), ("Quadrangles", "Quadrilaterals")];

/// The element of a MEDIT keyword.
pub(super) fn medit_kind(keyword: &str) -> Option<Kind> {
    let keyword = MEDIT_ALIASES.iter().find(|(alias, _)| *alias == keyword).map_or(keyword, |(_, name)| *name);
    if let Some(element) = all().iter().copied().find(|e| e.exchange.medit == Some(keyword)) {
        return Some(Kind::plain(element));
    }
    let &(_, nodes, name, without) = MEDIT_COMPLETE.iter().find(|(k, ..)| *k == keyword)?;
    let element = all().iter().copied().find(|e| u32::from(e.exchange.vtk) == without)?;
    Some(Kind::plain(element).reduced(name, nodes))
}

/// The element that remains of a complete one without face and centre nodes, when the registry has it.
pub(super) fn serendipity(element: &'static Element) -> Option<&'static Element> {
    all().iter().copied().find(|e| {
        e.family == element.family
            && e.degree == element.degree
            && e.node_count() < element.node_count()
            && e.nodes.iter().zip(element.nodes).all(|(a, b)| a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-9))
    })
}
