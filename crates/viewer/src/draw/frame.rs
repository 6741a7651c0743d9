//! One state as triangles and lines, ready for a graphics device: positions, normals and colours, no more.
//!
//! ```text
//! skin (or all faces, pulled towards their elements' centres) ── nodes' positions ──► corners with normals
//! elements that the section meets ── their tetrahedra ──► the cut face, in the elements' colours
//! edges, cables, springs, dots ──► lines
//! ```

use crate::colouring::Colours;
use crate::geometry::{Vector, along, cross, dot, length, minus, unit};
use crate::look::{Faces, Look, Section, Shading};
use crate::model::{Model, Skin};
use crate::palette::{self, Colour};
use crate::triangles::tetrahedra;
use bytemuck::{Pod, Zeroable};

/// A corner of a triangle.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Corner {
    /// Position in m.
    pub position: Vector,
    /// Unit normal.
    pub normal: Vector,
    /// Red, green, blue and 255, or 0 where no section cuts (the cut face itself).
    pub colour: [u8; 4],
}

/// A straight line, or a dot when both ends are one.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Line {
    /// Ends in m.
    pub ends: [Vector; 2],
    /// Red, green, blue; the last is 255, or 0 where no section cuts.
    pub colour: [u8; 4],
    /// Width in pixels of a picture 1000 pixels high.
    pub width: f32,
}

/// What is drawn besides the model: springs, tools, marks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Extras {
    /// Lines.
    pub lines: Vec<Line>,
    /// Triangles, three corners each.
    pub corners: Vec<Corner>,
}

/// Triangles and lines of one state.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    /// Three per triangle.
    pub corners: Vec<Corner>,
    /// Lines and dots.
    pub lines: Vec<Line>,
    /// The box around what is drawn, in m.
    pub bounds: [Vector; 2],
}

/// The faces that frames are made of, kept from frame to frame.
#[derive(Clone, Debug, Default)]
pub struct Faceted {
    skin: Skin,
    /// Triangles around each node: `around[starts[n]..starts[n + 1]]`.
    starts: Vec<u32>,
    around: Vec<u32>,
}

/// More elements than this are pulled apart at the surface only: all faces of a large volume would fill memory.
const MANY: usize = 60_000;

impl Faceted {
    /// The skin of a model, for elements that stay together.
    pub fn whole(model: &Model) -> Faceted {
        Faceted::of(model.skin.clone(), model.rest.len())
    }

    /// All faces of all elements, for elements that are pulled apart.
    pub fn apart(model: &Model) -> Faceted {
        let skin = if model.elements.len() > MANY {
            model.faces_of(model.skin.elements().into_iter())
        } else {
            model.faces_of(0..model.elements.len() as u32)
        };
        Faceted::of(skin, model.rest.len())
    }

    fn of(skin: Skin, nodes: usize) -> Faceted {
        let mut starts = vec![0u32; nodes + 1];
        skin.triangles.iter().flatten().for_each(|&n| starts[n as usize + 1] += 1);
        for n in 0..nodes {
            starts[n + 1] += starts[n];
        }
        let mut next = starts.clone();
        let mut around = vec![0; skin.triangles.len() * 3];
        for (t, triangle) in (0u32..).zip(&skin.triangles) {
            for &n in triangle {
                around[next[n as usize] as usize] = t;
                next[n as usize] += 1;
            }
        }
        Faceted { skin, starts, around }
    }
}

