//! Surfaces: STL, OBJ, PLY, and polygonal data of VTK.

use crate::{count, read_sample, read_text, region};

/// A cube of twelve triangles is the same from every format, and an STL's corners are welded.
#[test]
fn the_cube_is_the_same_from_every_format() {
    for name in ["cube-text.stl", "cube-binary.stl", "cube-text.ply", "cube-binary.ply", "cube.obj"] {
        let (mesh, report) = read_sample(name);
        assert_eq!((mesh.nodes.len(), count(&mesh, "tri3")), (8, 12), "{name}: {report}");
        assert_eq!(report.welded_nodes, if name.ends_with("stl") { 28 } else { 0 }, "{name}");
        // Outward normals: the signed volume under the triangles is that of the cube.
        let volume: f64 = (0..12)
            .map(|t| {
                let [a, b, c] = [0, 1, 2].map(|k| mesh.nodes[mesh.blocks[0].nodes(t)[k] as usize]);
                let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
                (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]) / 6.0
            })
            .sum();
        assert!((volume - 1.0).abs() < 1e-12, "{name}: {volume}");
    }
}

/// The surface that VTK extracts from the mixed body has its faces, in the old and in the new layout of cells.
#[test]
fn polygonal_data_is_read() {
    for name in ["surface-vtk42.vtk", "surface-vtk51.vtk"] {
        let (mesh, report) = read_sample(name);
        assert_eq!(mesh.dimension(), 2, "{report}");
        assert!(count(&mesh, "tri3") > 0 && count(&mesh, "quad4") > 0, "{report}");
        assert!(region(&mesh, "material_id_2").elements.len() > 1);
    }
}

/// Degenerate triangles of an STL are left out and counted; named solids are regions.
#[test]
fn stl_solids_and_slivers() {
    let facet = |p: [&str; 3]| {
        let vertices: String = p.iter().map(|v| format!("vertex {v}\n")).collect();
        format!("facet normal 0 0 0\nouter loop\n{vertices}endloop\nendfacet\n")
    };
    let (one, flat) = (facet(["0 0 0", "1 0 0", "0 1 0"]), facet(["0 0 0", "1 0 0", "1 0 0"]));
    let text = format!("solid left lobe\n{one}endsolid left lobe\nsolid right\n{flat}{one}endsolid\n");
    let (mesh, report) = read_text("a.stl", &text).unwrap();
    assert_eq!((count(&mesh, "tri3"), report.skipped[0].count), (2, 1), "{report}");
    assert_eq!(region(&mesh, "left lobe").elements.len(), 1);
    assert_eq!(region(&mesh, "right").elements.len(), 1);
}

/// OBJ: indices with textures and normals, counted back, polygons, lines, groups, objects and materials.
#[test]
fn obj_in_all_its_ways() {
    let text = "# cube side\nmtllib a.mtl\no thing\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0\nv 0 1 0\nv 0.5 2 0\nvn 0 0 1\n\
                g side top\nusemtl skin\nf 1/1/1 2/2/1 \\\n3//1 4\nf -5 -4 -3 -1 4\nl 1 2 3\ng\nf 1 2 3\n";
    let (mesh, report) = read_text("a.obj", text).unwrap();
    assert_eq!([count(&mesh, "quad4"), count(&mesh, "tri3"), count(&mesh, "edge2")], [1, 4, 2], "{report}");
    assert_eq!(region(&mesh, "top"), region(&mesh, "side"));
    assert_eq!(region(&mesh, "top").elements.len(), 6);
    assert_eq!(region(&mesh, "thing").elements.len(), 7);
    assert_eq!(region(&mesh, "material_skin").elements.len(), 7);
    assert_eq!(report.split["polygons into triangles"], 1);
    assert_eq!(report.ignored, ["mtllib", "vn"]);
}

/// PLY: other records and properties are passed over, quadrangles stay, lists may have any width.
#[test]
fn ply_with_more_than_a_mesh() {
    let text = "ply\nformat ascii 1.0\ncomment made by hand\nelement camera 1\nproperty float view_px\nelement vertex 4\n\
                property float x\nproperty float y\nproperty float z\nproperty uchar red\nelement face 2\n\
                property uchar flags\nproperty list uchar int vertex_index\nend_header\n0.5\n\
                0 0 0 255\n1 0 0 255\n1 1 0 9\n0 1 0 9\n1 4 0 1 2 3\n0 3 0 1 2\n";
    let (mesh, report) = read_text("a.ply", text).unwrap();
    assert_eq!([count(&mesh, "quad4"), count(&mesh, "tri3"), mesh.nodes.len()], [1, 1, 4], "{report}");
    assert_eq!(report.ignored, ["element camera"]);
}
