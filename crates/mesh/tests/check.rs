//! Checks promise: a sound mesh has nothing to report, each fault is found where it was put, and repair removes exactly
//! what it says.

#![expect(clippy::unwrap_used, reason = "a panic is how a test fails")]

use proptest::prelude::*;
use souple_elements::{all, by_id};
use souple_mesh::bar::{BarSpec, Section, Split, Transition, generate};
use souple_mesh::check::{Merge, MeshError, UnitGuess, first_at_same_place, repair, report, validate};
use souple_mesh::{ElementId, Mesh};

fn bar(id: &str) -> Mesh {
    let sections = vec![Section { until: 1.0, element: by_id(id).unwrap(), split: Split::Usual }];
    let spec = BarSpec {
        size: [4.0, 1.0, 1.0],
        cells: [8, 2, 2],
        origin: [1.0, -2.0, 0.5],
        sections,
        transition: Transition::Keep,
    };
    generate(&spec).unwrap().0
}

fn id(index: u32) -> ElementId {
    ElementId { block: 0, index }
}

/// A bar of any element of the registry has its measure and no fault, and cubes have quality 1.
#[test]
fn bars_are_sound() {
    for element in all() {
        let report = report(&bar(element.id)).unwrap();
        assert!((report.measure - 4.0).abs() < 1e-12, "{}: {}", element.id, report.measure);
        assert_eq!(report.dimension, element.dimension());
        let faults = [&report.inverted, &report.tangled, &report.degenerate, &report.slivers];
        assert!(faults.iter().all(|f| f.is_empty()), "{}: {report:?}", element.id);
        assert!(report.unreferenced.is_empty() && report.duplicates.is_empty());
        let quality = report.quality.unwrap();
        assert!(quality.min > 0.3 && quality.mean <= 1.0 + 1e-12 && quality.min <= quality.mean + 1e-12, "{quality:?}");
        assert_eq!(report.unit, UnitGuess::Metres);
    }
    let quality = report(&bar("hex8")).unwrap().quality.unwrap();
    assert!((quality.min - 1.0).abs() < 1e-12);
}

/// Mirrored elements are found, mirrored back by repair, and the mesh is the same again; for every element.
#[test]
fn inverted_elements_are_repaired() {
    for element in all().iter().filter(|e| e.dimension() > 1) {
        let good = bar(element.id);
        let mut bad = good.clone();
        for node in &mut bad.nodes {
            node[0] = -node[0];
        }
        let count = bad.element_count();
        let found = report(&bad).unwrap();
        assert_eq!(found.inverted.len(), count, "{}", element.id);
        assert!((found.measure + 4.0).abs() < 1e-12, "{}", element.id);
        let done = repair(&mut bad, Merge::Never).unwrap();
        assert_eq!((done.mirrored, done.merged, done.dropped), (count, 0, 0));
        let after = report(&bad).unwrap();
        assert!(after.inverted.is_empty() && (after.measure - 4.0).abs() < 1e-12, "{}", element.id);
        assert_eq!(repair(&mut bad, Merge::Never).unwrap().mirrored, 0);
        assert_eq!(bad.regions, good.regions);
    }
}

/// A hexahedron with two corners exchanged is tangled, one with a corner moved into the plane of its neighbours is
/// degenerate, one pressed nearly flat is a sliver, and the others are left alone.
#[test]
fn bad_shapes_are_told_apart() {
    let mut tangled = bar("hex8");
    tangled.blocks[0].connectivity.swap(8 * 3 + 6, 8 * 3 + 7);
    let found = report(&tangled).unwrap();
    assert_eq!((found.tangled, found.inverted.len()), (vec![id(3)], 0));
    assert_eq!(repair(&mut tangled, Merge::Never).unwrap().mirrored, 0, "no order of nodes is obvious");

    let tetrahedron = |apex: f64| {
        let mut mesh =
            Mesh { nodes: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, 0.3, apex]], ..Mesh::default() };
        mesh.block_mut(by_id("tet4").unwrap()).connectivity.extend([0, 1, 2, 3]);
        report(&mesh).unwrap()
    };
    assert_eq!(tetrahedron(0.0).degenerate, [id(0)]);
    assert_eq!(tetrahedron(1e-14).degenerate, [id(0)]);
    assert_eq!(tetrahedron(0.001).slivers, [id(0)]);
    assert_eq!(tetrahedron(-0.5).inverted, [id(0)]);
    let good = tetrahedron(0.8);
    assert!(good.slivers.is_empty() && (good.measure - 0.8 / 6.0).abs() < 1e-15);
}

