//! The mesh of each body: generated or read, in metres, fit to compute with.
//!
//! ```text
//! [body.mesh] ── generate | read, scale ──► mesh ── check ──► mesh without inverted elements ── tidy ──► mesh whose
//! every node belongs to a deformable element
//! ```

use super::PreparedBody;
use super::check::check;
use super::constraints;
use super::embedded;
use super::error::Findings;
use super::mesh_files::beside;
use souple_mesh::bar::{self, BarError, BarSpec, MismatchKind, Section, Split};
use souple_mesh::constraint::Conformity;
use souple_mesh::formats::{self, ReadOptions};
use souple_mesh::topology::{Interface, Topology, interfaces};
use souple_mesh::{Mesh, bar::Axis};
use souple_scene::body::Body;
use souple_scene::conforming::Conforming;
use souple_scene::mesh::{Bar, Mesh as MeshSource, MeshFile, Transition};
use souple_scene::{Location, choice};

/// Gives the bytes of a file that the scene names, or says why not.
pub type Read<'a> = &'a mut dyn FnMut(&str) -> Result<Vec<u8>, String>;

/// The mesh of a body, what makes it conform, and what was done to get it; `None` after a problem was noted.
pub(super) fn mesh_of(body: &Body, read: Read<'_>, findings: &mut Findings) -> Option<PreparedBody> {
    let name = &body.name.value;
    let at = place(body);
    let (mesh, report) = match &body.mesh.value {
        MeshSource::Bar(bar) => generated(bar, body, findings)?,
        MeshSource::File(file) => from_file(file, name, read, findings)?,
    };
    let dimension = embedded::space(body, &mesh);
    let mut prepared = PreparedBody {
        name: name.clone(),
        mesh,
        first_node: 0,
        first_element: 0,
        elements: Vec::new(),
        dimension,
        conformity: Conformity::default(),
        report,
    };
    let claimed = embedded::claimed(body, &prepared);
    check(&mut prepared, &claimed, body, at, findings)?;
    // Elements that hang on nothing are gone, and the others have moved up.
    let highest = prepared.mesh.dimension();
    let ids = prepared.mesh.element_ids();
    prepared.elements = ids.filter(|id| prepared.element(*id).dimension() == highest).collect();
    prepared.elements.extend(embedded::claimed(body, &prepared));
    // Surfaces and lines in space may branch: nothing is asked of their gluing, and nothing makes it conform.
    if highest < dimension {
        return Some(prepared);
    }
    let topology = match Topology::new(&prepared.mesh) {
        Ok(topology) => topology,
        Err(error) => {
            findings.problem(at, format!("mesh of body \"{name}\": {error}"));
            return None;
        }
    };
    if matches!(body.mesh.value, MeshSource::File(_)) {
        warn_of_interfaces(&topology, body, at, findings);
    }
    let PreparedBody { mesh, report, .. } = &mut prepared;
    prepared.conformity = constraints::of_body(mesh, &topology, body, at, report, findings)?;
    Some(prepared)
}

/// Where the scene says what the mesh is.
pub(super) fn place(body: &Body) -> &Location {
    match &body.mesh.value {
        MeshSource::File(file) => &file.path.at,
        MeshSource::Bar(_) => &body.mesh.at,
    }
}

fn generated(source: &Bar, body: &Body, findings: &mut Findings) -> Option<(Mesh, String)> {
    let spec = bar_spec(source, findings)?;
    let (mesh, report) = match bar::generate(&spec) {
        Ok(made) => made,
        Err(error) => {
            findings
                .problem(bar_place(&error, source, &body.mesh.at), format!("bar of body \"{}\": {error}", *body.name));
            return None;
        }
    };
    // Constraints make different interpolations conform.
    let tied = |kind: MismatchKind| kind == MismatchKind::DifferentInterpolation && body.conforming == Conforming::Auto;
    for mismatch in report.mismatches.iter().filter(|m| !tied(m.kind)) {
        let [from, to] = mismatch.elements;
        let how = match mismatch.kind {
            MismatchKind::QuadrangleAgainstTriangles => "a quadrangle meets two triangles",
            MismatchKind::CrossedDiagonals => "two triangles meet two others across the other diagonal",
            MismatchKind::DifferentInterpolation => "the two sides interpolate differently",
        };
        let cure = match mismatch.kind {
            MismatchKind::DifferentInterpolation => {
                "give both sections elements of the same degree, or drop `conforming = \"off\"`"
            }
            _ => "write `transition = \"pyramids\"` in [body.mesh] to put a matching layer between them",
        };
        let message = format!(
            "body \"{}\": between {from} and {to}, on {} faces {how}, so displacements are not continuous there; {cure}",
            *body.name, mismatch.faces
        );
        let section = source.sections.get(mismatch.sections[1]).map_or(&body.mesh.at, |section| &section.at);
        findings.warning(section, message);
    }
    let counts: Vec<String> = mesh.blocks.iter().map(|b| format!("{} {}", b.len(), b.element.id)).collect();
    let mut text = format!("bar: {} nodes, {}", mesh.nodes.len(), counts.join(", "));
    if report.transition_cells > 0 {
        text.push_str(&format!(", {} transition cells", report.transition_cells));
    }
    text.push('\n');
    Some((mesh, text))
}

