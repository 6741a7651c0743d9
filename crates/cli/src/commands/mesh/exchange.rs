//! Mesh files on disk: which reader or writer a path means, and the three files of a mixed model taken together.

use super::{Style, Wedge};
use crate::failure::{Failure, input};
use crate::files;
use crate::terminal::note;
use anyhow::Context as _;
use souple_simulation::mesh::formats::{
    self, ImportReport, MshVersion, ReadOptions, VtkWedge, VtuEncoding, VtuOptions, write_inp, write_msh, write_vtk,
    write_vtu,
};
use souple_simulation::mesh::triple::{self, Triple, associate};
use souple_simulation::mesh::{Mesh, check};
use std::path::{Path, PathBuf};

/// A mesh that was read.
pub(super) struct Imported {
    /// The mesh, with the associations of a mixed model where the files have them.
    pub(super) triple: Triple,
    /// What reading had to report; none for the three files, which hold nothing that is not read.
    pub(super) report: Option<ImportReport>,
    /// The same in words.
    pub(super) account: String,
}

/// The endings of the three files of a mixed model.
const TRIPLE: [&str; 3] = ["obj", "element", "info"];

fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

/// Reads a mesh file; a file of a mixed model with its two neighbours.
pub(super) fn read(path: &Path) -> Result<Imported, Failure> {
    let kind = extension(path);
    let neighbour = |e: &str| path.with_extension(e);
    // An .obj alone is a surface.
    let is_triple = match kind.as_str() {
        "element" | "info" => true,
        "obj" => neighbour("element").is_file() && neighbour("info").is_file(),
        _ => false,
    };
    if is_triple {
        return read_triple(path);
    }
    let bytes = files::read(path)?;
    let folder = path.parent().map(Path::to_owned).unwrap_or_default();
    let mut include = |name: &str| std::fs::read(folder.join(name)).map_err(|e| e.to_string());
    let options = ReadOptions { include: Some(&mut include), ..ReadOptions::default() };
    let name = path.display().to_string();
    let (mesh, report) = formats::read(&name, &bytes, options).with_context(|| name.clone())?;
    let account = report.to_string();
    Ok(Imported { triple: Triple { mesh, ..Triple::default() }, report: Some(report), account })
}

fn read_triple(path: &Path) -> Result<Imported, Failure> {
    let [obj, element, info] = TRIPLE.map(|e| path.with_extension(e));
    let texts = [files::read_text(&obj)?, files::read_text(&element)?, files::read_text(&info)?];
    let triple =
        triple::read(&texts[0], &texts[1], &texts[2]).with_context(|| path.with_extension("").display().to_string())?;
    check::validate(&triple.mesh).with_context(|| path.display().to_string())?;
    let (nodes, elements) = (triple.mesh.nodes.len(), triple.order.len());
    let account = format!("mixed model: {nodes} nodes, {elements} elements");
    Ok(Imported { triple, report: None, account })
}

/// What is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Writer {
    Msh,
    Vtu,
    Vtk,
    Inp,
    Triple,
}

impl Writer {
    /// What a path's ending means.
    pub(super) fn of(path: &Path) -> Result<Writer, Failure> {
        match extension(path).as_str() {
            "msh" => Ok(Writer::Msh),
            "vtu" => Ok(Writer::Vtu),
            "vtk" => Ok(Writer::Vtk),
            "inp" => Ok(Writer::Inp),
            e if TRIPLE.contains(&e) => Ok(Writer::Triple),
            _ => Err(input(format!(
                "cannot write {}: its ending is no format that is written; use .msh, .vtu, .vtk, .inp, or .element for \
                 the three files of a mixed model",
                path.display()
            ))),
        }
    }
}

/// The files of a mesh in a format: paths and bytes.
pub(super) fn encode(
    writer: Writer,
    path: &Path,
    model: &Triple,
    style: &Style,
) -> Result<Vec<(PathBuf, Vec<u8>)>, Failure> {
    let mesh: &Mesh = &model.mesh;
    let wedge = match style.vtk_wedge {
        Wedge::Positive => VtkWedge::PositiveJacobian,
        Wedge::Lagrange => VtkWedge::Lagrange,
    };
    let bytes = match writer {
        Writer::Msh => write_msh(mesh, if style.ascii { MshVersion::V41Text } else { MshVersion::V41Binary }),
        Writer::Vtu => {
            let encoding = if style.ascii { VtuEncoding::Text } else { VtuEncoding::default() };
            write_vtu(mesh, &[], &VtuOptions { encoding, wedge, time: None })
        }
        Writer::Vtk => write_vtk(mesh, &[], wedge),
        Writer::Inp => write_inp(mesh),
        Writer::Triple => return encode_triple(path, model, &style.law),
    };
    let bytes = bytes.with_context(|| format!("cannot write {}", path.display()))?;
    Ok(vec![(path.to_owned(), bytes)])
}

fn encode_triple(path: &Path, model: &Triple, law: &str) -> Result<Vec<(PathBuf, Vec<u8>)>, Failure> {
    if law.is_empty() || law.contains(char::is_whitespace) {
        return Err(input(format!("--law \"{law}\": expected one word, such as SaintVenant")));
    }
    let made;
    let laws: Vec<&str> = model.associations.iter().map(|a| a.law.as_str()).collect();
    let model = if model.associations.is_empty() {
        made = associate(model.mesh.clone(), |_| law.to_owned());
        &made
    } else {
        model
    };
    let lost: Vec<&str> = model.mesh.regions.keys().map(String::as_str).filter(|r| !laws.contains(r)).collect();
    if !lost.is_empty() {
        note(&format!("warning: the three files hold no regions but those of laws; not written: {}", lost.join(", ")));
    }
    let text = triple::write(model);
    let contents = [text.obj, text.element, text.info];
    Ok(TRIPLE.iter().zip(contents).map(|(e, text)| (path.with_extension(e), text.into_bytes())).collect())
}
