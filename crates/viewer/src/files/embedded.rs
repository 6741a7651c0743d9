//! The bundled scenes inside the program, under the names that they have in the repository.

use std::path::{Path, PathBuf};

// `FILES`: names and contents, as the build script found them.
include!(concat!(env!("OUT_DIR"), "/embedded.rs"));

fn find(name: &str) -> Option<&'static [u8]> {
    FILES.iter().find(|f| f.0 == name).map(|f| f.1)
}

/// A file's content.
///
/// # Errors
/// That there is no such file, and which scenes there are.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, String> {
    let found = path.to_str().and_then(find).map(<[u8]>::to_vec);
    found.ok_or_else(|| {
        let known: Vec<String> = scenes().iter().map(|p| p.display().to_string()).collect();
        format!("there is no file {} in this page; its scenes are {}", path.display(), known.join(", "))
    })
}

/// The scenes, in order of their names.
pub(crate) fn scenes() -> Vec<PathBuf> {
    FILES.iter().filter(|f| f.0.ends_with(".toml")).map(|f| PathBuf::from(f.0)).collect()
}

/// The picture of a scene as a PNG file, if there is one.
pub(crate) fn picture(scene: &Path) -> Option<Vec<u8>> {
    let name = scene.file_stem()?.to_str()?;
    find(&format!("docs/pictures/scenes/{name}.png")).map(<[u8]>::to_vec)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::disk;
    use souple_simulation::{RunOptions, Simulation};

    /// Every bundled scene is here as it is on the disk, with its picture, and needs no file that is not here.
    #[test]
    fn a_page_has_every_bundled_scene() {
        let on_disk = disk::scenes();
        let names =
            |paths: &[PathBuf]| -> Vec<_> { paths.iter().map(|p| p.file_name().map(ToOwned::to_owned)).collect() };
        assert_eq!(names(&scenes()), names(&on_disk));
        for (here, there) in scenes().iter().zip(&on_disk) {
            let text = read(here).unwrap();
            assert_eq!(text, disk::read(there).unwrap());
            assert_eq!(picture(here), disk::picture(there), "{}", here.display());
            let mut beside = |file: &str| read(&here.parent().unwrap().join(file));
            let text = String::from_utf8(text).unwrap();
            let options = RunOptions { threads: 1, ..RunOptions::default() };
            Simulation::load(&text, &here.display().to_string(), &[], &mut beside, &options).unwrap();
        }
    }

    /// A scene that is not here is refused with its name and those that are.
    #[test]
    fn an_unknown_scene_is_named() {
        let message = read(Path::new("scenes/sponge.toml")).unwrap_err();
        assert!(message.contains("scenes/sponge.toml") && message.contains("scenes/mixed_bar.toml"), "{message}");
    }
}
