//! What is wrong with a file is said with its place, what was expected, and what to do.

use crate::{count, read_text, region};
use souple_mesh::formats::{FormatError, Place, ReadOptions, read};

const MSH: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n\
                   $Elements\n1\n1 4 2 0 1 1 2 3 4\n$EndElements\n";
const MSH4: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n\
                    0 0 1\n$EndNodes\n$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n";
const VTK: &str = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0\n1 0 0\n\
                   0 1 0\n0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n";
const INP: &str = "*NODE, NSET=NALL\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n*ELEMENT, TYPE=C3D4, ELSET=EALL\n\
                   1, 1, 2, 3, 4\n*NSET, NSET=NFIX\n1, 3,\n";
const MEDIT: &str = "MeshVersionFormatted 2\nDimension 3\nVertices 4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n\
                     Tetrahedra 1\n1 2 3 4 7\nEnd\n";
const VTU: &str = "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\"><UnstructuredGrid>\n\
    <Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" \
    format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points>\n<Cells>\n\
    <DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray>\n\
    <DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">4</DataArray>\n\
    <DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10</DataArray>\n</Cells></Piece></UnstructuredGrid></VTKFile>";

/// The good texts, of which each test spoils one thing.
const GOOD: [(&str, &str); 6] =
    [("a.msh", MSH), ("b.msh", MSH4), ("a.vtk", VTK), ("a.inp", INP), ("a.mesh", MEDIT), ("a.vtu", VTU)];

fn error(name: &str, text: &str) -> FormatError {
    match read_text(name, text) {
        Err(error) => error,
        Ok((_, report)) => panic!("{name} was read: {report}"),
    }
}

/// The unspoilt texts are read and hold one tetrahedron.
#[test]
fn the_good_texts_are_good() {
    for (name, text) in GOOD {
        let (mesh, report) = read_text(name, text).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!((mesh.nodes.len(), count(&mesh, "tet4")), (4, 1), "{name}: {report}");
        assert!(report.flipped.is_empty() && report.unreferenced_nodes == 0, "{name}: {report}");
    }
}

/// A truncated file says so and names what is missing.
#[test]
fn truncation() {
    for (name, text, cut, missing) in [
        ("a.msh", MSH, "$EndElements", "$EndElements"),
        ("b.msh", MSH4, "$EndNodes", "$EndNodes"),
        ("a.vtk", VTK, "\n10\n", "cell types"),
        ("a.mesh", MEDIT, " 3 4 7", "Tetrahedra"),
    ] {
        let end = text.find(cut).expect("the text holds it");
        let message = error(name, &text[..end]).to_string();
        assert!(message.contains(missing), "{name}: {message}");
    }
    let error = error("b.msh", &MSH4[..MSH4.find("$EndNodes").unwrap()]);
    assert!(matches!(error, FormatError::Truncated { place: Place::Line(_), .. }), "{error}");
}

/// A count that the file does not hold is refused before anything is allocated for it.
#[test]
fn impossible_counts() {
    for (name, text, from, to) in [
        ("a.msh", MSH, "$Nodes\n4\n", "$Nodes\n4000000000000\n"),
        ("a.msh", MSH, "$Elements\n1\n", "$Elements\n99999999999\n"),
        ("b.msh", MSH4, "3 1 0 4\n", "3 1 0 4000000000000\n"),
        ("b.msh", MSH4, "3 1 4 1\n", "3 1 4 4000000000000\n"),
        ("a.vtk", VTK, "POINTS 4", "POINTS 4000000000000"),
        ("a.vtk", VTK, "CELLS 1 5", "CELLS 1 18446744073709551615"),
        ("a.mesh", MEDIT, "Vertices 4", "Vertices 4000000000000"),
        ("a.vtu", VTU, "NumberOfPoints=\"4\"", "NumberOfPoints=\"4000000000000\""),
    ] {
        let error = error(name, &text.replace(from, to));
        assert!(matches!(error, FormatError::Count { .. }), "{name}, {to}: {error}");
    }
    let ply = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nend_header\n";
    assert!(matches!(error("a.ply", ply), FormatError::Count { said: 4_000_000_000, .. }));
}

