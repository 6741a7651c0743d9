//! Which diagonals the faces of cells show, how neighbouring sections agree on them, and what is left.
//!
//! A subdivision shows on each face of its cell either the whole quadrangle or two triangles on one of the two
//! diagonals. Within a section neighbouring cells show the same; between sections only the planes normal to x matter.
//! On such a plane a pattern is a quadrangle everywhere, the forward diagonal everywhere, or diagonals that alternate
//! like a chess board:
//!
//! | subdivision | on planes normal to x |
//! |---|---|
//! | whole, pyramids, prisms along y or z | quadrangles |
//! | prisms along x | any triangles, the same on all planes of the section |
//! | tetrahedra 6 | forward |
//! | tetrahedra 6 mirrored | alternating, the same on all planes |
//! | tetrahedra 5 | alternating, changing from plane to plane; free to start with either |
//!
//! The two free ones follow their neighbours: first from left to right, then from right to left.

use super::cell::{Cell, Diagonal};
use super::spec::{Axis, BarError, BarSpec, Layout, Mismatch, Split};
use souple_elements::{Element, Family, all, by_id};

/// What one face of a cell shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FacePattern {
    Quadrangle,
    Triangles(Diagonal),
}

/// The diagonals on a plane, face by face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Diagonals {
    Forward,
    /// Forward on the faces (j, k) with (j + k) % 2 equal to this, backward on the others.
    Alternating(usize),
}

impl Diagonals {
    fn at(self, j: usize, k: usize) -> Diagonal {
        match self {
            Diagonals::Alternating(parity) if (j + k) % 2 != parity => Diagonal::Backward,
            Diagonals::Forward | Diagonals::Alternating(_) => Diagonal::Forward,
        }
    }
}

/// The pattern of one face of a plane: quadrangles where there are no diagonals.
fn face(diagonals: Option<Diagonals>, j: usize, k: usize) -> FacePattern {
    diagonals.map_or(FacePattern::Quadrangle, |d| FacePattern::Triangles(d.at(j, k)))
}

/// A section's subdivision with its freedom removed.
#[derive(Clone, Copy, Debug)]
pub(super) enum SectionPattern {
    Edges,
    Quadrangles,
    TrianglesForward,
    TrianglesBackward,
    TrianglesAlternating,
    Hexahedra,
    Pyramids,
    /// Along x, with these diagonals on every plane.
    PrismsAlong(Diagonals),
    /// Along y or z (1 or 2).
    PrismsAcross(usize),
    Kuhn,
    KuhnMirrored,
    /// On the plane x_i, diagonals are forward where i + j + k has this parity.
    Five(usize),
}

impl SectionPattern {
    /// The plane x_i; none where it shows quadrangles (or where faces are not planes at all, in 1D and 2D).
    fn plane(self, i: usize) -> Option<Diagonals> {
        match self {
            SectionPattern::PrismsAlong(diagonals) => Some(diagonals),
            SectionPattern::Kuhn => Some(Diagonals::Forward),
            SectionPattern::KuhnMirrored => Some(Diagonals::Alternating(0)),
            SectionPattern::Five(parity) => Some(Diagonals::Alternating((parity + i) % 2)),
            _ => None,
        }
    }

    /// The faces x−, x+, y−, y+, z−, z+ of a solid cell.
    fn faces(self, [i, j, k]: [usize; 3]) -> [FacePattern; 6] {
        let x = [face(self.plane(i), j, k), face(self.plane(i + 1), j, k)];
        let alternating = |parity, a, b| face(Some(Diagonals::Alternating(parity)), a, b);
        let forward = FacePattern::Triangles(Diagonal::Forward);
        let mut faces = [
            x[0],
            x[1],
            FacePattern::Quadrangle,
            FacePattern::Quadrangle,
            FacePattern::Quadrangle,
            FacePattern::Quadrangle,
        ];
        match self {
            SectionPattern::Kuhn => faces = [forward; 6],
            SectionPattern::KuhnMirrored => {
                let (y, z) = (alternating(0, i, k), alternating(0, i, j));
                faces = [x[0], x[1], y, y, z, z];
            }
            SectionPattern::Five(parity) => {
                let y = |j: usize| alternating((parity + j) % 2, i, k);
                let z = |k: usize| alternating((parity + k) % 2, i, j);
                faces = [x[0], x[1], y(j), y(j + 1), z(k), z(k + 1)];
            }
            SectionPattern::PrismsAcross(axis) => faces[2 * axis..2 * axis + 2].fill(forward),
            _ => {}
        }
        faces
    }

