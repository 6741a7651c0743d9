//! Graphics devices as a person meets them: with one, without one, under a name that there is not.

use crate::command::{Answer, Place};

/// What leaves a process without a Vulkan driver on Linux, whatever is installed.
const NO_DRIVER: [(&str, &str); 2] =
    [("VK_DRIVER_FILES", "/nonexistent/driver.json"), ("VK_ICD_FILENAMES", "/nonexistent/driver.json")];

/// Whether there is an adapter; where there is none, says that a test is skipped.
fn adapter(place: &Place) -> bool {
    let there = !place.souple("doctor --json").ends_with(0).json()["adapters"].as_array().unwrap().is_empty();
    if !there {
        println!("skipped: no adapter");
        if let Some(folder) = std::env::var_os("SOUPLE_SKIPPED") {
            let note = std::path::Path::new(&folder).join("cli, commands on a device.txt");
            std::fs::write(note, "no adapter").unwrap();
        }
    }
    there
}

const SCENE: &str = r#"
[time]
step = 0.01
end = 0.02
[[body]]
name = "bar"
density = 1000.0
[body.mesh]
generator = "bar"
size = [2.0, 1.0, 1.0]
cells = [2, 1, 1]
sections = [{ until = 1.0, element = "hex8" }]
[[body.material]]
law = "hooke"
young = 1e6
poisson = 0.3
[[body.fix]]
region = "x_min"
"#;

/// Without an adapter the doctor says so and what to do, the list shows the device as absent, and whatever asks for one
/// ends with an error that names a way on; nothing else changes.
#[cfg(target_os = "linux")]
#[test]
fn without_an_adapter_the_way_on_is_said() {
    let place = Place::new("no_adapter");
    place.write("bar.toml", SCENE);
    let souple = |words: &str| place.souple_where(words, &NO_DRIVER);
    let doctor = souple("doctor").ends_with(0).out;
    assert!(doctor.contains("No graphics adapter") && doctor.contains("mesa-vulkan-drivers"), "{doctor}");
    assert_eq!(souple("doctor --json").ends_with(0).json()["adapters"].as_array().unwrap().len(), 0);
    let devices = souple("list devices --json").ends_with(0).json();
    let gpu = devices.as_array().unwrap().iter().find(|d| d["id"] == "gpu").unwrap();
    assert!(gpu["available"] == false && gpu["about"].as_str().unwrap().contains("souple doctor"), "{gpu}");
    for device in ["gpu", "gpu:0", "gpu:lavapipe"] {
        for command in ["run bar.toml", "bench kernels", "bench step --cells 10"] {
            let Answer { err, .. } = souple(&format!("{command} --device {device}")).ends_with(2);
            assert!(err.contains("no graphics adapter") && err.contains("--device cpu"), "{command}: {err}");
        }
    }
    souple("run bar.toml --device cpu").ends_with(0);
}

/// A name or a number that no adapter has is refused with the names of those that there are.
#[test]
fn unknown_adapters_are_refused_with_those_there_are() {
    let place = Place::new("unknown_adapter");
    if !adapter(&place) {
        return;
    }
    place.write("bar.toml", SCENE);
    for device in ["gpu:99", "gpu:nosuchcard"] {
        for command in ["run bar.toml", "bench kernels", "bench step --cells 10"] {
            let err = place.souple(&format!("{command} --device {device}")).ends_with(2).err;
            let named = err.contains(&format!("`{device}`")) && err.contains("gpu:0 (");
            assert!(named && err.contains("--device cpu"), "{command}: {err}");
        }
    }
    let err = place.souple("bench kernels --device gpu --against").ends_with(2).err;
    assert!(err.contains("--against"), "{err}");
}

