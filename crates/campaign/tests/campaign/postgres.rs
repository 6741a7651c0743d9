//! The same campaigns in PostgreSQL; a server is started where there is one on this machine.

use crate::disturbed::both_share;
use crate::place::{Place, connect, densities, last_table, timeless, with_souple};
use souple_campaign::campaign::read;
use souple_campaign::database::{Database, Member, add_group, table};
use souple_campaign::plan::plan;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// A server that listens on a socket in a folder of its own only, ended with the test.
struct Server {
    socket: PathBuf,
    data: PathBuf,
    programs: PathBuf,
    user: Option<&'static str>,
}

impl Server {
    /// None, with a word, where PostgreSQL is missing.
    fn start(name: &str) -> Option<Server> {
        let Some(programs) = programs() else {
            println!("skipped: no PostgreSQL (initdb is neither on the path nor in /usr/lib/postgresql)");
            return None;
        };
        // The names of sockets are at most a hundred bytes long.
        let folder = std::env::temp_dir().join(format!("souple_{name}_{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        // PostgreSQL refuses to run as root.
        let root = run(Command::new("id").arg("-u")).stdout == b"0\n";
        let user = root.then_some("nobody");
        if let Some(user) = user {
            run(Command::new("chown").arg(user).arg(&folder));
        }
        let server = Server { data: folder.join("data"), socket: folder, programs, user };
        let data = server.data.display().to_string();
        server.run("initdb", &["-D", &data, "-U", "souple", "-A", "trust", "-N", "--no-locale", "-E", "UTF8"]);
        let options = format!("-c listen_addresses= -c fsync=off -k {}", server.socket.display());
        let log = server.socket.join("log").display().to_string();
        server.run("pg_ctl", &["-D", &data, "-w", "-l", &log, "-o", &options, "start"]);
        Some(server)
    }

    fn run(&self, program: &str, words: &[&str]) {
        let program = self.programs.join(program);
        let mut command = match self.user {
            None => Command::new(program),
            Some(user) => {
                let mut command = Command::new("setpriv");
                // Not every system has a group of that name.
                let group = run(Command::new("id").args(["-g", user])).stdout;
                let group = String::from_utf8(group).unwrap();
                command.args(["--reuid", user, "--clear-groups", "--regid", group.trim()]).arg(program);
                command
            }
        };
        run(command.args(words).current_dir(&self.socket));
    }

    fn url(&self, database: &str) -> String {
        let socket = self.socket.display().to_string().replace('/', "%2F");
        format!("postgres://souple@{socket}/{database}")
    }

    /// An empty database and its URL.
    fn database(&self, name: &str) -> String {
        let socket = self.socket.display().to_string();
        self.run("createdb", &["-h", &socket, "-U", "souple", name]);
        self.url(name)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let data = self.data.display().to_string();
        self.run("pg_ctl", &["-D", &data, "-m", "immediate", "stop"]);
        let _ = std::fs::remove_dir_all(&self.socket);
    }
}

fn run(command: &mut Command) -> Output {
    let output = command.stdin(Stdio::null()).output().unwrap_or_else(|e| panic!("{command:?}: {e}"));
    let err = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {err}");
    output
}

/// The folder of PostgreSQL's programs; Debian has it beside the search path.
fn programs() -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let versions = std::fs::read_dir("/usr/lib/postgresql").into_iter().flatten().flatten();
    let mut folders: Vec<PathBuf> = versions.map(|entry| entry.path().join("bin")).collect();
    folders.sort();
    folders.reverse();
    folders.extend(std::env::split_paths(&path));
    // Beside each other they are only where they were installed, not where a link leads to them.
    folders.into_iter().find(|folder| ["initdb", "pg_ctl", "createdb"].iter().all(|p| folder.join(p).is_file()))
}

/// Parameters and bars of a group's simulations, and everything else that its description says.
fn contents(database: &Database, group: i64) -> Vec<String> {
    let mut all: Vec<String> = table(database, group).unwrap().rows.iter().map(|row| row.join(";")).collect();
    for sql in [
        "SELECT name, source, scene, samples FROM groups WHERE id = $1",
        "SELECT position, name, variation, first, last, step, count FROM parameters WHERE group_id = $1 ORDER BY position",
        "SELECT b.position, b.name, s.position, s.until, s.law, s.element, s.quadrature FROM bars b
         JOIN sections s ON s.bar_id = b.id WHERE b.group_id = $1 ORDER BY b.position, s.position",
        "SELECT number, hash, device FROM members WHERE group_id = $1 ORDER BY number",
    ] {
        all.extend(database.query(sql, &[group.into()]).unwrap().iter().map(|row| format!("{row:?}")));
    }
    all
}

/// Everything that PostgreSQL promises, with one server: the example's 24 simulations are the same in both databases,
/// column by column; a campaign gives the same results; two runs at once share the work; a passing error is an error
/// with the server's words, and a server that is not there is named.
#[test]
fn both_databases_hold_the_same() {
    with_souple();
    let Some(server) = Server::start("same") else { return };

    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/example");
    let group = read(&folder).unwrap();
    let planned = plan(&group).unwrap();
    let hashes: Vec<String> = planned.iter().map(|p| format!("hash {}", p.number)).collect();
    let members: Vec<Member<'_>> =
        planned.iter().zip(&hashes).map(|(planned, hash)| Member { planned, hash }).collect();
    let example = server.database("example");
    let place = Place::new("postgres_example", "");
    let filled = |database: &Database| {
        let id = add_group(database, &group, "example", "definition", &members).unwrap();
        assert_eq!(add_group(database, &group, "example", "definition", &members).unwrap(), id, "it is there once");
        contents(database, id)
    };
    let in_server = filled(&connect(&example));
    assert_eq!(in_server, filled(&place.database()));
    assert_eq!(in_server.len(), 24 + 1 + 12 + 3 + 24, "simulations, group, parameters, sections, members");
    let shown = table(&connect(&example), 1).unwrap();
    let column = |name: &str| shown.heads.iter().position(|head| head == name).unwrap();
    for (n, row) in shown.rows.iter().enumerate() {
        // Table 5.2: the cells vary most quickly, then Young's modulus, then the bar.
        assert_eq!(row[column("nbCube")], ["40", "80", "160", "320"][n % 4]);
        assert_eq!(row[column("moduleYoung")], ["1000000.0", "2000000.0", "3000000.0"][n % 12 / 4]);
        assert_eq!(row[column("bar")], ["BarreSimple2D", "HookeSVT3D"][n / 12]);
        for (name, value) in crate::example::FIXED {
            assert_eq!(row[column(name)].parse::<f64>().unwrap(), *value, "{name}");
        }
    }

    let place = Place::new(
        "postgres_run",
        &densities(3).replace("step = 10", "step = 10\n[[vary]]\nkey = \"time.step\"\nvalues = [1e-3, 1.0]"),
    );
    place.succeeds("run .");
    let url = server.database("run");
    place.succeeds(&format!("run . --db {url}"));
    let database = connect(&url);
    assert_eq!(timeless(&last_table(&database)), place.results());
    for table in ["curves", "points", "meshes", "errors", "materials", "element_counts", "measurements", "timings"] {
        let count =
            |database: &Database| -> i64 { database.first(&format!("SELECT COUNT(*) FROM {table}"), &[]).unwrap() };
        assert_eq!(count(&database), count(&place.database()), "{table}");
        assert!(count(&database) > 0, "{table}");
    }
    let (_, err) = place.succeeds(&format!("resume . --db {url}"));
    assert!(err.contains("6 simulations, 0 to do"), "{err}");
    assert!(place.succeeds(&format!("list --db {url}")).0.contains("densities  6"));
    assert!(place.succeeds(&format!("show densities --db {url}")).0.contains("invalid"));
    assert!(place.0.join("run.results").is_dir(), "results have a folder of their own");

    let place = Place::new("postgres_shared", &densities(8));
    let url = server.database("shared");
    both_share(&place, &url, 8);
    let count: i64 = connect(&url).first("SELECT COUNT(*) FROM simulations", &[]).unwrap();
    assert_eq!(count, 8);
    crate::serve::stamps_tell_of_changes(&connect(&url), &connect(&url));

    let error = database.query("SELECT nothing FROM nowhere", &[]).unwrap_err().to_string();
    assert!(error.contains("nowhere") && error.contains("postgres://souple@"), "{error}");
    let error = database.transaction(|| {
        database.execute("DELETE FROM timings", &[])?;
        database.execute("DELETE FROM nowhere", &[])
    });
    assert!(error.is_err());
    let timings: i64 = database.first("SELECT COUNT(*) FROM timings", &[]).unwrap();
    assert!(timings > 0, "nothing of a failed transaction is done");
    let missing = place.command("list --db postgres://souple:secret@127.0.0.1:1/none").output().unwrap();
    let said = String::from_utf8_lossy(&missing.stderr).into_owned();
    assert_eq!(missing.status.code(), Some(2));
    assert!(said.contains("postgres://souple@127.0.0.1:1/none: ") && !said.contains("secret"), "{said}");
}
