//! Files that Gmsh, VTK and meshio wrote, in every variant; `tests/data/make.py` made them.

use crate::{count, read_sample, region, sample, samples};
use souple_elements::{Element, Family, by_id};
use souple_mesh::formats::{CompleteElements, ReadOptions, read};
use souple_mesh::{Mesh, Region};

/// Corners of the mixed body's elements, in VTK's order.
const MIXED: [(Family, &[[f64; 3]]); 6] = [
    (
        Family::Hexahedron,
        &[
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 0.0, 1.0],
            [1.0, 1.0, 1.0],
            [0.0, 1.0, 1.0],
        ],
    ),
    (
        Family::Prism,
        &[[0.0, 1.0, 0.0], [0.0, 2.0, 0.0], [0.0, 1.0, 1.0], [1.0, 1.0, 0.0], [1.0, 2.0, 0.0], [1.0, 1.0, 1.0]],
    ),
    (Family::Pyramid, &[[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [1.0, 0.0, 1.0], [2.0, 0.5, 0.5]]),
    (Family::Tetrahedron, &[[1.0, 0.0, 0.0], [2.0, 0.5, 0.5], [1.0, 0.0, 1.0], [1.5, -0.5, 1.5]]),
    (Family::Quadrangle, &[[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [0.0, 1.0, 0.0]]),
    (Family::Triangle, &[[0.0, 1.0, 0.0], [0.0, 1.0, 1.0], [0.0, 2.0, 0.0]]),
];

fn corners(mesh: &Mesh, family: Family) -> Vec<Vec<[f64; 3]>> {
    let blocks = mesh.blocks.iter().filter(|b| b.element.family == family);
    blocks
        .flat_map(|b| (0..b.len()).map(|e| b.nodes(e)[..family.corner_count()].to_vec()))
        .map(|nodes| nodes.iter().map(|&n| mesh.nodes[n as usize]).collect())
        .collect()
}

/// Every variant of the mixed body has each element once, with its nodes in VTK's order.
#[test]
fn every_variant_of_the_mixed_body_is_the_same_body() {
    let mut read = 0;
    for (name, _) in samples().iter().filter(|(name, _)| name.starts_with("mixed")) {
        let (mesh, report) = read_sample(name);
        for (family, expected) in MIXED {
            assert_eq!(corners(&mesh, family), [expected.to_vec()], "{name}, {family:?}: {report}");
        }
        assert_eq!(report.duplicate_nodes, 0, "{name}");
        read += 1;
    }
    assert!(read >= 24, "only {read} variants");
}

/// Where a node of a straight-sided element should be, by the sides that hold it.
fn straight(element: &Element, corners: &[[f64; 3]], node: usize) -> [f64; 3] {
    let blend = |weights: &[f64], of: &[u8]| {
        let mut x = [0.0; 3];
        for (w, &c) in weights.iter().zip(of) {
            (0..3).for_each(|k| x[k] += w * corners[c as usize][k]);
        }
        x
    };
    for side in element.edges.iter().chain(element.faces) {
        let lower = by_id(side.element).expect("sides are elements");
        let Some(at) = side.nodes.iter().position(|&n| n as usize == node) else { continue };
        let [s, t, _] = lower.nodes[at];
        return match lower.family {
            Family::Edge => blend(&[(1.0 - s) / 2.0, (1.0 + s) / 2.0], side.nodes),
            Family::Triangle => blend(&[1.0 - s - t, s, t], side.nodes),
            _ => {
                let w = |a: f64, b: f64| (1.0 + a * s) * (1.0 + b * t) / 4.0;
                blend(&[w(-1.0, -1.0), w(1.0, -1.0), w(1.0, 1.0), w(-1.0, 1.0)], side.nodes)
            }
        };
    }
    let count = corners.len();
    blend(&vec![1.0 / count as f64; count], &(0..count as u8).collect::<Vec<_>>())
}

/// In files of second and third order from Gmsh, in all the formats that it writes, every node lies where its element's reference cell has it: the
/// permutations are right.
#[test]
fn nodes_of_higher_order_are_in_place() {
    let mut seen = std::collections::BTreeSet::new();
    let higher = |name: &str| ["mixed2", "complete2", "cubic", "quadratic"].iter().any(|start| name.starts_with(start));
    for (name, _) in samples().iter().filter(|(name, _)| higher(name)) {
        let (mesh, _) = read_sample(name);
        for block in &mesh.blocks {
            for e in 0..block.len() {
                let x: Vec<[f64; 3]> = block.nodes(e).iter().map(|&n| mesh.nodes[n as usize]).collect();
                let corners = &x[..block.element.family.corner_count()];
                for node in 0..x.len() {
                    if node < corners.len() {
                        continue;
                    }
                    let expected = straight(block.element, corners, node);
                    let near = x[node].iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12);
                    assert!(near, "{name}: node {node} of {} at {:?}, not {expected:?}", block.element.id, x[node]);
                }
            }
            seen.insert(block.element.id);
        }
    }
    for id in ["tet10", "hex20", "prism15", "pyramid13", "tri6", "quad8", "tet20", "tri10"] {
        assert!(seen.contains(id), "no sample with {id}");
    }
}

