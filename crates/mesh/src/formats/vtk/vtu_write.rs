//! Writing VTU: one piece, little-endian, 64-bit headers.

use super::{LAGRANGE_HEXAHEDRON, REGION_PREFIX, VtkWedge, cell_type};
use crate::Mesh;
use crate::formats::error::FormatError;
use crate::formats::field::{Field, Location, Values, fitted};
use std::fmt::Write as _;
use std::io::Write as _;

/// How the numbers of a VTU file are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VtuEncoding {
    /// Behind the XML, compressed: small and quick.
    #[default]
    AppendedZlib,
    /// Behind the XML, as they are.
    AppendedRaw,
    /// As text inside the XML.
    Text,
}

/// Choices when writing VTU.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VtuOptions {
    /// Storage of the numbers.
    pub encoding: VtuEncoding,
    /// Type of six-node wedges.
    pub wedge: VtkWedge,
    /// Time that the file shows, in seconds.
    pub time: Option<f64>,
}

/// Bytes that are compressed together.
const BLOCK: usize = 1 << 16;

/// The arrays of a file, and the bytes behind the XML.
struct Output {
    xml: String,
    appended: Vec<u8>,
    encoding: VtuEncoding,
}

/// Writes a mesh with fields; regions become arrays of zeros and ones named `region:NAME`.
///
/// # Errors
///
/// [`FormatError::NotWritable`] for a field that does not fit the mesh, and for a region whose name XML cannot hold.
pub fn write_vtu(mesh: &Mesh, fields: &[Field], options: &VtuOptions) -> Result<Vec<u8>, FormatError> {
    let fields = fitted(mesh, fields, "VTU")?;
    if let Some(name) = mesh.regions.keys().find(|n| n.is_empty() || n.chars().any(char::is_control)) {
        return Err(FormatError::NotWritable {
            what: format!("region \"{}\"", name.escape_debug()),
            format: "VTU",
            why: "its name is empty or holds control characters; rename it".to_owned(),
        });
    }
    let mut out = Output { xml: String::new(), appended: Vec::new(), encoding: options.encoding };
    let compressor = match options.encoding {
        VtuEncoding::AppendedZlib => " compressor=\"vtkZLibDataCompressor\"",
        VtuEncoding::AppendedRaw | VtuEncoding::Text => "",
    };
    // The oldest version that allows these headers, so that most programs read it; from 2.2 on the order of the
    // Lagrange hexahedron is the one in use now.
    let lagrange = mesh.blocks.iter().any(|b| b.element.exchange.vtk == LAGRANGE_HEXAHEDRON);
    let version = if lagrange { "2.2" } else { "1.0" };
    let cells: usize = mesh.blocks.iter().map(|b| b.len()).sum();
    let points = mesh.nodes.len();
    let _ = write!(
        out.xml,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"{version}\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\"{compressor}>\n<UnstructuredGrid>\n"
    );
    if let Some(time) = options.time {
        let _ = writeln!(
            out.xml,
            "<FieldData>\n<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">\
             {time:?}</DataArray>\n</FieldData>"
        );
    }
    let _ = writeln!(out.xml, "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">");
    out.data("PointData", mesh, &fields, Location::Nodes);
    out.data("CellData", mesh, &fields, Location::Elements);

    out.xml.push_str("<Points>\n");
    out.array("Float64", "Points", 3, &Values::F64(mesh.nodes.as_flattened().to_vec()));
    out.xml.push_str("</Points>\n<Cells>\n");
    let connectivity = mesh.blocks.iter().flat_map(|b| b.connectivity.iter().map(|&n| i64::from(n)));
    out.array("Int64", "connectivity", 1, &Values::I64(connectivity.collect()));
    let sizes = mesh.blocks.iter().flat_map(|b| std::iter::repeat_n(b.element.node_count() as i64, b.len()));
    let ends = sizes.scan(0, |end, size| {
        *end += size;
        Some(*end)
    });
    out.array("Int64", "offsets", 1, &Values::I64(ends.collect()));
    let types = mesh.blocks.iter().flat_map(|b| std::iter::repeat_n(cell_type(b.element, options.wedge), b.len()));
    out.array("UInt8", "types", 1, &Values::I64(types.map(i64::from).collect()));
    out.xml.push_str("</Cells>\n</Piece>\n</UnstructuredGrid>\n");

    let Output { xml, appended, encoding } = out;
    let mut bytes = xml.into_bytes();
    if encoding != VtuEncoding::Text {
        bytes.extend_from_slice(b"<AppendedData encoding=\"raw\">\n_");
        bytes.extend_from_slice(&appended);
        bytes.extend_from_slice(b"\n</AppendedData>\n");
    }
    bytes.extend_from_slice(b"</VTKFile>\n");
    Ok(bytes)
}

impl Output {
    fn data(&mut self, section: &str, mesh: &Mesh, fields: &[Field], location: Location) {
        let _ = writeln!(self.xml, "<{section}>");
        for field in fields.iter().filter(|f| f.location == location) {
            let of = if matches!(field.values, Values::F64(_)) { "Float64" } else { "Int64" };
            self.array(of, &field.name, field.components, &field.values);
        }
        for (name, flags) in region_flags(mesh, location) {
            let values = Values::I64(flags.into_iter().map(i64::from).collect());
            self.array("UInt8", &format!("{REGION_PREFIX}{name}"), 1, &values);
        }
        let _ = writeln!(self.xml, "</{section}>");
    }

    fn array(&mut self, of: &str, name: &str, components: usize, values: &Values) {
        let name = escaped(name);
        let _ = write!(self.xml, "<DataArray type=\"{of}\" Name=\"{name}\" ");
        if components > 1 {
            let _ = write!(self.xml, "NumberOfComponents=\"{components}\" ");
        }
        if self.encoding == VtuEncoding::Text {
            let _ = writeln!(self.xml, "format=\"ascii\">\n{}</DataArray>", rows(values, components));
            return;
        }
        let _ = writeln!(self.xml, "format=\"appended\" offset=\"{}\"/>", self.appended.len());
        let bytes: Vec<u8> = match values {
            Values::F64(v) => v.iter().flat_map(|x| x.to_le_bytes()).collect(),
            Values::I64(v) if of == "UInt8" => v.iter().map(|&n| n as u8).collect(),
            Values::I64(v) => v.iter().flat_map(|n| n.to_le_bytes()).collect(),
        };
        let mut number = |n: usize| self.appended.extend_from_slice(&(n as u64).to_le_bytes());
        if self.encoding == VtuEncoding::AppendedRaw {
            number(bytes.len());
            self.appended.extend_from_slice(&bytes);
            return;
        }
        let blocks: Vec<Vec<u8>> = bytes.chunks(BLOCK).map(deflated).collect();
        [blocks.len(), BLOCK, bytes.len() % BLOCK].into_iter().for_each(&mut number);
        blocks.iter().for_each(|b| number(b.len()));
        self.appended.extend(blocks.into_iter().flatten());
    }
}

fn deflated(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).expect("writing to memory cannot fail");
    encoder.finish().expect("writing to memory cannot fail")
}

