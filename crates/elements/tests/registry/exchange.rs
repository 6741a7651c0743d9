//! Names and node orders of other formats, compared with what Gmsh and VTK themselves say (`formats/*.txt`).

use crate::evaluation::Point;
use souple_elements::{Element, Family, all};
use std::collections::BTreeMap;
use std::fmt::Debug;

/// Blocks of `type NUMBER` and node coordinates, by number and number of nodes: some of VTK's types hold any degree.
fn nodes_by_type(text: &str) -> BTreeMap<(u32, usize), Vec<Point>> {
    let mut blocks: Vec<(u32, Vec<Point>)> = Vec::new();
    for line in text.lines().filter(|l| !l.starts_with('#')) {
        if let Some(number) = line.strip_prefix("type ") {
            blocks.push((number.parse().expect("a type is a number"), Vec::new()));
            continue;
        }
        let x: Vec<f64> = line.split(' ').map(|w| w.parse().expect("a coordinate is a number")).collect();
        blocks.last_mut().expect("a type comes before its nodes").1.push([x[0], x[1], x[2]]);
    }
    blocks.into_iter().map(|(number, nodes)| ((number, nodes.len()), nodes)).collect()
}

fn assert_same_nodes(element: &Element, found: &[Point], format: &str) {
    assert_eq!(found.len(), element.node_count(), "{} in {format}", element.id);
    for (node, (ours, theirs)) in element.nodes.iter().zip(found).enumerate() {
        let same = (0..3).all(|axis| (ours[axis] - theirs[axis]).abs() < 1e-14);
        assert!(same, "{}: node {node} is at {ours:?}, in {format} at {theirs:?}", element.id);
    }
}

/// With the permutation, Gmsh's reference nodes are ours.
#[test]
fn gmsh_order_leads_to_our_nodes() {
    let gmsh = nodes_by_type(include_str!("formats/gmsh.txt"));
    for element in all() {
        let Some(theirs) = gmsh.get(&(element.exchange.gmsh, element.node_count())) else {
            panic!("{}: formats/gmsh.txt lacks type {}; add it there", element.id, element.exchange.gmsh)
        };
        let ordered: Vec<Point> = match element.exchange.gmsh_order {
            Some(order) => order.iter().map(|&from| theirs[usize::from(from)]).collect(),
            None => theirs.clone(),
        };
        assert_same_nodes(element, &ordered, "Gmsh");
    }
}

/// VTK's node order is ours; its reference cells are ours moved to [0, 1].
#[test]
fn vtk_order_is_ours() {
    let vtk = nodes_by_type(include_str!("formats/vtk.txt"));
    let wide = |x: f64| 2.0 * x - 1.0;
    for element in all() {
        let Some(theirs) = vtk.get(&(u32::from(element.exchange.vtk), element.node_count())) else {
            panic!("{}: formats/vtk.txt lacks type {}; add it there", element.id, element.exchange.vtk)
        };
        let moved: Vec<Point> = theirs
            .iter()
            .map(|&[x, y, z]| match element.family {
                Family::Edge => [wide(x), 0.0, 0.0],
                Family::Triangle | Family::Tetrahedron => [x, y, z],
                Family::Quadrangle => [wide(x), wide(y), 0.0],
                Family::Hexahedron => [wide(x), wide(y), wide(z)],
                Family::Prism => [x, y, wide(z)],
                // VTK's pyramid is a cube whose top is one point.
                Family::Pyramid => [wide(x) * (1.0 - z), wide(y) * (1.0 - z), z],
            })
            .collect();
        assert_same_nodes(element, &moved, "VTK");
    }
}

/// A permutation names each node once, and is absent where it would change nothing.
#[test]
fn permutations_are_permutations() {
    for element in all() {
        let Some(order) = element.exchange.gmsh_order else { continue };
        let mut sorted = order.to_vec();
        sorted.sort_unstable();
        assert!(sorted.iter().copied().eq(0..element.node_count() as u8), "{}: {order:?}", element.id);
        assert!(!order.is_sorted(), "{}: the permutation changes nothing, write None", element.id);
    }
}

/// No two elements share a number or a name, so that a reader knows what it reads; the types of VTK that hold any
/// degree are told apart by the number of nodes.
#[test]
fn names_are_unique() {
    fn unique<T: Ord + Debug>(names: impl Iterator<Item = (T, &'static str)>) {
        let mut owners: BTreeMap<T, &str> = BTreeMap::new();
        for (name, element) in names {
            if let Some(first) = owners.get(&name) {
                panic!("{first} and {element} are both called {name:?}");
            }
            owners.insert(name, element);
        }
    }
    unique(all().iter().map(|e| ((e.exchange.vtk, e.node_count()), e.id)));
    unique(all().iter().map(|e| (e.exchange.gmsh, e.id)));
    unique(all().iter().filter_map(|e| e.exchange.medit.map(|name| (name, e.id))));
    unique(all().iter().flat_map(|e| e.exchange.abaqus.iter().map(|name| (*name, e.id))));
}