    /// The subdivision of one cell.
    pub(super) fn cell(self, [i, j, k]: [usize; 3]) -> Cell {
        let chess = |parity, a, b| Diagonals::Alternating(parity).at(a, b);
        match self {
            SectionPattern::Edges => Cell::Edge,
            SectionPattern::Quadrangles => Cell::Quadrangle,
            SectionPattern::TrianglesForward => Cell::Triangles(Diagonal::Forward),
            SectionPattern::TrianglesBackward => Cell::Triangles(Diagonal::Backward),
            SectionPattern::TrianglesAlternating => Cell::Triangles(chess(0, i, j)),
            SectionPattern::Hexahedra => Cell::Hexahedron,
            SectionPattern::Pyramids => Cell::Star([FacePattern::Quadrangle; 6]),
            SectionPattern::PrismsAlong(diagonals) => Cell::Prisms(0, diagonals.at(j, k)),
            SectionPattern::PrismsAcross(axis) => Cell::Prisms(axis, Diagonal::Forward),
            SectionPattern::Kuhn => Cell::Kuhn(0),
            // The diagonal starts at the corner whose grid indices are all even: neighbours are mirror images.
            SectionPattern::KuhnMirrored => Cell::Kuhn((i & 1 | (j & 1) << 1 | (k & 1) << 2) as u8),
            // The central tetrahedron holds the ends of the diagonal on the face x−.
            SectionPattern::Five(parity) => Cell::Five(((i + j + k + parity) % 2) as u32),
        }
    }
}

/// A subdivision before it is fitted to its neighbours.
enum Choice {
    Fixed(SectionPattern),
    FreePrisms,
    FreeFive,
}

impl Choice {
    fn of(split: Split, family: Family) -> Choice {
        Choice::Fixed(match split.resolved(family) {
            Split::Prisms(Axis::X) => return Choice::FreePrisms,
            Split::Tetrahedra5 => return Choice::FreeFive,
            Split::Prisms(axis) => SectionPattern::PrismsAcross(axis as usize),
            Split::Tetrahedra6 => SectionPattern::Kuhn,
            Split::Tetrahedra6Mirrored => SectionPattern::KuhnMirrored,
            Split::Pyramids => SectionPattern::Pyramids,
            Split::TrianglesForward => SectionPattern::TrianglesForward,
            Split::TrianglesBackward => SectionPattern::TrianglesBackward,
            Split::TrianglesAlternating => SectionPattern::TrianglesAlternating,
            Split::Whole | Split::Usual => match family {
                Family::Edge => SectionPattern::Edges,
                Family::Quadrangle => SectionPattern::Quadrangles,
                _ => SectionPattern::Hexahedra,
            },
        })
    }

    /// The pattern that continues a neighbour across plane x_i, if there is one.
    fn following(&self, neighbour: SectionPattern, i: usize) -> Option<SectionPattern> {
        match (self, neighbour.plane(i)?) {
            (Choice::FreePrisms, diagonals) => Some(SectionPattern::PrismsAlong(diagonals)),
            (Choice::FreeFive, Diagonals::Alternating(parity)) => Some(SectionPattern::Five((parity + i) % 2)),
            _ => None,
        }
    }

    fn alone(&self) -> SectionPattern {
        match self {
            Choice::Fixed(pattern) => *pattern,
            Choice::FreePrisms => SectionPattern::PrismsAlong(Diagonals::Forward),
            Choice::FreeFive => SectionPattern::Five(0),
        }
    }
}

