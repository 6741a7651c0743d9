//! Commands that have a module of their own.

pub(crate) mod compare;
pub(crate) mod export;
pub(crate) mod report;
pub(crate) mod serve;

use souple_campaign::database::{Database, GroupRow, latest_group};
use souple_campaign::report::{data::Group, read};
use std::path::Path;

/// Opens a database that must be there already.
pub(crate) fn open(db: &str) -> Result<Database, String> {
    if !Path::new(db).is_file() {
        return Err(format!("there is no database {db}; say which one with --db"));
    }
    Database::open(Path::new(db)).map_err(|e| e.to_string())
}

/// The last group of this name, or of all, with everything that the database has of it.
pub(crate) fn whole_group(database: &Database, db: &str, name: Option<&str>) -> Result<Group, String> {
    let GroupRow { id, .. } = latest_group(database, name)
        .map_err(|e| e.to_string())?
        .ok_or_else(|| format!("{db} has no group {}; see: souple campaign list", name.unwrap_or("at all")))?;
    read::group(database, id).map_err(|e| e.to_string())
}