/// Counts that contradict each other are named with both numbers.
#[test]
fn contradicting_counts() {
    for (name, text, from, to) in [
        ("a.msh", MSH, "1 4 2 0 1 1 2 3 4", "1 4 2 0 1 1 2 3"),
        ("b.msh", MSH4, "1 4 1 4\n3 1 0 4", "1 5 1 4\n3 1 0 4"),
        ("b.msh", MSH4, "1 1 2 3 4", "1 1 2 3 4 1"),
        ("a.vtk", VTK, "CELL_TYPES 1\n10", "CELL_TYPES 2\n10 10"),
        ("a.vtk", VTK, "CELLS 1 5\n4", "CELLS 1 5\n5"),
        ("a.vtk", VTK, "CELLS 1 5\n4 0 1 2 3", "CELLS 1 4\n3 0 1 2"),
        ("a.inp", INP, "1, 1, 2, 3, 4\n", "1, 1, 2, 3\n"),
        ("a.inp", INP, "1, 1, 2, 3, 4\n", "1, 1, 2, 3, 4, 1\n"),
        ("a.vtu", VTU, ">4<", ">5<"),
        ("a.vtu", VTU, "NumberOfCells=\"1\"", "NumberOfCells=\"2\""),
    ] {
        assert!(text.contains(from), "{name}: {from}");
        let error = error(name, &text.replace(from, to));
        assert!(matches!(error, FormatError::Count { .. }), "{name}, {to}: {error}");
    }
    assert!(error("a.inp", &INP.replace("1, 1, 2, 3, 4\n", "8, 1, 2, 3\n")).to_string().contains("element 8"));
}

/// A coordinate that is no finite number names its node, its axis and its line.
#[test]
fn coordinates_must_be_finite() {
    for (name, text, from, to) in [
        ("a.msh", MSH, "3 0 1 0\n", "3 0 nan 0\n"),
        ("b.msh", MSH4, "0 1 0\n", "0 inf 0\n"),
        ("a.vtk", VTK, "0 1 0\n", "0 -inf 0\n"),
        ("a.inp", INP, "3, 0, 1, 0", "3, 0, 1e999, 0"),
        ("a.mesh", MEDIT, "0 1 0 0", "0 NaN 0 0"),
        ("a.vtu", VTU, "0 1 0 0 0 1<", "0 inf 0 0 0 1<"),
    ] {
        match error(name, &text.replacen(from, to, 1)) {
            FormatError::NotFinite { node, axis: 'y', place: Place::Line(_), .. } => {
                assert_eq!(node, if matches!(name, "a.vtk" | "a.vtu") { "2" } else { "3" }, "{name}");
            }
            other => panic!("{name}: {other}"),
        }
    }
    let line = error("a.msh", &MSH.replace("3 0 1 0\n", "3 0 nan 0\n"));
    assert!(line.to_string().starts_with("line 8: coordinate y of node 3"), "{line}");
}

/// An element that names a node that is not there is named, with what nodes there are.
#[test]
fn references_must_exist() {
    for (name, text, from, to, who) in [
        ("a.msh", MSH, "1 2 3 4\n$EndE", "1 2 3 9\n$EndE", "element 1 (tet4)"),
        ("b.msh", MSH4, "1 1 2 3 4", "5 1 2 3 9", "element 5 (tet4)"),
        ("a.vtk", VTK, "4 0 1 2 3", "4 0 1 2 4", "cell 0"),
        ("a.vtk", VTK, "4 0 1 2 3", "4 0 1 2 -1", "cell 0"),
        ("a.inp", INP, "1, 1, 2, 3, 4", "7, 1, 2, 3, 9", "element 7 (C3D4)"),
        ("a.inp", INP, "1, 3,\n", "1, 33\n", "set NFIX"),
        ("a.mesh", MEDIT, "1 2 3 4 7", "1 2 3 0 7", "element 1 of Tetrahedra"),
        ("a.vtu", VTU, "0 1 2 3<", "0 1 2 30<", "cell 0"),
    ] {
        assert!(text.contains(from), "{name}: {from}");
        match error(name, &text.replace(from, to)) {
            FormatError::OutOfRange { who: named, .. } => assert!(named.starts_with(who), "{name}: {named}"),
            other => panic!("{name}: {other}"),
        }
    }
    let message = error("a.inp", &INP.replace("1, 1, 2, 3, 4", "7, 1, 2, 3, 9")).to_string();
    assert!(message.starts_with("line 7:") && message.contains("nodes 1 to 4"), "{message}");
}

