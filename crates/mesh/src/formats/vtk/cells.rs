//! VTK cells into elements: what both VTK formats share.

use super::LAGRANGE_HEXAHEDRON;
use crate::ElementId;
use crate::formats::draft::Draft;
use crate::formats::error::{FormatError, Place};
use crate::formats::kinds::{Kind, VtkCell, linear, vtk_cell};
use souple_elements::Family;

/// Cells as VTK stores them.
pub(super) struct Cells {
    /// Type of each cell.
    pub(super) types: Vec<i64>,
    /// Where each cell ends in `connectivity`.
    pub(super) ends: Vec<i64>,
    /// Points of all cells, one after the other.
    pub(super) connectivity: Vec<i64>,
    /// Lagrange hexahedra of files before version 2.2 (legacy: 5.1) exchange the last two vertical edges.
    pub(super) old_lagrange: bool,
}

/// Which elements each cell became: none, one, or several.
#[derive(Default)]
pub(super) struct CellMap {
    elements: Vec<ElementId>,
    ends: Vec<usize>,
}

impl CellMap {
    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    pub(super) fn elements(&self, cell: usize) -> &[ElementId] {
        let start = cell.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.elements[start..self.ends[cell]]
    }
}

/// Adds cells whose points are numbered from `first` in the draft, which holds `count` of them.
pub(super) fn add(
    draft: &mut Draft,
    map: &mut CellMap,
    cells: &Cells,
    (first, count): (usize, usize),
    place: &dyn Fn() -> Place,
) -> Result<(), FormatError> {
    let mut start = 0;
    let mut nodes: Vec<u32> = Vec::new();
    // Cells of one kind follow each other, so the last answer is nearly always the next one.
    let mut known: Option<(i64, usize, VtkCell)> = None;
    for (cell, (&cell_type, &end)) in cells.types.iter().zip(&cells.ends).enumerate() {
        let end = usize::try_from(end).ok().filter(|&e| e >= start && e <= cells.connectivity.len());
        let Some(end) = end else {
            return Err(FormatError::Count {
                place: place(),
                what: format!("as the end of cell {cell} among the points of all cells"),
                said: cells.ends[cell] as u64,
                found: format!("the cell starts at {start} and there are {}", cells.connectivity.len()),
            });
        };
        let points = &cells.connectivity[start..end];
        start = end;
        nodes.clear();
        for &point in points {
            let node = usize::try_from(point).ok().filter(|&p| p < count).ok_or_else(|| FormatError::OutOfRange {
                place: place(),
                who: format!("cell {cell} (VTK type {cell_type})"),
                what: format!("point {point}"),
                defined: format!("{count} points, counted from 0"),
            })?;
            nodes.push((first + node) as u32);
        }
        if !known.as_ref().is_some_and(|(t, n, _)| *t == cell_type && *n == nodes.len()) {
            let mut found = vtk_cell(cell_type, nodes.len());
            if let VtkCell::Element(kind) = &mut found
                && cells.old_lagrange
                && cell_type == i64::from(LAGRANGE_HEXAHEDRON)
                && nodes.len() > 19
            {
                let mut order: Vec<usize> = (0..kind.element.node_count()).collect();
                order.swap(18, 19);
                kind.order = Some(order);
            }
            known = Some((cell_type, nodes.len(), found));
        }
        let (_, _, found) = known.as_ref().expect("it was just set");
        add_one(draft, map, found, &nodes, cell, cell_type, place)?;
        map.ends.push(map.elements.len());
    }
    Ok(())
}

fn add_one(
    draft: &mut Draft,
    map: &mut CellMap,
    found: &VtkCell,
    nodes: &[u32],
    cell: usize,
    cell_type: i64,
    place: &dyn Fn() -> Place,
) -> Result<(), FormatError> {
    let mut pieces = |what: &str, family: Family, parts: &mut dyn Iterator<Item = Vec<u32>>| {
        let kind = Kind { element: linear(family), listed: family.corner_count(), order: None, reduced_from: None };
        for part in parts {
            map.elements.push(draft.element(&kind, &part));
        }
        *draft.report.split.entry(what.to_owned()).or_default() += 1;
    };
    match found {
        VtkCell::Element(kind) => map.elements.push(draft.element(kind, nodes)),
        VtkCell::Polyline => {
            pieces("polylines into edges", Family::Edge, &mut nodes.windows(2).map(<[u32]>::to_vec));
        }
        VtkCell::TriangleStrip => {
            let turned = |(at, t): (usize, &[u32])| if at % 2 == 0 { t.to_vec() } else { vec![t[1], t[0], t[2]] };
            let mut parts = nodes.windows(3).enumerate().map(turned);
            pieces("triangle strips into triangles", Family::Triangle, &mut parts);
        }
        VtkCell::NotOurs(why) => {
            draft.report.skip(&format!("VTK type {cell_type} ({} nodes)", nodes.len()), 1, why);
        }
        VtkCell::WrongCount(expected) => {
            return Err(FormatError::Count {
                place: place(),
                what: format!("nodes (as VTK type {cell_type}) for cell {cell}"),
                said: *expected as u64,
                found: format!("{} follow", nodes.len()),
            });
        }
        VtkCell::Unknown => {
            return Err(FormatError::UnknownElement {
                place: place(),
                format: "VTK",
                element: cell_type.to_string(),
                advice: format!("cell {cell} is damaged, or its writer newer than this reader; save the file again"),
            });
        }
    }
    Ok(())
}
