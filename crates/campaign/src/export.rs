//! A group as typed columns, one row per member, and these as CSV or Parquet.
//!
//! ```text
//! Group ──► Column, … ──► CSV (RFC 4180)
//!                   └───► Parquet: one row group, no compression, every column may be null
//! ```
//!
//! Why no compression? A thousand simulations are a few hundred kilobytes, and each codec costs more to build than it saves.

use crate::database::Table;
use crate::report::data::{Done, Group, Simulation};
use crate::report::quantities::derive;
use crate::report::scene::value;
use crate::report::units::unit_of_parameter;
use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::column::writer::ColumnWriter;
use parquet::data_type::ByteArray;
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::sync::Arc;

/// A column: its name, its unit in brackets where it has one, and a cell for each member.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// `tip mean displacement y (m)`.
    pub name: String,
    /// Its cells.
    pub cells: Cells,
}

/// Cells of one kind; none where a value is missing.
#[derive(Clone, Debug, PartialEq)]
pub enum Cells {
    /// Whole numbers.
    Whole(Vec<Option<i64>>),
    /// Numbers.
    Real(Vec<Option<f64>>),
    /// Texts.
    Text(Vec<Option<String>>),
}

/// All columns of a group.
pub fn columns(group: &Group) -> Vec<Column> {
    let mut all = Vec::new();
    let mut add = |name: &str, unit: &str, cells| {
        let mut name = if unit.is_empty() { name.to_owned() } else { format!("{name} ({unit})") };
        // A parameter may be called as a quantity is; columns have different names.
        while all.iter().any(|c: &Column| c.name == name) {
            name.push('\'');
        }
        all.push(Column { name, cells });
    };
    let text = |of: &dyn Fn(&Simulation) -> Option<String>| Cells::Text(group.simulations.iter().map(of).collect());
    let whole = |of: &dyn Fn(&Simulation) -> Option<i64>| Cells::Whole(group.simulations.iter().map(of).collect());
    let done_text = |of: &dyn Fn(&Done) -> String| text(&|s| s.done.as_ref().map(of).filter(|text| !text.is_empty()));
    add("number", "", whole(&|s| i64::try_from(s.number).ok()));
    if !group.bars.is_empty() {
        add("bar", "", text(&|s| s.bar.map(|b| group.bars[b].name.clone())));
    }
    add("device", "", text(&|s| Some(s.device.clone())));
    for (at, parameter) in group.parameters.iter().enumerate() {
        let (cells, numbers) = parameter_cells(group, at);
        add(&parameter.name, if numbers { unit_of_parameter(&parameter.name) } else { String::new() }.as_str(), cells);
    }
    add("status", "", text(&|s| Some(s.done.as_ref().map_or("to do", |d| &d.status).to_owned())));
    for quantity in derive(group).quantities {
        add(&quantity.name, &quantity.unit, Cells::Real(quantity.values));
    }
    let kinds = |d: &Done| d.elements.iter().map(|(kind, n)| format!("{n} {kind}")).collect::<Vec<_>>().join(", ");
    add("elements by kind", "", done_text(&kinds));
    let machine = |d: &Done| group.machines[d.machine].clone();
    add("machine", "", done_text(&|d| machine(d).host));
    add("processor", "", done_text(&|d| machine(d).processor));
    add("threads", "", whole(&|s| s.done.as_ref().and_then(|d| i64::try_from(d.threads).ok())));
    add("program", "", done_text(&|d| d.program.clone()));
    add("hash", "", done_text(&|d| d.hash.clone()));
    add("reason", "", done_text(&|d| d.reason.clone()));
    all
}

