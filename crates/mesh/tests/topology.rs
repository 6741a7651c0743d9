//! The gluing promises: mates are mutual and have equal corners, boundaries are closed and turn outwards, nodes are
//! orbits whatever is opened in whatever order, and what is wrong with a mesh is listed.

#![expect(clippy::unwrap_used, reason = "a panic is how a test fails")]

use proptest::prelude::*;
use souple_elements::{Family, all, by_id};
use souple_mesh::bar::{BarSpec, Section, Split, Transition, generate};
use souple_mesh::topology::{
    FaceId, Interface, Topology, TopologyError, boundary, euler_characteristic, exterior, interfaces, surface,
};
use souple_mesh::{Mesh, with_elements};
use std::collections::{BTreeMap, BTreeSet};

fn mixed(cells: [usize; 3]) -> Mesh {
    let section = |until, id: &str| Section { until, element: by_id(id).unwrap(), split: Split::Usual };
    let sections = vec![section(0.25, "prism6"), section(0.5, "pyramid5"), section(0.75, "hex8"), section(1.0, "tet4")];
    let spec =
        BarSpec { size: [4.0, 1.0, 1.0], cells, origin: [0.0; 3], sections, transition: Transition::InsertPyramids };
    generate(&spec).unwrap().0
}

fn mesh(nodes: &[[f64; 3]], elements: &[(&str, &[u32])]) -> Mesh {
    let mut mesh = Mesh { nodes: nodes.to_vec(), ..Mesh::default() };
    for (id, connectivity) in elements {
        mesh.block_mut(by_id(id).unwrap()).connectivity.extend_from_slice(connectivity);
    }
    mesh
}

/// Mates are mutual, have the same corners, belong to different elements, and numbering goes both ways.
#[test]
fn mates_are_mutual() {
    let mesh = mixed([8, 2, 2]);
    let topology = Topology::new(&mesh).unwrap();
    let set = |f: FaceId| topology.face_material(f).collect::<BTreeSet<u32>>();
    for face in topology.faces() {
        let mate = topology.mate(face);
        if !mate.is_none() {
            assert_eq!(topology.mate(mate), face);
            assert_eq!(set(face), set(mate));
            assert_ne!(face.element(), mate.element());
        }
    }
    for element in 0..topology.element_count() as u32 {
        assert_eq!(topology.number(topology.id(element)), Some(element));
        let corners =
            topology.corner_start[element as usize] as usize..topology.corner_start[element as usize + 1] as usize;
        let nodes = mesh.nodes_of(topology.id(element));
        assert_eq!(&topology.corner_material[corners], nodes);
    }
    assert!(interfaces(&topology).is_empty());
}

/// The boundary of every element of the registry, alone, is a closed surface that turns outwards, with the element's
/// interpolation on it.
#[test]
fn boundaries_turn_outwards() {
    for element in all().iter().filter(|e| e.dimension() == 3) {
        let connectivity: Vec<u32> = (0..element.node_count() as u32).collect();
        let one = mesh(element.nodes, &[(element.id, &connectivity)]);
        let topology = Topology::new(&one).unwrap();
        let surface = boundary(&one, &topology);
        assert_eq!(euler_characteristic(&surface.mesh), 2, "{}", element.id);
        assert_eq!(surface.mesh.element_count(), element.faces.len());
        // ∮ x · n dA = 3 V over the corners: positive when faces turn outwards.
        let mut flux = 0.0;
        for (block, owners) in surface.mesh.blocks.iter().zip(&surface.owners) {
            assert_eq!(block.len(), owners.len());
            for f in 0..block.len() {
                let c: Vec<[f64; 3]> = block.nodes(f)[..block.element.family.corner_count()]
                    .iter()
                    .map(|&n| surface.mesh.nodes[n as usize])
                    .collect();
                for i in 1..c.len() - 1 {
                    let [p, q, r] = [c[0], c[i], c[i + 1]];
                    flux += p[0] * (q[1] * r[2] - q[2] * r[1]) - p[1] * (q[0] * r[2] - q[2] * r[0])
                        + p[2] * (q[0] * r[1] - q[1] * r[0]);
                }
            }
        }
        assert!((flux / 6.0 - element.family.reference_measure()).abs() < 1e-12, "{}: {flux}", element.id);
        assert!(surface.parent.iter().zip(&surface.mesh.nodes).all(|(&p, n)| one.nodes[p as usize] == *n));
    }
}

