//! A campaign from its folder to its results.

use crate::database::{Database, DatabaseError, Machine, Member, add_group, recorded_in};
use crate::folder;
use crate::group::Group;
use crate::identity::{Identity, Source, Surroundings, identify, sha256};
use crate::plan::{Planned, plan};
use crate::problem::Problems;
use crate::traction::traction;
use crate::worker::{Job, Workshop, remove_leftovers};
use souple_simulation::prepare::mesh_files;
use souple_simulation::scene::Scene;
use souple_simulation::scene::body::Body;
use souple_simulation::scene::integrator::Method;
use souple_simulation::scene::mesh::Mesh;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// A group whose simulations have their hashes, and what of them is to do.
#[derive(Debug)]
pub struct Prepared {
    /// Its id in the database.
    pub group: i64,
    /// Members of the group.
    pub members: usize,
    /// Simulations that are not done, each once.
    pub jobs: Vec<Job>,
    /// Where they run.
    pub workshop: Workshop,
}

/// Reads the description in a folder.
///
/// # Errors
///
/// Everything that is wrong with it.
pub fn read(folder: &Path) -> Result<Group, Problems> {
    let text = |path: &Path| fs::read_to_string(path).map_err(|e| format!("cannot read {}: {e}", path.display()));
    let name = fs::canonicalize(folder).ok().and_then(|f| f.file_name().map(|n| n.to_string_lossy().into_owned()));
    let toml = folder.join("campaign.toml");
    if toml.is_file() || !folder.join("params.csv").is_file() {
        let text_of = text(&toml).map_err(|why| {
            let message =
                format!("{why}; a campaign is a folder with campaign.toml, or with params.csv and barres.csv");
            let mut problems = Problems::default();
            problems.add(&folder.display().to_string(), 0, message);
            problems
        })?;
        let mut read = |path: &Path| text(path);
        return crate::description::parse(&text_of, &toml.display().to_string(), folder, &mut read);
    }
    let name = name.unwrap_or_else(|| "campaign".to_owned());
    folder::parse(&name, &folder.display().to_string(), &mut |local| text(&folder.join(local)))
}

/// What is asked of a campaign.
#[derive(Debug)]
pub struct Request<'a> {
    /// The group.
    pub group: &'a Group,
    /// Where it was described.
    pub folder: &'a Path,
    /// Where it runs.
    pub machine: &'a Machine,
    /// The `souple` program.
    pub program: &'a Path,
    /// Folder of results.
    pub results: &'a Path,
    /// Statuses whose simulations are to be repeated.
    pub again: &'a [&'a str],
}

/// Statuses of which the next run repeats the simulation: what ended it was not what determines it.
pub const PASSING: &[&str] = &["crashed", "unwritten", "changed"];

