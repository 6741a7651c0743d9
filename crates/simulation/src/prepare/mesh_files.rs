//! The files of a mesh: the one that a scene names, and those that it includes.
//!
//! What it is not: a reader of meshes. Whoever has to know of everything that a simulation depends on asks here.

use super::meshes::Read;
use souple_mesh::formats::{self, Format, ReadOptions};

/// Path of a file that the mesh file at `path` includes under `name`: it lies beside it.
pub(super) fn beside(path: &str, name: &str) -> String {
    match path.rsplit_once('/') {
        Some((folder, _)) if !name.starts_with('/') => format!("{folder}/{name}"),
        _ => name.to_owned(),
    }
}

/// Every file that reading the mesh at `path` reads, itself first: path, and bytes where it could be read.
///
/// `read` gives the bytes of a file by its path. A file that is no mesh is listed all the same; of what it includes, what
/// comes before the mistake.
pub fn mesh_files(path: &str, read: Read<'_>) -> Vec<(String, Option<Vec<u8>>)> {
    let Ok(bytes) = read(path) else { return vec![(path.to_owned(), None)] };
    let mut included = Vec::new();
    // Only this format includes files; the others need not be read twice.
    if formats::detect(path, &bytes).is_ok_and(|format| format == Format::Abaqus) {
        let mut note = |name: &str| {
            let path = beside(path, name);
            let found = read(&path);
            included.push((path, found.as_ref().ok().cloned()));
            found
        };
        // Mistakes are the simulation's to report.
        let _ = formats::read(path, &bytes, ReadOptions { include: Some(&mut note), ..ReadOptions::default() });
    }
    let mut all = vec![(path.to_owned(), Some(bytes))];
    all.append(&mut included);
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The files that a mesh includes are found beside it, also those of a file that it includes, and one that is missing
    /// is listed without bytes; a mesh that includes nothing is one file.
    #[test]
    fn included_files_belong_to_a_mesh() {
        let mut read = |path: &str| match path {
            "folder/a.inp" => Ok(b"*NODE\n1, 0, 0, 0\n*INCLUDE, INPUT=b.inp\n*INCLUDE, INPUT=gone.inp\n".to_vec()),
            "folder/b.inp" => Ok(b"*NODE\n2, 1, 0, 0\n".to_vec()),
            "plain.mesh" => Ok(b"MeshVersionFormatted 2\nDimension 3\nEnd\n".to_vec()),
            _ => Err("no such file".to_owned()),
        };
        let names = |files: &[(String, Option<Vec<u8>>)]| {
            files.iter().map(|(path, bytes)| (path.clone(), bytes.is_some())).collect::<Vec<_>>()
        };
        let found = names(&mesh_files("folder/a.inp", &mut read));
        let expected = [("folder/a.inp", true), ("folder/b.inp", true), ("folder/gone.inp", false)];
        assert_eq!(found, expected.map(|(path, there)| (path.to_owned(), there)));
        assert_eq!(names(&mesh_files("plain.mesh", &mut read)), [("plain.mesh".to_owned(), true)]);
        assert_eq!(names(&mesh_files("none.vtu", &mut read)), [("none.vtu".to_owned(), false)]);
    }
}