/// A quadratic mesh has the gluing of its linear one, and its boundary carries the quadratic faces.
#[test]
fn degree_does_not_matter_for_gluing() {
    let linear = mixed([8, 2, 2]);
    let quadratic = with_elements(&linear, |e| {
        all().iter().copied().find(|q| q.family == e.family && q.degree == 2 && q.node_count() < 27).unwrap()
    })
    .unwrap();
    let (a, b) = (Topology::new(&linear).unwrap(), Topology::new(&quadratic).unwrap());
    assert_eq!(a.mate, b.mate);
    let surface = boundary(&quadratic, &b);
    let kinds: BTreeSet<&str> = surface.mesh.blocks.iter().map(|b| b.element.id).collect();
    assert_eq!(kinds, BTreeSet::from(["quad8", "tri6"]));
    assert!(quadratic.regions["x_min"].nodes.len() > linear.regions["x_min"].nodes.len());
    let back =
        with_elements(&quadratic, |e| all().iter().copied().find(|l| l.family == e.family && l.degree == 1).unwrap())
            .unwrap();
    assert_eq!(back.nodes, linear.nodes);
    assert_eq!(back.regions, linear.regions);
    let hex_to_tet =
        with_elements(&linear, |e| if e.family == Family::Hexahedron { by_id("tet4").unwrap() } else { e });
    assert!(hex_to_tet.unwrap_err().to_string().contains("hex8"));
}

/// The faces on a named side of a bar are as many as its cells there.
#[test]
fn faces_within_a_region() {
    let mesh = mixed([8, 3, 2]);
    let topology = Topology::new(&mesh).unwrap();
    let ends = |name: &str| topology.boundary_within(&mesh.regions[name].nodes).len();
    assert_eq!(ends("x_min"), 2 * 6, "prisms show two triangles per cell");
    assert_eq!(ends("x_max"), 2 * 6, "tetrahedra too");
    let one = surface(&mesh, &topology, &topology.boundary_within(&mesh.regions["x_min"].nodes));
    assert_eq!(one.mesh.nodes.len(), 4 * 3);
}

/// Two tetrahedra that share one node only are two pieces: the node is two nodes.
#[test]
fn a_hinge_is_two_nodes() {
    let nodes: Vec<[f64; 3]> = (0..7).map(|i| [i as f64, (i * i) as f64, (i % 3) as f64]).collect();
    let topology = Topology::new(&mesh(&nodes, &[("tet4", &[0, 1, 2, 3, 3, 4, 5, 6])])).unwrap();
    assert_eq!(topology.corner_node, [0, 1, 2, 3, 7, 4, 5, 6]);
    assert_eq!(topology.node_material, [0, 1, 2, 3, 4, 5, 6, 3]);
}

/// Three triangles on one edge, a doubled element, a degenerate one, and a bad index are each named.
#[test]
fn faults_are_listed() {
    let nodes: Vec<[f64; 3]> = (0..5).map(|i| [i as f64, (i * i) as f64, 0.0]).collect();
    let book = Topology::new(&mesh(&nodes, &[("tri3", &[0, 1, 2, 0, 1, 3, 0, 1, 4])])).unwrap();
    assert_eq!(book.non_manifold.len(), 1);
    assert_eq!(book.non_manifold[0].len(), 3);
    assert_eq!(book.boundary().len(), 6);

    let folded = Topology::new(&mesh(&nodes, &[("tri3", &[0, 1, 2, 0, 1, 3])])).unwrap();
    assert_eq!(folded.folded.len(), 1, "both triangles run from 0 to 1");
    let flat = Topology::new(&mesh(&nodes, &[("tri3", &[0, 1, 2, 1, 0, 3])])).unwrap();
    assert!(flat.folded.is_empty());

    let collapsed = Topology::new(&mesh(&nodes, &[("tri3", &[0, 1, 1])])).unwrap();
    assert_eq!(collapsed.collapsed.len(), 1);

    let error = Topology::new(&mesh(&nodes, &[("tri3", &[0, 1, 2, 0, 1, 5])])).unwrap_err();
    let expected = TopologyError::NodeOutOfRange { block: 0, index: 1, element: "tri3", node: 5, nodes: 5 };
    assert_eq!(error, expected);
    assert!(Topology::new(&Mesh::default()).unwrap().boundary().is_empty());
}

/// A chain of edges is glued at its inner points and bounded by its two ends.
#[test]
fn chains_are_glued_at_points() {
    let nodes: Vec<[f64; 3]> = (0..4).map(|i| [i as f64, 0.0, 0.0]).collect();
    let topology = Topology::new(&mesh(&nodes, &[("edge2", &[0, 1, 1, 2, 2, 3])])).unwrap();
    let ends: Vec<u32> = topology.boundary().into_iter().flat_map(|f| topology.face_material(f)).collect();
    assert_eq!(ends, [0, 3]);
    assert!(topology.folded.is_empty());
}

