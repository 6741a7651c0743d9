//! `souple run`: drives a simulation to its end and writes what it gives.
//!
//! ```text
//! scene ── load ──► first frame ──► step, step, … ──► last frame, summary, table
//!                                     │ output due: frame    │ fails: last good state, exit code 3
//!                                     │ checkpoint due       │ Ctrl-C: present state, exit code 130
//! ```

mod folder;
mod progress;
mod report;

use crate::commands::check::reader;
use crate::failure::{Failure, input};
use crate::files;
use crate::terminal::{note, say, say_json};
use anyhow::Context as _;
use clap::Args;
use folder::Folder;
use progress::Watch;
use serde_json::Value;
use souple_simulation::derive_report::explanation;
use souple_simulation::scene::output::Format;
use souple_simulation::{Progress, RunOptions, Simulation};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  souple run scenes/mixed_bar.toml\n  \
    souple run bar.toml --out out/soft --set body.bar.material.0.young=1e5 --threads 4 --json\n  \
    souple run bar.toml --checkpoint-every 1 && souple run bar.toml --resume --set time.end=20\n\n\
    Files: OUT/BODY_0000.vtu, … and OUT/BODY.pvd for ParaView, OUT/summary.json.\n\
    Exit code: 0 finished, 1 expectations not met (with --check), 2 bad input, 3 the simulation failed (its last good\n\
    state is in OUT/last_good.vtu and OUT/checkpoint.bin), 4 results cannot be written, 130 interrupted (state in\n\
    OUT/checkpoint.bin).")]
pub(crate) struct Arguments {
    /// The scene file
    scene: PathBuf,
    /// Where results go; without it, out/ and the scene's name
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Change a value of the scene; repeat it
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// What to compute on (see: souple list devices)
    #[arg(long, default_value = "cpu")]
    device: String,
    /// Number of threads; 0 takes as many as the machine has. Results do not depend on it
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// End with the summary as one line of JSON on standard output
    #[arg(long)]
    json: bool,
    /// Say nothing but what is wrong
    #[arg(long)]
    quiet: bool,
    /// Compare with the scene's expectations; exit code 1 when one is not met
    #[arg(long)]
    check: bool,
    /// Write OUT/checkpoint.bin whenever this many simulated seconds have passed
    #[arg(long, value_name = "S", value_parser = positive)]
    checkpoint_every: Option<f64>,
    /// Go on from OUT/checkpoint.bin
    #[arg(long)]
    resume: bool,
    /// Add to the summary how long the parts of steps took, in ms altogether
    #[arg(long)]
    phases: bool,
    /// Stop as on Ctrl-C when standard input closes, as it does when the program that started this one is gone
    #[arg(long)]
    stop_at_eof: bool,
    /// Say first what each kind of elements costs and how systems are solved
    #[arg(long)]
    explain: bool,
}

fn positive(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "expected a number of seconds".to_owned())?;
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err("expected a positive number of seconds".to_owned()) }
}

/// How the loop over steps ended.
enum End {
    Reached,
    Failed(String),
    Interrupted,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let stop = stop_signal(arguments);
    let file = arguments.scene.display().to_string();
    let text = files::read_text(&arguments.scene)?;
    let options = RunOptions { device: arguments.device.clone(), threads: arguments.threads };
    let mut read = reader(&arguments.scene);
    let (mut simulation, warnings) =
        Simulation::load(&text, &file, &arguments.overrides, &mut read, &options).map_err(input)?;
    let tell = |message: &str| {
        if !arguments.quiet {
            note(message);
        }
    };
    warnings.iter().for_each(|w| tell(w));
    if arguments.check && simulation.scene().expectations.is_empty() {
        tell(&format!("{file}: warning: there is no [[expect]] in this scene, so --check checks nothing"));
    }
    if arguments.explain {
        note(&explanation(&mut simulation));
    }

    // A folder that cannot be written is found before the work, not after it.
    let mut folder = Folder::open(arguments.out.clone().unwrap_or_else(|| default_folder(&arguments.scene)))?;
    folder.pictures = simulation.scene().output.format == Format::Vtu;
    if arguments.resume {
        folder.resume(&mut simulation)?;
    } else {
        folder.frame(&mut simulation)?;
    }
    if arguments.phases {
        simulation.watch();
    }
    let end = steps(arguments, &mut simulation, &mut folder, &stop)?;
    finish(arguments, &mut simulation, &folder, end)
}

