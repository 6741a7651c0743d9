//! What is written is read back: every writer, every element of the registry.

use crate::menagerie::menagerie;
use crate::{assert_same, sample};
use souple_elements::all;
use souple_mesh::formats::{
    FormatError, MshVersion, ReadOptions, VtkWedge, VtuEncoding, VtuOptions, read, write_inp, write_msh, write_vtk,
    write_vtu,
};

/// A mesh of all elements with overlapping, mixed, empty and node regions survives every version of MSH unchanged.
#[test]
fn msh_keeps_everything() {
    let mesh = menagerie(|_| true);
    for version in [MshVersion::V41Binary, MshVersion::V41Text, MshVersion::V22Text] {
        let bytes = write_msh(&mesh, version).unwrap();
        let (back, report) =
            read("m.msh", &bytes, ReadOptions::default()).unwrap_or_else(|e| panic!("{version:?}: {e}"));
        assert_same(&mesh, &back, &format!("{version:?}"));
        assert!(report.flipped.is_empty() && report.skipped.is_empty(), "{report}");
        let permuted = all().iter().filter(|e| e.exchange.gmsh_order.is_some());
        assert!(permuted.clone().count() > 0 && permuted.clone().all(|e| report.reordered[e.id] == 2), "{report}");
        assert_eq!(report.unreferenced_nodes, 1);
    }
}

/// The same for VTU in every encoding, and for legacy VTK, with both ways of writing wedges.
#[test]
fn vtk_keeps_everything() {
    let mesh = menagerie(|_| true);
    for wedge in [VtkWedge::PositiveJacobian, VtkWedge::Lagrange] {
        for encoding in [VtuEncoding::AppendedZlib, VtuEncoding::AppendedRaw, VtuEncoding::Text] {
            let bytes = write_vtu(&mesh, &[], &VtuOptions { encoding, wedge, time: Some(0.25) }).unwrap();
            let (back, report) = read("vtu", &bytes, ReadOptions::default()).unwrap();
            assert_same(&mesh, &back, &format!("{encoding:?}, {wedge:?}"));
            assert!(report.flipped.is_empty() && report.skipped.is_empty(), "{report}");
        }
        let bytes = write_vtk(&mesh, &[], wedge).unwrap();
        let (back, _) = read("x.vtk", &bytes, ReadOptions::default()).unwrap();
        assert_same(&mesh, &back, &format!("legacy, {wedge:?}"));
    }
}

/// The same for Abaqus, as far as it has the elements.
#[test]
fn inp_keeps_everything() {
    let mesh = menagerie(|e| !e.exchange.abaqus.is_empty());
    let bytes = write_inp(&mesh).unwrap();
    let (back, report) = read("a.inp", &bytes, ReadOptions::default()).unwrap();
    assert_same(&mesh, &back, "inp");
    assert!(report.skipped.is_empty(), "{report}");
}

/// Writing an element that Abaqus does not have names it and says what to do.
#[test]
fn inp_refuses_what_it_cannot_say() {
    for element in all().iter().filter(|e| e.exchange.abaqus.is_empty()) {
        let error = write_inp(&menagerie(|e| e.id == element.id || e.id == "hex8")).unwrap_err();
        assert!(matches!(&error, FormatError::NotWritable { what, .. } if what.contains(element.id)), "{error}");
    }
    let mut mesh = menagerie(|e| matches!(e.id, "hex8" | "tet4"));
    mesh.regions.insert("NOTHING".to_owned(), Default::default());
    assert!(write_inp(&mesh).unwrap_err().to_string().contains("case"));
    mesh.regions.insert("a\"b".to_owned(), Default::default());
    assert!(write_inp(&mesh).is_err() && write_msh(&mesh, MshVersion::V22Text).is_err());
    mesh.regions.insert("a\nb".to_owned(), Default::default());
    assert!(write_vtu(&mesh, &[], &VtuOptions::default()).is_err());
}