/// A hexahedron beside two tetrahedra on its face: found without any position.
#[test]
fn quadrangles_against_triangles_are_found() {
    let nodes = vec![[0.0; 3]; 9];
    let hexahedron: &[u32] = &[0, 1, 2, 3, 4, 5, 6, 7];
    let topology = Topology::new(&mesh(&nodes, &[("hex8", hexahedron), ("tet4", &[4, 5, 6, 8, 4, 6, 7, 8])])).unwrap();
    let found = interfaces(&topology);
    assert_eq!(found.len(), 1);
    let Interface::QuadrangleAgainstTriangles { quadrangle, triangles } = &found[0] else { panic!("{found:?}") };
    assert_eq!(topology.face_material(*quadrangle).collect::<BTreeSet<_>>(), BTreeSet::from([4, 5, 6, 7]));
    assert_eq!(triangles.len(), 2);
    let half = Topology::new(&mesh(&nodes, &[("hex8", hexahedron), ("tet4", &[4, 5, 6, 8])])).unwrap();
    let found = interfaces(&half);
    assert!(matches!(&found[..], [Interface::QuadrangleAgainstTriangles { triangles, .. }] if triangles.len() == 1));
}

/// Where sections do not meet, the faces between them are boundary but not exterior: the exterior is the box.
#[test]
fn interfaces_are_not_exterior() {
    let section = |until, id: &str| Section { until, element: by_id(id).unwrap(), split: Split::Usual };
    let sections = vec![section(0.3, "prism6"), section(0.6, "hex8"), section(1.0, "tet4")];
    let spec = BarSpec { size: [1.0; 3], cells: [6, 2, 3], origin: [0.0; 3], sections, transition: Transition::Keep };
    let (mesh, report) = generate(&spec).unwrap();
    let topology = Topology::new(&mesh).unwrap();
    let (boundary, exterior) = (topology.boundary(), exterior(&topology));
    assert_eq!(boundary.len() - exterior.len(), 3 * report.mismatched_faces());
    for face in exterior {
        let nodes: Vec<[f64; 3]> = topology.face_material(face).map(|n| mesh.nodes[n as usize]).collect();
        assert!((0..3).any(|a| [0.0, 1.0].iter().any(|end| nodes.iter().all(|p| p[a] == *end))), "{face:?}");
    }
}

/// Components of the corners over each material node, by walking: what the orbits must be.
fn orbits_by_walking(topology: &Topology) -> BTreeSet<BTreeSet<usize>> {
    let mut corners_of: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    for e in 0..topology.element_count() {
        for c in topology.corner_start[e]..topology.corner_start[e + 1] {
            corners_of.insert((e as u32, topology.corner_material[c as usize]), c as usize);
        }
    }
    let mut seen = BTreeSet::new();
    let mut found = BTreeSet::new();
    for (&(element, material), &corner) in &corners_of {
        if seen.contains(&corner) {
            continue;
        }
        let (mut piece, mut open) = (BTreeSet::from([corner]), vec![element]);
        while let Some(at) = open.pop() {
            for face in topology.faces().filter(|f| f.element() == at) {
                let mate = topology.mate(face);
                if !mate.is_none() && topology.face_material(face).any(|n| n == material) {
                    let next = corners_of[&(mate.element(), material)];
                    if piece.insert(next) {
                        open.push(mate.element());
                    }
                }
            }
        }
        seen.extend(piece.iter().copied());
        found.insert(piece);
    }
    found
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Whatever faces are opened, in whatever order: nodes are the face-connected parts of stars, the first part keeps
    /// the number, and boundary faces pair up across their edges.
    #[test]
    fn nodes_are_orbits(picks in prop::collection::vec(any::<prop::sample::Index>(), 0..40), turn in 0usize..40) {
        let mesh = mixed([4, 2, 1]);
        let whole = Topology::new(&mesh).unwrap();
        let glued: Vec<FaceId> = whole.faces().filter(|&f| !whole.mate(f).is_none()).collect();
        let mut faces: Vec<FaceId> = picks.iter().map(|p| *p.get(&glued)).collect();
        let mut opened = whole.clone();
        opened.open(&faces);

        let mut groups: BTreeMap<u32, BTreeSet<usize>> = BTreeMap::new();
        for (corner, &node) in opened.corner_node.iter().enumerate() {
            groups.entry(node).or_default().insert(corner);
            prop_assert_eq!(opened.node_material[node as usize], opened.corner_material[corner]);
        }
        prop_assert_eq!(groups.into_values().collect::<BTreeSet<_>>(), orbits_by_walking(&opened));

        // Order does not matter, nor does doing it in two steps.
        if !faces.is_empty() {
            let by = turn % faces.len();
            faces.rotate_left(by);
        }
        let mut again = whole.clone();
        let (first, second) = faces.split_at(faces.len() / 2);
        again.open(first);
        again.open(second);
        prop_assert_eq!(&again.corner_node, &opened.corner_node);
        prop_assert_eq!(&again.node_material, &opened.node_material);

        for face in opened.boundary() {
            let corners: Vec<u32> = opened.face_material(face).collect();
            for i in 0..corners.len() {
                let edge = [corners[i], corners[(i + 1) % corners.len()]];
                let other = opened.across_edge(face, edge).unwrap();
                prop_assert_ne!(other, face);
                prop_assert_eq!(opened.across_edge(other, edge), Some(face));
            }
        }
    }
}
