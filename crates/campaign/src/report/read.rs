//! From the tables of the database to a [`Group`]: the only place of reports that knows them.
//!
//! Each table is read once for the whole group and handed out by simulation, so that the number of statements does not
//! grow with the group.

use super::data::{
    Bar, Curve, Done, Expectation, Group, Machine, Material, Measurement, Parameter, Section, Simulation,
};
use crate::database::{Database, DatabaseError, Row};
use std::collections::BTreeMap;

/// Reads the group with this id.
///
/// # Errors
///
/// When the database cannot be read.
pub fn group(database: &Database, id: i64) -> Result<Group, DatabaseError> {
    let head = rows(database, "SELECT name, folder, source, scene FROM groups WHERE id = $1", id, |row| {
        Ok((row.get::<String>(0)?, row.get::<String>(1)?, row.get::<String>(2)?, row.get::<String>(3)?))
    })?;
    let (name, folder, source, scene) = head.into_iter().next().unwrap_or_default();
    let (parameter_ids, parameters) = parameters(database, id)?;
    let (bar_ids, bars) = bars(database, id)?;
    let (machines, mut done) = simulations(database, id)?;
    parts(database, id, &mut done)?;
    let mut values: BTreeMap<(i64, i64), String> = BTreeMap::new();
    let sql = "SELECT number, parameter_id, value FROM member_values WHERE group_id = $1";
    for (number, parameter, value) in rows(database, sql, id, |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?)))? {
        values.insert((number, parameter), value);
    }
    let sql = "SELECT number, hash, bar_id, device FROM members WHERE group_id = $1 ORDER BY number";
    let members = rows(database, sql, id, |row| {
        let number: i64 = row.get(0)?;
        let hash: String = row.get(1)?;
        let bar: Option<i64> = row.get(2)?;
        let device: String = row.get(3)?;
        Ok((number, hash, bar, device))
    })?;
    let by_hash: BTreeMap<String, Done> = done.into_values().map(|d| (d.hash.clone(), d)).collect();
    let simulations = members
        .into_iter()
        .map(|(number, hash, bar, device)| Simulation {
            number: usize::try_from(number).unwrap_or(0),
            bar: bar.and_then(|b| bar_ids.iter().position(|&id| id == b)),
            device,
            values: parameter_ids.iter().map(|&p| values.get(&(number, p)).cloned()).collect(),
            done: by_hash.get(&hash).cloned(),
        })
        .collect();
    Ok(Group { name, folder, source, scene, parameters, bars, machines, simulations })
}

/// What a statement with the group's id as `$1` finds.
fn rows<T>(
    database: &Database,
    sql: &str,
    group: i64,
    each: impl FnMut(&Row) -> Result<T, DatabaseError>,
) -> Result<Vec<T>, DatabaseError> {
    database.query(sql, &[group.into()])?.iter().map(each).collect()
}

fn parameters(database: &Database, group: i64) -> Result<(Vec<i64>, Vec<Parameter>), DatabaseError> {
    let sql = "SELECT id, name, variation, first, last, step, count FROM parameters WHERE group_id = $1
        ORDER BY position";
    let found = rows(database, sql, group, |row| {
        let parameter = Parameter {
            name: row.get(1)?,
            variation: row.get(2)?,
            first: row.get(3)?,
            last: row.get(4)?,
            step: row.get(5)?,
            count: row.get(6)?,
        };
        Ok((row.get::<i64>(0)?, parameter))
    })?;
    Ok(found.into_iter().unzip())
}

fn bars(database: &Database, group: i64) -> Result<(Vec<i64>, Vec<Bar>), DatabaseError> {
    let sql = "SELECT id, name FROM bars WHERE group_id = $1 ORDER BY position";
    let found =
        rows(database, sql, group, |row| Ok((row.get::<i64>(0)?, Bar { name: row.get(1)?, sections: Vec::new() })))?;
    let (ids, mut bars): (Vec<i64>, Vec<Bar>) = found.into_iter().unzip();
    let sql = "SELECT s.bar_id, s.until, s.law, s.element, s.quadrature FROM sections s JOIN bars b ON b.id = s.bar_id
        WHERE b.group_id = $1 ORDER BY s.bar_id, s.position";
    let sections = rows(database, sql, group, |row| {
        let section = Section { until: row.get(1)?, law: row.get(2)?, element: row.get(3)?, quadrature: row.get(4)? };
        Ok((row.get::<i64>(0)?, section))
    })?;
    for (bar, section) in sections {
        if let Some(at) = ids.iter().position(|&id| id == bar) {
            bars[at].sections.push(section);
        }
    }
    Ok((ids, bars))
}