/// What stops the steps: set at the end of standard input, where that is asked for.
fn stop_signal(arguments: &Arguments) -> Arc<AtomicBool> {
    let stop = Arc::new(AtomicBool::new(false));
    if arguments.stop_at_eof {
        let closed = stop.clone();
        std::thread::spawn(move || {
            // A standard input that cannot be read is one that nobody holds any more.
            let _ = std::io::copy(&mut std::io::stdin(), &mut std::io::sink());
            closed.store(true, Ordering::Relaxed);
        });
    }
    stop
}

/// `out/bar` for `scenes/bar.toml`.
fn default_folder(scene: &Path) -> PathBuf {
    let stem = scene.file_stem().filter(|s| *s != "-").unwrap_or("scene".as_ref());
    Path::new("out").join(stem)
}

/// Steps until the end, a failure or an interruption; frames and checkpoints on the way.
fn steps(
    arguments: &Arguments,
    simulation: &mut Simulation,
    folder: &mut Folder,
    stop: &Arc<AtomicBool>,
) -> Result<End, Failure> {
    let asked = stop.clone();
    ctrlc::set_handler(move || asked.store(true, Ordering::Relaxed)).context("cannot listen for Ctrl-C")?;
    let mut watch = Watch::start(simulation.end_time(), simulation.time(), arguments.quiet || arguments.json);
    let mut next_checkpoint = arguments.checkpoint_every.map(|s| simulation.time() + s);
    let end = loop {
        let Progress { time, finished, output_due, warnings, .. } = match simulation.advance() {
            Ok(progress) => {
                watch.step(&progress);
                progress
            }
            Err(error) => {
                folder.last_good(simulation)?;
                break End::Failed(error.message);
            }
        };
        if !arguments.quiet {
            watch.warn(&warnings);
        }
        if output_due {
            folder.frame(simulation)?;
        }
        if let (Some(next), Some(every)) = (&mut next_checkpoint, arguments.checkpoint_every)
            // Steps add up with rounding; a checkpoint one step late would be one step too late.
            && time >= *next * (1.0 - 1e-12)
        {
            folder.checkpoint(simulation)?;
            while *next <= time {
                *next += every;
            }
        }
        if finished.is_some() {
            break End::Reached;
        }
        if stop.load(Ordering::Relaxed) {
            folder.frame(simulation)?;
            folder.checkpoint(simulation)?;
            break End::Interrupted;
        }
    };
    watch.end(arguments.quiet);
    Ok(end)
}

/// Writes and prints the summary; the result is the command's.
fn finish(arguments: &Arguments, simulation: &mut Simulation, folder: &Folder, end: End) -> Result<(), Failure> {
    let summary = simulation.summary();
    let mut json = serde_json::to_value(&summary).context("cannot write the summary as JSON")?;
    if matches!(end, End::Interrupted) {
        json["status"] = Value::from("interrupted");
    }
    let results = if arguments.check && matches!(end, End::Reached) { simulation.expectations() } else { Vec::new() };
    if arguments.check {
        json["expectations"] = serde_json::to_value(&results).context("cannot write the expectations as JSON")?;
    }
    if let Some(phases) = simulation.phases() {
        json["phases_ms"] = serde_json::json!({
            "force": phases.force,
            "linearise": phases.linearise,
            "product": phases.product,
            "rest_of_solve": phases.rest_of_solve,
        });
    }
    folder.summary(&json)?;
    if arguments.json {
        say_json(&json)?;
    } else if !arguments.quiet {
        say(&report::text(&summary, &results, &end, folder.path()))?;
    }
    match end {
        End::Failed(message) => Err(Failure::Simulation(format!(
            "{message}\nThe last good state is in {}; {} holds it for --resume.",
            folder.last_good_name(),
            folder.checkpoint_path().display()
        ))),
        End::Interrupted => Err(Failure::Interrupted(format!(
            "interrupted after t = {} s; go on with --resume (state in {})",
            simulation.time(),
            folder.checkpoint_path().display()
        ))),
        End::Reached => {
            let unmet: Vec<String> = results.iter().filter(|r| !r.passed).map(report::comparison).collect();
            if unmet.is_empty() { Ok(()) } else { Err(Failure::Unmet(unmet)) }
        }
    }
}