/// A type number that the format does not define is an error; a type that it defines and we do not is only skipped.
#[test]
fn unknown_element_types() {
    for (name, text, from, to) in [
        ("a.msh", MSH, "1 4 2 0 1", "1 999 2 0 1"),
        ("b.msh", MSH4, "3 1 4 1\n", "3 1 999 1\n"),
        ("a.vtk", VTK, "CELL_TYPES 1\n10", "CELL_TYPES 1\n200"),
        ("a.vtu", VTU, ">10<", ">200<"),
    ] {
        let error = error(name, &text.replace(from, to));
        assert!(matches!(error, FormatError::UnknownElement { .. }), "{name}: {error}");
    }
    let (mesh, report) = read_text("a.inp", &INP.replace("TYPE=C3D4", "TYPE=SPRING4")).unwrap();
    assert_eq!((mesh.blocks.len(), report.skipped[0].count), (0, 1), "{report}");
    let (_, report) = read_text("a.mesh", &MEDIT.replace("Tetrahedra", "Polytopes")).unwrap();
    assert_eq!(report.ignored, ["Polytopes"]);
}

/// The same id twice is refused.
#[test]
fn ids_must_be_unique() {
    for (name, text, from, to) in [
        ("a.msh", MSH, "4 0 0 1", "1 0 0 1"),
        ("b.msh", MSH4, "1\n2\n3\n4\n", "1\n2\n3\n2\n"),
        ("a.inp", INP, "4, 0, 0, 1", "3, 0, 0, 1"),
        ("a.inp", INP, "1, 1, 2, 3, 4\n", "1, 1, 2, 3, 4\n1, 1, 2, 3, 4\n"),
    ] {
        let error = error(name, &text.replace(from, to));
        assert!(matches!(error, FormatError::Repeated { .. }), "{name}: {error}");
    }
}

/// What a format has and is not read is named, with a way out.
#[test]
fn unsupported_variants_say_what_to_do() {
    for (name, text, advice) in [
        ("a.msh", MSH.replace("2.2 0 8", "4.0 0 8"), "4.1 or 2.2"),
        ("a.msh", MSH.replace("2.2 0 8", "2.2 0 4"), "4.1 or 2.2"),
        ("a.vtk", VTK.replace("UNSTRUCTURED_GRID", "STRUCTURED_POINTS"), "unstructured grid"),
        ("a.vtu", VTU.replace("UnstructuredGrid", "PolyData"), "unstructured grid"),
        ("a.vtu", VTU.replace("version=", "compressor=\"vtkLZ4DataCompressor\" version="), "zlib"),
        ("a.inp", INP.replace("*NODE,", "*NODE, SYSTEM=C,"), "rectangular"),
        ("a.inp", INP.replace("*NSET, NSET=NFIX\n1, 3,", "*NGEN\n1, 4, 1"), "listed"),
    ] {
        let error = error(name, &text);
        assert!(error.to_string().contains(advice), "{name}: {error}");
        assert!(matches!(error, FormatError::Unsupported { .. }), "{name}: {error}");
    }
}

/// A file without nodes is refused.
#[test]
fn empty_files() {
    for (name, text) in [("a.inp", "*HEADING\n"), ("a.obj", ""), ("a.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n")] {
        assert!(matches!(error(name, text), FormatError::Empty { .. }), "{name}");
    }
    for (name, text) in [("a.msh", ""), ("a.vtk", ""), ("a.vtu", ""), ("a.mesh", ""), ("a.stl", ""), ("a.ply", "")] {
        error(name, text);
    }
}

/// Text where a number should be names the line and the word.
#[test]
fn words_instead_of_numbers() {
    for (name, text, from, to) in [
        ("a.msh", MSH, "2 1 0 0", "2 one 0 0"),
        ("a.vtk", VTK, "1 0 0", "one 0 0"),
        ("a.inp", INP, "2, 1, 0, 0", "2, one, 0, 0"),
        ("a.mesh", MEDIT, "1 0 0 0", "one 0 0 0"),
        ("a.vtu", VTU, "0 0 0 1 0 0", "0 0 0 one 0 0"),
    ] {
        let error = error(name, &text.replace(from, to));
        assert!(matches!(error, FormatError::Syntax { place: Place::Line(_), .. }), "{name}: {error}");
        assert!(error.to_string().contains("one"), "{name}: {error}");
    }
}

