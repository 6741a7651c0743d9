//! What it takes before the first step: seconds and memory to load a scene, by phase.
//!
//! The whole is measured first, in one piece, as an application would do it: the highest memory of the process is what
//! the system counted until then. The parts are run once more afterwards, one by one, for their times alone.

use crate::machine::{Machine, machine};
use crate::step::{Bar, StepError};
use serde::Serialize;
use souple_operators::{Elements, Threads};
use souple_program::Costs;
use souple_simulation::prepare::{catalogue, prepare};
use souple_simulation::scene::parse_with_overrides;
use souple_simulation::{LoadError, RunOptions, Simulation, open_device};
use std::sync::Arc;
use std::time::Instant;

/// What was measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// On what.
    pub machine: Machine,
    /// Name of the device.
    pub device: String,
    /// Threads.
    pub threads: usize,
    /// Number of elements.
    pub elements: usize,
    /// Number of unknowns.
    pub unknowns: usize,
    /// From the scene's text to a simulation that can step, in s.
    pub load_s: f64,
    /// Highest memory of the process by then, in bytes, where the system tells (VmHWM).
    pub peak_memory_bytes: Option<u64>,
    /// Memory before, in bytes, likewise.
    pub memory_before_bytes: Option<u64>,
    /// Text to scene, in s.
    pub parse_s: f64,
    /// Mesh, regions, checks, conditions, in s.
    pub prepare_s: f64,
    /// Programs derived and compiled, carried values, masses, in s.
    pub elements_s: f64,
    /// Pattern of the matrix and the places of every element's blocks in it, in s; part of a load where there is a matrix.
    pub pattern_s: f64,
}

/// Loads a bar, then its parts once more.
///
/// # Errors
/// When it cannot be loaded.
pub fn measure(bar: &Bar, options: &RunOptions, progress: &mut dyn FnMut(&str)) -> Result<Report, StepError> {
    const FILE: &str = "bar";
    let text = bar.scene();
    let mut read = |path: &str| Err(format!("a generated bar reads no {path}"));
    progress("loading");
    let memory_before_bytes = peak_memory();
    let start = Instant::now();
    let (simulation, _) = Simulation::load(&text, FILE, &[], &mut read, options)?;
    let load_s = start.elapsed().as_secs_f64();
    let peak_memory_bytes = peak_memory();
    let (elements, unknowns) = (simulation.element_count(), simulation.unknowns());
    drop(simulation);

    progress("loading once more in parts");
    let start = Instant::now();
    let (scene, _) = parse_with_overrides(&text, FILE, &[], &catalogue()).map_err(LoadError::from)?;
    let parse_s = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let (prepared, _) = prepare(&scene, FILE, &mut read).map_err(LoadError::from)?;
    let prepare_s = start.elapsed().as_secs_f64();
    let count = match options.threads {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        n => n,
    };
    let threads = Arc::new(Threads::new(count).map_err(LoadError::Threads)?);
    let device = open_device(&options.device)?;
    let dimension = prepared.blocks.first().map_or(3, |b| b.element.dimension());
    let start = Instant::now();
    let built = Elements::new(dimension, &prepared.nodes, prepared.blocks, &*device, threads, Costs::default());
    let (built, _) = built.map_err(LoadError::from)?;
    let elements_s = start.elapsed().as_secs_f64();
    let start = Instant::now();
    std::hint::black_box(built.pattern());
    let pattern_s = start.elapsed().as_secs_f64();
    Ok(Report {
        machine: machine(),
        device: options.device.clone(),
        threads: count,
        elements,
        unknowns,
        load_s,
        peak_memory_bytes,
        memory_before_bytes,
        parse_s,
        prepare_s,
        elements_s,
        pattern_s,
    })
}

/// Highest memory of this process so far in bytes, where the system tells.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kib * 1024)
}
