//! Bars: structured grids of cells, cut along their length into sections of one element kind each.
//!
//! ```text
//!   y                 cells[0] = 8
//!   ^  +---+---+---+---+---+---+---+---+
//!   |  | prism | prism | hex   | tet   |  cells[1]
//!   |  +---+---+---+---+---+---+---+---+
//!   +--> x      0.25    0.50    0.75    1.00   = until
//! ```
//!
//! Each cell (a box; a rectangle in 2D, a segment in 1D) is subdivided into elements of its section: one hexahedron,
//! two prisms, six pyramids, five or six tetrahedra; one quadrangle or two triangles; one edge.
//! `pattern` says which diagonals the faces of a cell show, `cell` subdivides one cell, this file walks the grid.
//!
//! Where two sections meet, faces may differ: a quadrangle against two triangles, two triangles against the other two,
//! or two degrees of interpolation. Diagonals are chosen so that they meet wherever the subdivisions leave a choice;
//! what remains is counted in the [`BarReport`], or removed by a layer of transition cells
//! ([`Transition::InsertPyramids`]).
//!
//! Nodes: the grid with x fastest, then y, then z; then cell centres; then nodes that are not corners (see `place`).
//! Regions: `x_min` … `z_max` (nodes), `section_0`, `section_1`, … (elements and their nodes), `transition`.

mod cell;
mod pattern;
mod spec;

pub use pattern::MismatchKind;
pub use spec::{Axis, BarError, BarReport, BarSpec, Mismatch, Section, Split, Transition};

use crate::mesh::{ElementId, Mesh, Region};
use crate::place::{CornerBlock, complete};
use cell::{Cell, Shape};
use souple_elements::{Element, Family};
use spec::Layout;

/// Generates the bar.
///
/// # Errors
/// [`BarError`] names the field of the specification that is wrong and what would be right.
pub fn generate(spec: &BarSpec) -> Result<(Mesh, BarReport), BarError> {
    let layout = spec::layout(spec)?;
    let patterns = pattern::resolve(spec, &layout);
    let mismatches = pattern::mismatches(spec, &layout, &patterns);
    let layers = match spec.transition {
        Transition::Keep => Vec::new(),
        Transition::InsertPyramids => pattern::transition_layers(spec, &layout, &patterns, &mismatches)?,
    };

    let mut grid = Grid::new(spec, &layout);
    let mut blocks = Blocks::default();
    let mut section_elements: Vec<Vec<(usize, usize)>> = vec![Vec::new(); spec.sections.len()];
    let mut transition_elements = Vec::new();
    let mut transition_cells = 0;
    let [_, ny, nz] = layout.cells;
    for (s, section) in spec.sections.iter().enumerate() {
        for k in 0..nz {
            for j in 0..ny {
                for i in layout.planes[s]..layout.planes[s + 1] {
                    let at = [i, j, k];
                    let layer = layers.iter().find(|l| l.section == s && l.plane == i);
                    let cell = match layer {
                        Some(layer) => Cell::Star(layer.faces(&patterns, at)),
                        None => patterns[s].cell(at),
                    };
                    let choose = |family: Family| match layer {
                        None => section.element,
                        Some(layer) => layer.element(family),
                    };
                    transition_cells += usize::from(layer.is_some());
                    for Shape { family, corners } in cell::subdivide(cell) {
                        let corners: Vec<u32> = corners.iter().map(|&c| grid.node(at, c)).collect();
                        let id = blocks.push(choose(family), &corners);
                        section_elements[s].push(id);
                        if layer.is_some() {
                            transition_elements.push(id);
                        }
                    }
                }
            }
        }
    }

    let mut nodes = grid.nodes;
    let blocks = complete(&mut nodes, blocks.0);
    let mut mesh = Mesh { nodes, blocks, regions: Default::default() };
    for (s, elements) in section_elements.into_iter().enumerate() {
        let region = element_region(&mesh, elements);
        mesh.regions.insert(format!("section_{s}"), region);
    }
    if !transition_elements.is_empty() {
        let region = element_region(&mesh, transition_elements);
        mesh.regions.insert("transition".to_owned(), region);
    }
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate().take(layout.dimension) {
        let (low, high) = (spec.origin[axis], spec.origin[axis] + spec.size[axis]);
        for (end, at) in [("min", low), ("max", high)] {
            mesh.regions.insert(format!("{name}_{end}"), plane_region(&mesh, axis, at, 1e-9 * spec.size[axis]));
        }
    }

    // What the transition layers joined is conforming now.
    let joined = matches!(spec.transition, Transition::InsertPyramids);
    let mismatches = if joined { Vec::new() } else { mismatches };
    let cells = (0..spec.sections.len()).map(|s| layout.planes[s + 1] - layout.planes[s]).collect();
    Ok((mesh, BarReport { mismatches, section_cells: cells, transition_cells }))
}

