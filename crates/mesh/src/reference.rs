//! Reference cells as geometry: where a point lies between the corners, which edges meet at a corner, what the ideal
//! shape of a family is, and which renumbering mirrors it.
//!
//! Everything is derived from the registry's node coordinates, faces and edges, so a new element of a known family
//! needs nothing here. What is not here: shape functions of any element (those are expressions in `souple-elements`)
//! and their derivatives (nobody types those).

use souple_elements::{Element, Family, Side, by_id};

/// Weights of the corners at a reference point: the point is Σ wᵢ · cornerᵢ and Σ wᵢ = 1, `[corner]`.
///
/// These are the affine weights of simplices, the multilinear ones of cubes, and the rational ones of the pyramid,
/// `wᵢ = ((1 − ζ) + ξᵢ ξ)((1 − ζ) + ηᵢ η) / (4 (1 − ζ))`, whose limit at the apex is the apex itself.
pub(crate) fn corner_weights(family: Family, [x, y, z]: [f64; 3]) -> Vec<f64> {
    let line = |t: f64| [(1.0 - t) / 2.0, (1.0 + t) / 2.0];
    let square = |x: f64, y: f64| {
        let ([a, b], [c, d]) = (line(x), line(y));
        [a * c, b * c, b * d, a * d]
    };
    match family {
        Family::Edge => line(x).to_vec(),
        Family::Triangle => vec![1.0 - x - y, x, y],
        Family::Quadrangle => square(x, y).to_vec(),
        Family::Tetrahedron => vec![1.0 - x - y - z, x, y, z],
        Family::Hexahedron => line(z).iter().flat_map(|s| square(x, y).map(|w| w * s)).collect(),
        Family::Prism => line(z).iter().flat_map(|s| [1.0 - x - y, x, y].map(|w| w * s)).collect(),
        Family::Pyramid => {
            let h = 1.0 - z;
            // At the apex the rational form is 0/0; every path inside the cell leads to the apex alone.
            if h <= 0.0 {
                return vec![0.0, 0.0, 0.0, 0.0, 1.0];
            }
            let mut weights: Vec<f64> = square(x / h, y / h).iter().map(|w| w * h).collect();
            weights.push(z);
            weights
        }
    }
}

/// The part of an element that carries one of its nodes: the smallest side that contains it, else the whole element.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Support {
    /// Local corners of the element.
    pub corners: Vec<u8>,
    /// Weight of each of those corners at the node.
    pub weights: Vec<f64>,
}

/// The supports of the nodes that are not corners, in node order.
pub(crate) fn supports(element: &Element) -> Vec<Support> {
    (element.family.corner_count()..element.node_count())
        .map(|node| {
            let on = |sides: &'static [Side]| sides.iter().find_map(|s| side_support(s, node));
            on(element.edges).or_else(|| on(element.faces)).unwrap_or_else(|| Support {
                corners: (0..element.family.corner_count() as u8).collect(),
                weights: corner_weights(element.family, element.nodes[node]),
            })
        })
        .collect()
}

fn side_support(side: &Side, node: usize) -> Option<Support> {
    let at = side.nodes.iter().position(|&n| n as usize == node)?;
    let lower = side_element(side);
    Some(Support { corners: side_corners(side).to_vec(), weights: corner_weights(lower.family, lower.nodes[at]) })
}

/// The lower element of a side.
pub(crate) fn side_element(side: &Side) -> &'static Element {
    by_id(side.element).expect("the element registry's own tests check that every side names a registered element")
}

/// The local corners of a side, in its own order.
pub(crate) fn side_corners(side: &Side) -> &'static [u8] {
    &side.nodes[..side_element(side).family.corner_count()]
}

/// Corner lists of the sides of dimension one less; the ends of an edge, which the registry does not list, are points.
pub(crate) fn corner_faces(element: &Element) -> Vec<&'static [u8]> {
    match element.family {
        Family::Edge => vec![&[0], &[1]],
        _ => element.faces.iter().map(side_corners).collect(),
    }
}

/// For each corner, the corners at the far ends of the edges that meet there, ordered so that the determinant of
/// these edge vectors is positive in the reference cell; `None` where more edges meet than there are axes (the apex
/// of a pyramid).
pub(crate) fn corner_frames(element: &Element) -> Vec<Option<Vec<u8>>> {
    let dimension = element.dimension();
    (0..element.family.corner_count() as u8)
        .map(|corner| {
            let mut far: Vec<u8> = match element.family {
                Family::Edge => vec![1 - corner],
                _ => element
                    .edges
                    .iter()
                    .map(|side| [side.nodes[0], side.nodes[1]])
                    .filter(|ends| ends.contains(&corner))
                    .map(|[a, b]| if a == corner { b } else { a })
                    .collect(),
            };
            far.sort_unstable();
            if far.len() != dimension {
                return None;
            }
            if dimension > 1 && determinant(&edge_vectors(element.nodes, corner, &far), dimension) < 0.0 {
                far.swap(dimension - 2, dimension - 1);
            }
            Some(far)
        })
        .collect()
}