/// The ideal shapes have quality 1 in any place, size and direction.
#[test]
fn ideal_shapes_have_quality_one() {
    let mut mesh = Mesh::default();
    let h = 3f64.sqrt() / 2.0;
    let shapes: [(&str, Vec<[f64; 3]>); 3] = [
        ("tet4", vec![[0.0; 3], [1.0, 0.0, 0.0], [0.5, h, 0.0], [0.5, h / 3.0, (2f64 / 3.0).sqrt()]]),
        ("prism6", [0.0, 1.0].iter().flat_map(|&z| [[0.0, 0.0, z], [1.0, 0.0, z], [0.5, h, z]]).collect()),
        ("pyramid5", vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.5, 0.5f64.sqrt()]]),
    ];
    for (id, points) in shapes {
        let first = mesh.nodes.len() as u32;
        // A rotation by the rows of an orthogonal matrix, a scale and a shift.
        let (a, b) = (0.6, 0.8);
        mesh.nodes.extend(
            points.iter().map(|p| [7.0 * (a * p[0] - b * p[1]) + 1.0, 7.0 * (b * p[0] + a * p[1]), 7.0 * p[2]]),
        );
        let count = points.len() as u32;
        mesh.block_mut(by_id(id).unwrap()).connectivity.extend(first..first + count);
    }
    let quality = report(&mesh).unwrap().quality.unwrap();
    assert!((quality.min - 1.0).abs() < 1e-12 && (quality.mean - 1.0).abs() < 1e-12, "{quality:?}");
}

/// A mid-side node that strays folds a quadratic element although its corners are good.
#[test]
fn stray_mid_side_nodes_are_seen() {
    let mut mesh = bar("hex20");
    let nodes = mesh.blocks[0].nodes(5).to_vec();
    let [corner, mid] = [nodes[0], nodes[8]].map(|n| mesh.nodes[n as usize]);
    // From the middle of the edge to beyond the quarter point, where det J changes sign at the corner.
    mesh.nodes[nodes[8] as usize] = std::array::from_fn(|a| corner[a] + 0.4 * (mid[a] - corner[a]));
    let found = report(&mesh).unwrap();
    assert!(found.tangled.contains(&id(5)), "{found:?}");
    assert!(found.tangled.len() < mesh.element_count());
}

