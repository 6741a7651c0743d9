//! Writing: a group with its members, and simulations one by one.

use super::{Database, DatabaseError};
use crate::group::{Group, Source, Variation};
use crate::plan::Planned;
use rusqlite::{OptionalExtension as _, Transaction, params};
use serde_json::Value as Json;

/// Where simulations run.
#[derive(Clone, Debug, PartialEq, Eq)]
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
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Of everything that determines it.
    pub hash: String,
    /// `finished`, `at rest`, `failed`, `invalid` or `crashed`.
    pub status: String,
    /// Why it is one of the latter three.
    pub reason: String,
    /// Program and device.
    pub program: String,
    /// Device.
    pub device: String,
    /// Threads.
    pub threads: usize,
    /// Time that its process took, in s.
    pub wall_s: f64,
    /// `summary.json`; null where there is none.
    pub summary: Json,
    /// Body, position, law, parameters as JSON.
    pub materials: Vec<(String, usize, String, String)>,
    /// Body, path relative to the database's folder, SHA-256.
    pub meshes: Vec<(String, String, String)>,
}

/// Writes a group with its members, or finds it; its id.
///
/// `hashes` are those of its simulations, in their order; `definition` identifies the description.
///
/// # Errors
///
/// When the database cannot be written.
pub fn add_group(
    database: &mut Database,
    group: &Group,
    folder: &str,
    definition: &str,
    planned: &[Planned],
    hashes: &[String],
) -> Result<i64, DatabaseError> {
    let path = database.path.clone();
    let written = || -> Result<i64, rusqlite::Error> {
        let transaction = database.connection.transaction()?;
        let source = match group.source {
            Source::Toml => "campaign.toml",
            Source::Folder => "params.csv",
        };
        let found: Option<i64> = transaction
            .query_row("SELECT id FROM groups WHERE name = ?1 AND definition = ?2", [&group.name, definition], |row| {
                row.get(0)
            })
            .optional()?;
        if let Some(id) = found {
            members(&transaction, id, planned, hashes, None)?;
            transaction.commit()?;
            return Ok(id);
        }
        transaction.execute(
            "INSERT INTO groups (name, definition, folder, source, scene, samples) VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
            params![group.name, definition, folder, source, group.scene.text, group.samples],
        )?;
        let id = transaction.last_insert_rowid();
        let parameters = parameters(&transaction, id, group)?;
        let bars = bars(&transaction, id, group)?;
        members(&transaction, id, planned, hashes, Some((&parameters, &bars)))?;
        transaction.commit()?;
        Ok(id)
    };
    let mut written = written;
    written().map_err(|source| DatabaseError::Sqlite { path, source })
}

fn parameters(transaction: &Transaction<'_>, group_id: i64, group: &Group) -> Result<Vec<i64>, rusqlite::Error> {
    let mut ids = Vec::new();
    for (position, parameter) in group.parameters.iter().enumerate() {
        let (variation, first, last, step) = match parameter.variation {
            Variation::List => ("list", None, None, None),
            Variation::Adding { from, to, step } => ("adding", Some(from), Some(to), Some(step)),
            Variation::Multiplying { from, to, factor } => ("multiplying", Some(from), Some(to), Some(factor)),
            Variation::LatinHypercube { low, high } => ("latin hypercube", Some(low), Some(high), None),
        };
        transaction.execute(
            "INSERT INTO parameters (group_id, position, name, variation, first, last, step, count)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)",
            params![group_id, position, parameter.name, variation, first, last, step, parameter.values.len()],
        )?;
        ids.push(transaction.last_insert_rowid());
    }
    Ok(ids)
}

