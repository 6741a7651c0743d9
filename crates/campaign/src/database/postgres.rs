//! A database on a PostgreSQL server.

use super::{Row, Value};
use bytes::BytesMut;
use postgres::types::{FromSql, IsNull, ToSql, Type, to_sql_checked};
use postgres::{Client, Statement};
use std::collections::BTreeMap;
use std::error::Error;

/// A connection with the statements that it has prepared.
pub(super) struct Connection {
    client: Client,
    prepared: BTreeMap<String, Statement>,
}

impl std::fmt::Debug for Connection {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Connection").field("prepared", &self.prepared.len()).finish_non_exhaustive()
    }
}

impl ToSql for Value {
    fn to_sql(&self, ty: &Type, out: &mut BytesMut) -> Result<IsNull, Box<dyn Error + Sync + Send>> {
        match self {
            Value::Null => Ok(IsNull::Yes),
            Value::Whole(x) if *ty == Type::FLOAT8 => (*x as f64).to_sql(ty, out),
            Value::Whole(x) if *ty == Type::INT8 => x.to_sql(ty, out),
            Value::Real(x) if *ty == Type::FLOAT8 => x.to_sql(ty, out),
            // PostgreSQL has no texts with a zero byte in them, and messages of others may have one.
            Value::Text(x) if *ty == Type::TEXT => x.replace('\0', "\u{fffd}").to_sql(ty, out),
            other => Err(format!("{other:?} is not a {ty}").into()),
        }
    }

    fn accepts(_: &Type) -> bool {
        true
    }

    to_sql_checked!();
}

impl FromSql<'_> for Value {
    fn from_sql(ty: &Type, raw: &[u8]) -> Result<Value, Box<dyn Error + Sync + Send>> {
        match *ty {
            Type::INT8 => i64::from_sql(ty, raw).map(Value::Whole),
            Type::INT4 => i32::from_sql(ty, raw).map(|x| Value::Whole(i64::from(x))),
            Type::FLOAT8 => f64::from_sql(ty, raw).map(Value::Real),
            _ => String::from_sql(ty, raw).map(Value::Text),
        }
    }

    fn from_sql_null(_: &Type) -> Result<Value, Box<dyn Error + Sync + Send>> {
        Ok(Value::Null)
    }

    fn accepts(ty: &Type) -> bool {
        [Type::INT8, Type::INT4, Type::FLOAT8].contains(ty) || <String as FromSql<'_>>::accepts(ty)
    }
}

impl Connection {
    pub(super) fn open(config: &postgres::Config) -> Result<Connection, postgres::Error> {
        Ok(Connection { client: config.connect(postgres::NoTls)?, prepared: BTreeMap::new() })
    }

    pub(super) fn batch(&mut self, sql: &str) -> Result<(), postgres::Error> {
        self.client.batch_execute(sql)
    }

    fn prepare(&mut self, sql: &str) -> Result<Statement, postgres::Error> {
        if let Some(statement) = self.prepared.get(sql) {
            return Ok(statement.clone());
        }
        let statement = self.client.prepare(sql)?;
        self.prepared.insert(sql.to_owned(), statement.clone());
        Ok(statement)
    }

    pub(super) fn query(&mut self, sql: &str, values: &[Value]) -> Result<Vec<Row>, postgres::Error> {
        let statement = self.prepare(sql)?;
        let values: Vec<&(dyn ToSql + Sync)> = values.iter().map(|v| v as &(dyn ToSql + Sync)).collect();
        let rows = self.client.query(&statement, &values)?;
        rows.iter().map(|row| (0..row.len()).map(|c| row.try_get(c)).collect::<Result<_, _>>().map(Row)).collect()
    }

    pub(super) fn execute(&mut self, sql: &str, values: &[Value]) -> Result<u64, postgres::Error> {
        let statement = self.prepare(sql)?;
        let values: Vec<&(dyn ToSql + Sync)> = values.iter().map(|v| v as &(dyn ToSql + Sync)).collect();
        self.client.execute(&statement, &values)
    }
}
