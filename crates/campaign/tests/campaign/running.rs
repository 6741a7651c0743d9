//! Running a campaign: failures stay alone, and what is not the simulation's fault is repeated.

use crate::place::{Place, SCENE, STEPS, densities, with_souple};
use souple_campaign::database::latest_group;
use std::process::Stdio;

/// A simulation that fails and one that is invalid are recorded with their reasons, the others come to their end; the
/// same campaign again has nothing to do; list, show and CSV tell.
#[test]
fn failures_stay_alone() {
    with_souple();
    let failing = "[[vary]]\nkey = \"time.end\"\nvalues = [0.02, 50.0]\n";
    let campaign =
        format!("{}{failing}[[vary]]\nkey = \"body.0.density\"\nvalues = [1000, -1]\n", STEPS.replace("2e-3", "0.5"));
    let place = Place::new("failures", &campaign);
    let (out, err) = place.succeeds("run . --jobs 2");
    assert!(err.contains("8 simulations, 8 to do"), "{err}");
    assert!(out.contains("8 of 8 done"), "{out}");
    let table = place.table();
    let column = |name: &str| table.heads.iter().position(|h| h == name).unwrap_or_else(|| panic!("{name}"));
    let (step, end, density) = (column("time.step"), column("time.end"), column("body.0.density"));
    let (status, reason) = (column("status"), column("reason"));
    for row in &table.rows {
        let expected = match (row[step].as_str(), row[end].as_str(), row[density].as_str()) {
            (_, _, "-1") => ("invalid", "density"),
            // A step longer than the simulation.
            ("0.5", "0.02", _) => ("invalid", "time"),
            ("0.5", _, _) => ("failed", "failed after t = "),
            _ => ("finished", ""),
        };
        assert_eq!(row[status], expected.0, "{row:?}");
        assert!(row[reason].contains(expected.1) && row[reason].is_empty() == expected.1.is_empty(), "{row:?}");
        let last_good = "The last good state is in last_good.vtu; checkpoint.bin holds it";
        assert!(row[status] != "failed" || row[reason].contains(last_good), "folders had other names then: {row:?}");
    }
    let tip = column("tip mean displacement z");
    assert!(table.rows[0][tip].parse::<f64>().unwrap() < 0.0 && table.rows[0][column("elements")] == "5");
    let database = rusqlite::Connection::open(place.0.join("campaign.db")).unwrap();
    // Of the first simulation that came to its end.
    let count = |from: &str| {
        let which = "simulation_id = (SELECT MIN(id) FROM simulations WHERE status = 'finished')";
        let sql = format!("SELECT COUNT(*) FROM {from} WHERE {which}");
        database.query_row(&sql, [], |row| row.get::<_, i64>(0)).unwrap()
    };
    assert_eq!(count("points JOIN curves ON curves.id = curve_id"), 6);
    assert_eq!((count("errors"), count("materials")), (1, 1));
    assert_eq!(count("timings"), 5, "four phases and the step");
    let mesh: String = database.query_row("SELECT path FROM meshes LIMIT 1", [], |row| row.get(0)).unwrap();
    assert!(place.0.join(mesh).is_file());

    let before = place.table();
    let (_, err) = place.succeeds("resume .");
    assert!(err.contains("8 simulations, 0 to do"), "{err}");
    assert_eq!(place.table(), before);
    let (_, err) = place.succeeds("run . --retry");
    assert!(!err.contains(" 0 to do") && !err.contains(" 8 to do"), "{err}");
    assert!(place.succeeds("list").0.contains("steps  8"));
    assert!(place.succeeds("show steps").0.contains("failed after t = "));
    let csv = place.succeeds("show --csv -").0;
    assert_eq!(csv.lines().next().unwrap().split(',').next(), Some("number"));
    assert!(csv.contains("invalid"));
    let no = place.command("show other").output().unwrap();
    assert!(no.status.code() == Some(2) && String::from_utf8_lossy(&no.stderr).contains("has no group other"));
}

/// `--check` passes when every simulation ends as its case says and meets what its scene expects, and says what does not.
#[test]
fn check_compares_with_what_is_described() {
    with_souple();
    let case = |name: &str, set: &str, ends: &str| {
        format!("[[case]]\nname = \"{name}\"\nset = {{ {set} }}\nends = \"{ends}\"\n")
    };
    let right = [
        case("fine", "\"expect.0.value\" = 0.0", "finished"),
        case("diverging", "\"time.step\" = 0.5, \"time.end\" = 50", "failed"),
        case("refused", "\"body.0.density\" = -1", "invalid"),
    ];
    let head = "name = \"checked\"\nscene = \"bar.toml\"\n";
    let place = Place::new("checked", &(head.to_owned() + &right.concat()));
    place.succeeds("run . --check --jobs 2");
    let wrong = [
        case("missed", "\"expect.0.value\" = 5.0", "finished"),
        case("not refused", "\"body.0.density\" = 900", "invalid"),
    ];
    std::fs::write(place.0.join("campaign.toml"), head.to_owned() + &wrong.concat()).unwrap();
    let out = place.command("run . --check --jobs 2").output().unwrap();
    let said = String::from_utf8(out.stderr).unwrap();
    assert_eq!(out.status.code(), Some(1), "{said}");
    assert!(said.contains("(missed): tip") && said.contains("is off by"), "{said}");
    assert!(said.contains("(not refused) should be invalid and is finished"), "{said}");
    place.succeeds("run . --jobs 2");
}