fn bars(transaction: &Transaction<'_>, group_id: i64, group: &Group) -> Result<Vec<i64>, rusqlite::Error> {
    let mut ids = Vec::new();
    for (position, bar) in group.bars.iter().enumerate() {
        transaction.execute(
            "INSERT INTO bars (group_id, position, name) VALUES (?1, ?2, ?3)",
            params![group_id, position, bar.name],
        )?;
        let id = transaction.last_insert_rowid();
        for (position, s) in bar.sections.iter().enumerate() {
            transaction.execute(
                "INSERT INTO sections (bar_id, position, until, law, element, quadrature)
                 VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
                params![id, position, s.until, s.law, s.element, s.quadrature],
            )?;
        }
        ids.push(id);
    }
    Ok(ids)
}

/// Writes the members, or, where the group is known, their hashes: another program gives other results.
fn members(
    transaction: &Transaction<'_>,
    group_id: i64,
    planned: &[Planned],
    hashes: &[String],
    new: Option<(&[i64], &[i64])>,
) -> Result<(), rusqlite::Error> {
    let Some((parameters, bars)) = new else {
        let mut update =
            transaction.prepare("UPDATE members SET hash = ?3 WHERE group_id = ?1 AND number = ?2 AND hash <> ?3")?;
        for (simulation, hash) in planned.iter().zip(hashes) {
            update.execute(params![group_id, simulation.number, hash])?;
        }
        return Ok(());
    };
    let mut member = transaction
        .prepare("INSERT INTO members (group_id, number, hash, bar_id, device) VALUES (?1, ?2, ?3, ?4, ?5)")?;
    let mut value = transaction
        .prepare("INSERT INTO member_values (group_id, number, parameter_id, value) VALUES (?1, ?2, ?3, ?4)")?;
    for (simulation, hash) in planned.iter().zip(hashes) {
        let bar = simulation.bar.map(|b| bars[b]);
        member.execute(params![group_id, simulation.number, hash, bar, simulation.device])?;
        for (parameter, v) in parameters.iter().zip(&simulation.values) {
            value.execute(params![group_id, simulation.number, parameter, v.to_string()])?;
        }
    }
    Ok(())
}

/// The status of a simulation, where it is done.
///
/// # Errors
///
/// When the database cannot be read.
pub fn done(database: &Database, hash: &str) -> Result<Option<String>, DatabaseError> {
    database
        .connection
        .prepare_cached("SELECT status FROM simulations WHERE hash = ?1")
        .and_then(|mut s| s.query_row([hash], |row| row.get(0)).optional())
        .map_err(|e| database.failed(e))
}

/// Records a simulation in one transaction; what was recorded under its hash before is replaced.
///
/// # Errors
///
/// When the database cannot be written.
pub fn record(database: &mut Database, outcome: &Outcome, machine: &Machine) -> Result<(), DatabaseError> {
    let path = database.path.clone();
    let transaction = database.connection.transaction();
    let written = transaction.and_then(|transaction| {
        simulation(&transaction, outcome, machine)?;
        transaction.commit()
    });
    written.map_err(|source| DatabaseError::Sqlite { path, source })
}