/// The pattern of every section: fixed ones first, then free ones after their left neighbour, then after their right
/// one, then what is left with the usual pattern from left to right.
pub(super) fn resolve(spec: &BarSpec, layout: &Layout) -> Vec<SectionPattern> {
    let choices: Vec<Choice> = spec.sections.iter().map(|s| Choice::of(s.split, s.element.family)).collect();
    let mut patterns: Vec<Option<SectionPattern>> = choices
        .iter()
        .map(|choice| match choice {
            Choice::Fixed(pattern) => Some(*pattern),
            _ => None,
        })
        .collect();
    let count = choices.len();
    let follow_left = |patterns: &[Option<SectionPattern>], s: usize| {
        let left = patterns[s.checked_sub(1)?]?;
        choices[s].following(left, layout.planes[s])
    };
    for s in 0..count {
        patterns[s] = patterns[s].or_else(|| follow_left(&patterns, s));
    }
    for s in (0..count.saturating_sub(1)).rev() {
        let following = patterns[s + 1].and_then(|right| choices[s].following(right, layout.planes[s + 1]));
        patterns[s] = patterns[s].or(following);
    }
    for s in 0..count {
        patterns[s] = patterns[s].or_else(|| follow_left(&patterns, s)).or_else(|| Some(choices[s].alone()));
    }
    patterns.into_iter().flatten().collect()
}

/// In what the faces of two sections differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MismatchKind {
    /// One side has a quadrangle where the other has two triangles.
    QuadrangleAgainstTriangles,
    /// Both have triangles, on different diagonals.
    CrossedDiagonals,
    /// The faces are the same but carry different nodes (degrees, or face centres on one side only).
    DifferentInterpolation,
}

/// The ids of an element's sides of one family, without repeats.
fn side_ids(element: &Element, family: Family) -> Vec<&'static str> {
    let mut ids: Vec<&'static str> = element.faces.iter().map(|side| side.element).collect();
    ids.retain(|id| by_id(id).is_some_and(|lower| lower.family == family));
    ids.sort_unstable();
    ids.dedup();
    ids
}

fn family_of(pattern: FacePattern, dimension: usize) -> Family {
    match (dimension, pattern) {
        (3, FacePattern::Triangles(_)) => Family::Triangle,
        (3, FacePattern::Quadrangle) => Family::Quadrangle,
        _ => Family::Edge,
    }
}

/// The interfaces that do not conform, counted by kind, in order of x.
pub(super) fn mismatches(spec: &BarSpec, layout: &Layout, patterns: &[SectionPattern]) -> Vec<Mismatch> {
    let mut found: Vec<Mismatch> = Vec::new();
    let [_, ny, nz] = layout.cells;
    for s in 1..spec.sections.len() {
        let i = layout.planes[s];
        let [a, b] = [spec.sections[s - 1].element, spec.sections[s].element];
        let first = found.len();
        for (k, j) in (0..nz).flat_map(|k| (0..ny).map(move |j| (k, j))) {
            let [low, high] = [patterns[s - 1], patterns[s]].map(|p| face(p.plane(i), j, k));
            let family = family_of(low, layout.dimension);
            let kind = match (low, high) {
                (FacePattern::Triangles(p), FacePattern::Triangles(q)) if p != q => MismatchKind::CrossedDiagonals,
                _ if family != family_of(high, layout.dimension) => MismatchKind::QuadrangleAgainstTriangles,
                _ if side_ids(a, family) != side_ids(b, family) => MismatchKind::DifferentInterpolation,
                _ => continue,
            };
            match found[first..].iter_mut().find(|m| m.kind == kind) {
                Some(mismatch) => mismatch.faces += 1,
                None => found.push(Mismatch { sections: [s - 1, s], elements: [a.id, b.id], kind, faces: 1 }),
            }
        }
        found[first..].sort_by_key(|m| m.kind);
    }
    found
}

