//! Writing: a group with its members, and simulations one by one.

use super::{Database, DatabaseError, Value};
use crate::group::{Group, Source, Variation};
use crate::owner::Owner;
use crate::plan::Planned;
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;
use std::collections::BTreeMap;

/// One row of values of any kinds.
macro_rules! row {
    ($($value:expr),* $(,)?) => { [$(Value::from($value)),*] };
}

/// Where simulations run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// Its name.
    pub host: String,
    /// Its processor.
    pub processor: String,
    /// Number of threads that it runs at the same time.
    pub cores: usize,
    /// Its operating system.
    pub system: String,
}

/// What became of a simulation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Of everything that determines it.
    pub hash: String,
    /// `finished`, `at rest`, `failed`, `invalid`, `crashed`, `unwritten` or `changed`.
    pub status: String,
    /// Why it is one of the latter five.
    pub reason: String,
    /// Program and device.
    pub program: String,
    /// Device.
    pub device: String,
    /// Threads.
    pub threads: usize,
    /// Time that its process took, in s.
    pub wall_s: f64,
    /// `summary.json`; null where there is none. It stays in its file when the rest is written to another one.
    #[serde(skip)]
    pub summary: Json,
    /// Body, position, law, parameters as JSON.
    pub materials: Vec<(String, usize, String, String)>,
    /// Probe, quantity and value of what follows from the probes.
    pub measured: Vec<(String, String, f64)>,
    /// Body, path relative to the database's folder, SHA-256.
    pub meshes: Vec<(String, String, String)>,
    /// Path of the picture of its end, relative like those.
    pub picture: Option<String>,
}

/// A place in a group.
#[derive(Clone, Copy, Debug)]
pub struct Member<'a> {
    /// What it asks for.
    pub planned: &'a Planned,
    /// Hash of its simulation.
    pub hash: &'a str,
}