fn bar_spec(source: &Bar, findings: &mut Findings) -> Option<BarSpec> {
    use souple_elements::Family;
    let axis = match source.prism_axis {
        choice::Axis::X => Axis::X,
        choice::Axis::Y => Axis::Y,
        choice::Axis::Z => Axis::Z,
    };
    let mut sections = Vec::with_capacity(source.sections.len());
    for section in &source.sections {
        let Some(element) = souple_elements::by_id(&section.element) else {
            let message = format!("there is no element `{}`; `souple list elements` shows them", *section.element);
            findings.problem(&section.element.at, message);
            return None;
        };
        let split = match element.family {
            Family::Tetrahedron if source.tetrahedra == 5 => Split::Tetrahedra5,
            Family::Tetrahedron => Split::Tetrahedra6,
            Family::Prism => Split::Prisms(axis),
            _ => Split::Usual,
        };
        sections.push(Section { until: section.until, element, split });
    }
    let transition = match source.transition {
        Transition::Keep => bar::Transition::Keep,
        Transition::Pyramids => bar::Transition::InsertPyramids,
    };
    let cells = source.cells.value.map(|count| count as usize);
    Some(BarSpec { size: source.size.value, cells, origin: source.origin, sections, transition })
}

/// Where the value stands that a generator refuses.
fn bar_place<'s>(error: &BarError, source: &'s Bar, otherwise: &'s Location) -> &'s Location {
    let section = |at: usize| source.sections.get(at).map_or(otherwise, |section| &section.at);
    match *error {
        BarError::Size { .. } => &source.size.at,
        BarError::Cells { .. } | BarError::TooMany { .. } => &source.cells.at,
        BarError::Until { section: at, .. }
        | BarError::EmptySection { section: at, .. }
        | BarError::MixedDimensions { section: at, .. }
        | BarError::Split { section: at, .. } => section(at),
        BarError::DifferentInterpolation { sections, .. } | BarError::NoTransition { sections, .. } => {
            section(sections[1])
        }
        BarError::NoSection | BarError::Origin { .. } | BarError::Unfilled { .. } => otherwise,
    }
}

fn from_file(file: &MeshFile, body: &str, read: Read<'_>, findings: &mut Findings) -> Option<(Mesh, String)> {
    let (path, at) = (file.path.value.as_str(), &file.path.at);
    let bytes = match read(path) {
        Ok(bytes) => bytes,
        Err(why) => {
            findings.problem(at, format!("the mesh of body \"{body}\" cannot be read from \"{path}\": {why}"));
            return None;
        }
    };
    // Included files lie beside the mesh file that names them.
    let mut included = |name: &str| read(&beside(path, name));
    let options = ReadOptions { include: Some(&mut included), ..ReadOptions::default() };
    let (mut mesh, report) = match formats::read(path, &bytes, options) {
        Ok(found) => found,
        Err(error) => {
            findings.problem(at, format!("mesh file \"{path}\": {error}"));
            return None;
        }
    };
    mesh.nodes.iter_mut().flatten().for_each(|x| *x *= file.scale);
    let flipped: usize = report.flipped.values().sum();
    if flipped > 0 {
        let message = format!("mesh file \"{path}\": {flipped} elements were inside out; their nodes were reordered");
        findings.warning(at, message);
    }
    // A mesher's points are nodes of other elements as well; leaving them out changes nothing.
    for skipped in report.skipped.iter().filter(|s| !s.why.starts_with("a point is a node")) {
        let message = format!("mesh file \"{path}\": {} × {} left out: {}", skipped.count, skipped.what, skipped.why);
        findings.warning(at, message);
    }
    Some((mesh, report.to_string()))
}

/// Warns of faces in a file's mesh that lie on each other without being the same.
fn warn_of_interfaces(topology: &Topology, body: &Body, at: &Location, findings: &mut Findings) {
    let name = &*body.name;
    let (mut quadrangles, mut crossed, mut degrees) = (0, 0, 0);
    for interface in interfaces(topology) {
        match interface {
            Interface::QuadrangleAgainstTriangles { .. } => quadrangles += 1,
            Interface::CrossedDiagonals { .. } => crossed += 1,
            // Constraints make these conform.
            Interface::DifferentInterpolation { .. } => degrees += u32::from(body.conforming == Conforming::Off),
        }
    }
    let cases = [
        (quadrangles, "a quadrangle meets triangles", "put pyramids between them in the mesher"),
        (crossed, "two triangles meet two others across the other diagonal", "let both sides share one diagonal"),
        (
            degrees,
            "the two sides interpolate differently",
            "use elements of one degree on both sides, or drop `conforming = \"off\"`",
        ),
    ];
    for (count, how, cure) in cases.into_iter().filter(|case| case.0 > 0) {
        let message = format!(
            "body \"{name}\": on {count} inner faces {how}, so displacements are not continuous there; {cure} (generated \
             bars: `transition = \"pyramids\"`)"
        );
        findings.warning(at, message);
    }
    if !topology.folded.is_empty() {
        let message = format!(
            "body \"{name}\": {} pairs of elements lie on the same side of their common face and overlap; check the mesh",
            topology.folded.len()
        );
        findings.warning(at, message);
    }
}
