//! One file per stage; each has a `run` and, where the check is a table, the table.

pub(crate) mod arrows;
pub(crate) mod documents;
pub(crate) mod format;
pub(crate) mod lint;
pub(crate) mod names;
pub(crate) mod newcomer;
pub(crate) mod reference_data;
pub(crate) mod scenes;
pub(crate) mod tests;
pub(crate) mod text;
pub(crate) mod words;