fn simulation(t: &Transaction<'_>, outcome: &Outcome, machine: &Machine) -> Result<(), rusqlite::Error> {
    let described = params![machine.host, machine.processor, machine.cores, machine.system];
    t.execute("INSERT OR IGNORE INTO machines (host, processor, cores, system) VALUES (?1, ?2, ?3, ?4)", described)?;
    let machine_id: i64 = t.query_row(
        "SELECT id FROM machines WHERE host = ?1 AND processor = ?2 AND cores = ?3 AND system = ?4",
        described,
        |row| row.get(0),
    )?;
    t.execute("DELETE FROM simulations WHERE hash = ?1", [&outcome.hash])?;
    let summary = &outcome.summary;
    t.execute(
        "INSERT INTO simulations (hash, status, reason, program, device, threads, machine_id, wall_s, steps,
         simulated_s, nodes) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11)",
        params![
            outcome.hash,
            outcome.status,
            outcome.reason,
            outcome.program,
            outcome.device,
            outcome.threads,
            machine_id,
            outcome.wall_s,
            summary["steps"].as_i64(),
            summary["simulated_s"].as_f64(),
            summary["nodes"].as_i64(),
        ],
    )?;
    let id = t.last_insert_rowid();
    for (body, position, law, parameters) in &outcome.materials {
        t.execute("INSERT INTO materials VALUES (?1, ?2, ?3, ?4, ?5)", params![id, body, position, law, parameters])?;
    }
    for (body, path, hash) in &outcome.meshes {
        t.execute("INSERT INTO meshes VALUES (?1, ?2, ?3, ?4)", params![id, body, path, hash])?;
    }
    for (element, count) in summary["elements"].as_object().into_iter().flatten() {
        t.execute("INSERT INTO element_counts VALUES (?1, ?2, ?3)", params![id, element, count.as_i64()])?;
    }
    for (component, value) in summary["cg_iterations"].as_object().into_iter().flatten() {
        if let Some(x) = value.as_f64() {
            let row = params![id, crate::report::SOLVER, "cg iterations per step", component, x];
            t.execute("INSERT INTO measurements VALUES (?1, ?2, ?3, ?4, ?5)", row)?;
        }
    }
    let steps = summary["steps"].as_f64().unwrap_or(0.0).max(1.0);
    let phases = summary["phases_ms"].as_object().into_iter().flatten();
    let phases = phases.filter_map(|(phase, ms)| Some((phase.clone(), ms.as_f64()? / steps)));
    let step = summary["step_ms"]["mean"].as_f64().map(|ms| ("step".to_owned(), ms));
    for (phase, ms) in phases.chain(step) {
        t.execute("INSERT INTO timings VALUES (?1, ?2, ?3)", params![id, phase, ms])?;
    }
    for (position, e) in summary["expectations"].as_array().into_iter().flatten().enumerate() {
        t.execute(
            "INSERT INTO errors VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
            params![
                id,
                position,
                e["name"].as_str().unwrap_or(""),
                e["difference"].as_f64(),
                e["tolerance"].as_f64().unwrap_or(0.0),
                e["passed"].as_bool()
            ],
        )?;
    }
    for (probe, quantities) in summary["probes"].as_object().into_iter().flatten() {
        for (quantity, value) in quantities.as_object().into_iter().flatten() {
            measured(t, id, probe, quantity, value)?;
        }
    }
    Ok(())
}

/// A number, a vector, a tensor, or a curve.
fn measured(t: &Transaction<'_>, id: i64, probe: &str, quantity: &str, value: &Json) -> Result<(), rusqlite::Error> {
    let one = |component: &str, x: f64| {
        t.execute("INSERT INTO measurements VALUES (?1, ?2, ?3, ?4, ?5)", params![id, probe, quantity, component, x])
    };
    let numbers = |list: &[Json]| list.iter().map(Json::as_f64).collect::<Option<Vec<f64>>>();
    match value {
        Json::Array(list) => match numbers(list) {
            Some(values) if !values.is_empty() => {
                let names: &[&str] =
                    if values.len() == 3 { &["x", "y", "z"] } else { &["xx", "yy", "zz", "xy", "yz", "zx"] };
                for (name, x) in names.iter().zip(values) {
                    one(name, x)?;
                }
            }
            _ => {
                t.execute(
                    "INSERT INTO curves (simulation_id, probe, quantity) VALUES (?1, ?2, ?3)",
                    params![id, probe, quantity],
                )?;
                let curve = t.last_insert_rowid();
                let points = list.iter().map(|p| p.as_array().and_then(|p| numbers(p)));
                for (position, p) in points.flatten().filter(|p| p.len() == 3).enumerate() {
                    let row = params![curve, position, p[0], p[1], p[2]];
                    t.execute("INSERT INTO points VALUES (?1, ?2, ?3, ?4, ?5)", row)?;
                }
            }
        },
        other => {
            if let Some(x) = other.as_f64() {
                one("", x)?;
            }
        }
    }
    Ok(())
}
