//! `souple check` and `souple run`.

use crate::bad_input::SCENE;
use crate::command::Place;

/// What a scene holds is counted: elements, materials, regions, fixed nodes, probes.
#[test]
fn a_scene_is_checked() {
    let place = Place::new("run_check");
    place.write("scene.toml", SCENE);
    let found = place.souple("check scene.toml --json").ends_with(0).json();
    assert_eq!(found["title"], "Small bar");
    let body = &found["bodies"][0];
    assert_eq!(body["fixed_nodes"], 4);
    assert_eq!(body["regions"]["x_max"]["nodes"], 4);
    let counted: u64 = body["materials"].as_array().unwrap().iter().map(|m| m["elements"].as_u64().unwrap()).sum();
    let elements: u64 = found["elements"].as_object().unwrap().values().map(|n| n.as_u64().unwrap()).sum();
    assert_eq!(counted, elements);
    assert_eq!(found["probes"][0]["nodes"], 4);
    let text = place.souple("check scene.toml").ends_with(0).out;
    assert!(text.contains("Small bar") && text.contains("x_max") && text.contains("stvk"), "{text}");
    let found = place.souple("check scene.toml --json --set time.end=7").ends_with(0).json();
    assert_eq!(found["end"], 7.0);
}

/// A run writes frames, their list and the summary, prints the summary as its last line, and exits with 0.
#[test]
fn a_run_leaves_what_it_promises() {
    let place = Place::new("run_files");
    place.write("scene.toml", SCENE);
    let summary = place.souple("run scene.toml --json").ends_with(0).json();
    assert_eq!((&summary["steps"], &summary["status"]), (&10.into(), &"finished".into()));
    let tip = summary["probes"]["tip"]["mean displacement"].as_array().unwrap();
    assert!(tip[1].as_f64().unwrap() < -1e-3, "gravity pulls the tip down: {tip:?}");
    for number in ["mean", "p50", "p99"] {
        assert!(summary["step_ms"][number].as_f64().unwrap() > 0.0);
    }
    assert!(summary["cg_iterations"]["max"].as_u64().unwrap() > 0);
    let file: serde_json::Value = serde_json::from_slice(&place.read("out/scene/summary.json")).unwrap();
    assert_eq!(file, summary);
    // Frames at 0, 0.1 and 0.2 s; each is a mesh with the displaced nodes.
    let list = String::from_utf8(place.read("out/scene/bar.pvd")).unwrap();
    assert_eq!(list.matches("<DataSet").count(), 3, "{list}");
    let nodes = place.souple("mesh info out/scene/bar_0002.vtu --json").ends_with(0).json();
    assert_eq!(nodes["nodes"], summary["nodes"]);
    assert!(!place.path("out/scene/bar_0003.vtu").exists());

    let answer = place.souple("run scene.toml --out elsewhere --quiet --set output.format=\"none\"").ends_with(0);
    assert!(answer.out.is_empty() && answer.err.is_empty(), "{}{}", answer.out, answer.err);
    assert!(place.path("elsewhere/summary.json").is_file() && !place.path("elsewhere/bar.pvd").exists());
}

/// One thread or three give the same state, to the last bit.
#[test]
fn threads_do_not_change_a_bit() {
    let place = Place::new("run_threads");
    place.write("scene.toml", SCENE);
    for threads in ["1", "3"] {
        let out = format!("t{threads}");
        place
            .souple(&format!("run scene.toml --quiet --threads {threads} --out {out} --checkpoint-every 0.2"))
            .ends_with(0);
    }
    assert_eq!(place.read("t1/checkpoint.bin"), place.read("t3/checkpoint.bin"));
    assert_eq!(place.read("t1/bar_0002.vtu"), place.read("t3/bar_0002.vtu"));
}

/// A run that is continued from a checkpoint ends in the state of one that was never stopped, to the last bit.
#[test]
fn a_resumed_run_ends_the_same() {
    let place = Place::new("run_resume");
    place.write("scene.toml", SCENE);
    place.souple("run scene.toml --quiet --out whole --checkpoint-every 0.2").ends_with(0);
    place.souple("run scene.toml --quiet --out parts --checkpoint-every 0.1 --set time.end=0.1").ends_with(0);
    place.souple("run scene.toml --quiet --out parts --checkpoint-every 0.1 --resume").ends_with(0);
    assert_eq!(place.read("whole/checkpoint.bin"), place.read("parts/checkpoint.bin"));
    let list = String::from_utf8(place.read("parts/bar.pvd")).unwrap();
    assert_eq!(list.matches("timestep=\"0.1\"").count(), 1, "{list}");
}

/// With `--check`, met expectations exit with 0 and others with 1, saying what was expected and what came.
#[test]
fn expectations_decide_the_exit_code() {
    let place = Place::new("run_expect");
    let expect = |value: &str| {
        format!(
            "{SCENE}[[expect]]\nprobe = \"tip\"\nquantity = \"mean displacement\"\ncomponent = \"z\"\n\
             value = {value}\ntolerance = 1e-2\n"
        )
    };
    place.write("met.toml", &expect("0.0"));
    place.write("unmet.toml", &expect("5.0"));
    place.souple("run met.toml --quiet --check").ends_with(0);
    let answer = place.souple("run unmet.toml --json --check").ends_with(1);
    assert!(answer.err.contains("tip") && answer.err.contains("5.0"), "{}", answer.err);
    assert_eq!(answer.json()["expectations"][0]["passed"], false);
    // Without --check they are not looked at.
    place.souple("run unmet.toml --quiet").ends_with(0);
}

/// A simulation that fails exits with 3 and leaves its last good state, a checkpoint and the reason.
#[test]
fn a_failure_leaves_the_last_good_state() {
    let place = Place::new("run_failure");
    // An explicit step far beyond the critical one: the cubic forces blow up faster than any exponential.
    let unstable = "[integrator]\nmethod = \"symplectic-euler\"\nallow_unstable_step = true\n[time]";
    let scene = SCENE.replace("[time]", unstable).replace("end = 0.2", "end = 10.0");
    place.write("scene.toml", &scene);
    let answer = place.souple("run scene.toml --json").ends_with(3);
    assert_eq!(answer.json()["status"], "failed");
    for said in ["failed after t = ", "last_good.vtu", "checkpoint.bin", "may help"] {
        assert!(answer.err.contains(said), "{said}: {}", answer.err);
    }
    assert!(place.path("out/scene/checkpoint.bin").is_file());
    place.souple("mesh info out/scene/last_good.vtu").ends_with(0);
}

/// `--explain` names every kind of element with its costs, the solver, and why products are made as they are; what it
/// measures changes no result.
#[test]
fn a_run_explains_itself() {
    let place = Place::new("run_explain");
    place.write("scene.toml", SCENE);
    let answer = place.souple("run scene.toml --explain --json --set time.end=0.02").ends_with(0);
    let costs = ["hex8 with stvk", "tet4 with stvk", "operations per element"];
    let choices = ["block-jacobi", "implicit-euler", "measured with a matrix of", "without a matrix", "`auto`"];
    for said in costs.into_iter().chain(choices) {
        assert!(answer.err.contains(said), "{said}: {}", answer.err);
    }
    let silent = place.souple("run scene.toml --json --set time.end=0.02").ends_with(0);
    assert_eq!(answer.json()["probes"], silent.json()["probes"]);
    assert!(silent.json()["probes"].is_object());
}