/// The regions that list nodes, or elements, as one flag for each node or element.
///
/// An empty region lists (no) nodes, so that its name survives.
pub(super) fn region_flags(mesh: &Mesh, location: Location) -> Vec<(&str, Vec<u8>)> {
    let mut starts = vec![0];
    for block in &mesh.blocks {
        starts.push(starts.last().copied().unwrap_or(0) + block.len());
    }
    let elements = starts.last().copied().unwrap_or(0);
    let mut all = Vec::new();
    for (name, region) in &mesh.regions {
        let mut flags = Vec::new();
        match location {
            Location::Nodes if !region.nodes.is_empty() || region.elements.is_empty() => {
                flags.resize(mesh.nodes.len(), 0);
                region.nodes.iter().for_each(|&n| flags[n as usize] = 1);
            }
            Location::Elements if !region.elements.is_empty() => {
                flags.resize(elements, 0);
                region.elements.iter().for_each(|e| flags[starts[e.block as usize] + e.index as usize] = 1);
            }
            _ => continue,
        }
        all.push((name.as_str(), flags));
    }
    all
}

/// Numbers as text, one tuple per line; a real number has as many digits as it needs to be read back exactly.
pub(super) fn rows(values: &Values, components: usize) -> String {
    let mut text = String::new();
    let mut number = |at: usize, value: &dyn std::fmt::Debug| {
        let separator = if (at + 1).is_multiple_of(components) { '\n' } else { ' ' };
        let _ = write!(text, "{value:?}{separator}");
    };
    match values {
        // VTK reads "nan", not "NaN".
        Values::F64(v) => v
            .iter()
            .enumerate()
            .for_each(|(at, x)| if x.is_nan() { number(at, &format_args!("nan")) } else { number(at, x) }),
        Values::I64(v) => v.iter().enumerate().for_each(|(at, n)| number(at, n)),
    }
    text
}

/// Text inside an attribute of XML.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
