//! The text of a scene as a tree of values with places; what the TOML parser gives, freed of its types.
//!
//! Overrides change this tree before anything is validated, so an overridden value passes the same checks as a
//! written one and its messages name the override.

use toml::de::{DeTable, DeValue};

use crate::error::{Problem, SceneError};
use crate::location::{Lines, Location};

/// A value and its place.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub(crate) value: Value,
    pub(crate) at: Location,
}

/// A value of the text.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    Text(String),
    Integer(i64),
    Float(f64),
    Boolean(bool),
    Datetime(String),
    Array(Vec<Node>),
    Table(Vec<Entry>),
}

/// A key with its value.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub(crate) name: String,
    /// Place of the key.
    pub(crate) at: Location,
    pub(crate) node: Node,
}

impl Node {
    /// What a message calls this value.
    pub(crate) fn found(&self) -> String {
        match &self.value {
            Value::Text(text) => format!("the text \"{}\"", shortened(text)),
            Value::Integer(x) => format!("the number {x}"),
            Value::Float(x) => format!("the number {x}"),
            Value::Boolean(x) => format!("{x}"),
            Value::Datetime(text) => format!("the date or time {text}"),
            Value::Array(items) if items.iter().any(|i| matches!(i.value, Value::Table(_))) => {
                format!("a list of {} {}", items.len(), if items.len() == 1 { "table" } else { "tables" })
            }
            Value::Array(items) => {
                format!("a list of {} {}", items.len(), if items.len() == 1 { "value" } else { "values" })
            }
            Value::Table(_) => "a table".to_owned(),
        }
    }
}

/// The text, cut where a message would become unreadable.
pub(crate) fn shortened(text: &str) -> String {
    const MOST: usize = 60;
    if text.chars().count() <= MOST {
        return text.escape_debug().to_string();
    }
    let start: String = text.chars().take(MOST).collect();
    format!("{}…", start.escape_debug())
}

/// How many syntax errors to report: one missing bracket makes the parser stumble on every line that follows.
const SYNTAX_ERRORS_AT_MOST: usize = 3;

/// Reads TOML; the root is a table at line 1.
///
/// # Errors
///
/// At most one per line and [`SYNTAX_ERRORS_AT_MOST`] in all, in the order of the text.
pub(crate) fn tree(text: &str) -> Result<Node, Vec<SceneError>> {
    let lines = Lines::new(text);
    let (table, errors) = DeTable::parse_recoverable(text);
    if errors.is_empty() {
        let value = Value::Table(entries(table.get_ref(), &lines));
        return Ok(Node { value, at: lines.location(0) });
    }
    let mut errors: Vec<SceneError> = errors
        .iter()
        .map(|error| SceneError {
            location: lines.location(error.span().map_or(0, |span| span.start)),
            problem: Problem::Syntax(error.message().to_owned()),
        })
        .collect();
    errors.sort_by(|a, b| a.location.cmp(&b.location));
    errors.dedup_by_key(|error| error.location.line());
    errors.truncate(SYNTAX_ERRORS_AT_MOST);
    Err(errors)
}

/// Reads one TOML value, every part of it placed at `at`; `None` when it is not one.
pub(crate) fn value_of_override(text: &str, at: &Location) -> Option<Node> {
    let parsed = DeValue::parse(text).ok()?;
    let lines = Lines::new(text);
    let mut node = node(parsed.get_ref(), 0, &lines);
    place(&mut node, at);
    Some(node)
}

fn place(node: &mut Node, at: &Location) {
    node.at = at.clone();
    match &mut node.value {
        Value::Array(items) => items.iter_mut().for_each(|item| place(item, at)),
        Value::Table(entries) => {
            for entry in entries {
                entry.at = at.clone();
                place(&mut entry.node, at);
            }
        }
        _ => {}
    }
}

fn entries(table: &DeTable<'_>, lines: &Lines<'_>) -> Vec<Entry> {
    table
        .iter()
        .map(|(key, value)| Entry {
            name: key.get_ref().to_string(),
            at: lines.location(key.span().start),
            node: node(value.get_ref(), value.span().start, lines),
        })
        .collect()
}

fn node(value: &DeValue<'_>, offset: usize, lines: &Lines<'_>) -> Node {
    let value = match value {
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Integer(digits) => match i64::from_str_radix(digits.as_str(), digits.radix()) {
            Ok(number) => Value::Integer(number),
            // Too large for 64 bits: as a number it may still be meant (1 followed by twenty zeros); as a count it is refused.
            Err(_) if digits.radix() == 10 => Value::Float(digits.as_str().parse().unwrap_or(f64::INFINITY)),
            Err(_) => Value::Float(f64::INFINITY),
        },
        DeValue::Float(digits) => Value::Float(digits.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(value) => Value::Boolean(*value),
        DeValue::Datetime(value) => Value::Datetime(value.to_string()),
        DeValue::Array(items) => {
            Value::Array(items.iter().map(|item| node(item.get_ref(), item.span().start, lines)).collect())
        }
        DeValue::Table(table) => Value::Table(entries(table, lines)),
    };
    Node { value, at: lines.location(offset) }
}