/// A file with 18-node prisms and 14-node pyramids is reduced as a whole, hexahedra and quadrangles too; nodes that
/// only the dropped parts used are gone.
#[test]
fn complete_elements_are_reduced_knowingly() {
    for name in ["complete2-gmsh41-binary.msh", "complete2-gmsh22-text.msh"] {
        let (mesh, report) = read_sample(name);
        for id in ["hex20", "prism15", "pyramid13", "tet10", "quad8", "tri6"] {
            assert_eq!(count(&mesh, id), 1, "{name}: {report}");
        }
        for what in ["hex27 → hex20", "prism18 → prism15", "pyramid14 → pyramid13", "quad9 → quad8"] {
            assert_eq!(report.reduced[what], 1, "{report}");
        }
        // The faces of the hexahedron (6, of which the prism and the pyramid share one each), the prism's other two
        // quadrangles and the hexahedron's centre.
        assert_eq!((report.dropped_nodes, report.unreferenced_nodes), (9, 0), "{report}");
        assert_eq!(region(&mesh, "fixed").nodes.len(), 11, "{report}");
    }
}

/// A file of complete elements that the registry has keeps them, unless asked otherwise.
#[test]
fn known_complete_elements_are_kept_or_reduced_as_asked() {
    let hex27 = by_id("hex27").expect("it is registered");
    let mut mesh = Mesh { nodes: hex27.nodes.to_vec(), ..Mesh::default() };
    mesh.block_mut(hex27).connectivity.extend(0..27);
    let all: Vec<u32> = (0..27).collect();
    mesh.regions.insert(
        "body".to_owned(),
        Region { nodes: all, elements: vec![souple_mesh::ElementId { block: 0, index: 0 }] },
    );
    let bytes = souple_mesh::formats::write_msh(&mesh, Default::default()).unwrap();
    let (kept, _) = read("msh", &bytes, ReadOptions::default()).unwrap();
    assert_eq!((count(&kept, "hex27"), kept.nodes.len()), (1, 27));
    let options = ReadOptions { complete: CompleteElements::Reduce, ..ReadOptions::default() };
    let (reduced, report) = read("msh", &bytes, options).unwrap();
    assert_eq!((count(&reduced, "hex20"), reduced.nodes.len(), report.dropped_nodes), (1, 20, 7));
    assert_eq!(region(&reduced, "body").nodes.len(), 20);
}

/// Elements that Gmsh has and the registry has not are counted as skipped, and the rest is read.
#[test]
fn unknown_orders_are_skipped_and_counted() {
    for name in ["cubic-gmsh41-binary.msh", "cubic-gmsh22-text.msh"] {
        let (mesh, report) = read_sample(name);
        assert_eq!((count(&mesh, "tet20"), count(&mesh, "tri10")), (1, 1), "{report}");
        let skipped: Vec<(&str, usize)> = report.skipped.iter().map(|s| (s.what.as_str(), s.count)).collect();
        assert!(skipped.iter().any(|(what, _)| *what == "Gmsh type 92 (64 nodes)"), "{report}");
        assert!(report.to_string().contains("no such element here"));
    }
}

/// Names and numbers of physical groups become regions with the right members, in every version and encoding.
#[test]
fn physical_groups_become_regions() {
    for name in ["mixed-gmsh41-text.msh", "mixed-gmsh41-binary.msh", "mixed-gmsh22-text.msh", "mixed-gmsh22-binary.msh"]
    {
        let (mesh, report) = read_sample(name);
        let sizes = |region: &Region| (region.nodes.len(), region.elements.len());
        assert_eq!(sizes(region(&mesh, "body")), (12, 4), "{name}: {report}");
        assert_eq!(sizes(region(&mesh, "stiff part")), (8, 1), "{name}");
        assert_eq!(sizes(region(&mesh, "fixed")), (5, 2), "{name}");
        let apex = region(&mesh, "physical_42_dim0");
        assert_eq!((apex.nodes.len(), mesh.nodes[apex.nodes[0] as usize]), (1, [1.5, -0.5, 1.5]), "{name}");
        assert!(region(&mesh, "fixed").nodes.iter().all(|&n| mesh.nodes[n as usize][0] == 0.0));
        assert_eq!(report.repeated_elements, usize::from(name.contains("22")), "{name}");
    }
}

