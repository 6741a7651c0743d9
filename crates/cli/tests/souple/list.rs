//! `souple list`.

use crate::command::Place;

/// Every list is a table for people and an array of objects with an id for machines.
#[test]
fn lists_have_two_forms() {
    let place = Place::new("list_forms");
    for (what, member) in [("elements", "hex8"), ("laws", "stvk"), ("integrators", "rk4"), ("devices", "interpreter")] {
        let text = place.souple(&format!("list {what}")).ends_with(0).out;
        assert!(text.contains(member), "{text}");
        let json = place.souple(&format!("list {what} --json")).ends_with(0).json();
        let ids: Vec<&str> = json.as_array().unwrap().iter().map(|e| e["id"].as_str().unwrap()).collect();
        assert!(ids.contains(&member), "{ids:?}");
        // What the machine reads, the person sees.
        assert!(ids.iter().all(|id| text.contains(id)), "{what}");
    }
}

/// Elements tell their nodes, quadratures and names in formats; laws their formula and parameters with ranges.
#[test]
fn entries_are_complete() {
    let place = Place::new("list_entries");
    let elements = place.souple("list elements --json").ends_with(0).json();
    for e in elements.as_array().unwrap() {
        let rules = e["quadratures"].as_array().unwrap();
        assert!(rules.len() >= 2 && rules[0]["default"] == true && rules[0]["points"].as_u64().unwrap() > 0, "{e}");
        assert!(e["nodes"].as_u64().unwrap() > 1 && e["degree"].is_u64() && e["family"].is_string(), "{e}");
        assert!(e["exchange"]["vtk"].is_u64() && e["exchange"]["gmsh"].is_u64(), "{e}");
    }
    for law in place.souple("list laws --json").ends_with(0).json().as_array().unwrap() {
        assert!(!law["formula"].as_str().unwrap().is_empty() && law["about"].is_string(), "{law}");
        assert!(!law["references"].as_array().unwrap().is_empty(), "{law}");
        for p in law["parameters"].as_array().unwrap() {
            assert!(p["range"].as_str().unwrap().contains(", ") && p["unit"].is_string(), "{p}");
        }
    }
}

/// Scene files are found in folders with their titles; other TOML files are not scenes.
#[test]
fn scenes_are_found() {
    let place = Place::new("list_scenes");
    std::fs::create_dir_all(place.path("s/deep")).unwrap();
    place.write("s/deep/a.toml", "title = \"A bar\"\n[[body]]\n");
    place.write("s/other.toml", "[package]\n");
    let json = place.souple("list scenes --folder s --json").ends_with(0).json();
    assert_eq!(json.as_array().unwrap().len(), 1);
    assert_eq!(json[0]["title"], "A bar");
    assert!(json[0]["file"].as_str().unwrap().ends_with("a.toml"));
    let error = place.souple("list scenes --folder nowhere").ends_with(2).err;
    assert!(error.contains("nowhere"), "{error}");
}

/// The doctor names the same graphics adapters as the list of devices, and says what to do where there is none.
#[test]
fn the_doctor_and_the_list_agree() {
    let place = Place::new("doctor");
    let report = place.souple("doctor --json").ends_with(0).json();
    let adapters = report["adapters"].as_array().unwrap();
    let devices = place.souple("list devices --json").ends_with(0).json();
    let listed = devices.as_array().unwrap().iter().map(|d| d["id"].as_str().unwrap());
    let numbered: Vec<&str> = listed.filter(|id| id.starts_with("gpu:")).collect();
    assert_eq!(adapters.iter().map(|a| a["id"].as_str().unwrap()).collect::<Vec<_>>(), numbered);
    let text = place.souple("doctor").ends_with(0).out;
    assert!(adapters.iter().all(|a| text.contains(a["name"].as_str().unwrap()) && !a["notes"][0].is_null()), "{text}");
    assert!(!report["advice"][0].as_str().unwrap().is_empty());
    let error = place.souple("run nothing.toml --device gpu:nosuchcard").ends_with(2).err;
    assert!(!error.is_empty());
}