/// Writes a group with its members, or finds it; its id.
///
/// `definition` identifies the description.
///
/// # Errors
///
/// When the database cannot be written.
pub fn add_group(
    database: &Database,
    group: &Group,
    folder: &str,
    definition: &str,
    members: &[Member<'_>],
) -> Result<i64, DatabaseError> {
    database.transaction(|| {
        let source = match group.source {
            Source::Toml => "campaign.toml",
            Source::Folder => "params.csv",
        };
        let added = database.query(
            "INSERT INTO groups (name, definition, folder, source, scene, samples) VALUES ($1, $2, $3, $4, $5, $6)
             ON CONFLICT (name, definition) DO NOTHING RETURNING id",
            &row![&group.name, definition, folder, source, &group.scene.text, group.samples],
        )?;
        let Some(added) = added.first() else {
            let sql = "SELECT id FROM groups WHERE name = $1 AND definition = $2";
            let id = database.first(sql, &row![&group.name, definition])?;
            renew_members(database, id, members)?;
            return Ok(id);
        };
        let id = added.get(0)?;
        let parameters = add_parameters(database, id, group)?;
        let bars = add_bars(database, id, group)?;
        add_members(database, id, members, &parameters, &bars)?;
        Ok(id)
    })
}

fn add_parameters(database: &Database, group_id: i64, group: &Group) -> Result<Vec<i64>, DatabaseError> {
    let mut ids = Vec::new();
    for (position, parameter) in group.parameters.iter().enumerate() {
        let (variation, first, last, step) = match parameter.variation {
            Variation::List => ("list", None, None, None),
            Variation::Adding { from, to, step } => ("adding", Some(from), Some(to), Some(step)),
            Variation::Multiplying { from, to, factor } => ("multiplying", Some(from), Some(to), Some(factor)),
            Variation::LatinHypercube { low, high } => ("latin hypercube", Some(low), Some(high), None),
        };
        let count = parameter.values.len();
        ids.push(database.first(
            "INSERT INTO parameters (group_id, position, name, variation, first, last, step, count)
             VALUES ($1, $2, $3, $4, $5, $6, $7, $8) RETURNING id",
            &row![group_id, position, &parameter.name, variation, first, last, step, count],
        )?);
    }
    Ok(ids)
}

fn add_bars(database: &Database, group_id: i64, group: &Group) -> Result<Vec<i64>, DatabaseError> {
    let mut ids = Vec::new();
    for (position, bar) in group.bars.iter().enumerate() {
        let sql = "INSERT INTO bars (group_id, position, name) VALUES ($1, $2, $3) RETURNING id";
        let id: i64 = database.first(sql, &row![group_id, position, &bar.name])?;
        let rows: Vec<_> = (bar.sections.iter().enumerate())
            .map(|(position, s)| row![id, position, s.until, &s.law, &s.element, s.quadrature.as_ref()])
            .collect();
        database.insert("sections", "bar_id, position, until, law, element, quadrature", &rows)?;
        ids.push(id);
    }
    Ok(ids)
}

fn add_members(
    database: &Database,
    group_id: i64,
    members: &[Member<'_>],
    parameters: &[i64],
    bars: &[i64],
) -> Result<(), DatabaseError> {
    let rows: Vec<_> = members
        .iter()
        .map(|m| row![group_id, m.planned.number, m.hash, m.planned.bar.map(|b| bars[b]), m.planned.device.as_str()])
        .collect();
    database.insert("members", "group_id, number, hash, bar_id, device", &rows)?;
    let values = |m: &Member<'_>| -> Vec<[Value; 4]> {
        let own = parameters.iter().zip(&m.planned.values);
        own.map(|(&parameter, value)| row![group_id, m.planned.number, parameter, value.to_string()]).collect()
    };
    let rows: Vec<_> = members.iter().flat_map(values).collect();
    database.insert("member_values", "group_id, number, parameter_id, value", &rows)
}

/// Writes the hashes of a known group anew where they changed: another program gives other results.
fn renew_members(database: &Database, group_id: i64, members: &[Member<'_>]) -> Result<(), DatabaseError> {
    let rows = database.query("SELECT number, hash FROM members WHERE group_id = $1", &row![group_id])?;
    let known: BTreeMap<usize, String> =
        rows.iter().map(|row| Ok((row.get(0)?, row.get(1)?))).collect::<Result<_, DatabaseError>>()?;
    for member in members {
        if known.get(&member.planned.number).is_none_or(|hash| hash != member.hash) {
            let sql = "UPDATE members SET hash = $3 WHERE group_id = $1 AND number = $2";
            database.execute(sql, &row![group_id, member.planned.number, member.hash])?;
        }
    }
    Ok(())
}

/// What is recorded of a simulation: its id and its status.
///
/// # Errors
///
/// When the database cannot be read.
pub fn recorded(database: &Database, hash: &str) -> Result<Option<(i64, String)>, DatabaseError> {
    let rows = database.query("SELECT id, status FROM simulations WHERE hash = $1", &row![hash])?;
    rows.first().map(|row| Ok((row.get(0)?, row.get(1)?))).transpose()
}

/// What is recorded of the simulations of a group: id and status by hash.
///
/// # Errors
///
/// When the database cannot be read.
pub fn recorded_in(database: &Database, group: i64) -> Result<BTreeMap<String, (i64, String)>, DatabaseError> {
    let sql = "SELECT s.hash, s.id, s.status FROM simulations s
               WHERE s.hash IN (SELECT m.hash FROM members m WHERE m.group_id = $1)";
    let rows = database.query(sql, &row![group])?;
    rows.iter().map(|row| Ok((row.get(0)?, (row.get(1)?, row.get(2)?)))).collect()
}

/// Records a simulation in one transaction, if its claim is still held, and ends the claim; whether it was recorded.
/// What was recorded under its hash before is replaced.
///
/// # Errors
///
/// When the database cannot be written.
pub fn record(database: &Database, outcome: &Outcome, machine: &Machine, owner: &Owner) -> Result<bool, DatabaseError> {
    database.transaction(|| {
        // Held until the end of the transaction, so that nobody else can take the claim before what it is for is there.
        let held = database.execute(
            "UPDATE claims SET beat = {now} WHERE hash = $1 AND owner = $2",
            &row![&outcome.hash, owner.to_string()],
        )?;
        if held == 0 {
            return Ok(false);
        }
        simulation(database, outcome, machine)?;
        database.execute("DELETE FROM claims WHERE hash = $1", &row![&outcome.hash])?;
        Ok(true)
    })
}

fn simulation(database: &Database, outcome: &Outcome, machine: &Machine) -> Result<(), DatabaseError> {
    let described = row![&machine.host, &machine.processor, machine.cores, &machine.system];
    let known = "SELECT id FROM machines WHERE host = $1 AND processor = $2 AND cores = $3 AND system = $4";
    let machine_id: i64 = match database.query(known, &described)?.first() {
        Some(row) => row.get(0)?,
        None => {
            let add = "INSERT INTO machines (host, processor, cores, system) VALUES ($1, $2, $3, $4)
                       ON CONFLICT DO NOTHING";
            database.execute(add, &described)?;
            database.first(known, &described)?
        }
    };
    database.execute("DELETE FROM simulations WHERE hash = $1", &row![&outcome.hash])?;
    let summary = &outcome.summary;
    let id: i64 = database.first(
        "INSERT INTO simulations (hash, status, reason, program, device, threads, machine_id, wall_s, steps,
         simulated_s, nodes) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11) RETURNING id",
        &row![
            &outcome.hash,
            &outcome.status,
            &outcome.reason,
            &outcome.program,
            &outcome.device,
            outcome.threads,
            machine_id,
            outcome.wall_s,
            summary["steps"].as_i64(),
            summary["simulated_s"].as_f64(),
            summary["nodes"].as_i64(),
        ],
    )?;
    let rows: Vec<_> = (outcome.materials.iter())
        .map(|(body, position, law, parameters)| row![id, body, *position, law, parameters])
        .collect();
    database.insert("materials", "simulation_id, body, position, law, parameters", &rows)?;
    let rows: Vec<_> = outcome.meshes.iter().map(|(body, path, hash)| row![id, body, path, hash]).collect();
    database.insert("meshes", "simulation_id, body, path, hash", &rows)?;
    if let Some(path) = &outcome.picture {
        database.insert("pictures", "simulation_id, path", &[row![id, path]])?;
    }
    let elements = summary["elements"].as_object().into_iter().flatten();
    let rows: Vec<_> = elements.map(|(element, count)| row![id, element, count.as_i64()]).collect();
    database.insert("element_counts", "simulation_id, element, count", &rows)?;
    let steps = summary["steps"].as_f64().unwrap_or(0.0).max(1.0);
    let phases = summary["phases_ms"].as_object().into_iter().flatten();
    let phases = phases.filter_map(|(phase, ms)| Some((phase.clone(), ms.as_f64()? / steps)));
    let step = summary["step_ms"]["mean"].as_f64().map(|ms| ("step".to_owned(), ms));
    let rows: Vec<_> = phases.chain(step).map(|(phase, ms)| row![id, phase, ms]).collect();
    database.insert("timings", "simulation_id, phase, ms_per_step", &rows)?;
    let expectations = summary["expectations"].as_array().into_iter().flatten().enumerate();
    let rows: Vec<_> = expectations
        .map(|(position, e)| {
            let (name, difference) = (e["name"].as_str().unwrap_or(""), e["difference"].as_f64());
            row![id, position, name, difference, e["tolerance"].as_f64().unwrap_or(0.0), e["passed"] == true]
        })
        .collect();
    database.insert("errors", "simulation_id, position, name, difference, tolerance, met", &rows)?;
    let derived = outcome.measured.iter().filter(|(_, _, x)| x.is_finite());
    let mut measurements: Vec<_> = derived.map(|(probe, quantity, x)| row![id, probe, quantity, "", *x]).collect();
    for (component, value) in summary["cg_iterations"].as_object().into_iter().flatten() {
        if let Some(x) = value.as_f64() {
            measurements.push(row![id, crate::report::SOLVER, "cg iterations per step", component, x]);
        }
    }
    for (probe, quantities) in summary["probes"].as_object().into_iter().flatten() {
        for (quantity, value) in quantities.as_object().into_iter().flatten() {
            match measured(value) {
                Measured::Numbers(all) => {
                    measurements.extend(all.into_iter().map(|(component, x)| row![id, probe, quantity, component, x]))
                }
                Measured::Curve(points) => add_curve(database, id, probe, quantity, &points)?,
            }
        }
    }
    database.insert("measurements", "simulation_id, probe, quantity, component, value", &measurements)
}