/// Every program of a step on a device is measured beside the device's own peaks, after its results were compared with
/// the oracle's.
#[test]
fn kernels_are_measured_on_a_device() {
    let place = Place::new("bench_graphics");
    if !adapter(&place) {
        return;
    }
    let words = "bench kernels --element tri3 --law stvk --elements 100 --rounds 2 --device gpu";
    let report = place.souple(&format!("{words} --json")).ends_with(0).json();
    for key in ["adapter", "driver", "backend", "date", "clock"] {
        assert!(!report[key].as_str().unwrap().is_empty(), "{key}: {report}");
    }
    for key in ["operations_per_ns", "copy_bytes_per_ns", "triad_bytes_per_ns"] {
        assert!(report["peak"][key]["median"].as_f64().unwrap() > 0.0, "{key}: {report}");
    }
    let rows = report["rows"].as_array().unwrap();
    let programs: Vec<&str> = rows.iter().map(|r| r["program"].as_str().unwrap()).collect();
    assert_eq!(programs, ["force", "row_sums", "linearise", "tangent_apply", "tangent_diagonal"]);
    for row in rows {
        assert_eq!(row["elements"], 128, "whole groups of 64: {row}");
        for key in ["operations", "bytes", "operations_per_ns", "bytes_per_ns", "percent_of_bound"] {
            assert!(row[key].as_f64().unwrap() > 0.0, "{key}: {row}");
        }
        assert!(row["ns_per_element"]["median"].as_f64().unwrap() > 0.0, "{row}");
        assert!(row["error_of_bound"].as_f64().unwrap() <= 1.0, "{row}");
    }
    let text = place.souple(words).ends_with(0).out;
    assert!(text.contains("Gop/s") && text.contains("row_sums"), "{text}");
}

/// What a run compiled lies in the cache folder and is left alone by the next run; a damaged file is ignored with a note
/// that names it, and written anew; a folder that cannot be made is no error.
#[test]
fn pipelines_are_kept_and_damage_is_survived() {
    let place = Place::new("pipelines");
    if !adapter(&place) {
        return;
    }
    if place.souple("doctor --json").ends_with(0).json()["adapters"][0]["pipeline_cache"] == false {
        return println!("skipped: the driver keeps no pipelines");
    }
    place.write("bar.toml", SCENE);
    let folder = place.path("cache");
    let run = |folder: &std::path::Path| {
        let variables = [("XDG_CACHE_HOME", folder.to_str().unwrap())];
        place.souple_where("run bar.toml --device gpu", &variables).ends_with(0).err
    };
    run(&folder);
    let files: Vec<_> = std::fs::read_dir(folder.join("souple")).unwrap().map(|f| f.unwrap().path()).collect();
    assert!(files.len() == 1 && files[0].file_name().unwrap().to_str().unwrap().starts_with("pipelines-"), "{files:?}");
    let kept = std::fs::read(&files[0]).unwrap();
    assert!(!run(&folder).contains("pipelines"), "a whole file is used without a word");
    assert_eq!(std::fs::read(&files[0]).unwrap().len(), kept.len());
    let mut damaged = kept.clone();
    *damaged.last_mut().unwrap() ^= 0xff;
    for content in [&damaged[..], &kept[..kept.len() / 2], b"something else", b""] {
        std::fs::write(&files[0], content).unwrap();
        let err = run(&folder);
        assert!(err.contains("compiled again") && err.contains(files[0].to_str().unwrap()), "{err}");
        assert_eq!(std::fs::read(&files[0]).unwrap().len(), kept.len(), "it is written anew");
    }
    // A file where the folder should be: nothing can be written there, whoever asks.
    place.write("file", "");
    let err = run(&place.path("file"));
    assert!(!err.contains("pipelines-") && !err.contains("compiled again"), "{err}");
}

/// Steps on a device make the iterations that were asked for, name the adapter, and say where their time went by the
/// device's clock; what is not measured apart is null and not zero.
#[test]
fn steps_are_measured_on_a_device() {
    let place = Place::new("bench_step_graphics");
    if !adapter(&place) {
        return;
    }
    let words = "bench step --cells 60 --element tet4 --cg 5 --steps 3 --device gpu";
    let report = place.souple(&format!("{words} --json")).ends_with(0).json();
    assert_eq!(report["iterations"], 5.0, "{report}");
    assert_eq!(report["step_ms"]["rounds"], 3);
    let doctor = place.souple("doctor --json").ends_with(0).json();
    let first = &doctor["adapters"][0];
    assert!(report["device"].as_str().unwrap().contains(first["name"].as_str().unwrap()), "{report}");
    let phases = &report["phases_ms"];
    if first["timestamps"] == true {
        for phase in ["force", "product", "rest_of_solve"] {
            assert!(phases[phase]["median"].as_f64().unwrap() > 0.0, "{phase}: {report}");
        }
        assert!(phases["linearise"].is_null(), "{report}");
    } else {
        assert!(phases.is_null(), "{report}");
    }
    assert!(place.souple(words).ends_with(0).out.contains("not measured apart"));
}