/// An element whose nodes are mirrored comes back turned, whatever its kind and the format, and is counted.
#[test]
fn inverted_elements_are_turned_and_counted() {
    for element in all().iter().filter(|e| e.dimension() == 3) {
        let mut mesh = menagerie(|e| e.id == element.id || e.id == "tet4" || e.id == "hex8");
        mesh.regions.clear();
        let good = mesh.clone();
        // Mirrored in space: every node keeps its place in the list, the volumes become negative.
        for node in &mut mesh.nodes {
            node[0] = -node[0];
        }
        let bytes = write_vtu(&mesh, &[], &VtuOptions::default()).unwrap();
        let (back, report) = read("vtu", &bytes, ReadOptions::default()).unwrap();
        assert_eq!(report.flipped[element.id], 2, "{report}");
        let again = write_msh(&back, MshVersion::V41Text).unwrap();
        let (_, report) = read("msh", &again, ReadOptions::default()).unwrap();
        assert!(report.flipped.is_empty(), "{}: turned twice", element.id);
        // Turning permutes the nodes of an element and changes none of them.
        for (a, b) in good.blocks.iter().zip(&back.blocks) {
            let sorted = |nodes: &[u32]| {
                let mut nodes = nodes.to_vec();
                nodes.sort_unstable();
                nodes
            };
            assert!((0..a.len()).all(|e| sorted(a.nodes(e)) == sorted(b.nodes(e))));
        }
    }
}

/// A plane mesh whose elements turn clockwise is turned; a surface in space is left as it is.
#[test]
fn plane_meshes_are_turned_and_surfaces_are_not() {
    let flat = "*NODE\n1,0,0\n2,1,0\n3,0,1\n*ELEMENT,TYPE=CPE3\n1,1,3,2\n";
    let (mesh, report) = crate::read_text("a.inp", flat).unwrap();
    assert_eq!((report.flipped["tri3"], mesh.blocks[0].nodes(0)), (1, &[0, 1, 2][..]));
    let bent = "*NODE\n1,0,0\n2,1,0\n3,0,1,1\n*ELEMENT,TYPE=S3\n1,1,3,2\n";
    let (mesh, report) = crate::read_text("a.inp", bent).unwrap();
    assert!(report.flipped.is_empty());
    assert_eq!(mesh.blocks[0].nodes(0), [0, 2, 1]);
}

/// The same mesh written by other means as MSH 2.2 and as legacy VTK gives the same nodes and elements.
#[test]
fn two_formats_of_one_mesh_agree() {
    let (msh, from_msh) = crate::read_sample("P9_meshA_affine_quads.msh");
    let (vtk, from_vtk) = crate::read_sample("P9_meshA_affine_quads.vtk");
    assert_eq!(msh.nodes, vtk.nodes);
    assert_eq!(from_msh.found, from_vtk.found);
    assert!(msh.element_count() > 0 && from_msh.skipped.is_empty());
    for (a, b) in msh.blocks.iter().zip(&vtk.blocks) {
        assert_eq!((a.element.id, &a.connectivity), (b.element.id, &b.connectivity));
    }
}

/// Content decides the format where the name does not: the same bytes are read under any name.
#[test]
fn formats_are_told_by_content() {
    let names = [
        "mixed-gmsh41-binary.msh",
        "mixed-vtk-appended-zlib.vtu",
        "mixed-vtk42-binary.vtk",
        "solids-meshio.inp",
        "solids-meshio.mesh",
        "cube-text.stl",
        "cube-binary.stl",
        "cube-binary.ply",
    ];
    for name in names {
        let (by_name, _) = crate::read_sample(name);
        let (by_content, _) = read("data", &sample(name), ReadOptions::default()).unwrap();
        assert_same(&by_name, &by_content, name);
    }
    let error = read("liver.step", b"ISO-10303-21;", ReadOptions::default()).unwrap_err();
    assert!(error.to_string().contains("convert it"), "{error}");
}