/// Hashes all simulations of a group, writes the group, and finds what is to do.
///
/// The simulations run from a copy of the text that was hashed: a scene that is edited while they run changes nothing.
///
/// # Errors
///
/// In words.
pub fn prepare(request: &Request<'_>, database: &Database) -> Result<Prepared, String> {
    let Request { group, results, .. } = *request;
    let planned: Vec<Planned> = plan(group).map_err(|problems| problems.to_string())?;
    let bytes = fs::read(request.program).map_err(|e| format!("cannot read {}: {e}", request.program.display()))?;
    let surroundings = Surroundings {
        program: sha256(&bytes),
        processor: request.machine.processor.clone(),
        catalogue: souple_simulation::prepare::catalogue(),
        scene: &group.scene.text,
    };
    let given = group.scene.path.as_ref().and_then(|path| path.parent());
    let meshes = match given {
        Some(folder) if folder.as_os_str().is_empty() => PathBuf::from("."),
        Some(folder) => folder.to_owned(),
        None => results.to_owned(),
    };
    let made = fs::create_dir_all(results).and_then(|()| Ok((fs::canonicalize(results)?, fs::canonicalize(meshes)?)));
    let (results, meshes) = made.map_err(|e| format!("cannot make {}: {e}", results.display()))?;
    remove_leftovers(&results);
    let scene = results.join(format!("scene_{}.toml", &sha256(group.scene.text.as_bytes())[..16]));
    if fs::read_to_string(&scene).ok().as_ref() != Some(&group.scene.text) {
        fs::write(&scene, &group.scene.text).map_err(|e| format!("cannot write {}: {e}", scene.display()))?;
    }
    // Many simulations have one mesh: its files are read once.
    let mut known: BTreeMap<String, Vec<Source>> = BTreeMap::new();
    let mut files = |name: &str| known.entry(name.to_owned()).or_insert_with(|| sources(&meshes.join(name))).clone();
    let identities: Vec<Identity> =
        planned.iter().map(|p| identify(&surroundings, &p.overrides, &p.device, &mut files)).collect();
    let members: Vec<Member<'_>> =
        planned.iter().zip(&identities).map(|(planned, identity)| Member { planned, hash: &identity.hash }).collect();
    let definition = sha256(format!("{group:?}").as_bytes());
    let where_from = request.folder.display().to_string();
    let failed = |e: DatabaseError| e.to_string();
    let id = add_group(database, group, &where_from, &definition, &members).map_err(failed)?;
    let recorded = recorded_in(database, id).map_err(failed)?;
    let mut seen = BTreeSet::new();
    let mut jobs = Vec::new();
    let mut check = false;
    for (planned, Identity { hash, scene, sources }) in planned.iter().zip(&identities) {
        check |= scene.as_ref().is_some_and(|s| !s.expectations.is_empty());
        if !seen.insert(hash) {
            continue;
        }
        let before = recorded.get(hash);
        let repeated = |status: &str| PASSING.contains(&status) || request.again.contains(&status);
        if before.is_none_or(|(_, status)| repeated(status)) {
            let mut overrides = planned.overrides.clone();
            overrides.extend(scene.iter().flat_map(|scene| meshes_from(scene, &meshes)));
            jobs.push(Job {
                number: planned.number,
                hash: hash.clone(),
                device: planned.device.clone(),
                overrides,
                materials: scene.as_ref().map_or(Vec::new(), materials),
                quasi_static: scene.as_ref().is_some_and(quasi_static),
                traction: scene.as_ref().and_then(traction),
                before: before.map(|(id, _)| *id),
                sources: sources.clone(),
            });
        }
    }
    let program_hash = surroundings.program;
    let scene_name = group.scene.path.as_ref().map_or("scene".to_owned(), |path| path.display().to_string());
    let workshop = Workshop {
        program: request.program.to_owned(),
        program_hash,
        scene,
        scene_name,
        results,
        threads: 1,
        check,
        view: None,
    };
    Ok(Prepared { group: id, members: planned.len(), jobs, workshop })
}

/// The files of a mesh as they are now.
fn sources(mesh: &Path) -> Vec<Source> {
    let mut read = |path: &str| fs::read(path).map_err(|e| e.to_string());
    let files = mesh_files(&mesh.display().to_string(), &mut read).into_iter();
    files.map(|(path, bytes)| Source { path: path.into(), hash: bytes.map(|bytes| sha256(&bytes)) }).collect()
}

fn quasi_static(scene: &Scene) -> bool {
    scene.integrator.method.value == Method::QuasiStatic
}

/// Changes of a copy of a scene: its mesh files are where they were.
fn meshes_from(scene: &Scene, folder: &Path) -> Vec<String> {
    let file = |body: &Body| match &body.mesh.value {
        Mesh::File(file) => Some(folder.join(&file.path.value)),
        Mesh::Bar(_) => None,
    };
    let files = scene.bodies.iter().enumerate().filter_map(|(i, body)| Some((i, file(&body.value)?)));
    // A text in JSON is one in TOML.
    let quoted = |path: PathBuf| serde_json::Value::from(path.display().to_string()).to_string();
    files.map(|(i, path)| format!("body.{i}.mesh.file={}", quoted(path))).collect()
}

fn materials(scene: &Scene) -> Vec<(String, usize, String, String)> {
    let mut all = Vec::new();
    for body in &scene.bodies {
        for (position, material) in body.value.materials.iter().enumerate() {
            let parameters = serde_json::to_string(&material.parameters).unwrap_or_default();
            all.push((body.value.name.value.clone(), position, material.law.value.clone(), parameters));
        }
    }
    all
}

/// This machine.
pub fn this_machine() -> Machine {
    let line = |path: &str| fs::read_to_string(path).ok().map(|text| text.trim().to_owned());
    let processor = line("/proc/cpuinfo").and_then(|text| {
        let name = text.lines().find(|l| l.starts_with("model name"))?;
        Some(name.split_once(':')?.1.trim().to_owned())
    });
    Machine {
        host: line("/proc/sys/kernel/hostname").unwrap_or_else(|| "unknown".to_owned()),
        processor: processor.unwrap_or_else(|| std::env::consts::ARCH.to_owned()),
        cores: std::thread::available_parallelism().map_or(1, usize::from),
        system: std::env::consts::OS.to_owned(),
    }
}
