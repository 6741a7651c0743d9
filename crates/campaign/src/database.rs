//! The database: an SQLite file or a PostgreSQL server, whose tables are those of `docs/campaigns.md`.
//!
//! Every simulation is written in one transaction: it is there with all of its results, or not at all.
//!
//! ```text
//! read, write, claim ──► query, execute, transaction ──► dialect ──► sqlite | postgres
//! ```

mod claim;
mod dialect;
mod location;
mod postgres;
mod read;
mod sqlite;
mod value;
mod write;

pub use claim::{Claim, LEASE, beat, claim, release};
pub use dialect::Dialect;
pub use location::Location;
pub use read::{GroupRow, Table, Unmet, group, groups, latest_group, table, unmet};
pub use value::{FromValue, Row, Value};
pub use write::{Machine, Member, Outcome, add_group, record, recorded, recorded_in};

use std::borrow::Borrow;
use std::cell::RefCell;
use std::path::Path;

/// Migrations in their order; number n brings a database from version n to n + 1. Published ones never change.
const MIGRATIONS: &[&str] = &[include_str!("database/schema_1.sql"), include_str!("database/schema_2.sql")];

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
    /// PostgreSQL says no.
    #[error("{url}: {}", chain(source))]
    Postgres {
        /// The server, without the password.
        url: String,
        /// Its reason.
        source: ::postgres::Error,
    },
    /// Not the URL of a server.
    #[error("{url}: {why}; expected postgres://USER:PASSWORD@HOST:PORT/DATABASE")]
    Url {
        /// What was given, without the password.
        url: String,
        /// What is wrong.
        why: String,
    },
    /// Written by a later version of this program.
    #[error("{path} has version {found} of the tables, this program knows {known}: use the program that wrote it")]
    TooNew {
        /// The file or server.
        path: String,
        /// Its version.
        found: usize,
        /// The last one that is known.
        known: usize,
    },
    /// A cell of another kind than the tables say.
    #[error("column {at} of a result must be {expected}, found {found}: the tables were changed by something else")]
    Cell {
        /// Its number.
        at: usize,
        /// What it must be.
        expected: &'static str,
        /// What it is.
        found: String,
    },
}

/// An error with its causes: that of `postgres` alone says "db error".
fn chain(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut next = error.source();
    while let Some(cause) = next {
        text = format!("{text}: {cause}");
        next = cause.source();
    }
    text
}

/// An open database.
#[derive(Debug)]
pub struct Database {
    connection: RefCell<Connection>,
    /// Where it is, for people.
    pub place: String,
    /// Which one it is.
    pub dialect: Dialect,
}

#[derive(Debug)]
enum Connection {
    Sqlite(rusqlite::Connection),
    Postgres(Box<postgres::Connection>),
}

impl Database {
    /// Opens or makes the database in a file and brings its tables up to date.
    ///
    /// # Errors
    ///
    /// When the file is no database, cannot be written, or comes from a later program.
    pub fn open(path: &Path) -> Result<Database, DatabaseError> {
        Database::connect(&Location::File(path.to_owned()))
    }

    /// Opens a database and brings its tables up to date; a file is made where there is none.
    ///
    /// # Errors
    ///
    /// When it cannot be reached, is no database, cannot be written, or comes from a later program.
    pub fn connect(location: &Location) -> Result<Database, DatabaseError> {
        let place = location.to_string();
        let (connection, dialect) = match location {
            Location::File(path) => {
                let open = sqlite::open(path);
                let open = open.map_err(|source| DatabaseError::Sqlite { path: place.clone(), source })?;
                (Connection::Sqlite(open), Dialect::Sqlite)
            }
            Location::Server(url) => {
                let config = location::server(url).map_err(|why| DatabaseError::Url { url: place.clone(), why })?;
                let open = postgres::Connection::open(&config);
                let open = open.map_err(|source| DatabaseError::Postgres { url: place.clone(), source })?;
                (Connection::Postgres(Box::new(open)), Dialect::Postgres)
            }
        };
        let database = Database { connection: RefCell::new(connection), place, dialect };
        database.transaction(|| database.migrate())?;
        Ok(database)
    }

    /// Brings the tables up to date.
    fn migrate(&self) -> Result<(), DatabaseError> {
        let known = MIGRATIONS.len();
        let found: usize = match self.dialect {
            Dialect::Sqlite => self.first("PRAGMA user_version", &[])?,
            Dialect::Postgres => {
                // One program at a time, until the end of the transaction; the number is this program's own.
                self.batch("SELECT pg_advisory_xact_lock(736787713)")?;
                self.batch("CREATE TABLE IF NOT EXISTS souple_version (version BIGINT NOT NULL)")?;
                self.first("SELECT COALESCE(MAX(version), 0) FROM souple_version", &[])?
            }
        };
        if found > known {
            return Err(DatabaseError::TooNew { path: self.place.clone(), found, known });
        }
        if found == known {
            return Ok(());
        }
        for migration in &MIGRATIONS[found..] {
            self.batch(&self.dialect.tables(migration))?;
        }
        match self.dialect {
            Dialect::Sqlite => self.batch(&format!("PRAGMA user_version = {known}")),
            Dialect::Postgres => self
                .batch(&format!("DELETE FROM souple_version; INSERT INTO souple_version (version) VALUES ({known})")),
        }
    }