/// Vectors from one corner to others, `[vector][axis]`.
pub(crate) fn edge_vectors(points: &[[f64; 3]], corner: u8, far: &[u8]) -> Vec<[f64; 3]> {
    far.iter().map(|&f| crate::geometry::minus(points[f as usize], points[corner as usize])).collect()
}

fn determinant(v: &[[f64; 3]], dimension: usize) -> f64 {
    match dimension {
        2 => v[0][0] * v[1][1] - v[0][1] * v[1][0],
        _ => crate::geometry::triple(v[0], v[1], v[2]),
    }
}

/// Corners of the shape that has quality 1: equilateral simplices, the cube, the prism on an equilateral triangle with
/// square sides, the pyramid with a square base and equilateral sides. Unit edges throughout, `[corner][axis]`.
pub(crate) fn ideal_corners(family: Family) -> Vec<[f64; 3]> {
    let h = 3f64.sqrt() / 2.0;
    let triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, h, 0.0]];
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let lift = |base: &[[f64; 3]]| base.iter().copied().chain(base.iter().map(|p| [p[0], p[1], 1.0])).collect();
    match family {
        Family::Edge => square[..2].to_vec(),
        Family::Triangle => triangle.to_vec(),
        Family::Quadrangle => square.to_vec(),
        Family::Tetrahedron => triangle.into_iter().chain([[0.5, h / 3.0, (2f64 / 3.0).sqrt()]]).collect(),
        Family::Hexahedron => lift(&square),
        Family::Prism => lift(&triangle),
        Family::Pyramid => square.into_iter().chain([[0.5, 0.5, 0.5f64.sqrt()]]).collect(),
    }
}

/// The renumbering that mirrors an element: `mirrored[i] = nodes[p[i]]` turns an inverted element into a good one.
///
/// Exchanging ξ and η maps every reference cell of dimension two and three onto itself; on an edge ξ changes sign.
/// `None` when the nodes are not symmetric under it.
pub(crate) fn mirror(element: &Element) -> Option<Vec<u8>> {
    let image = |[x, y, z]: [f64; 3]| match element.family {
        Family::Edge => [-x, y, z],
        _ => [y, x, z],
    };
    let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-9);
    element
        .nodes
        .iter()
        .map(|&node| element.nodes.iter().position(|&other| near(other, image(node))).map(|at| at as u8))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use souple_elements::all;

    /// Corner weights reproduce every reference node of every element and sum to one.
    #[test]
    fn corner_weights_reproduce_reference_nodes() {
        for element in all() {
            let corners = &element.nodes[..element.family.corner_count()];
            for &node in element.nodes {
                let weights = corner_weights(element.family, node);
                assert_eq!(weights.len(), corners.len(), "{}", element.id);
                assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-14, "{}", element.id);
                for axis in 0..3 {
                    let at: f64 = weights.iter().zip(corners).map(|(w, c)| w * c[axis]).sum();
                    assert!((at - node[axis]).abs() < 1e-14, "{} {node:?}", element.id);
                }
            }
        }
    }

    /// The support of each inner node places it where the registry says, and uses no corner of weight zero.
    #[test]
    fn supports_are_the_smallest_sides() {
        for element in all() {
            for (support, node) in supports(element).iter().zip(&element.nodes[element.family.corner_count()..]) {
                assert!(support.weights.iter().all(|w| *w > 1e-12), "{} {node:?} {support:?}", element.id);
                for axis in 0..3 {
                    let corner = |&c: &u8| element.nodes[c as usize][axis];
                    let at: f64 = support.weights.iter().zip(&support.corners).map(|(w, c)| w * corner(c)).sum();
                    assert!((at - node[axis]).abs() < 1e-14, "{} {node:?}", element.id);
                }
            }
        }
    }

    /// Every corner except the apex of a pyramid has a frame, and frames are positive in the ideal shape as well.
    #[test]
    fn frames_are_right_handed() {
        for element in all() {
            let ideal = ideal_corners(element.family);
            for (corner, frame) in corner_frames(element).iter().enumerate() {
                let apex = element.family == Family::Pyramid && corner == 4;
                assert_eq!(frame.is_none(), apex, "{} corner {corner}", element.id);
                let Some(frame) = frame else { continue };
                if element.dimension() > 1 {
                    let vectors = edge_vectors(&ideal, corner as u8, frame);
                    assert!(determinant(&vectors, element.dimension()) > 0.1, "{} corner {corner}", element.id);
                }
            }
        }
    }

    /// Mirroring twice is the identity, and once reverses the sign of every corner frame.
    #[test]
    fn mirror_reverses_orientation() {
        for element in all() {
            let p = mirror(element).expect("every element of the registry is symmetric");
            assert!(p.iter().enumerate().all(|(i, &j)| p[j as usize] as usize == i), "{}", element.id);
            if element.dimension() < 2 {
                continue;
            }
            let mirrored: Vec<[f64; 3]> = p.iter().map(|&j| element.nodes[j as usize]).collect();
            for (corner, frame) in corner_frames(element).iter().enumerate() {
                let Some(frame) = frame else { continue };
                let vectors = edge_vectors(&mirrored, corner as u8, frame);
                assert!(determinant(&vectors, element.dimension()) < 0.0, "{} corner {corner}", element.id);
            }
        }
    }
}
