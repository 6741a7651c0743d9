//! Simulations as tasks of a scheduler: what is submitted, run by a stand-in that runs tasks in a random order and some of
//! them twice, gives the table of a local run.
//!
//! `SOUPLE_SEED` repeats the order of another test.

use crate::chance::{seed, shuffled};
use crate::place::{Place, densities, with_souple};
use std::process::{Command, Stdio};

/// A shell function that runs a command with each number of an array, in an order of its own, some of them twice.
#[cfg(unix)]
fn stand_in() -> String {
    let mut random = seed();
    println!("SOUPLE_SEED={random}");
    let order: Vec<String> = shuffled(TASKS, &mut random).iter().map(usize::to_string).collect();
    format!(
        r#"
run_all() {{ # VARIABLE FIRST-LAST COMMAND…
  variable=$1; first=${{2%-*}}; last=${{2#*-}}; shift 2
  for index in {}; do
    if [ "$index" -ge "$first" ] && [ "$index" -le "$last" ]; then
      env "$variable=$index" "$@" || exit 1
    fi
  done
}}
"#,
        order.join(" ")
    )
}

/// `hq submit` with its options, as far as they are used: what it does not know it refuses.
#[cfg(unix)]
fn stand_in_for_hq(place: &Place) -> String {
    use std::os::unix::fs::PermissionsExt as _;
    let functions = stand_in();
    let text = format!(
        r#"#!/bin/sh
{functions}
[ "$1" = submit ] || exit 2
shift
while [ "$1" != -- ]; do
  case $1 in
    --wait) shift ;;
    --array) array=$2; shift 2 ;;
    --name|--cpus|--stdout|--stderr) shift 2 ;;
    *) exit 2 ;;
  esac
done
shift
run_all HQ_TASK_ID "$array" "$@"
"#
    );
    let folder = place.0.join("bin");
    std::fs::create_dir(&folder).unwrap();
    std::fs::write(folder.join("hq"), text).unwrap();
    std::fs::set_permissions(folder.join("hq"), std::fs::Permissions::from_mode(0o755)).unwrap();
    let path = std::env::var("PATH").unwrap_or_default();
    format!("{}:{path}", folder.display())
}

/// Tasks of the campaign.
#[cfg(unix)]
const TASKS: usize = 6;

/// Three simulations that come to their end, and three that are refused.
fn campaign() -> String {
    format!("{}[[vary]]\nkey = \"time.step\"\nvalues = [1e-3, 1.0]\n", densities(3))
}

/// HyperQueue is given a command for all tasks; the run takes in what they give while it waits.
#[cfg(unix)]
#[test]
fn hyperqueue_gives_the_same_table() {
    with_souple();
    let local = Place::new("hq_local", &campaign());
    local.succeeds("run .");
    let place = Place::new("hq", &campaign());
    let path = stand_in_for_hq(&place);
    let run = || {
        let mut command = place.command("run . --executor hyperqueue");
        let output = command.env("PATH", &path).output().unwrap();
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, said) = run();
    assert_eq!(code, Some(0), "{said}");
    assert_eq!(place.results(), local.results());
    let count: i64 = place.database().first("SELECT COUNT(*) FROM simulations", &[]).unwrap();
    assert_eq!(count, 6);
    let mesh: String = place.database().first("SELECT path FROM meshes ORDER BY simulation_id", &[]).unwrap();
    assert!(place.0.join(mesh).is_file(), "files are among the results of the database");
    let (code, said) = run();
    assert!(code == Some(0) && said.contains("6 simulations, 0 to do"), "{said}");
}

/// For Slurm a script is written and instructions are given; collecting twice, or after a local run has done the same,
/// records nothing twice.
#[cfg(unix)]
#[test]
fn slurm_gives_the_same_table() {
    with_souple();
    let local = Place::new("slurm_local", &campaign());
    local.succeeds("run .");
    let place = Place::new("slurm", &campaign());
    let (said, _) = place.succeeds("run . --executor slurm --jobs 2 --threads 3");
    assert!(said.contains("sbatch ") && said.contains("souple campaign collect"), "{said}");
    let script = place.0.join("campaign.spool/0001/submit.sbatch");
    let text = std::fs::read_to_string(&script).unwrap();
    assert!(text.contains("#SBATCH --array=0-5%2\n") && text.contains("#SBATCH --cpus-per-task=3\n"), "{text}");
    let run = format!("{}\nrun_all SLURM_ARRAY_TASK_ID \"$1\" sh {}", stand_in(), script.display());
    let tasks = |range: &str| {
        let shell = Command::new("sh").args(["-c", &run, "sh", range]).stdout(Stdio::null()).status();
        assert!(shell.unwrap().success(), "{range}");
    };
    tasks("4-5");
    let collect = "collect campaign.spool";
    assert!(place.succeeds(collect).0.contains("2 taken in; 2 of 6 tasks are in the database"));
    let before: i64 = place.database().first("SELECT MIN(id) FROM simulations", &[]).unwrap();
    tasks("0-5");
    assert!(place.succeeds(collect).0.contains("4 taken in; 6 of 6 tasks are in the database"));
    assert!(place.succeeds(collect).0.contains("0 taken in; 6 of 6"));
    assert_eq!(place.results(), local.results());
    let after: i64 = place.database().first("SELECT MIN(id) FROM simulations", &[]).unwrap();
    assert_eq!(after, before, "what was there is not recorded again");

    let other = Place::new("slurm_none", &campaign());
    other.succeeds("run . --executor slurm");
    other.succeeds("run .");
    let script = other.0.join("campaign.spool/0001/submit.sbatch");
    let done = Command::new("sh").arg(script).env("SLURM_ARRAY_TASK_ID", "2").status().unwrap();
    assert!(done.success());
    assert!(other.succeeds(collect).0.contains("0 taken in; 1 of 6"));
    let empty = other.command("collect .").output().unwrap();
    assert_eq!(empty.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&empty.stderr).contains("holds no simulations"));
}