    /// The rows that a statement finds or gives back. Values are `$1`, `$2`, … in it.
    ///
    /// # Errors
    ///
    /// When the database says no.
    pub fn query(&self, sql: &str, values: &[Value]) -> Result<Vec<Row>, DatabaseError> {
        let sql = self.dialect.statement(sql);
        match &mut *self.connection.borrow_mut() {
            Connection::Sqlite(c) => sqlite::query(c, &sql, values).map_err(|e| self.sqlite(e)),
            Connection::Postgres(c) => c.query(&sql, values).map_err(|e| self.postgres(e)),
        }
    }

    /// The first cell of the first row.
    ///
    /// # Errors
    ///
    /// When the database says no, or there is no row.
    pub fn first<T: FromValue>(&self, sql: &str, values: &[Value]) -> Result<T, DatabaseError> {
        self.query(sql, values)?.first().unwrap_or(&Row(Vec::new())).get(0)
    }

    /// Changes rows; their number.
    ///
    /// # Errors
    ///
    /// When the database says no.
    pub fn execute(&self, sql: &str, values: &[Value]) -> Result<u64, DatabaseError> {
        let sql = self.dialect.statement(sql);
        match &mut *self.connection.borrow_mut() {
            Connection::Sqlite(c) => sqlite::execute(c, &sql, values).map_err(|e| self.sqlite(e)),
            Connection::Postgres(c) => c.execute(&sql, values).map_err(|e| self.postgres(e)),
        }
    }

    /// Adds rows to a table: as many values per row as columns.
    ///
    /// # Errors
    ///
    /// When the database says no.
    pub fn insert<R: Borrow<[Value]>>(&self, table: &str, columns: &str, rows: &[R]) -> Result<(), DatabaseError> {
        let width = columns.split(',').count();
        let mut rest = rows;
        // A server is asked few times, and few statements are prepared, whatever the number of rows.
        for size in [64, 16, 4, 1] {
            while rest.len() >= size {
                let (now, later) = rest.split_at(size);
                let row = |r: usize| {
                    let places: Vec<String> = (0..width).map(|c| format!("${}", r * width + c + 1)).collect();
                    format!("({})", places.join(", "))
                };
                let places: Vec<String> = (0..size).map(row).collect();
                let sql = format!("INSERT INTO {table} ({columns}) VALUES {}", places.join(", "));
                self.execute(&sql, &now.concat())?;
                rest = later;
            }
        }
        Ok(())
    }

    /// What is another text whenever somebody else has changed something since this connection was last asked; it may
    /// be another one without that too.
    ///
    /// # Errors
    ///
    /// When the database says no.
    pub fn stamp(&self) -> Result<String, DatabaseError> {
        match self.dialect {
            Dialect::Sqlite => self.first::<i64>("PRAGMA data_version", &[]).map(|version| version.to_string()),
            // Which transactions have ended: those that change nothing have no number.
            Dialect::Postgres => self.first("SELECT CAST(txid_current_snapshot() AS TEXT)", &[]),
        }
    }

    /// Does all of `act` or nothing.
    ///
    /// # Errors
    ///
    /// When the database says no; then nothing of it is done.
    pub fn transaction<T>(&self, act: impl FnOnce() -> Result<T, DatabaseError>) -> Result<T, DatabaseError> {
        self.batch(self.dialect.begin())?;
        match act().and_then(|done| self.batch("COMMIT").map(|()| done)) {
            Ok(done) => Ok(done),
            Err(error) => {
                // The first error is the one that counts; a connection that is gone has undone everything by itself.
                let _ = self.batch("ROLLBACK");
                Err(error)
            }
        }
    }

    fn batch(&self, sql: &str) -> Result<(), DatabaseError> {
        match &mut *self.connection.borrow_mut() {
            Connection::Sqlite(c) => c.execute_batch(sql).map_err(|e| self.sqlite(e)),
            Connection::Postgres(c) => c.batch(sql).map_err(|e| self.postgres(e)),
        }
    }

    fn sqlite(&self, source: rusqlite::Error) -> DatabaseError {
        DatabaseError::Sqlite { path: self.place.clone(), source }
    }

    fn postgres(&self, source: ::postgres::Error) -> DatabaseError {
        DatabaseError::Postgres { url: self.place.clone(), source }
    }
}