/// The cells of a parameter, numbers where all of them are, and whether they are.
fn parameter_cells(group: &Group, at: usize) -> (Cells, bool) {
    let values = || group.simulations.iter().map(|s| s.values[at].as_deref().map(value));
    if values().all(|v| v.is_none_or(|v| matches!(v, crate::group::Value::Whole(_)))) {
        let whole = |v: crate::group::Value| if let crate::group::Value::Whole(x) = v { Some(x) } else { None };
        return (Cells::Whole(values().map(|v| v.and_then(whole)).collect()), true);
    }
    if values().all(|v| v.is_none_or(|v| v.number().is_some())) {
        return (Cells::Real(values().map(|v| v.and_then(|v| v.number())).collect()), true);
    }
    (Cells::Text(values().map(|v| v.map(|v| v.to_string())).collect()), false)
}

/// The columns as texts; numbers read back to the same bits, what is missing is empty.
pub fn table(columns: &[Column]) -> Table {
    let cells = |column: &Column| -> Vec<String> {
        match &column.cells {
            Cells::Whole(v) => v.iter().map(|x| x.map_or(String::new(), |x| x.to_string())).collect(),
            Cells::Real(v) => v.iter().map(|x| x.map_or(String::new(), |x| format!("{x:?}"))).collect(),
            Cells::Text(v) => v.iter().map(|x| x.clone().unwrap_or_default()).collect(),
        }
    };
    let texts: Vec<Vec<String>> = columns.iter().map(cells).collect();
    let count = texts.first().map_or(0, Vec::len);
    let rows = (0..count).map(|row| texts.iter().map(|column| column[row].clone()).collect()).collect();
    Table { heads: columns.iter().map(|c| c.name.clone()).collect(), rows }
}

/// The columns as the bytes of a Parquet file.
///
/// # Errors
///
/// When two columns have one name.
pub fn parquet(columns: &[Column]) -> Result<Vec<u8>, ParquetError> {
    let field = |column: &Column| -> Result<Arc<Type>, ParquetError> {
        let (physical, logical) = match &column.cells {
            Cells::Whole(_) => (Physical::INT64, None),
            Cells::Real(_) => (Physical::DOUBLE, None),
            Cells::Text(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        };
        let builder = Type::primitive_type_builder(&column.name, physical).with_repetition(Repetition::OPTIONAL);
        Ok(Arc::new(builder.with_logical_type(logical).build()?))
    };
    let fields = columns.iter().map(field).collect::<Result<Vec<_>, _>>()?;
    let schema = Arc::new(Type::group_type_builder("simulations").with_fields(fields).build()?);
    let properties = Arc::new(WriterProperties::builder().set_created_by("souple".to_owned()).build());
    let mut bytes = Vec::new();
    let mut file = SerializedFileWriter::new(&mut bytes, schema, properties)?;
    let mut rows = file.next_row_group()?;
    for column in columns {
        let mut writer = rows.next_column()?.expect("the schema has as many columns as we write");
        match (writer.untyped(), &column.cells) {
            (ColumnWriter::Int64ColumnWriter(w), Cells::Whole(v)) => {
                w.write_batch(&present(v), Some(&levels(v)), None)?;
            }
            (ColumnWriter::DoubleColumnWriter(w), Cells::Real(v)) => {
                w.write_batch(&present(v), Some(&levels(v)), None)?;
            }
            (ColumnWriter::ByteArrayColumnWriter(w), Cells::Text(v)) => {
                let texts: Vec<ByteArray> = v.iter().flatten().map(|text| ByteArray::from(text.as_str())).collect();
                w.write_batch(&texts, Some(&levels(v)), None)?;
            }
            _ => unreachable!("writers have the types of their fields, which are those of the cells"),
        }
        writer.close()?;
    }
    rows.close()?;
    file.close()?;
    Ok(bytes)
}

/// The values that are there.
fn present<T: Copy>(values: &[Option<T>]) -> Vec<T> {
    values.iter().flatten().copied().collect()
}

/// 1 where a value is there, 0 where it is missing.
fn levels<T>(values: &[Option<T>]) -> Vec<i16> {
    values.iter().map(|v| i16::from(v.is_some())).collect()
}