/// One state, as it is to be seen.
pub fn frame(
    model: &Model,
    faceted: &Faceted,
    positions: &[Vector],
    colours: &Colours,
    look: &Look,
    held: &[u32],
    extras: &Extras,
) -> Frame {
    let mut frame = Frame { bounds: bounds(positions), ..Frame::default() };
    let apart = look.element_size < 0.999;
    let skin = &faceted.skin;
    let centres = if apart { centres(model, positions) } else { Vec::new() };
    // Pulled apart, elements are shown whole or not at all.
    let hidden = |owner: u32| match (&look.section, apart) {
        (Some(section), true) => section.depth(centres[owner as usize]) > 0.0,
        _ => false,
    };
    let shown_at = |node: u32, owner: u32| -> Vector {
        let p = positions[node as usize];
        if apart {
            let c = centres[owner as usize];
            along(c, look.element_size, minus(p, c))
        } else {
            p
        }
    };
    let cut = if apart { 0 } else { 255 };
    let mut marked = vec![false; model.elements.len()];
    look.marked.iter().for_each(|&e| marked[e as usize] = true);
    let colour_of = |node: u32, owner: u32| -> Colour {
        if marked[owner as usize] {
            return palette::MARKED;
        }
        colours.nodes.as_ref().map_or(colours.elements[owner as usize], |c| c[node as usize])
    };
    if look.faces != Faces::Wireframe {
        let normals: Vec<Vector> = skin.triangles.iter().map(|t| normal(t.map(|n| positions[n as usize]))).collect();
        for (t, triangle) in skin.triangles.iter().enumerate() {
            let owner = skin.owners[t];
            if hidden(owner) {
                continue;
            }
            let shading = if apart { Shading::Flat } else { look.shading };
            for &node in triangle {
                let [r, g, b] = colour_of(node, owner);
                let position = shown_at(node, owner);
                let normal = shaded(faceted, &normals, t, node, shading);
                frame.corners.push(Corner { position, normal, colour: [r, g, b, cut] });
            }
        }
    }
    let [r, g, b] = palette::EDGE;
    if look.faces != Faces::Plain {
        // Pieces that two faces share are drawn once per element.
        let width = if look.faces == Faces::Wireframe { 1.5 } else { 1.2 };
        for (piece, &owner) in skin.edges.iter().zip(&skin.edge_owners).filter(|(_, owner)| !hidden(**owner)) {
            let colour = if look.faces == Faces::Wireframe { colour_of(piece[0], owner) } else { [r, g, b] };
            let ends = piece.map(|n| shown_at(n, owner));
            frame.lines.push(Line { ends, colour: [colour[0], colour[1], colour[2], cut], width });
        }
    }
    for &(ends, owner) in &model.cables {
        let [r, g, b] = colour_of(ends[0], owner);
        frame.lines.push(Line { ends: ends.map(|n| positions[n as usize]), colour: [r, g, b, 255], width: 5.0 });
    }
    let mut dot = |n: u32, [r, g, b]: Colour, width: f32| {
        let p = positions[n as usize];
        frame.lines.push(Line { ends: [p, p], colour: [r, g, b, 255], width });
    };
    if look.points {
        (0..positions.len() as u32).for_each(|n| dot(n, palette::EDGE, 5.0));
    }
    if look.held && !apart {
        held.iter().for_each(|&n| dot(n, palette::HELD, 7.0));
    }
    if let (Some(section), false) = (&look.section, apart) {
        cut_face(model, positions, section, &colour_of, look.faces, &mut frame);
    }
    frame.corners.extend_from_slice(&extras.corners);
    frame.lines.extend_from_slice(&extras.lines);
    frame
}

/// The box around points; the unit box around none.
pub fn bounds(points: &[Vector]) -> [Vector; 2] {
    let mut bounds = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    for p in points.iter().filter(|p| p.iter().all(|x| x.is_finite())) {
        for k in 0..3 {
            bounds[0][k] = bounds[0][k].min(p[k]);
            bounds[1][k] = bounds[1][k].max(p[k]);
        }
    }
    if bounds[0][0] <= bounds[1][0] { bounds } else { [[0.0; 3], [1.0; 3]] }
}

/// Twice the area of a triangle along its normal.
fn normal([a, b, c]: [Vector; 3]) -> Vector {
    cross(minus(b, a), minus(c, a))
}

/// Mean normal of the triangles around a node that belong to the same surface as triangle `t`.
fn shaded(faceted: &Faceted, normals: &[Vector], t: usize, node: u32, shading: Shading) -> Vector {
    let own = unit(normals[t]);
    let around = &faceted.around[faceted.starts[node as usize] as usize..faceted.starts[node as usize + 1] as usize];
    let mut sum = [0.0; 3];
    for &other in around {
        let other = other as usize;
        let same = match shading {
            Shading::Flat => faceted.skin.faces[other] == faceted.skin.faces[t],
            Shading::Smooth => dot(own, unit(normals[other])) > 0.64,
        };
        if same {
            sum = along(sum, 1.0, normals[other]);
        }
    }
    if length(sum) > 0.0 { unit(sum) } else { own }
}