/// Included files come from the caller; their errors name the file; loops and missing files are refused.
#[test]
fn included_files() {
    let mut asked = Vec::new();
    let mut include = |name: &str| {
        asked.push(name.to_owned());
        match name {
            "nodes.inp" => Ok(b"1, 0., 0., 0.\n2, 1.d0, 0, 0\n3, 0, 1\n4, 0, 0, 1".to_vec()),
            "rest.inp" => Ok(b"*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 5\n".to_vec()),
            "loop.inp" => Ok(b"*INCLUDE, INPUT=loop.inp\n".to_vec()),
            _ => Err("no such file".to_owned()),
        }
    };
    let mut with = |text: &str| {
        read("a.inp", text.as_bytes(), ReadOptions { include: Some(&mut include), ..ReadOptions::default() })
    };
    let good = "*NODE, INPUT=nodes.inp\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n";
    assert_eq!(with(good).unwrap().0.nodes[1], [1.0, 0.0, 0.0]);
    let wrong = with("*NODE, INPUT=nodes.inp\n*INCLUDE, INPUT=rest.inp\n").unwrap_err();
    assert!(wrong.to_string().starts_with("rest.inp, line 2: element 1"), "{wrong}");
    assert!(with("*INCLUDE, INPUT=loop.inp\n").unwrap_err().to_string().contains("too often"));
    assert!(with("*INCLUDE, INPUT=\"my file.inp\"\n").unwrap_err().to_string().contains("no such file"));
    assert_eq!(asked.last().map(String::as_str), Some("my file.inp"));
    assert!(matches!(read_text("a.inp", good).unwrap_err(), FormatError::Include { .. }));
}

/// Sets of Abaqus: lists over several lines, ranges, sets of sets, nodes of element sets, any case, spread over the file.
#[test]
fn abaqus_sets() {
    let text = format!(
        "{INP}** a comment\n*Nset, nset=Some, generate\n2, 100, 2\n*NSET, NSET=both\nsome, nfix\n*elset,\n elset=\"my set\"\n\
         eall\n*NSET, NSET=of elements, ELSET=EALL\n*NSET, NSET=SOME\n3\n*NSET, NSET=NFIX\nBOTH\n*NSET, NSET=none\n\
         *MATERIAL, NAME=M\n*ELASTIC\n1e6, 0.3\n"
    );
    let (mesh, report) = read_text("a.inp", &text).unwrap();
    assert_eq!(region(&mesh, "NALL").nodes, [0, 1, 2, 3]);
    assert_eq!(region(&mesh, "Some").nodes, [1, 2, 3]);
    assert_eq!(region(&mesh, "both").nodes, [0, 1, 2, 3]);
    assert_eq!(region(&mesh, "NFIX").nodes, [0, 1, 2, 3]);
    assert_eq!(region(&mesh, "of elements").nodes, [0, 1, 2, 3]);
    assert_eq!(region(&mesh, "none").nodes.len(), 0);
    assert_eq!(region(&mesh, "my set").elements.len(), 1);
    assert_eq!(mesh.regions.len(), 8, "{report}");
    assert_eq!(report.ignored, ["*MATERIAL", "*ELASTIC"]);
    let unknown = error("a.inp", &format!("{INP}*NSET, NSET=A\nB\n"));
    assert!(unknown.to_string().contains("the set B"), "{unknown}");
}

/// The report says in words what was found, skipped, reordered, turned and left over.
#[test]
fn the_report_reads_well() {
    let text = INP.replace("1, 1, 2, 3, 4", "1, 1, 3, 2, 4").replace("*ELEMENT", "9, 1, 0, 0\n*ELEMENT")
        + "*ELEMENT, TYPE=MASS\n5, 1\n6, 2\n*STEP\n";
    let (_, report) = read_text("a.inp", &text).unwrap();
    let expected = "Abaqus input: 5 nodes, 1 elements\n  found      1 tet4\n  skipped    2 × TYPE=MASS: no such element here\n  \
                    flipped    1 tet4 (they were inside out)\n  nodes      1 in no element, 1 at the place of another one\n  \
                    region     EALL: 4 nodes, 1 elements\n  region     NALL: 5 nodes, 0 elements\n  \
                    region     NFIX: 2 nodes, 0 elements\n  ignored    *STEP\n";
    assert_eq!(report.to_string(), expected);
}
