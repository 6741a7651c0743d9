//! The commands, one module each.

pub(crate) mod collect;
pub(crate) mod compare;
mod elsewhere;
pub(crate) mod export;
pub(crate) mod list;
pub(crate) mod report;
pub(crate) mod run;
pub(crate) mod serve;
pub(crate) mod show;
pub(crate) mod task;

use souple_campaign::database::{Database, GroupRow, Location, latest_group};
use souple_campaign::report::{data::Group, read};

/// Opens a database that must be there already.
pub(crate) fn open(db: &str) -> Result<Database, String> {
    let location = Location::parse(db);
    match &location {
        Location::File(path) if !path.is_file() => {
            Err(format!("there is no database {}; say which one with --db", path.display()))
        }
        _ => Database::connect(&location).map_err(|e| e.to_string()),
    }
}

/// The last group of this name, or of all, with everything that the database has of it.
pub(crate) fn whole_group(database: &Database, name: Option<&str>) -> Result<Group, String> {
    let GroupRow { id, .. } = latest_group(database, name).map_err(|e| e.to_string())?.ok_or_else(|| {
        format!("{} has no group {}; see: souple campaign list", database.place, name.unwrap_or("at all"))
    })?;
    read::group(database, id).map_err(|e| e.to_string())
}

/// A reason in one line, with what separates it from what is before.
pub(crate) fn why(reason: &str) -> String {
    reason.lines().next().filter(|line| !line.is_empty()).map_or(String::new(), |line| format!(": {line}"))
}
