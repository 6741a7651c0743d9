//! What goes into a statement and what comes out of it: the four kinds of cells that both databases share.
//!
//! What it is not: a mapping of structs to tables. A row is read cell by cell, by number.

use super::DatabaseError;

/// One cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Nothing.
    Null,
    /// A whole number; also what is true (1) or false (0).
    Whole(i64),
    /// A number.
    Real(f64),
    /// A text.
    Text(String),
}

impl From<i64> for Value {
    fn from(x: i64) -> Value {
        Value::Whole(x)
    }
}

impl From<usize> for Value {
    fn from(x: usize) -> Value {
        // No count comes near the end of 63 bits.
        Value::Whole(x as i64)
    }
}

impl From<bool> for Value {
    fn from(x: bool) -> Value {
        Value::Whole(i64::from(x))
    }
}

impl From<f64> for Value {
    fn from(x: f64) -> Value {
        Value::Real(x)
    }
}

impl From<&str> for Value {
    fn from(x: &str) -> Value {
        Value::Text(x.to_owned())
    }
}

impl From<&String> for Value {
    fn from(x: &String) -> Value {
        Value::Text(x.clone())
    }
}

impl From<String> for Value {
    fn from(x: String) -> Value {
        Value::Text(x)
    }
}

impl<T: Into<Value>> From<Option<T>> for Value {
    fn from(x: Option<T>) -> Value {
        x.map_or(Value::Null, Into::into)
    }
}

/// What a cell can be read as.
pub trait FromValue: Sized {
    /// What is expected, in words.
    const EXPECTED: &'static str;
    /// The value; none where the cell is something else.
    fn from_value(value: &Value) -> Option<Self>;
}

impl FromValue for i64 {
    const EXPECTED: &'static str = "a whole number";
    fn from_value(value: &Value) -> Option<i64> {
        if let Value::Whole(x) = value { Some(*x) } else { None }
    }
}

impl FromValue for usize {
    const EXPECTED: &'static str = "a count";
    fn from_value(value: &Value) -> Option<usize> {
        i64::from_value(value).and_then(|x| usize::try_from(x).ok())
    }
}

impl FromValue for f64 {
    const EXPECTED: &'static str = "a number";
    fn from_value(value: &Value) -> Option<f64> {
        match value {
            Value::Real(x) => Some(*x),
            Value::Whole(x) => Some(*x as f64),
            Value::Null | Value::Text(_) => None,
        }
    }
}

impl FromValue for String {
    const EXPECTED: &'static str = "a text";
    fn from_value(value: &Value) -> Option<String> {
        if let Value::Text(x) = value { Some(x.clone()) } else { None }
    }
}

impl<T: FromValue> FromValue for Option<T> {
    const EXPECTED: &'static str = T::EXPECTED;
    fn from_value(value: &Value) -> Option<Option<T>> {
        if *value == Value::Null { Some(None) } else { T::from_value(value).map(Some) }
    }
}

/// One row of what a query found.
#[derive(Clone, Debug, PartialEq)]
pub struct Row(pub Vec<Value>);

impl Row {
    /// The cell number `at`.
    ///
    /// # Errors
    ///
    /// When it is not of this kind: the tables are not those of this program.
    pub fn get<T: FromValue>(&self, at: usize) -> Result<T, DatabaseError> {
        self.0.get(at).and_then(T::from_value).ok_or_else(|| DatabaseError::Cell {
            at,
            expected: T::EXPECTED,
            found: format!("{:?}", self.0.get(at)),
        })
    }
}
