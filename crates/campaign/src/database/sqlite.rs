//! A database in one SQLite file.

use super::{Row, Value};
use rusqlite::Connection;
use rusqlite::types::{ToSqlOutput, Value as Cell, ValueRef};
use std::path::Path;

impl rusqlite::ToSql for Value {
    fn to_sql(&self) -> Result<ToSqlOutput<'_>, rusqlite::Error> {
        Ok(match self {
            Value::Null => ToSqlOutput::Owned(Cell::Null),
            Value::Whole(x) => ToSqlOutput::Owned(Cell::Integer(*x)),
            Value::Real(x) => ToSqlOutput::Owned(Cell::Real(*x)),
            Value::Text(x) => ToSqlOutput::Borrowed(ValueRef::Text(x.as_bytes())),
        })
    }
}

fn value(cell: ValueRef<'_>) -> Value {
    match cell {
        ValueRef::Null => Value::Null,
        ValueRef::Integer(x) => Value::Whole(x),
        ValueRef::Real(x) => Value::Real(x),
        ValueRef::Text(x) | ValueRef::Blob(x) => Value::Text(String::from_utf8_lossy(x).into_owned()),
    }
}

/// Opens or makes the file.
pub(super) fn open(path: &Path) -> Result<Connection, rusqlite::Error> {
    let connection = Connection::open(path)?;
    connection.busy_timeout(std::time::Duration::from_secs(60))?;
    // A log beside the file: readers do not wait, what was committed survives the end of the process, and the disk is
    // waited for only when the log is taken into the file.
    connection.execute_batch("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL; PRAGMA foreign_keys = ON;")?;
    connection.set_prepared_statement_cache_capacity(64);
    Ok(connection)
}

pub(super) fn query(connection: &Connection, sql: &str, values: &[Value]) -> Result<Vec<Row>, rusqlite::Error> {
    let mut statement = connection.prepare_cached(sql)?;
    let columns = statement.column_count();
    let mut found = statement.query(rusqlite::params_from_iter(values))?;
    let mut rows = Vec::new();
    while let Some(row) = found.next()? {
        rows.push(Row((0..columns).map(|c| row.get_ref(c).map(value)).collect::<Result<_, _>>()?));
    }
    Ok(rows)
}

pub(super) fn execute(connection: &Connection, sql: &str, values: &[Value]) -> Result<u64, rusqlite::Error> {
    let changed = connection.prepare_cached(sql)?.execute(rusqlite::params_from_iter(values))?;
    Ok(changed as u64)
}
