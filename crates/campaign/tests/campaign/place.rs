//! A folder of a test's own with a small campaign, and the programs.

use souple_campaign::database::{Database, Location, Table, latest_group, table};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A small bar; explicit, so that a long step makes it fail.
pub(crate) const SCENE: &str = r#"
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
        if words.starts_with("run") || words.starts_with("resume") {
            // Whether there is a souple-view depends on what else was built.
            command.arg("--no-pictures");
        }
        command
    }

    /// Runs the command to its end and gives what it said.
    pub(crate) fn succeeds(&self, words: &str) -> (String, String) {
        let Output { status, stdout, stderr } = self.command(words).output().unwrap();
        let (out, err) = (String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap());
        assert!(status.success(), "{status}: {out}{err}");
        (out, err)
    }

    pub(crate) fn database(&self) -> Database {
        Database::open(&self.0.join("campaign.db")).unwrap()
    }

    pub(crate) fn table(&self) -> Table {
        last_table(&self.database())
    }

    /// What does not depend on the clock.
    pub(crate) fn results(&self) -> Vec<Vec<String>> {
        timeless(&self.table())
    }

    /// Folders of simulations that are not done.
    pub(crate) fn leftovers(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.join("campaign.results")).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned());
        names.filter(|name| name.split_once('.').is_some_and(|(hash, _)| hash.len() == 64)).collect()
    }
}

pub(crate) fn connect(db: &str) -> Database {
    Database::connect(&Location::parse(db)).unwrap()
}

/// The table of the last group.
pub(crate) fn last_table(database: &Database) -> Table {
    table(database, latest_group(database, None).unwrap().unwrap().id).unwrap()
}

/// What does not depend on the clock.
pub(crate) fn timeless(table: &Table) -> Vec<Vec<String>> {
    let timeless = |head: &str| head != "wall s" && !head.starts_with("ms per step");
    let cells = |row: &Vec<String>| -> Vec<String> {
        row.iter().zip(&table.heads).filter(|(_, head)| timeless(head)).map(|(cell, _)| cell.clone()).collect()
    };
    table.rows.iter().map(cells).collect()
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

/// Two simulations: two time steps.
pub(crate) const STEPS: &str =
    "name = \"steps\"\nscene = \"bar.toml\"\n[[vary]]\nkey = \"time.step\"\nvalues = [1e-3, 2e-3]\n";

/// `count` simulations of the small bar that differ in their density.
pub(crate) fn densities(count: u32) -> String {
    let to = 900 + 10 * (count - 1);
    format!(
        "name = \"densities\"\nscene = \"bar.toml\"\n[[vary]]\nkey = \"body.0.density\"\nfrom = 900\nto = {to}\nstep = 10\n"
    )
}
