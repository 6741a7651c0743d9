//! Reading tables of TOML: every wrong key and value is noted with its line, and reading goes on.

use crate::group::Value;
use crate::problem::Problems;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A table being read.
pub(crate) struct Table<'t> {
    pub(crate) table: &'t DeTable<'t>,
    /// How messages call it: `[[vary]]`.
    pub(crate) header: &'static str,
    /// Where it begins, in bytes.
    pub(crate) span: Range<usize>,
    pub(crate) text: &'t str,
    pub(crate) file: &'t str,
}

/// The line of an offset, from 1.
pub(crate) fn line(text: &str, offset: usize) -> usize {
    text.as_bytes()[..offset.min(text.len())].iter().filter(|&&b| b == b'\n').count() + 1
}

impl<'t> Table<'t> {
    /// Notes something wrong at a place of the text.
    pub(crate) fn wrong(&self, span: &Range<usize>, problems: &mut Problems, message: impl std::fmt::Display) {
        problems.add(self.file, line(self.text, span.start), message);
    }

    /// Notes keys that the table does not have.
    pub(crate) fn only(&self, known: &[&str], problems: &mut Problems) {
        for (key, _) in self.table.iter().filter(|(key, _)| !known.contains(&key.get_ref().as_ref())) {
            let message = format!("unknown key `{}` in {}; its keys: {}", key.get_ref(), self.header, known.join(", "));
            self.wrong(&key.span(), problems, message);
        }
    }

    /// The value of a key, where it is given.
    pub(crate) fn get(&self, key: &str) -> Option<&'t Spanned<DeValue<'t>>> {
        self.table.get(key)
    }

    fn of_type<T>(
        &self,
        key: &str,
        expected: &str,
        problems: &mut Problems,
        take: impl FnOnce(&'t DeValue<'t>) -> Option<T>,
    ) -> Option<T> {
        let value = self.get(key)?;
        let taken = take(value.get_ref());
        if taken.is_none() {
            let found = &self.text[value.span()];
            self.wrong(&value.span(), problems, format!("`{key}` must be {expected}, found {found}"));
        }
        taken
    }

    /// A text.
    pub(crate) fn text_of(&self, key: &str, problems: &mut Problems) -> Option<String> {
        self.of_type(key, "a text in quotes", problems, |v| match v {
            DeValue::String(s) => Some(s.to_string()),
            _ => None,
        })
    }

    /// A finite number.
    pub(crate) fn number(&self, key: &str, problems: &mut Problems) -> Option<f64> {
        self.of_type(key, "a finite number", problems, number)
    }

    /// A whole number that is not negative.
    pub(crate) fn count(&self, key: &str, problems: &mut Problems) -> Option<u64> {
        self.of_type(key, "a whole number, 0 or more", problems, |v| match v {
            DeValue::Integer(digits) => u64::from_str_radix(digits.as_str(), digits.radix()).ok(),
            _ => None,
        })
    }

    /// Whether a value is written as a whole number.
    pub(crate) fn is_whole(&self, key: &str) -> bool {
        self.get(key).is_some_and(|v| matches!(v.get_ref(), DeValue::Integer(_)))
    }

    /// A list of values, each as TOML.
    pub(crate) fn values(&self, key: &str, problems: &mut Problems) -> Option<Vec<Value>> {
        let list = self.of_type(key, "a list with at least one value", problems, |v| match v {
            DeValue::Array(items) if !items.is_empty() => Some(items),
            _ => None,
        })?;
        Some(list.iter().map(|item| value(item.get_ref(), &self.text[item.span()])).collect())
    }

    /// A list of texts.
    pub(crate) fn texts(&self, key: &str, problems: &mut Problems) -> Option<Vec<String>> {
        self.of_type(key, "a list of texts, at least one", problems, |v| match v {
            DeValue::Array(items) if !items.is_empty() => items
                .iter()
                .map(|item| match item.get_ref() {
                    DeValue::String(s) => Some(s.to_string()),
                    _ => None,
                })
                .collect(),
            _ => None,
        })
    }

    /// The tables of a list; none where the key is not given.
    pub(crate) fn tables(&self, key: &str, header: &'static str, problems: &mut Problems) -> Vec<Table<'t>> {
        let tables = self.of_type(key, &format!("written as {header}"), problems, |v| match v {
            DeValue::Array(items) => items
                .iter()
                .map(|item| match item.get_ref() {
                    DeValue::Table(table) => {
                        Some(Table { table, header, span: item.span(), text: self.text, file: self.file })
                    }
                    _ => None,
                })
                .collect(),
            _ => None,
        });
        tables.unwrap_or_default()
    }

    /// A table.
    pub(crate) fn table(&self, key: &str, header: &'static str, problems: &mut Problems) -> Option<Table<'t>> {
        let span = self.get(key)?.span();
        self.of_type(key, &format!("a table, {header}"), problems, |v| match v {
            DeValue::Table(table) => Some(Table { table, header, span, text: self.text, file: self.file }),
            _ => None,
        })
    }
}

fn number(v: &DeValue<'_>) -> Option<f64> {
    match v {
        DeValue::Integer(digits) => i64::from_str_radix(digits.as_str(), digits.radix()).ok().map(|x| x as f64),
        DeValue::Float(digits) => digits.as_str().parse::<f64>().ok().filter(|x| x.is_finite()),
        _ => None,
    }
}

fn value(v: &DeValue<'_>, written: &str) -> Value {
    match v {
        DeValue::Integer(digits) => match i64::from_str_radix(digits.as_str(), digits.radix()) {
            Ok(x) => Value::Whole(x),
            Err(_) => Value::Toml(written.to_owned()),
        },
        DeValue::Float(_) => number(v).map_or_else(|| Value::Toml(written.to_owned()), Value::Number),
        _ => Value::Toml(written.to_owned()),
    }
}
