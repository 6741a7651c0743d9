//! Exports of a group, read back.

use crate::report::group;
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::Field;
use souple_campaign::export::{Cells, columns, parquet as parquet_bytes, table};

/// What Parquet gives back is what went in, bit by bit, what is missing included; CSV has the same cells.
#[test]
fn exports_read_back() {
    let columns = columns(&group());
    let names: Vec<&str> = columns.iter().map(|c| c.name.as_str()).collect();
    for name in ["number", "bar", "body.0.mesh.cells", "status", "tip mean displacement y (m)", "reason"] {
        assert!(names.contains(&name), "{name} is not among {names:?}");
    }
    let bytes = parquet_bytes(&columns).unwrap();
    let reader = SerializedFileReader::new(bytes::Bytes::from(bytes)).unwrap();
    let mut rows = 0;
    for (at, row) in reader.get_row_iter(None).unwrap().enumerate() {
        rows += 1;
        for ((name, field), column) in row.unwrap().get_column_iter().zip(&columns) {
            assert_eq!(name, &column.name);
            let same = match (&column.cells, field) {
                (Cells::Whole(v), Field::Null) => v[at].is_none(),
                (Cells::Real(v), Field::Null) => v[at].is_none(),
                (Cells::Text(v), Field::Null) => v[at].is_none(),
                (Cells::Whole(v), Field::Long(x)) => v[at] == Some(*x),
                (Cells::Real(v), Field::Double(x)) => v[at].map(f64::to_bits) == Some(x.to_bits()),
                (Cells::Text(v), Field::Str(x)) => v[at].as_ref() == Some(x),
                _ => false,
            };
            assert!(same, "row {at}, {name}: {field}");
        }
    }
    assert_eq!(rows, group().simulations.len());
    let missing = columns.iter().filter(|c| matches!(&c.cells, Cells::Real(v) if v.contains(&None))).count();
    assert!(missing > 5, "simulations that failed have no results");
    let table = table(&columns);
    assert_eq!((table.rows.len(), table.heads.len()), (rows, columns.len()));
    for (c, column) in columns.iter().enumerate() {
        for (row, cells) in table.rows.iter().enumerate() {
            match &column.cells {
                Cells::Real(v) => assert_eq!(cells[c].parse().ok(), v[row], "{}", column.name),
                Cells::Whole(v) => assert_eq!(cells[c].parse().ok(), v[row], "{}", column.name),
                Cells::Text(v) => assert_eq!(cells[c], v[row].clone().unwrap_or_default(), "{}", column.name),
            }
        }
    }
}