/// Unused nodes go and regions follow; merging two separate bars at their common plane joins them.
#[test]
fn nodes_are_dropped_and_merged() {
    let mut mesh = bar("hex8");
    let (count, elements) = (mesh.nodes.len(), mesh.element_count());
    let end = mesh.regions["x_max"].nodes.clone();
    // A second bar of its own nodes behind the first, and a node of nothing in front of all.
    let mut connectivity = mesh.blocks[0].connectivity.clone();
    connectivity.extend(mesh.blocks[0].connectivity.iter().map(|n| n + count as u32));
    mesh.blocks[0].connectivity = connectivity;
    mesh.nodes.extend(mesh.nodes.clone().iter().map(|p| [p[0] + 4.0, p[1], p[2]]));
    mesh.nodes.insert(0, [99.0; 3]);
    mesh.blocks[0].connectivity.iter_mut().for_each(|n| *n += 1);
    for region in mesh.regions.values_mut() {
        region.nodes.iter_mut().for_each(|n| *n += 1);
    }
    mesh.regions.get_mut("x_min").unwrap().nodes.insert(0, 0);

    let before = report(&mesh).unwrap();
    assert_eq!(before.unreferenced, [0]);
    assert_eq!(before.duplicates.len(), 9);
    assert_eq!(before.unit, UnitGuess::Millimetres, "99 is far for metres");
    let positions = mesh.nodes.clone();
    let done = repair(&mut mesh, Merge::Within(1e-6)).unwrap();
    assert_eq!((done.mirrored, done.merged, done.dropped), (0, 9, 1));
    assert!(done.collapsed.is_empty());
    assert_eq!(mesh.nodes.len(), 2 * count - 9);
    assert_eq!(mesh.element_count(), 2 * elements);
    assert_eq!(mesh.regions["x_max"].nodes, end, "the first bar keeps its numbers");
    assert_eq!(mesh.regions["x_min"].nodes.len(), 9);
    assert_eq!(done.new_node[0], None);
    for (old, new) in done.new_node.iter().enumerate().skip(1) {
        let moved: f64 = (0..3).map(|a| (positions[old][a] - mesh.nodes[new.unwrap() as usize][a]).abs()).sum();
        assert!(moved < 1e-12);
    }
    let after = report(&mesh).unwrap();
    assert!(after.duplicates.is_empty() && after.unreferenced.is_empty() && (after.measure - 8.0).abs() < 1e-12);
    // Merging more than the size of a cell collapses elements, and says which.
    assert!(!repair(&mut mesh, Merge::Within(0.6)).unwrap().collapsed.is_empty());
}

/// What a mesh may not contain is named with its place.
#[test]
fn invalid_meshes_are_named() {
    let good = bar("hex8");
    assert_eq!(validate(&good), Ok(()));
    let with = |change: &dyn Fn(&mut Mesh)| {
        let mut mesh = good.clone();
        change(&mut mesh);
        assert_eq!(repair(&mut mesh.clone(), Merge::Never).unwrap_err(), report(&mesh).unwrap_err());
        report(&mesh).unwrap_err()
    };
    let error = with(&|m| m.nodes[7][1] = f64::INFINITY);
    assert!(matches!(error, MeshError::NotFinite { node: 7, .. }), "{error}");
    let error = with(&|m| m.blocks[0].connectivity[17] = 1000);
    assert!(matches!(error, MeshError::NodeOutOfRange { index: 2, node: 1000, .. }), "{error}");
    let error = with(&|m| m.blocks[0].connectivity.truncate(9));
    assert!(matches!(error, MeshError::RaggedBlock { length: 9, node_count: 8, .. }), "{error}");
    let error = with(&|m| m.regions.get_mut("y_max").unwrap().nodes.push(5000));
    assert!(matches!(&error, MeshError::RegionOutOfRange { region, .. } if region == "y_max"), "{error}");
    let stray = ElementId { block: 3, index: 0 };
    let error = with(&|m| m.regions.get_mut("x_min").unwrap().elements.push(stray));
    assert!(matches!(&error, MeshError::RegionOutOfRange { region, .. } if region == "x_min"), "{error}");
    let empty = report(&Mesh::default()).unwrap();
    assert_eq!((empty.nodes, empty.quality, empty.unit), (0, None, UnitGuess::Unknown));
}

proptest! {
    /// Coincident points are found as by comparing each with all earlier ones.
    #[test]
    fn coincidence_is_that_of_all_pairs(
        points in prop::collection::vec(prop::array::uniform3(0i32..6), 0..60),
        scale in prop::sample::select(vec![1e-6, 1.0, 1e6]),
        share in 0.0f64..2.5,
    ) {
        let points: Vec<[f64; 3]> = points.iter().map(|p| p.map(|x| f64::from(x) * scale)).collect();
        let tolerance = share * scale;
        let mut expected: Vec<u32> = Vec::new();
        for (i, p) in points.iter().enumerate() {
            let near = |j: &usize| {
                let q = points[*j];
                expected[*j] == *j as u32 && (0..3).map(|a| (p[a] - q[a]).powi(2)).sum::<f64>().sqrt() <= tolerance
            };
            let first = (0..i).find(near).unwrap_or(i);
            expected.push(first as u32);
        }
        prop_assert_eq!(first_at_same_place(&points, tolerance), expected);
    }
}