/// A layer of cells that is subdivided about its centres to join what its section does not.
pub(super) struct Layer {
    pub section: usize,
    /// Its cells lie between the planes x_i and x_(i+1); this is i.
    pub plane: usize,
    /// Diagonals taken over from the neighbours on x− and x+; none where the section's own stay.
    adopted: [Option<Diagonals>; 2],
    tetrahedron: &'static Element,
    pyramid: Option<&'static Element>,
}

impl Layer {
    pub(super) fn faces(&self, patterns: &[SectionPattern], at: [usize; 3]) -> [FacePattern; 6] {
        let mut faces = patterns[self.section].faces(at);
        for (end, adopted) in self.adopted.iter().enumerate() {
            if adopted.is_some() {
                faces[end] = face(*adopted, at[1], at[2]);
            }
        }
        faces
    }

    pub(super) fn element(&self, family: Family) -> &'static Element {
        match (family, self.pyramid) {
            (Family::Pyramid, Some(pyramid)) => pyramid,
            _ => self.tetrahedron,
        }
    }
}

/// The layers that make every interface conform.
///
/// The side with the quadrangles gives its last layer; where both sides show triangles, the left one does.
/// A layer one cell thick may join both its neighbours.
pub(super) fn transition_layers(
    spec: &BarSpec,
    layout: &Layout,
    patterns: &[SectionPattern],
    mismatches: &[Mismatch],
) -> Result<Vec<Layer>, BarError> {
    let mut layers: Vec<Layer> = Vec::new();
    for mismatch in mismatches {
        let ([left, right], elements) = (mismatch.sections, mismatch.elements);
        if mismatch.kind == MismatchKind::DifferentInterpolation {
            return Err(BarError::DifferentInterpolation { sections: mismatch.sections, elements });
        }
        let i = layout.planes[right];
        let [low, high] = [left, right].map(|s| patterns[s].plane(i));
        // The neighbour's pattern is adopted across the face that looks at it: x+ of the left, x− of the right.
        let (section, neighbour, plane, end, adopted) = match (low, high) {
            (Some(_), None) => (right, left, i, 0, low),
            _ => (left, right, i - 1, 1, high),
        };
        let (tetrahedron, pyramid) =
            transition_elements(spec, section, neighbour, patterns[section]).map_err(|(family, faces)| {
                BarError::NoTransition { sections: mismatch.sections, elements, family, faces }
            })?;
        match layers.iter_mut().find(|l| l.section == section && l.plane == plane) {
            // Both interfaces asked for the same faces of the section, so they found the same elements or none.
            Some(layer) => layer.adopted[end] = adopted,
            None => {
                let mut layer = Layer { section, plane, adopted: [None, None], tetrahedron, pyramid };
                layer.adopted[end] = adopted;
                layers.push(layer);
            }
        }
    }
    Ok(layers)
}

/// The tetrahedron and the pyramid whose faces are those of the section and of its neighbour; else the family that is
/// missing and the faces it should have.
fn transition_elements(
    spec: &BarSpec,
    section: usize,
    neighbour: usize,
    pattern: SectionPattern,
) -> Result<(&'static Element, Option<&'static Element>), (&'static str, String)> {
    let (own, other) = (spec.sections[section].element, spec.sections[neighbour].element);
    let mut triangles = side_ids(other, Family::Triangle);
    triangles.extend(side_ids(own, Family::Triangle));
    triangles.sort_unstable();
    triangles.dedup();
    let quadrangles = side_ids(own, Family::Quadrangle);
    let find = |family: Family, quadrangles: &[&'static str]| {
        all()
            .iter()
            .copied()
            .find(|e| {
                e.family == family
                    && side_ids(e, Family::Triangle) == triangles
                    && side_ids(e, Family::Quadrangle) == quadrangles
            })
            .ok_or_else(|| (family.name(), [&triangles, quadrangles].concat().join(" and ")))
    };
    let tetrahedron = find(Family::Tetrahedron, &[])?;
    let shows_quadrangles = pattern.faces([0, 0, 0]).contains(&FacePattern::Quadrangle);
    let pyramid = if shows_quadrangles { Some(find(Family::Pyramid, &quadrangles)?) } else { None };
    Ok((tetrahedron, pyramid))
}
