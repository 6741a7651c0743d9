//! Which format a file is in: by content where the format has a signature, by name otherwise.

use super::error::FormatError;

/// The formats that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Gmsh MSH.
    Msh,
    /// VTK XML unstructured grid.
    Vtu,
    /// Legacy VTK.
    LegacyVtk,
    /// Abaqus or CalculiX input.
    Abaqus,
    /// MEDIT text.
    Medit,
    /// Stereolithography.
    Stl,
    /// Wavefront object.
    Obj,
    /// Polygon file format.
    Ply,
}

/// How far into a file its signature is looked for.
const HEAD: usize = 2048;

/// The format of a file.
///
/// # Errors
///
/// [`FormatError::UnknownFormat`] when neither content nor name (a file name, or an extension) tell.
pub fn detect(name: &str, bytes: &[u8]) -> Result<Format, FormatError> {
    if let Some(format) = signature(bytes) {
        return Ok(format);
    }
    let extension = name.rsplit(['.', '/', '\\']).next().unwrap_or(name).to_ascii_lowercase();
    let advice = match extension.as_str() {
        "msh" => return Ok(Format::Msh),
        "vtu" => return Ok(Format::Vtu),
        "vtk" => return Ok(Format::LegacyVtk),
        "inp" => return Ok(Format::Abaqus),
        "mesh" => return Ok(Format::Medit),
        "stl" => return Ok(Format::Stl),
        "obj" => return Ok(Format::Obj),
        "ply" => return Ok(Format::Ply),
        "pvtu" | "pvd" | "vtm" => "it only names other files: read one of those",
        "meshb" => "binary MEDIT: save it as .mesh",
        "vtp" | "vtkhdf" | "xdmf" | "feb" | "frd" | "bdf" | "nas" | "exo" | "e" | "step" | "stp" | "geo" => {
            "convert it, for example with Gmsh or meshio, to .msh or .vtu"
        }
        _ => "the formats are .msh, .vtu, .vtk, .inp, .mesh, .stl, .obj and .ply",
    };
    Err(FormatError::UnknownFormat { name: name.to_owned(), advice: advice.to_owned() })
}

fn signature(bytes: &[u8]) -> Option<Format> {
    let head = &bytes[..bytes.len().min(HEAD)];
    let has = |needle: &[u8]| head.windows(needle.len()).any(|w| w == needle);
    let start = head.trim_ascii_start();
    if has(b"$MeshFormat") {
        Some(Format::Msh)
    } else if has(b"<VTKFile") {
        Some(Format::Vtu)
    } else if start.starts_with(b"# vtk DataFile") {
        Some(Format::LegacyVtk)
    } else if start.starts_with(b"*") {
        Some(Format::Abaqus)
    } else if has(b"MeshVersionFormatted") {
        Some(Format::Medit)
    } else if start.starts_with(b"ply\n") || start.starts_with(b"ply\r") {
        Some(Format::Ply)
    } else if super::stl::is_binary(bytes) || (start.starts_with(b"solid") && has(b"facet")) {
        Some(Format::Stl)
    } else {
        None
    }
}