fn element_region(mesh: &Mesh, elements: Vec<(usize, usize)>) -> Region {
    let mut elements: Vec<ElementId> =
        elements.into_iter().map(|(block, index)| ElementId { block: block as u32, index: index as u32 }).collect();
    elements.sort_unstable();
    let nodes = crate::mesh::sorted_set(elements.iter().flat_map(|&id| mesh.nodes_of(id)).copied());
    Region { nodes, elements }
}

fn plane_region(mesh: &Mesh, axis: usize, at: f64, tolerance: f64) -> Region {
    let on = |n: &u32| (mesh.nodes[*n as usize][axis] - at).abs() <= tolerance;
    Region { nodes: (0..mesh.nodes.len() as u32).filter(on).collect(), elements: Vec::new() }
}

/// Elements by kind in order of first appearance.
#[derive(Default)]
struct Blocks(Vec<CornerBlock>);

impl Blocks {
    fn push(&mut self, element: &'static Element, corners: &[u32]) -> (usize, usize) {
        let at = self.0.iter().position(|b| b.element.id == element.id).unwrap_or_else(|| {
            self.0.push(CornerBlock { element, corners: Vec::new() });
            self.0.len() - 1
        });
        let block = &mut self.0[at];
        block.corners.extend_from_slice(corners);
        (at, block.corners.len() / corners.len() - 1)
    }
}

/// The nodes of the grid, and the cell centres made so far.
struct Grid<'a> {
    spec: &'a BarSpec,
    layout: &'a Layout,
    nodes: Vec<[f64; 3]>,
    /// The cell whose centre was made last, and that centre: cells are subdivided one after the other.
    centre: Option<([usize; 3], u32)>,
}

impl<'a> Grid<'a> {
    fn new(spec: &'a BarSpec, layout: &'a Layout) -> Self {
        let [nx, ny, nz] = layout.points();
        let mut grid = Grid { spec, layout, nodes: Vec::with_capacity(nx * ny * nz), centre: None };
        for k in 0..nz {
            for j in 0..ny {
                for i in 0..nx {
                    let position = grid.position([i as f64, j as f64, k as f64]);
                    grid.nodes.push(position);
                }
            }
        }
        grid
    }

    /// Position of a point given in cells: origin + size · (at / cells).
    fn position(&self, at: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|a| match a < self.layout.dimension {
            true => self.spec.origin[a] + self.spec.size[a] * (at[a] / self.layout.cells[a] as f64),
            false => self.spec.origin[a],
        })
    }

    /// Global node of a local corner (its bits are the x, y, z offsets) or of the centre of the cell.
    fn node(&mut self, cell: [usize; 3], corner: u8) -> u32 {
        if corner == cell::CENTRE {
            return match self.centre {
                Some((at, node)) if at == cell => node,
                _ => {
                    let position = self.position(cell.map(|c| c as f64 + 0.5));
                    self.nodes.push(position);
                    let node = (self.nodes.len() - 1) as u32;
                    self.centre = Some((cell, node));
                    node
                }
            };
        }
        let [nx, ny, _] = self.layout.points();
        let [i, j, k]: [usize; 3] = std::array::from_fn(|a| cell[a] + (corner as usize >> a & 1));
        (i + nx * (j + ny * k)) as u32
    }
}
