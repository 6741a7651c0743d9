//! One cell of the grid and its subdivision.
//!
//! Local corners are 3-bit numbers: bit a is the offset along axis a. All shapes come out positively oriented, with
//! their nodes in VTK order.

use super::pattern::FacePattern;
use souple_elements::Family;

/// The local corner that stands for the centre of the cell.
pub(super) const CENTRE: u8 = 8;

/// A diagonal of a rectangle with the corners (0,0), (1,0), (1,1), (0,1) in its two axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Diagonal {
    /// (0,0)–(1,1).
    Forward,
    /// (1,0)–(0,1).
    Backward,
}

/// What becomes of a cell.
#[derive(Clone, Copy, Debug)]
pub(super) enum Cell {
    Edge,
    Quadrangle,
    Triangles(Diagonal),
    Hexahedron,
    /// Extruded along this axis, with this diagonal in the plane normal to it.
    Prisms(usize, Diagonal),
    /// Kuhn's six around the diagonal from this corner to the opposite one.
    Kuhn(u8),
    /// Five tetrahedra; the central one has the corners with this parity of their bits.
    Five(u32),
    /// About the centre, each face as given: x−, x+, y−, y+, z−, z+.
    Star([FacePattern; 6]),
}

/// One element of the subdivision.
pub(super) struct Shape {
    pub family: Family,
    pub corners: Vec<u8>,
}

fn shape(family: Family, corners: &[u8]) -> Shape {
    Shape { family, corners: corners.to_vec() }
}

/// The four corners of a face of the cell, counter-clockwise seen from outside.
///
/// Faces are numbered x−, x+, y−, y+, z−, z+.
pub(super) fn face_corners(face: usize) -> [u8; 4] {
    let (axis, up) = (face / 2, face % 2 == 1);
    let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
    let at = if up { 1 << axis } else { 0 };
    // u × v points along the axis: counter-clockwise seen from its positive side.
    if up { [at, at | u, at | u | v, at | v] } else { [at, at | v, at | u | v, at | u] }
}

/// Two triangles of a face, each counter-clockwise seen from outside.
fn face_triangles(face: usize, diagonal: Diagonal) -> [[u8; 3]; 2] {
    let [a, b, c, d] = face_corners(face);
    match diagonal {
        Diagonal::Forward => [[a, b, c], [a, c, d]],
        Diagonal::Backward => [[a, b, d], [b, c, d]],
    }
}

/// The tetrahedron on these corners, the last two exchanged if that makes its volume positive.
fn tetrahedron([a, b, c, d]: [u8; 4]) -> Shape {
    let vector = |to: u8| -> [i32; 3] { std::array::from_fn(|x| i32::from(to >> x & 1) - i32::from(a >> x & 1)) };
    let ([p, q, r], [s, t, u], [x, y, z]) = (vector(b), vector(c), vector(d));
    let volume: i32 = p * (t * z - u * y) - q * (s * z - u * x) + r * (s * y - t * x);
    shape(Family::Tetrahedron, &if volume < 0 { [a, b, d, c] } else { [a, b, c, d] })
}

/// The elements of a cell, in a fixed order.
pub(super) fn subdivide(cell: Cell) -> Vec<Shape> {
    match cell {
        Cell::Edge => vec![shape(Family::Edge, &[0, 1])],
        Cell::Quadrangle => vec![shape(Family::Quadrangle, &face_corners(5).map(|c| c & 3))],
        Cell::Triangles(diagonal) => {
            face_triangles(5, diagonal).iter().map(|t| shape(Family::Triangle, &t.map(|c| c & 3))).collect()
        }
        Cell::Hexahedron => vec![shape(Family::Hexahedron, &[0, 1, 3, 2, 4, 5, 7, 6])],
        Cell::Prisms(axis, diagonal) => face_triangles(2 * axis + 1, diagonal)
            .iter()
            .map(|&[a, b, c]| {
                let low = |corner: u8| corner & !(1 << axis);
                shape(Family::Prism, &[low(a), low(b), low(c), a, b, c])
            })
            .collect(),
        Cell::Kuhn(from) => {
            // One tetrahedron for each order of walking along the three axes.
            const ORDERS: [[u8; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
            ORDERS
                .iter()
                .map(|[a, b, _]| {
                    let first = from ^ 1 << a;
                    tetrahedron([from, first, first ^ 1 << b, from ^ 7])
                })
                .collect()
        }
        Cell::Five(parity) => {
            let (central, outer): (Vec<u8>, Vec<u8>) = (0..8u8).partition(|c| c.count_ones() % 2 == parity);
            let mut shapes = vec![tetrahedron([central[0], central[1], central[2], central[3]])];
            shapes.extend(outer.iter().map(|&c| tetrahedron([c, c ^ 1, c ^ 2, c ^ 4])));
            shapes
        }
        Cell::Star(faces) => faces
            .iter()
            .enumerate()
            .flat_map(|(face, pattern)| match pattern {
                // Counter-clockwise from outside is clockwise from the apex; a base turns the other way.
                FacePattern::Quadrangle => {
                    let [a, b, c, d] = face_corners(face);
                    vec![shape(Family::Pyramid, &[a, d, c, b, CENTRE])]
                }
                FacePattern::Triangles(diagonal) => face_triangles(face, *diagonal)
                    .iter()
                    .map(|&[a, b, c]| shape(Family::Tetrahedron, &[a, c, b, CENTRE]))
                    .collect(),
            })
            .collect(),
    }
}
