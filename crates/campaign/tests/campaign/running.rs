//! Running a campaign: failures stay alone, nothing is lost or repeated, whatever happens.

use souple_campaign::database::{Database, Table, latest_group, table};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, Instant};

/// A small bar; explicit, so that a long step makes it fail.
const SCENE: &str = r#"
gravity = [0, 0, -9.81]
[time]
step = 1e-3
end = 0.02
[integrator]
method = "symplectic-euler"
allow_unstable_step = true
[[body]]
name = "bar"
density = 1000.0
mesh = { generator = "bar", size = [1, 0.2, 0.2], cells = [5, 1, 1], sections = [{ until = 1.0, element = "hex8" }] }
[[body.material]]
law = "stvk"
young = 1e5
poisson = 0.3
[[body.fix]]
region = "x_min"
[[probe]]
name = "tip"
region = "x_max"
quantity = "mean displacement"
[[probe]]
name = "bar"
quantity = "deflection curve"
[[expect]]
probe = "tip"
quantity = "mean displacement"
component = "y"
value = 1.0
tolerance = 0.1
"#;

/// A folder of a test's own, removed when the test passes.
pub(crate) struct Place(pub(crate) PathBuf);

impl Place {
    pub(crate) fn new(name: &str, campaign: &str) -> Place {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        std::fs::write(path.join("bar.toml"), SCENE).unwrap();
        std::fs::write(path.join("campaign.toml"), campaign).unwrap();
        Place(path)
    }

    pub(crate) fn command(&self, words: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_souple-campaign"));
        command.args(words.split_whitespace()).current_dir(&self.0);
        command
    }

    /// Runs the command to its end and gives what it said.
    pub(crate) fn succeeds(&self, words: &str) -> (String, String) {
        let Output { status, stdout, stderr } = self.command(words).output().unwrap();
        let (out, err) = (String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap());
        assert!(status.success(), "{status}: {out}{err}");
        (out, err)
    }

    fn table(&self) -> Table {
        let database = Database::open(&self.0.join("campaign.db")).unwrap();
        table(&database, latest_group(&database, None).unwrap().unwrap().id).unwrap()
    }

    /// What does not depend on the clock.
    fn results(&self) -> Vec<Vec<String>> {
        let table = self.table();
        let timeless = |head: &str| head != "wall s" && !head.starts_with("ms per step");
        table
            .rows
            .iter()
            .map(|row| row.iter().zip(&table.heads).filter(|(_, h)| timeless(h)).map(|(c, _)| c.clone()).collect())
            .collect()
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }
}

/// `souple` beside `souple-campaign`; it is built where only this package's tests are.
pub(crate) fn with_souple() {
    let campaign = Path::new(env!("CARGO_BIN_EXE_souple-campaign"));
    if campaign.with_file_name(format!("souple{}", std::env::consts::EXE_SUFFIX)).is_file() {
        return;
    }
    let target = campaign.parent().and_then(Path::parent).unwrap();
    let built = Command::new(std::env::var("CARGO").unwrap_or_else(|_| "cargo".into()))
        .args(["build", "--quiet", "--package", "souple-cli"])
        .env("CARGO_TARGET_DIR", target)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .status();
    assert!(built.unwrap().success());
}

const STEPS: &str = "name = \"steps\"\nscene = \"bar.toml\"\n[[vary]]\nkey = \"time.step\"\nvalues = [1e-3, 2e-3]\n";

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

/// A run that is killed again and again, each time at another moment, ends in the table of one that was not; every
/// simulation is there once, and none that was recorded ran again.
#[test]
fn killed_runs_lose_and_repeat_nothing() {
    with_souple();
    // SOUPLE_KILLS=20 is the long form.
    let kills: u32 = std::env::var("SOUPLE_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(4);
    let campaign =
        format!("{STEPS}[[vary]]\nkey = \"body.0.density\"\nfrom = 900\nto = {}\nstep = 10\n", 900 + 20 * kills);
    let undisturbed = Place::new("undisturbed", &campaign);
    let started = Instant::now();
    undisturbed.succeeds("run . --jobs 2");
    let whole = started.elapsed();
    let place = Place::new("killed", &campaign);
    let mut recorded: Vec<(String, i64)> = Vec::new();
    for kill in 0..kills {
        let mut run = place.command("run . --jobs 2").stderr(std::process::Stdio::null()).spawn().unwrap();
        // Moments spread over the time of a run by the golden ratio, the same in every test.
        let part = f64::from(kill + 1) * 0.618_033_988_749_895 % 1.0;
        wait(whole.mul_f64(part * 0.5), &mut run);
        // It may have ended by itself.
        let _ = run.kill();
        run.wait().unwrap();
        let database = Database::open(&place.0.join("campaign.db")).unwrap();
        let group = latest_group(&database, None).unwrap();
        drop(database);
        let database = rusqlite::Connection::open(place.0.join("campaign.db")).unwrap();
        let mut query = database.prepare("SELECT hash, id FROM simulations").unwrap();
        let now: Vec<(String, i64)> =
            query.query_map([], |row| Ok((row.get(0)?, row.get(1)?))).unwrap().map(Result::unwrap).collect();
        // A simulation that ran again would have a new id.
        assert!(recorded.iter().all(|old| now.contains(old)), "kill {kill}");
        assert!(group.is_none_or(|g| g.done == now.len()));
        recorded = now;
    }
    place.succeeds("run . --jobs 2");
    assert_eq!(place.results(), undisturbed.results());
    let database = rusqlite::Connection::open(place.0.join("campaign.db")).unwrap();
    let count: usize = database.query_row("SELECT COUNT(*) FROM simulations", [], |row| row.get(0)).unwrap();
    assert_eq!(count, place.table().rows.len());
}

/// Waits until the time is over or the process has ended.
fn wait(time: Duration, process: &mut std::process::Child) {
    let started = Instant::now();
    while started.elapsed() < time && process.try_wait().unwrap().is_none() {
        std::thread::yield_now();
    }
}
