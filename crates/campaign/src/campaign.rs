//! A campaign from its folder to its results.

use crate::database::{Database, Machine, add_group, done};
use crate::folder;
use crate::group::Group;
use crate::identity::{Surroundings, identify, sha256};
use crate::plan::{Planned, plan};
use crate::problem::Problems;
use crate::worker::{Job, Workshop};
use souple_simulation::scene::Scene;
use std::collections::BTreeSet;
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

/// Hashes all simulations of a group, writes the group, and finds what is to do.
///
/// `again`: statuses whose simulations are to be repeated.
///
/// # Errors
///
/// In words.
pub fn prepare(
    group: &Group,
    folder: &Path,
    database: &mut Database,
    machine: &Machine,
    program: &Path,
    results: &Path,
    again: &[&str],
) -> Result<Prepared, String> {
    let planned: Vec<Planned> = plan(group).map_err(|problems| problems.to_string())?;
    let bytes = fs::read(program).map_err(|e| format!("cannot read {}: {e}", program.display()))?;
    let surroundings = Surroundings {
        program: sha256(&bytes),
        processor: machine.processor.clone(),
        catalogue: souple_simulation::prepare::catalogue(),
        scene: &group.scene.text,
    };
    fs::create_dir_all(results).map_err(|e| format!("cannot make {}: {e}", results.display()))?;
    let scene = match &group.scene.path {
        Some(path) => path.clone(),
        None => {
            let path = results.join(format!("scene_{}.toml", &sha256(group.scene.text.as_bytes())[..16]));
            fs::write(&path, &group.scene.text).map_err(|e| format!("cannot write {}: {e}", path.display()))?;
            path
        }
    };
    let beside: PathBuf = scene.parent().map(Path::to_owned).unwrap_or_default();
    let mut read = |name: &str| fs::read(beside.join(name)).map_err(|e| e.to_string());
    let identities: Vec<(String, Option<Scene>)> =
        planned.iter().map(|p| identify(&surroundings, &p.overrides, &p.device, &mut read)).collect();
    let hashes: Vec<String> = identities.iter().map(|(hash, _)| hash.clone()).collect();
    let definition = sha256(format!("{group:?}").as_bytes());
    let where_from = folder.display().to_string();
    let id = add_group(database, group, &where_from, &definition, &planned, &hashes).map_err(|e| e.to_string())?;
    let mut seen = BTreeSet::new();
    let mut jobs = Vec::new();
    let mut check = false;
    for (planned, (hash, scene)) in planned.iter().zip(&identities) {
        check |= scene.as_ref().is_some_and(|s| !s.expectations.is_empty());
        if !seen.insert(hash) {
            continue;
        }
        // What ended a process may not be what determines it: a crash is never final.
        let status = done(database, hash).map_err(|e| e.to_string())?;
        if status.is_none_or(|s| s == "crashed" || again.contains(&s.as_str())) {
            jobs.push(Job {
                number: planned.number,
                hash: hash.clone(),
                device: planned.device.clone(),
                overrides: planned.overrides.clone(),
                materials: scene.as_ref().map_or(Vec::new(), materials),
            });
        }
    }
    let program_hash = surroundings.program;
    let workshop =
        Workshop { program: program.to_owned(), program_hash, scene, results: results.to_owned(), threads: 1, check };
    Ok(Prepared { group: id, members: planned.len(), jobs, workshop })
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

/// The folder of results beside a database: `campaign.db` has `campaign.results`.
pub fn results_of(database: &Path) -> PathBuf {
    database.with_extension("results")
}