/// What a probe gives.
enum Measured {
    /// A number, or the components of a vector or a tensor.
    Numbers(Vec<(&'static str, f64)>),
    /// Points.
    Curve(Vec<[f64; 3]>),
}

fn measured(value: &Json) -> Measured {
    let numbers = |list: &[Json]| list.iter().map(Json::as_f64).collect::<Option<Vec<f64>>>();
    let Json::Array(list) = value else {
        return Measured::Numbers(value.as_f64().map(|x| ("", x)).into_iter().collect());
    };
    match numbers(list) {
        Some(values) if !values.is_empty() => {
            let names: &[&str] =
                if values.len() == 3 { &["x", "y", "z"] } else { &["xx", "yy", "zz", "xy", "yz", "zx"] };
            Measured::Numbers(names.iter().copied().zip(values).collect())
        }
        _ => {
            let points = list.iter().filter_map(|p| numbers(p.as_array()?)?.try_into().ok());
            Measured::Curve(points.collect())
        }
    }
}

fn add_curve(
    database: &Database,
    simulation: i64,
    probe: &str,
    quantity: &str,
    points: &[[f64; 3]],
) -> Result<(), DatabaseError> {
    let sql = "INSERT INTO curves (simulation_id, probe, quantity) VALUES ($1, $2, $3) RETURNING id";
    let curve: i64 = database.first(sql, &row![simulation, probe, quantity])?;
    let rows: Vec<_> = points.iter().enumerate().map(|(position, p)| row![curve, position, p[0], p[1], p[2]]).collect();
    database.insert("points", "curve_id, position, x, y, z", &rows)
}
