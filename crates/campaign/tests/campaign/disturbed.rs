//! Runs that are killed, interrupted, or work side by side: nothing is lost, repeated or left behind.

use crate::chance::{seed, uniform, variable};
use crate::place::{Place, densities, with_souple};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Hash and id of what is recorded; a simulation that ran again has a new id.
fn recorded(place: &Place) -> Vec<(String, i64)> {
    let rows = place.database().query("SELECT hash, id FROM simulations ORDER BY id", &[]).unwrap();
    rows.iter().map(|row| (row.get(0).unwrap(), row.get(1).unwrap())).collect()
}

/// A run that is killed again and again, each time at another moment, ends in the table of one that was not; every
/// simulation is there once, none that was recorded ran again, and nothing half done is left behind.
///
/// `SOUPLE_KILLS` is how often; `SOUPLE_SEED` repeats the moments of another test.
#[test]
fn killed_runs_lose_and_repeat_nothing() {
    with_souple();
    let kills = variable("SOUPLE_KILLS").unwrap_or(6) as u32;
    let seed = seed();
    println!("SOUPLE_KILLS={kills} SOUPLE_SEED={seed}");
    let mut random = seed;
    let undisturbed = Place::new("undisturbed", &densities(2 * kills));
    let started = Instant::now();
    undisturbed.succeeds("run . --jobs 2");
    let whole = started.elapsed();
    let place = Place::new("killed", &densities(2 * kills));
    let mut before: Vec<(String, i64)> = Vec::new();
    for kill in 0..kills {
        let mut run = place.command("run . --jobs 2").stderr(Stdio::null()).stdout(Stdio::null()).spawn().unwrap();
        // Uniform up to half the time of a run: the last ones of many find little to do.
        let part = uniform(&mut random) * 0.5;
        wait(whole.mul_f64(part), &mut run);
        // It may have ended by itself.
        let _ = run.kill();
        run.wait().unwrap();
        let now = recorded(&place);
        assert!(before.iter().all(|old| now.contains(old)), "seed {seed}, kill {kill} at {part} of {whole:?}");
        before = now;
    }
    let begun = Instant::now();
    place.succeeds("run . --jobs 2");
    assert!(begun.elapsed() < Duration::from_secs(50), "claims of the dead are not waited for");
    assert_eq!(place.results(), undisturbed.results(), "seed {seed}");
    let now = recorded(&place);
    assert_eq!(now.len(), place.table().rows.len());
    assert!(before.iter().all(|old| now.contains(old)), "seed {seed}");
    let claims: i64 = place.database().first("SELECT COUNT(*) FROM claims", &[]).unwrap();
    assert_eq!(claims, 0, "seed {seed}");
    // Processes of a killed run stop by themselves, some moments later; what they wrote is the next run's to remove.
    for _ in 0..100 {
        if place.leftovers().is_empty() {
            break;
        }
        place.succeeds("run .");
    }
    assert_eq!(place.leftovers(), Vec::<String>::new(), "seed {seed}");
}

/// Waits until the time is over or the process has ended.
fn wait(time: Duration, process: &mut Child) {
    let started = Instant::now();
    while started.elapsed() < time && process.try_wait().unwrap().is_none() {
        std::thread::yield_now();
    }
}

/// Two runs of one campaign at the same time on one file share the work: each simulation is done by one of them, and
/// both end when all are done.
#[test]
fn two_runs_share_the_work() {
    with_souple();
    let place = Place::new("shared", &densities(8));
    both_share(&place, "campaign.db", 8);
    assert_eq!(recorded(&place).len(), 8);
}

/// Starts two runs at once; both must succeed, say that all is done, and have begun each simulation once in all.
pub(crate) fn both_share(place: &Place, db: &str, count: usize) {
    let start = |_| {
        let mut command = place.command("run . --jobs 1");
        command.args(["--db", db]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    };
    let runs: Vec<Child> = (0..2).map(start).collect();
    let mut done = 0;
    for run in runs {
        let output = run.wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{said}");
        assert!(String::from_utf8_lossy(&output.stdout).contains(&format!("{count} of {count} done")), "{said}");
        done += said.lines().filter(|line| line.contains(" finished (left")).count();
    }
    assert_eq!(done, count, "each simulation is recorded by one run");
}

/// Ctrl-C in a terminal reaches the run and its simulations: they stop within the time that they have, nothing is
/// recorded of them, the exit code is 130, and the same command completes the campaign.
#[cfg(unix)]
#[test]
fn interrupted_runs_go_on() {
    use std::os::unix::process::CommandExt as _;
    with_souple();
    // The last two would take minutes.
    let long = format!("{}[[vary]]\nkey = \"time.end\"\nvalues = [0.02, 1e4]\n", densities(2));
    let place = Place::new("interrupted", &long);
    let mut command = place.command("run . --jobs 2");
    let mut run = command.process_group(0).stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
    let mut said = std::io::BufReader::new(run.stderr.take().unwrap());
    let mut text = String::new();
    while !text.contains("2/4 ") {
        assert!(std::io::BufRead::read_line(&mut said, &mut text).unwrap() > 0, "{text}");
    }
    let group = format!("-{}", run.id());
    assert!(Command::new("kill").args(["-INT", "--", &group]).status().unwrap().success());
    std::io::Read::read_to_string(&mut said, &mut text).unwrap();
    assert_eq!(run.wait().unwrap().code(), Some(130), "{text}");
    assert!(text.contains("interrupted; the same command goes on"), "{text}");
    let status: Vec<String> = place.table().rows.iter().map(|row| row[5].clone()).collect();
    assert_eq!(place.table().heads[5], "status");
    assert_eq!(status, ["finished", "finished", "to do", "to do"]);
    assert_eq!(place.leftovers(), Vec::<String>::new());
    // Shorter ones in their place; the first two are known.
    std::fs::write(place.0.join("campaign.toml"), long.replace("1e4", "0.03")).unwrap();
    let (out, err) = place.succeeds("resume .");
    assert!(err.contains("4 simulations, 2 to do") && out.contains("4 of 4 done"), "{out}{err}");
}

/// `souple run --stop-at-eof` ends when its standard input closes: exit code 130, a summary that says so, and a last state
/// from which `--resume` goes on to the end.
#[test]
fn closing_standard_input_ends_a_simulation() {
    with_souple();
    let place = Place::new("stop_at_eof", "");
    let souple = std::path::Path::new(env!("CARGO_BIN_EXE_souple-campaign")).with_file_name("souple");
    let start = |words: &str| {
        let mut command = Command::new(&souple);
        command.args(words.split(' ')).current_dir(&place.0).stdin(Stdio::piped());
        command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
    };
    let mut run = start("run bar.toml --out out --stop-at-eof --set time.end=1e4");
    drop(run.stdin.take());
    assert_eq!(run.wait().unwrap().code(), Some(130));
    let summary = || std::fs::read_to_string(place.0.join("out/summary.json")).unwrap();
    assert!(summary().contains("\"interrupted\""), "{}", summary());
    let steps = |text: &str| -> u64 {
        let at = text.split("\"steps\":").nth(1).unwrap();
        at.trim_start().split(|c: char| !c.is_ascii_digit()).next().unwrap().parse().unwrap()
    };
    let made = steps(&summary());
    assert!(made > 0);
    let end = 1e-3 * (made + 5) as f64;
    let mut run = start(&format!("run bar.toml --out out --resume --set time.end={end}"));
    assert_eq!(run.wait().unwrap().code(), Some(0));
    assert!(summary().contains("\"finished\"") && steps(&summary()) == made + 5, "{}", summary());
}