/// The simulations of a group that are done, by id, without their parts.
fn simulations(database: &Database, group: i64) -> Result<(Vec<Machine>, BTreeMap<i64, Done>), DatabaseError> {
    let sql =
        "SELECT s.id, s.hash, s.status, s.reason, s.program, s.threads, s.wall_s, s.steps, s.simulated_s, s.nodes,
        m.host, m.processor, m.cores, m.system FROM simulations s JOIN machines m ON m.id = s.machine_id
        WHERE s.hash IN (SELECT hash FROM members WHERE group_id = $1) ORDER BY s.id";
    let found = rows(database, sql, group, |row| {
        let machine =
            Machine { host: row.get(10)?, processor: row.get(11)?, cores: row.get(12)?, system: row.get(13)? };
        let done = Done {
            hash: row.get(1)?,
            status: row.get(2)?,
            reason: row.get(3)?,
            program: row.get(4)?,
            threads: row.get(5)?,
            machine: 0,
            wall_s: row.get(6)?,
            steps: row.get(7)?,
            simulated_s: row.get(8)?,
            nodes: row.get(9)?,
            elements: Vec::new(),
            timings: Vec::new(),
            measurements: Vec::new(),
            curves: Vec::new(),
            expectations: Vec::new(),
            materials: Vec::new(),
        };
        Ok((row.get::<i64>(0)?, machine, done))
    })?;
    let mut machines: Vec<Machine> = Vec::new();
    let mut all = BTreeMap::new();
    for (id, machine, mut done) in found {
        done.machine = machines.iter().position(|m| *m == machine).unwrap_or_else(|| {
            machines.push(machine);
            machines.len() - 1
        });
        all.insert(id, done);
    }
    Ok((machines, all))
}

/// What belongs to simulations, row by row.
fn parts(database: &Database, group: i64, done: &mut BTreeMap<i64, Done>) -> Result<(), DatabaseError> {
    let of = |columns: &str, table: &str, order: &str| {
        format!(
            "SELECT t.simulation_id, {columns} FROM {table} t JOIN simulations s ON s.id = t.simulation_id
             WHERE s.hash IN (SELECT hash FROM members WHERE group_id = $1) ORDER BY t.simulation_id, {order}"
        )
    };
    let sql = of("t.element, t.count", "element_counts", "t.element");
    for (id, element, count) in rows(database, &sql, group, |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?)))? {
        give(done, id, |d| d.elements.push((element, count)));
    }
    let sql = of("t.phase, t.ms_per_step", "timings", "t.phase");
    for (id, phase, ms) in rows(database, &sql, group, |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?)))? {
        give(done, id, |d| d.timings.push((phase, ms)));
    }
    let sql = of("t.probe, t.quantity, t.component, t.value", "measurements", "t.probe, t.quantity, t.component");
    let found = rows(database, &sql, group, |row| {
        let measurement =
            Measurement { probe: row.get(1)?, quantity: row.get(2)?, component: row.get(3)?, value: row.get(4)? };
        Ok((row.get(0)?, measurement))
    })?;
    for (id, measurement) in found {
        give(done, id, |d| d.measurements.push(measurement));
    }
    let sql = of("t.name, t.difference, t.tolerance", "errors", "t.position");
    let found = rows(database, &sql, group, |row| {
        Ok((row.get(0)?, Expectation { name: row.get(1)?, difference: row.get(2)?, tolerance: row.get(3)? }))
    })?;
    for (id, expectation) in found {
        give(done, id, |d| d.expectations.push(expectation));
    }
    let sql = of("t.law, t.parameters", "materials", "t.body, t.position");
    let found =
        rows(database, &sql, group, |row| Ok((row.get(0)?, Material { law: row.get(1)?, parameters: row.get(2)? })))?;
    for (id, material) in found {
        give(done, id, |d| d.materials.push(material));
    }
    let sql = "SELECT c.simulation_id, c.probe, c.quantity, p.x, p.y, p.z FROM curves c
        JOIN simulations s ON s.id = c.simulation_id JOIN points p ON p.curve_id = c.id
        WHERE s.hash IN (SELECT hash FROM members WHERE group_id = $1)
        ORDER BY c.simulation_id, c.probe, c.quantity, p.position";
    let found = rows(database, sql, group, |row| {
        let point = [row.get(3)?, row.get(4)?, row.get(5)?];
        Ok((row.get(0)?, row.get::<String>(1)?, row.get::<String>(2)?, point))
    })?;
    for (id, probe, quantity, point) in found {
        give(done, id, |d| match d.curves.last_mut() {
            Some(last) if last.probe == probe && last.quantity == quantity => last.points.push(point),
            _ => d.curves.push(Curve { probe, quantity, points: vec![point] }),
        });
    }
    Ok(())
}

fn give(done: &mut BTreeMap<i64, Done>, id: i64, what: impl FnOnce(&mut Done)) {
    if let Some(d) = done.get_mut(&id) {
        what(d);
    }
}
