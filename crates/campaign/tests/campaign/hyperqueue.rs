//! The HyperQueue that is installed: its server, its workers, its `hq submit`.
//!
//! Promise: a campaign that it runs, also one whose worker is killed on the way, gives the table of a local run, bit for
//! bit. Skipped where `SOUPLE_HQ` names no `hq` and none is on the search path. Out of scope: several machines, and
//! clusters that HyperQueue asks for workers.

use crate::place::{Place, densities, with_souple};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

/// The program, where there is one.
fn installed() -> Option<PathBuf> {
    let named = std::env::var_os("SOUPLE_HQ").map(PathBuf::from);
    let on_path = std::env::var_os("PATH").unwrap_or_default();
    let found = std::env::split_paths(&on_path).map(|folder| folder.join("hq")).find(|path| path.is_file());
    let path = named.or(found)?;
    assert!(path.is_file(), "SOUPLE_HQ names no program: {}", path.display());
    Some(std::fs::canonicalize(path).unwrap())
}

/// A server with its workers, which end with the test.
struct Cluster {
    program: PathBuf,
    /// A folder of its own.
    folder: PathBuf,
    processes: Vec<Child>,
}

impl Cluster {
    /// Starts a server and waits until it answers.
    fn start(program: &Path, folder: &Path) -> Cluster {
        std::fs::create_dir_all(folder).unwrap();
        // Under its name, whatever that of the program is.
        std::fs::copy(program, folder.join("hq")).unwrap();
        let mut cluster = Cluster { program: program.to_owned(), folder: folder.to_owned(), processes: Vec::new() };
        cluster.spawn("server start --host localhost");
        for _ in 0..1000 {
            let said = cluster.command("server info").stdout(Stdio::null()).stderr(Stdio::null()).status();
            if said.unwrap().success() {
                return cluster;
            }
            assert!(cluster.processes[0].try_wait().unwrap().is_none(), "the server ended: {}", cluster.said());
        }
        panic!("the server does not answer: {}", cluster.said());
    }

    fn command(&self, words: &str) -> Command {
        let mut command = Command::new(&self.program);
        command.args(words.split(' ')).env("HQ_SERVER_DIR", self.folder.join("server")).current_dir(&self.folder);
        command.stdin(Stdio::null());
        command
    }

    fn spawn(&mut self, words: &str) {
        let messages =
            std::fs::File::options().create(true).append(true).open(self.folder.join("messages.txt")).unwrap();
        let both = messages.try_clone().unwrap();
        self.processes.push(self.command(words).stdout(both).stderr(messages).spawn().unwrap());
    }

    /// A worker with two processors, whatever the machine has.
    fn add_worker(&mut self) {
        self.spawn("worker start --cpus 2");
    }

    /// `souple campaign …` where `hq` is this one and finds this server.
    fn campaign(&self, place: &Place, words: &str) -> Command {
        let folders = std::env::var_os("PATH").unwrap_or_default();
        let folders = std::iter::once(self.folder.clone()).chain(std::env::split_paths(&folders));
        let mut command = place.command(words);
        command.env("HQ_SERVER_DIR", self.folder.join("server")).env("PATH", std::env::join_paths(folders).unwrap());
        command
    }

    /// Kills what was started last.
    fn kill_last(&mut self) {
        let last = self.processes.last_mut().unwrap();
        last.kill().unwrap();
        last.wait().unwrap();
    }

    fn said(&self) -> String {
        std::fs::read_to_string(self.folder.join("messages.txt")).unwrap_or_default()
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        for process in self.processes.iter_mut().rev() {
            // It may have ended by itself.
            let _ = process.kill();
            let _ = process.wait();
        }
    }
}

/// Runs a command that must succeed; what it said.
fn succeeds(command: &mut Command) -> String {
    let Output { status, stdout, stderr } = command.output().unwrap();
    let said = String::from_utf8_lossy(&stdout).into_owned() + &String::from_utf8_lossy(&stderr);
    assert!(status.success(), "{said}");
    said
}

/// Number of entries of a folder; none where there is no folder.
fn count(folder: &Path) -> usize {
    std::fs::read_dir(folder).map_or(0, Iterator::count)
}

/// A reduced campaign of the project, and one whose worker is killed in the middle of its first tasks and replaced, give
/// the tables of local runs; what is done again, submitted again or collected again changes nothing.
#[test]
fn the_real_scheduler_gives_the_same_tables() {
    let Some(program) = installed() else {
        eprintln!("skipped: no hq on the search path, and SOUPLE_HQ names none");
        return;
    };
    with_souple();
    let own = Place::new("hq_cluster", "");
    let mut cluster = Cluster::start(&program, &own.0.join("cluster"));

    let reduced = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../campaigns/explicit_against_implicit/reduced");
    let run = format!("run {}", std::fs::canonicalize(reduced).unwrap().display());
    let (local, place) = (Place::new("hq_real_local", ""), Place::new("hq_real", ""));
    local.succeeds(&format!("{run} --jobs 2"));
    cluster.add_worker();
    let said = succeeds(&mut cluster.campaign(&place, &format!("{run} --check --executor hyperqueue")));
    assert!(said.contains("8 of 8 done"), "{said}");
    assert_eq!(place.results(), local.results());
    let said = succeeds(&mut cluster.campaign(&place, &format!("{run} --executor hyperqueue")));
    assert!(said.contains("8 simulations, 0 to do"), "{said}");
    let said = succeeds(&mut cluster.campaign(&place, "collect campaign.spool"));
    assert!(said.contains("0 taken in; 8 of 8 tasks are in the database"), "{said}");

    // Long enough to be killed on the way.
    let long = densities(4) + "[[vary]]\nkey = \"time.end\"\nvalues = [4.0]\n";
    let (local, place) = (Place::new("hq_killed_local", &long), Place::new("hq_killed", &long));
    local.succeeds("run . --jobs 2");
    let mut submitted = cluster.campaign(&place, "run . --executor hyperqueue");
    let mut submitted = submitted.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let spool = place.0.join("campaign.spool/0001");
    // A folder of its own is the first thing that a task makes.
    while count(&spool.join("results")) == 0 {
        assert!(submitted.try_wait().unwrap().is_none(), "it ended without having begun: {}", cluster.said());
        std::thread::yield_now();
    }
    cluster.kill_last();
    cluster.add_worker();
    let ended = submitted.wait_with_output().unwrap();
    assert!(ended.status.success(), "{}{}", String::from_utf8_lossy(&ended.stderr), cluster.said());
    assert_eq!(place.results(), local.results());
    let simulations = || place.database().query("SELECT id, hash FROM simulations ORDER BY id", &[]).unwrap();
    let before = simulations();
    assert_eq!(before.len(), 4);
    // As a scheduler that has forgotten that they are done.
    succeeds(&mut place.command("task campaign.spool/0001 0"));
    let mut again = cluster.command("submit --wait --array 0-3 --stdout none --stderr none --");
    succeeds(again.args([Path::new(env!("CARGO_BIN_EXE_souple-campaign")), Path::new("task"), &spool]));
    let said = succeeds(&mut place.command("collect campaign.spool"));
    assert!(said.contains("0 taken in; 4 of 4"), "{said}");
    assert_eq!(simulations(), before);
}
