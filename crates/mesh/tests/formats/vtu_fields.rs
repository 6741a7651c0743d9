//! Fields beside the mesh.

use crate::menagerie::menagerie;
use souple_mesh::Mesh;
use souple_mesh::formats::{
    Field, FormatError, Location, PvdEntry, ReadOptions, Values, VtkWedge, VtuEncoding, VtuOptions,
    read_vtu_with_fields, write_pvd, write_vtk, write_vtu,
};

/// A field of this many components with values that need all their digits.
fn field(mesh: &Mesh, name: &str, components: usize, location: Location, integers: bool) -> Field {
    let tuples = match location {
        Location::Nodes => mesh.nodes.len(),
        Location::Elements => mesh.blocks.iter().map(|b| b.len()).sum(),
    };
    let count = tuples * components;
    let values = if integers {
        Values::I64((0..count as i64).map(|i| i * i * 1_000_003 - 7).collect())
    } else {
        Values::F64((0..count).map(|i| (i as f64).sqrt() * 1e-7 - 0.1).collect())
    };
    Field { name: name.to_owned(), components, location, values }
}

/// Scalars, vectors and tensors, real and whole, at nodes and elements, come back bit for bit in every encoding.
#[test]
fn fields_survive() {
    let mesh = menagerie(|_| true);
    let mut fields = Vec::new();
    for location in [Location::Nodes, Location::Elements] {
        for components in [1, 3, 9] {
            fields.push(field(&mesh, &format!("real \"{components}\" <m>"), components, location, false));
            fields.push(field(&mesh, &format!("whole {components}"), components, location, true));
        }
    }
    for encoding in [VtuEncoding::AppendedZlib, VtuEncoding::AppendedRaw, VtuEncoding::Text] {
        let bytes = write_vtu(&mesh, &fields, &VtuOptions { encoding, ..VtuOptions::default() }).unwrap();
        let (back, read, _) = read_vtu_with_fields(&bytes, ReadOptions::default()).unwrap();
        crate::assert_same(&mesh, &back, "with fields");
        assert_eq!(read, fields, "{encoding:?}");
    }
    assert!(write_vtk(&mesh, &fields, VtkWedge::default()).is_ok());
}

/// Writing twice gives the same bytes.
#[test]
fn writing_is_deterministic() {
    let mesh = menagerie(|_| true);
    let write = || write_vtu(&mesh, &[], &VtuOptions::default()).unwrap();
    assert_eq!(write(), write());
}

/// A field of the solids alone is spread: lower elements get NaN, or -1.
#[test]
fn fields_of_the_highest_dimension_are_spread() {
    let mesh = menagerie(|e| matches!(e.id, "tri3" | "tet4"));
    let solids =
        |name: &str, values| Field { name: name.to_owned(), components: 1, location: Location::Elements, values };
    let fields = [solids("real", Values::F64(vec![1.5, 2.5])), solids("whole", Values::I64(vec![4, 5]))];
    for encoding in [VtuEncoding::AppendedZlib, VtuEncoding::Text] {
        let bytes = write_vtu(&mesh, &fields, &VtuOptions { encoding, ..VtuOptions::default() }).unwrap();
        let (_, read, _) = read_vtu_with_fields(&bytes, ReadOptions::default()).unwrap();
        let Values::F64(real) = &read[0].values else { panic!("real numbers were written") };
        assert!(real[0].is_nan() && real[1].is_nan() && real[2..] == [1.5, 2.5], "{real:?}");
        assert_eq!(read[1].values, Values::I64(vec![-1, -1, 4, 5]));
    }
}

/// A field that does not fit is refused with both counts; so are two fields of one name and odd component counts.
#[test]
fn fields_that_do_not_fit_are_refused() {
    let mesh = menagerie(|e| matches!(e.id, "tri3" | "tet4"));
    let refusal = |fields: &[Field]| match write_vtu(&mesh, fields, &VtuOptions::default()) {
        Err(error @ FormatError::NotWritable { .. }) => error.to_string(),
        other => panic!("{other:?}"),
    };
    let good = field(&mesh, "u", 3, Location::Nodes, false);
    let short = Field { values: Values::F64(vec![0.0; 5]), ..good.clone() };
    let nodes = mesh.nodes.len();
    let message = refusal(std::slice::from_ref(&short));
    assert!(message.contains(&(3 * nodes).to_string()) && message.contains('5'), "{message}");
    assert!(refusal(&[good.clone(), good.clone()]).contains("same name"));
    assert!(refusal(&[Field { components: 2, ..good.clone() }]).contains("2 components"));
    assert!(write_vtk(&mesh, &[short], VtkWedge::default()).is_err());
}

/// Fields of a file in which elements of several kinds alternate follow their elements into the blocks.
#[test]
fn fields_follow_reordered_elements() {
    let text = "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\"><UnstructuredGrid>\
        <Piece NumberOfPoints=\"4\" NumberOfCells=\"3\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" \
        format=\"ascii\">0 0 0 1 0 0 1 1 0 0 1 0</DataArray></Points><Cells><DataArray type=\"Int32\" \
        Name=\"connectivity\" format=\"ascii\">0 1 2 0 1 2 3 0 2 3</DataArray><DataArray type=\"Int32\" Name=\"offsets\" \
        format=\"ascii\">3 7 10</DataArray><DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">5 9 5</DataArray>\
        </Cells><CellData><DataArray type=\"Float32\" Name=\"t\" format=\"ascii\">1 2 3</DataArray></CellData></Piece>\
        </UnstructuredGrid></VTKFile>";
    let (mesh, fields, _) = read_vtu_with_fields(text.as_bytes(), ReadOptions::default()).unwrap();
    assert_eq!((mesh.blocks[0].len(), mesh.blocks[1].len()), (2, 1));
    assert_eq!(fields[0].values, Values::F64(vec![1.0, 3.0, 2.0]));
}

/// A time series names its files with their times, escaped.
#[test]
fn pvd_lists_times_and_files() {
    let entries =
        [PvdEntry { time: 0.0, file: "a&b_0.vtu".to_owned() }, PvdEntry { time: 0.1, file: "a_1.vtu".to_owned() }];
    let text = write_pvd(&entries);
    let document = roxmltree::Document::parse(&text).unwrap();
    let steps: Vec<(&str, &str)> = document
        .descendants()
        .filter(|n| n.has_tag_name("DataSet"))
        .map(|n| (n.attribute("timestep").unwrap(), n.attribute("file").unwrap()))
        .collect();
    assert_eq!(steps, [("0.0", "a&b_0.vtu"), ("0.1", "a_1.vtu")]);
}