/// Mean of each element's corners.
fn centres(model: &Model, positions: &[Vector]) -> Vec<Vector> {
    (0..model.elements.len() as u32)
        .map(|e| {
            let corners = model.elements[e as usize].kind.family.corner_count();
            let nodes = model.nodes_of(e);
            let sum = nodes[..corners].iter().fold([0.0; 3], |s, &n| along(s, 1.0, positions[n as usize]));
            sum.map(|x| x / corners as f32)
        })
        .collect()
}

/// A point of the cut: position and colour.
type Cut = (Vector, Colour);

/// Adds what the section plane meets of the solid elements: faces in their colours, and the outlines of elements.
fn cut_face(
    model: &Model,
    positions: &[Vector],
    section: &Section,
    colour_of: &dyn Fn(u32, u32) -> Colour,
    faces: Faces,
    frame: &mut Frame,
) {
    for e in 0..model.elements.len() as u32 {
        let kind = model.elements[e as usize].kind;
        if kind.dimension() != 3 {
            continue;
        }
        // Most elements are not cut: nothing is stored for them.
        let (mut over, mut under) = (false, false);
        for n in model.node_numbers(e) {
            let hidden = section.depth(positions[n as usize]) > 0.0;
            (over, under) = (over | hidden, under | !hidden);
        }
        if !(over && under) {
            continue;
        }
        let nodes = model.nodes_of(e);
        let depth: Vec<f32> = nodes.iter().map(|&n| section.depth(positions[n as usize])).collect();
        let between = |a: u8, b: u8| -> Cut {
            let (a, b) = (a as usize, b as usize);
            let share = depth[a] / (depth[a] - depth[b]);
            let (pa, pb) = (positions[nodes[a] as usize], positions[nodes[b] as usize]);
            let (ca, cb) = (colour_of(nodes[a], e), colour_of(nodes[b], e));
            let mix = |k: usize| (f32::from(ca[k]) + share * (f32::from(cb[k]) - f32::from(ca[k]))).round() as u8;
            (along(pa, share, minus(pb, pa)), [mix(0), mix(1), mix(2)])
        };
        if faces != Faces::Wireframe {
            for tetrahedron in tetrahedra(kind.family) {
                let (over, under): (Vec<u8>, Vec<u8>) = tetrahedron.iter().partition(|&&n| depth[n as usize] > 0.0);
                let corners: Vec<Cut> = match (&over[..], &under[..]) {
                    ([a], [b, c, d]) | ([b, c, d], [a]) => vec![between(*a, *b), between(*a, *c), between(*a, *d)],
                    ([a, b], [c, d]) => vec![between(*a, *c), between(*a, *d), between(*b, *d), between(*b, *c)],
                    _ => continue,
                };
                for k in 2..corners.len() {
                    for (position, [r, g, b]) in [corners[0], corners[k - 1], corners[k]] {
                        frame.corners.push(Corner { position, normal: section.normal, colour: [r, g, b, 0] });
                    }
                }
            }
        }
        if faces != Faces::Plain {
            for side in kind.faces {
                let corners = &side.nodes[..if side.element.starts_with("tri") { 3 } else { 4 }];
                let crossed: Vec<Vector> = (0..corners.len())
                    .map(|k| (corners[k], corners[(k + 1) % corners.len()]))
                    .filter(|(a, b)| (depth[*a as usize] > 0.0) != (depth[*b as usize] > 0.0))
                    .map(|(a, b)| between(a, b).0)
                    .collect();
                if let [a, b] = crossed[..] {
                    let [r, g, blue] = palette::EDGE;
                    frame.lines.push(Line { ends: [a, b], colour: [r, g, blue, 0], width: 1.2 });
                }
            }
        }
    }
}
