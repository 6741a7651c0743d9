//! Reading: the groups, and one group as a table.

use super::{Database, DatabaseError, Row, Value};
use std::collections::{BTreeMap, BTreeSet};

/// A group in a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GroupRow {
    /// Its id.
    pub id: i64,
    /// Its name.
    pub name: String,
    /// Where it was described.
    pub folder: String,
    /// Its simulations.
    pub members: usize,
    /// Those that are done, however they ended.
    pub done: usize,
    /// Those that came to their end.
    pub succeeded: usize,
}

/// A group as a table: one row per member, in their order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    /// Names of the columns.
    pub heads: Vec<String>,
    /// Cells, as many as heads.
    pub rows: Vec<Vec<String>>,
}

const GROUPS: &str = "SELECT g.id, g.name, g.folder, COUNT(*), COUNT(s.id),
    COUNT(CASE WHEN s.status IN ('finished', 'at rest') THEN 1 END)
    FROM groups g JOIN members m ON m.group_id = g.id LEFT JOIN simulations s ON s.hash = m.hash";

fn group_row(row: &Row) -> Result<GroupRow, DatabaseError> {
    Ok(GroupRow {
        id: row.get(0)?,
        name: row.get(1)?,
        folder: row.get(2)?,
        members: row.get(3)?,
        done: row.get(4)?,
        succeeded: row.get(5)?,
    })
}

/// All groups, the oldest first.
///
/// # Errors
///
/// When the database cannot be read.
pub fn groups(database: &Database) -> Result<Vec<GroupRow>, DatabaseError> {
    database.query(&format!("{GROUPS} GROUP BY g.id ORDER BY g.id"), &[])?.iter().map(group_row).collect()
}

/// The last group of this name, as it was described last; without a name the last of all.
///
/// # Errors
///
/// When the database cannot be read.
pub fn latest_group(database: &Database, name: Option<&str>) -> Result<Option<GroupRow>, DatabaseError> {
    let (condition, values) = match name {
        Some(name) => ("WHERE g.name = $1", vec![Value::from(name)]),
        None => ("", Vec::new()),
    };
    let sql = format!("{GROUPS} {condition} GROUP BY g.id ORDER BY g.id DESC LIMIT 1");
    database.query(&sql, &values)?.first().map(group_row).transpose()
}

/// The group with this id.
///
/// # Errors
///
/// When the database cannot be read.
pub fn group(database: &Database, id: i64) -> Result<Option<GroupRow>, DatabaseError> {
    database.query(&format!("{GROUPS} WHERE g.id = $1 GROUP BY g.id"), &[id.into()])?.first().map(group_row).transpose()
}

/// One group: parameters, status, times, and every single number that was measured.
///
/// # Errors
///
/// When the database cannot be read.
pub fn table(database: &Database, group: i64) -> Result<Table, DatabaseError> {
    let of_group = [Value::from(group)];
    let parameters: Vec<(i64, String)> = database
        .query("SELECT id, name FROM parameters WHERE group_id = $1 ORDER BY position", &of_group)?
        .iter()
        .map(|row| Ok((row.get(0)?, row.get(1)?)))
        .collect::<Result<_, DatabaseError>>()?;
    let values: BTreeMap<(i64, i64), String> = database
        .query("SELECT number, parameter_id, value FROM member_values WHERE group_id = $1", &of_group)?
        .iter()
        .map(|row| Ok(((row.get(0)?, row.get(1)?), row.get(2)?)))
        .collect::<Result<_, DatabaseError>>()?;
    let mut measured: BTreeMap<(i64, String), f64> = BTreeMap::new();
    let mut quantities: BTreeSet<String> = BTreeSet::new();
    let found = database.query(
        "SELECT m.number, v.probe, v.quantity, v.component, v.value FROM members m
         JOIN simulations s ON s.hash = m.hash JOIN measurements v ON v.simulation_id = s.id WHERE m.group_id = $1
         UNION ALL SELECT m.number, 'ms per step', t.phase, '', t.ms_per_step FROM members m
         JOIN simulations s ON s.hash = m.hash JOIN timings t ON t.simulation_id = s.id WHERE m.group_id = $1",
        &of_group,
    )?;
    for row in &found {
        let parts: [String; 3] = [row.get(1)?, row.get(2)?, row.get(3)?];
        let name = parts.join(" ").trim_end().to_owned();
        quantities.insert(name.clone());
        measured.insert((row.get(0)?, name), row.get(4)?);
    }
    let mut heads: Vec<String> = ["number", "bar", "device"].map(String::from).to_vec();
    heads.extend(parameters.iter().map(|(_, name)| name.clone()));
    heads.extend(["status", "steps", "simulated s", "nodes", "elements", "wall s"].map(String::from));
    heads.extend(quantities.iter().cloned());
    heads.push("reason".to_owned());
    let found = database.query(
        "SELECT m.number, b.name, m.device, s.status, s.steps, s.simulated_s, s.nodes,
         (SELECT CAST(SUM(e.count) AS BIGINT) FROM element_counts e WHERE e.simulation_id = s.id), s.wall_s, s.reason
         FROM members m LEFT JOIN bars b ON b.id = m.bar_id LEFT JOIN simulations s ON s.hash = m.hash
         WHERE m.group_id = $1 ORDER BY m.number",
        &of_group,
    )?;
    let mut rows = Vec::new();
    for row in &found {
        let number: i64 = row.get(0)?;
        let whole = |at: usize| Ok::<_, DatabaseError>(row.get::<Option<i64>>(at)?.map(|x| x.to_string()));
        let real = |at: usize| Ok::<_, DatabaseError>(row.get::<Option<f64>>(at)?.map(|x| format!("{x:?}")));
        let text = |at: usize| row.get::<Option<String>>(at);
        let mut cells = vec![Some(number.to_string()), text(1)?, text(2)?];
        cells.extend(parameters.iter().map(|(id, _)| values.get(&(number, *id)).cloned()));
        cells.push(Some(text(3)?.unwrap_or_else(|| "to do".to_owned())));
        cells.extend([whole(4)?, real(5)?, whole(6)?, whole(7)?, real(8)?]);
        cells.extend(quantities.iter().map(|name| measured.get(&(number, name.clone())).map(|x| format!("{x:?}"))));
        cells.push(text(9)?);
        rows.push(cells.into_iter().map(Option::unwrap_or_default).collect());
    }
    Ok(Table { heads, rows })
}

/// An `[[expect]]` that a simulation of a group did not meet.
#[derive(Clone, Debug, PartialEq)]
pub struct Unmet {
    /// The simulation's number in the group.
    pub number: i64,
    /// What was expected, as the summary names it.
    pub name: String,
    /// Distance from the expected value; none where nothing was measured.
    pub difference: Option<f64>,
    /// The largest distance that is allowed.
    pub tolerance: f64,
}

/// The expectations that the simulations of a group did not meet, in their order.
///
/// # Errors
///
/// When the database cannot be read.
pub fn unmet(database: &Database, group: i64) -> Result<Vec<Unmet>, DatabaseError> {
    let found = database.query(
        "SELECT m.number, e.name, e.difference, e.tolerance FROM members m JOIN simulations s ON s.hash = m.hash
         JOIN errors e ON e.simulation_id = s.id WHERE m.group_id = $1 AND e.met = 0
         ORDER BY m.number, e.position",
        &[group.into()],
    )?;
    found
        .iter()
        .map(|row| {
            Ok(Unmet { number: row.get(0)?, name: row.get(1)?, difference: row.get(2)?, tolerance: row.get(3)? })
        })
        .collect()
}
