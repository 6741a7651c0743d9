//! Whether a group gave what it says that it gives: endings of its cases, and `[[expect]]` of their scenes.
//!
//! What it is not: a status of simulations. One that missed an expectation has finished all the same.

use crate::database::{Database, DatabaseError, Unmet, table, unmet};
use crate::group::{CASE, Ending, Group};

/// Everything about a group that is not as it says, one sentence each, in the order of its simulations.
///
/// Simulations without a case must come to their end. What is still to do is not as it should be either.
///
/// # Errors
///
/// When the database cannot be read.
pub fn differences(group: &Group, id: i64, database: &Database) -> Result<Vec<String>, DatabaseError> {
    let table = table(database, id)?;
    let at = |name: &str| table.heads.iter().position(|head| head == name);
    let cell = |row: &[String], name: &str| at(name).map_or(String::new(), |column| row[column].clone());
    let unmet = unmet(database, id)?;
    let mut all = Vec::new();
    for row in &table.rows {
        let (number, status) = (cell(row, "number"), cell(row, "status"));
        let case = group.cases.iter().find(|c| cell(row, CASE) == format!("{:?}", c.name));
        let who = case.map_or_else(|| format!("simulation {number}"), |c| format!("simulation {number} ({})", c.name));
        let expected = case.map_or(Ending::Finished, |c| c.ends);
        let found = match status.as_str() {
            "finished" | "at rest" => Some(Ending::Finished),
            "failed" => Some(Ending::Failed),
            "invalid" => Some(Ending::Invalid),
            _ => None,
        };
        if found != Some(expected) {
            let word = match expected {
                Ending::Finished => "finished",
                Ending::Failed => "failed",
                Ending::Invalid => "invalid",
            };
            let reason = cell(row, "reason");
            let reason =
                reason.lines().next().filter(|line| !line.is_empty()).map_or(String::new(), |l| format!(": {l}"));
            all.push(format!("{who} should be {word} and is {status}{reason}"));
        }
        if expected == Ending::Finished {
            let own = unmet.iter().filter(|u| u.number.to_string() == number);
            all.extend(own.map(|Unmet { name, difference, tolerance, .. }| match difference {
                Some(found) => format!("{who}: {name} is off by {found:e}, more than {tolerance:e}"),
                None => format!("{who}: {name} was not measured"),
            }));
        }
    }
    Ok(all)
}