/// Two descriptions that share a name are two groups; a run counts the simulations of its own.
#[test]
fn groups_that_share_a_name_are_counted_apart() {
    with_souple();
    let place = Place::new("namesakes", &densities(3));
    std::fs::create_dir(place.0.join("other")).unwrap();
    std::fs::write(place.0.join("other/bar.toml"), SCENE).unwrap();
    std::fs::write(place.0.join("other/campaign.toml"), densities(1)).unwrap();
    assert!(place.succeeds("run .").0.contains("3 of 3 done"));
    assert!(place.succeeds("run other --db campaign.db").0.contains("1 of 1 done"));
    assert!(place.succeeds("run .").0.contains("3 of 3 done"), "not the newer group of the same name");
    assert_eq!(latest_group(&place.database(), Some("densities")).unwrap().unwrap().members, 1);
}

/// A program in front of `souple` that does something first; words of its command line are in `$@`, its folder is `$out`.
#[cfg(unix)]
fn in_front(place: &Place, what: &str) -> String {
    use std::os::unix::fs::PermissionsExt as _;
    let souple = std::path::Path::new(env!("CARGO_BIN_EXE_souple-campaign")).with_file_name("souple");
    let find = "previous=; for word in \"$@\"; do [ \"$previous\" = --out ] && out=$word; previous=$word; done";
    let path = place.0.join("in_front");
    std::fs::write(&path, format!("#!/bin/sh\n{find}\n{what}\nexec {} \"$@\"\n", souple.display())).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    path.display().to_string()
}

/// A simulation whose results cannot be written is not invalid: the reason says what happened, and the next run repeats
/// it by itself.
#[cfg(unix)]
#[test]
fn what_could_not_be_written_is_repeated() {
    with_souple();
    let place = Place::new("unwritten", &densities(2));
    // The first one finds a folder where its summary should go.
    let once = "mkdir once 2>/dev/null && mkdir -p \"$out/summary.json\"";
    let program = in_front(&place, once);
    let run = format!("run . --jobs 1 --souple {program}");
    let (_, err) = place.succeeds(&run);
    assert!(err.contains("unwritten: cannot write") && err.contains("summary.json"), "{err}");
    let (out, err) = place.succeeds(&run);
    assert!(err.contains("2 simulations, 1 to do"), "{err}");
    assert!(out.contains("2 of 2 done: 2 came to their end"), "{out}");
}

/// Simulations run from the text that was hashed: a scene that is edited in between changes nothing.
#[cfg(unix)]
#[test]
fn edits_during_a_run_change_nothing() {
    with_souple();
    let undisturbed = Place::new("unedited", &densities(2));
    undisturbed.succeeds("run .");
    let place = Place::new("edited", &densities(2));
    let program = in_front(&place, "sed -i 's/^young = 1e5/young = 1e7/' bar.toml");
    place.succeeds(&format!("run . --souple {program}"));
    assert!(std::fs::read_to_string(place.0.join("bar.toml")).unwrap().contains("1e7"), "it was edited");
    assert_eq!(place.results(), undisturbed.results());
}

/// A scene in `scenes/` with its mesh in a file there.
fn with_mesh_file(name: &str) -> Place {
    let place = Place::new(name, &STEPS.replace("bar.toml", "scenes/bar.toml"));
    std::fs::create_dir(place.0.join("scenes")).unwrap();
    mesh_file(&place, 1.0);
    let generated = SCENE.lines().find(|line| line.starts_with("mesh = ")).unwrap();
    let scene = SCENE.replace(generated, "mesh = { file = \"bar.vtu\" }");
    let scene = scene.replace("region = \"x_min\"", "region = { box = { min = [-0.01, -1, -1], max = [0.01, 1, 1] } }");
    let scene = scene.replace("region = \"x_max\"", "region = { box = { min = [0.99, -1, -1], max = [1.01, 1, 1] } }");
    std::fs::write(place.0.join("scenes/bar.toml"), scene).unwrap();
    place
}