/// A meshed geometry is the same from every version: several groups per entity, reversed groups, parameters, partitions.
#[test]
fn a_geometry_is_the_same_from_every_version() {
    let mut bodies = Vec::new();
    for (name, _) in samples().iter().filter(|(name, _)| name.starts_with("box")) {
        let (mesh, report) = read_sample(name);
        let body = region(&mesh, "body").clone();
        assert_eq!(body.elements.len(), mesh.element_count(), "{name}: {report}");
        assert_eq!(body, *region(&mesh, "also body"), "{name}");
        let (left, sides) = (region(&mesh, "left, reversed"), region(&mesh, "x sides"));
        assert!(left.elements.iter().all(|e| sides.elements.contains(e)), "{name}");
        assert!(left.nodes.iter().all(|&n| mesh.nodes[n as usize][0].abs() < 1e-12), "{name}");
        assert_eq!(sides.elements.len(), 2 * left.elements.len(), "{name}");
        assert_eq!(region(&mesh, "physical_9_dim0").nodes.len(), 2, "{name}");
        // Every group of the front side holds it reversed, so its triangles are turned: their normals point to +y.
        let front = region(&mesh, "front, reversed");
        assert!(!front.elements.is_empty());
        for e in &front.elements {
            let x = mesh.nodes_of(*e).iter().map(|&n| mesh.nodes[n as usize]).collect::<Vec<_>>();
            let (u, v) = ([0, 2].map(|k| x[1][k] - x[0][k]), [0, 2].map(|k| x[2][k] - x[0][k]));
            assert!(u[1] * v[0] - u[0] * v[1] > 0.0, "{name}: a triangle of the front looks outwards");
        }
        bodies.push((mesh.nodes.len(), mesh.element_count(), left.elements.len(), sides.nodes.len()));
    }
    assert!(bodies.len() == 6 && bodies.iter().all(|b| *b == bodies[0]), "{bodies:?}");
}

/// Label arrays, flag arrays and names of meshio, VTK and MEDIT become regions; other arrays are listed as ignored.
#[test]
fn arrays_become_regions() {
    for (name, _) in samples().iter().filter(|(name, _)| name.starts_with("mixed-vtk")) {
        let (mesh, report) = read_sample(name);
        assert_eq!(region(&mesh, "material_id_1").elements.len(), 1, "{name}: {report}");
        assert_eq!(region(&mesh, "material_id_2").elements.len(), 3, "{name}");
        assert_eq!(region(&mesh, "fixed").nodes.len(), 5, "{name}");
        let clamped = region(&mesh, "clamped");
        assert!(clamped.elements.is_empty() && clamped.nodes.len() == 5, "{name}");
        for array in ["stress xx", "displacement", "label text"] {
            assert!(report.ignored.iter().any(|i| i.contains(array)), "{name}: {report}");
        }
    }
    let (mesh, report) = read_sample("solids-meshio.mesh");
    assert_eq!(region(&mesh, "reference_2_dim3").elements.len(), 2, "{report}");
    assert_eq!(region(&mesh, "reference_4_dim2").elements.len(), 2);
    assert!(!mesh.regions.keys().any(|name| name.ends_with("dim0")), "all vertices have the reference 0");
}

/// Pixels, voxels, strips, lines, polygons and Lagrange cells of VTK become elements; the rest is counted.
#[test]
fn vtk_cells_are_converted_or_counted() {
    let (mesh, report) = read_sample("kinds-vtk.vtu");
    let expected = [("quad4", 2), ("hex8", 1), ("tri3", 4), ("edge2", 3), ("prism6", 1), ("hex27", 2)];
    for (id, n) in expected {
        assert_eq!(count(&mesh, id), n, "{id}: {report}");
    }
    let skipped: Vec<&str> = report.skipped.iter().map(|s| s.what.as_str()).collect();
    assert_eq!(skipped, ["VTK type 7 (5 nodes)", "VTK type 1 (1 nodes)"], "{report}");
    assert!(report.flipped.is_empty(), "{report}");
    // The Lagrange hexahedron and the triquadratic one are the same cell.
    let block = mesh.blocks.iter().find(|b| b.element.id == "hex27").expect("it was counted");
    assert_eq!(block.nodes(0), block.nodes(1));
    // Files before version 2.2 exchange two edges of the Lagrange hexahedron, and of nothing else.
    let old = String::from_utf8(sample("kinds-vtk.vtu")).unwrap().replace("version=\"2.3\"", "version=\"2.1\"");
    let (old, report) = read("vtu", old.as_bytes(), ReadOptions::default()).unwrap();
    let block = old.blocks.iter().find(|b| b.element.id == "hex27").expect("as before");
    let differing: Vec<usize> = (0..27).filter(|&i| block.nodes(0)[i] != block.nodes(1)[i]).collect();
    assert_eq!((differing.as_slice(), report.reordered["hex27"]), (&[18, 19][..], 1));
}

/// Abaqus elements are read with any suffix, and their types are told apart by the whole number.
#[test]
fn abaqus_of_meshio_is_read() {
    let (mesh, report) = read_sample("solids-meshio.inp");
    assert_eq!([count(&mesh, "hex8"), count(&mesh, "prism6"), count(&mesh, "tet4")], [1, 1, 1], "{report}");
    assert_eq!(report.ignored, ["*HEADING"]);
}

/// The hexahedra-only file of meshio in MSH 4.1 has no entities at all and is read.
#[test]
fn msh_without_entities_is_read() {
    let (mesh, _) = read_sample("hex-meshio41.msh");
    assert_eq!((count(&mesh, "hex8"), mesh.nodes.len()), (1, 12));
    assert!(!sample("hex-meshio41.msh").is_empty());
}
