//! The campaigns that come with the project: each folder of `campaigns/`, whichever there are.
//!
//! Promise: the reduced form of each one runs, ends as its cases say, and gives what its scenes expect; the full form
//! is a group whose scenes are valid. Out of scope: the numbers of the full forms, which take minutes.

use crate::place::with_souple;
use souple_campaign::campaign::read;
use souple_campaign::group::Ending;
use souple_campaign::plan::plan;
use souple_simulation::prepare::catalogue;
use souple_simulation::scene::parse_with_overrides;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The folders, in the order of their names.
fn folders() -> Vec<PathBuf> {
    let all = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../campaigns");
    let entries = std::fs::read_dir(&all).unwrap().map(|entry| entry.unwrap().path());
    let mut folders: Vec<PathBuf> = entries.filter(|path| path.is_dir()).collect();
    folders.sort();
    assert!(!folders.is_empty(), "{} holds no campaign", all.display());
    folders
}

/// Every scene of every form can be read, and whatever must come to its end in a reduced form expects something.
#[test]
fn their_scenes_are_valid() {
    for folder in folders() {
        for (form, reduced) in [(folder.clone(), false), (folder.join("reduced"), true)] {
            let group = read(&form).unwrap_or_else(|problems| panic!("{problems}"));
            for simulation in plan(&group).unwrap_or_else(|problems| panic!("{problems}")) {
                let case = group.cases.get(simulation.number % group.cases.len().max(1));
                let who = format!("{}, simulation {}", form.display(), simulation.number);
                let changes: Vec<&str> = simulation.overrides.iter().map(String::as_str).collect();
                let (scene, _) = parse_with_overrides(&group.scene.text, "scene.toml", &changes, &catalogue())
                    .unwrap_or_else(|errors| panic!("{who}: {errors}"));
                let must_end = case.is_none_or(|c| c.ends == Ending::Finished);
                assert!(!(reduced && must_end && scene.expectations.is_empty()), "{who} expects nothing");
            }
        }
    }
}

/// Every reduced form runs to what it describes.
#[test]
fn their_reduced_forms_give_what_they_describe() {
    with_souple();
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("shipped");
    let _ = std::fs::remove_dir_all(&place);
    std::fs::create_dir_all(&place).unwrap();
    for folder in folders() {
        let output = Command::new(env!("CARGO_BIN_EXE_souple-campaign"))
            .args(["run", "--check", "--db"])
            .args([place.join("campaign.db"), folder.join("reduced")])
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{}: {}\n{said}", folder.display(), output.status);
    }
    std::fs::remove_dir_all(&place).unwrap();
}
