//! The database: one SQLite file, whose tables are those of `docs/campaigns.md`.
//!
//! Every simulation is written in one transaction: it is there with all of its results, or not at all.

mod read;
mod write;

pub use read::{GroupRow, Table, Unmet, groups, latest_group, table, unmet};
pub use write::{Machine, Outcome, add_group, done, record};

use rusqlite::Connection;
use std::path::Path;

/// Migrations in their order; number n brings a database from version n to n + 1. Published ones never change.
const MIGRATIONS: &[&str] = &[include_str!("database/schema_1.sql")];

/// Why the database cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum DatabaseError {
    /// SQLite says no.
    #[error("{path}: {source}")]
    Sqlite {
        /// The file.
        path: String,
        /// Its reason.
        source: rusqlite::Error,
    },
    /// Written by a later version of this program.
    #[error("{path} has version {found} of the tables, this program knows {known}: use the program that wrote it")]
    TooNew {
        /// The file.
        path: String,
        /// Its version.
        found: usize,
        /// The last one that is known.
        known: usize,
    },
}

/// An open database.
#[derive(Debug)]
pub struct Database {
    pub(crate) connection: Connection,
    pub(crate) path: String,
}

impl Database {
    /// Opens or makes a database and brings its tables up to date.
    ///
    /// # Errors
    ///
    /// When the file is no database, cannot be written, or comes from a later program.
    pub fn open(path: &Path) -> Result<Database, DatabaseError> {
        let name = path.display().to_string();
        let failed = |source| DatabaseError::Sqlite { path: name.clone(), source };
        let mut connection = Connection::open(path).map_err(failed)?;
        connection.busy_timeout(std::time::Duration::from_secs(60)).map_err(failed)?;
        // A log beside the file: readers do not wait, and what was committed survives the end of the process.
        connection
            .execute_batch("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL; PRAGMA foreign_keys = ON;")
            .map_err(failed)?;
        let transaction =
            connection.transaction_with_behavior(rusqlite::TransactionBehavior::Immediate).map_err(failed)?;
        let version: usize = transaction.query_row("PRAGMA user_version", [], |row| row.get(0)).map_err(failed)?;
        if version > MIGRATIONS.len() {
            return Err(DatabaseError::TooNew { path: name, found: version, known: MIGRATIONS.len() });
        }
        for migration in &MIGRATIONS[version..] {
            transaction.execute_batch(migration).map_err(failed)?;
        }
        transaction.pragma_update(None, "user_version", MIGRATIONS.len()).map_err(failed)?;
        transaction.commit().map_err(failed)?;
        Ok(Database { connection, path: name })
    }

    pub(crate) fn failed(&self, source: rusqlite::Error) -> DatabaseError {
        DatabaseError::Sqlite { path: self.path.clone(), source }
    }
}