/// Writes the mesh of a bar that is 1 m long and as thick as is said.
fn mesh_file(place: &Place, thickness: f64) {
    let souple = std::path::Path::new(env!("CARGO_BIN_EXE_souple-campaign")).with_file_name("souple");
    let words = format!("mesh bar --output bar.vtu --size 1,{thickness},0.2 --cells 5,1,1 --section 1:hex8");
    let mut make = std::process::Command::new(souple);
    let made = make.args(words.split(' ')).current_dir(place.0.join("scenes")).stdout(Stdio::null()).status();
    assert!(made.unwrap().success());
}

/// Mesh files are found beside the scene, although the scene runs from a copy.
#[test]
fn meshes_lie_beside_the_scene() {
    with_souple();
    let (out, err) = with_mesh_file("meshes").succeeds("run .");
    assert!(out.contains("2 came to their end"), "{out}{err}");
}

/// A mesh that is edited after its simulations were planned gives no results under their hashes: what has not begun does
/// not run, what was running is not kept, the reason names the file, and the next run plans them anew.
#[cfg(unix)]
#[test]
fn edited_meshes_are_noticed() {
    with_souple();
    let place = with_mesh_file("edited_meshes");
    let mesh = place.0.join("scenes/bar.vtu");
    let original = std::fs::read(&mesh).unwrap();
    mesh_file(&place, 0.3);
    std::fs::rename(&mesh, place.0.join("thicker.vtu")).unwrap();
    std::fs::write(&mesh, original).unwrap();
    // The first one finds the mesh as it was hashed when it is started, and another one when it reads it.
    let program = in_front(&place, "echo started >> started; cp thicker.vtu scenes/bar.vtu");
    let run = format!("run . --jobs 1 --souple {program}");
    let (out, err) = place.succeeds(&run);
    assert!(out.contains("2 of 2 done: 0 came to their end"), "{out}{err}");
    assert_eq!(err.matches("changed: ").count(), 2, "{err}");
    assert_eq!(err.matches("scenes/bar.vtu was changed after the simulation was planned").count(), 2, "{err}");
    let started = || std::fs::read_to_string(place.0.join("started")).unwrap().lines().count();
    assert_eq!(started(), 1, "what has not begun does not run");
    for table in ["meshes", "measurements", "timings"] {
        let rows: i64 = place.database().first(&format!("SELECT COUNT(*) FROM {table}"), &[]).unwrap();
        assert_eq!(rows, 0, "{table}");
    }
    let (out, err) = place.succeeds(&run);
    assert!(err.contains("2 simulations, 2 to do") && out.contains("2 of 2 done: 2 came to their end"), "{out}{err}");
    assert_eq!(started(), 3);
}

/// What happens to a mesh after a simulation has ended is not that simulation's affair, also while it is being recorded.
#[cfg(unix)]
#[test]
fn later_edits_concern_later_simulations() {
    with_souple();
    let place = with_mesh_file("edited_later");
    // The second one empties the mesh as soon as it is started: the first has not been recorded yet.
    let program = in_front(&place, "[ -e started ] && : > scenes/bar.vtu; echo started >> started");
    let (out, err) = place.succeeds(&format!("run . --jobs 1 --souple {program}"));
    assert!(out.contains("2 of 2 done: 1 came to their end"), "{out}{err}");
    assert_eq!(err.matches("changed: ").count(), 1, "{err}");
}

/// Where a `souple-view` lies beside `souple`, it is given a scene of the end of each simulation that came to one, and the
/// database says where its picture is.
#[cfg(unix)]
#[test]
fn ends_are_drawn() {
    use std::os::unix::fs::PermissionsExt as _;
    with_souple();
    let place = Place::new("pictures", &format!("{}[[vary]]\nkey = \"body.0.density\"\nvalues = [1e3, -1]\n", STEPS));
    let program = in_front(&place, "");
    let souple = std::path::Path::new(env!("CARGO_BIN_EXE_souple-campaign")).with_file_name("souple");
    let view = place.0.join("souple-view");
    // What it is given must be a scene; the picture is none here.
    let text = format!("#!/bin/sh\n{} check \"$1\" --json > \"$3\"\n", souple.display());
    std::fs::write(&view, text).unwrap();
    std::fs::set_permissions(&view, std::fs::Permissions::from_mode(0o755)).unwrap();
    let mut run = std::process::Command::new(env!("CARGO_BIN_EXE_souple-campaign"));
    let run = run.args(["run", ".", "--souple", &program]).current_dir(&place.0).stderr(Stdio::null());
    assert!(run.stdout(Stdio::null()).status().unwrap().success());
    let rows = place.database().query("SELECT path FROM pictures", &[]).unwrap();
    assert_eq!(rows.len(), 2, "those that were refused have none");
    for row in rows {
        let drawn = std::fs::read_to_string(place.0.join(row.get::<String>(0).unwrap())).unwrap();
        assert!(drawn.contains("\"hex8\":5") || drawn.contains("\"hex8\": 5"), "{drawn}");
    }
}
