//! Reading legacy VTK: unstructured grids and polygonal data, text and big-endian binary.
//!
//! Up to version 4.2 a list of cells is `[n, p₀ … pₙ₋₁, n, …]`; from version 5 on it is offsets and connectivity.

use super::arrays::{self, Array};
use super::cells::{self, CellMap, Cells};
use crate::formats::draft::Draft;
use crate::formats::error::{FormatError, Place};
use crate::formats::field::Values;
use crate::formats::stream::{Encoding, Endian, Scalar, Stream};

/// The data set of a file.
#[derive(Clone, Copy, PartialEq, Eq)]
enum DataSet {
    Unstructured,
    Poly,
}

/// VTK's types of the cells in polygonal data; a line of two points is a type of its own.
const POLY_VERTEX: i64 = 2;
const LINE: i64 = 3;
const POLY_LINE: i64 = 4;
const TRIANGLE_STRIP: i64 = 6;
const POLYGON: i64 = 7;

pub(super) struct Reader<'a> {
    pub(super) stream: Stream<'a>,
    pub(super) draft: Draft,
    pub(super) map: CellMap,
    cells: Cells,
    version: u32,
    pub(super) arrays: Vec<Array>,
    /// Numbers of points and cells, once they are complete.
    pub(super) complete: Option<(usize, usize)>,
}

pub(in crate::formats) fn read(bytes: &[u8]) -> Result<Draft, FormatError> {
    let mut stream = Stream::new(bytes);
    let (version, encoding, name) = header(&mut stream)?;
    stream.encoding = encoding;
    let mut reader = Reader {
        stream,
        draft: Draft::new(name, bytes.len()),
        map: CellMap::default(),
        cells: Cells { types: Vec::new(), ends: Vec::new(), connectivity: Vec::new(), old_lagrange: version < 5 },
        version,
        arrays: Vec::new(),
        complete: None,
    };
    reader.sections()?;
    reader.complete()?;
    for array in &reader.arrays {
        arrays::regions(&mut reader.draft, &reader.map, array);
    }
    Ok(reader.draft)
}

/// Version line, title, encoding.
fn header(stream: &mut Stream<'_>) -> Result<(u32, Encoding, String), FormatError> {
    let first = stream.full_line().ok_or_else(|| FormatError::Truncated {
        place: Place::Line(1),
        expected: "# vtk DataFile Version".to_owned(),
    })?;
    let first = String::from_utf8_lossy(first);
    let version = first.strip_prefix("# vtk DataFile Version").map(str::trim);
    let Some(version) = version else {
        return Err(stream.syntax("# vtk DataFile Version", &first));
    };
    let major = version.split('.').next().and_then(|v| v.parse().ok());
    let Some(major) = major else {
        return Err(stream.syntax("a version such as 3.0", version));
    };
    if stream.line().is_none() {
        return Err(stream.truncated("a title line"));
    }
    let Some(line) = stream.full_line() else {
        return Err(stream.truncated("ASCII or BINARY"));
    };
    let (encoding, name) = match line.to_ascii_uppercase().as_slice() {
        b"ASCII" => (Encoding::Text, "text"),
        b"BINARY" => (Encoding::Binary(Endian::Big), "binary"),
        _ => return Err(stream.syntax("ASCII or BINARY", &String::from_utf8_lossy(line))),
    };
    Ok((major, encoding, format!("legacy VTK {version}, {name}")))
}

impl Reader<'_> {
    fn sections(&mut self) -> Result<(), FormatError> {
        let mut data_set = None;
        while let Some(line) = self.stream.full_line() {
            let line = String::from_utf8_lossy(line).into_owned();
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            let keyword = words.first().map(|w| w.to_ascii_uppercase()).unwrap_or_default();
            match keyword.as_str() {
                "DATASET" => data_set = Some(self.data_set(words.get(1).copied().unwrap_or("none"))?),
                _ if data_set.is_none() => return Err(self.stream.syntax("DATASET", &line)),
                "POINTS" => self.points(&words)?,
                "CELLS" => self.cells(&words, None)?,
                "CELL_TYPES" => {
                    let count = self.number(&words, 1)?;
                    self.cells.types = whole(self.stream.array(Scalar::I32, count, "cell types")?);
                }
                "VERTICES" | "LINES" | "POLYGONS" | "TRIANGLE_STRIPS" if data_set == Some(DataSet::Poly) => {
                    let cell_type = match keyword.as_str() {
                        "VERTICES" => POLY_VERTEX,
                        "LINES" => POLY_LINE,
                        "POLYGONS" => POLYGON,
                        _ => TRIANGLE_STRIP,
                    };
                    self.cells(&words, Some(cell_type))?;
                }
                "METADATA" => self.metadata(),
                "FIELD" => self.field(&words, None)?,
                "POINT_DATA" | "CELL_DATA" => {
                    self.complete()?;
                    self.attributes(&words)?;
                }
                _ => return Err(self.stream.syntax("a section such as POINTS or CELLS", &line)),
            }
        }
        if data_set.is_none() {
            return Err(self.stream.truncated("DATASET"));
        }
        Ok(())
    }

    fn data_set(&self, name: &str) -> Result<DataSet, FormatError> {
        match name.to_ascii_uppercase().as_str() {
            "UNSTRUCTURED_GRID" => Ok(DataSet::Unstructured),
            "POLYDATA" => Ok(DataSet::Poly),
            other => Err(FormatError::Unsupported {
                place: self.stream.place(),
                what: format!("data set {other}"),
                advice: "save it as an unstructured grid".to_owned(),
            }),
        }
    }

    /// A count in the words of a header line.
    pub(super) fn number(&self, words: &[&str], at: usize) -> Result<u64, FormatError> {
        let number = words.get(at).and_then(|w| w.parse().ok());
        number.ok_or_else(|| self.stream.syntax(&format!("a count as word {} of the line", at + 1), &words.join(" ")))
    }

    /// The type of numbers that a header line names.
    pub(super) fn scalar(&self, name: Option<&&str>) -> Result<Scalar, FormatError> {
        let name = name.copied().unwrap_or("none");
        Ok(match name.to_ascii_lowercase().as_str() {
            "char" | "signed_char" | "vtktypeint8" => Scalar::I8,
            "unsigned_char" | "vtktypeuint8" => Scalar::U8,
            "short" | "vtktypeint16" => Scalar::I16,
            "unsigned_short" | "vtktypeuint16" => Scalar::U16,
            // VTK writes its ids as 32-bit integers here.
            "int" | "vtkidtype" | "vtktypeint32" => Scalar::I32,
            "unsigned_int" | "vtktypeuint32" => Scalar::U32,
            "long" | "long_long" | "vtktypeint64" => Scalar::I64,
            "unsigned_long" | "unsigned_long_long" | "vtktypeuint64" => Scalar::U64,
            "float" => Scalar::F32,
            "double" => Scalar::F64,
            _ => {
                return Err(FormatError::Unsupported {
                    place: self.stream.place(),
                    what: format!("an array of type {name}"),
                    advice: "save the file without this array".to_owned(),
                });
            }
        })
    }

    fn points(&mut self, words: &[&str]) -> Result<(), FormatError> {
        let count = self.number(words, 1)?;
        let scalar = self.scalar(words.get(2))?;
        self.stream.claim(count, 3, 3 * scalar.size(), "points")?;
        for node in 0..count {
            let [x, y, z] = [0; 3].map(|_| self.stream.float(scalar, "a coordinate"));
            self.draft.node([x?, y?, z?], node, || self.stream.place())?;
        }
        Ok(())
    }

    /// A list of cells; in polygonal data the section says their type.
    fn cells(&mut self, words: &[&str], cell_type: Option<i64>) -> Result<(), FormatError> {
        let (count, size) = (self.number(words, 1)?, self.number(words, 2)?);
        let base = self.cells.connectivity.len() as i64;
        let already = self.cells.ends.len();
        if self.version >= 5 && self.stream.peek_word().is_some_and(|w| w.eq_ignore_ascii_case("OFFSETS")) {
            let offsets = self.named_array("OFFSETS", count)?;
            let connectivity = self.named_array("CONNECTIVITY", size)?;
            self.cells.ends.extend(offsets.iter().skip(1).map(|end| end.saturating_add(base)));
            self.cells.connectivity.extend(connectivity);
        } else {
            let flat = whole(self.stream.array(Scalar::I32, size, "numbers of cells")?);
            let mut rest = &flat[..];
            for cell in 0..count {
                let part = rest.split_first().and_then(|(&n, after)| {
                    let n = usize::try_from(n).ok()?;
                    (n <= after.len()).then(|| after.split_at(n))
                });
                let Some((points, after)) = part else {
                    return Err(FormatError::Count {
                        place: self.stream.place(),
                        what: format!("numbers for {count} cells"),
                        said: size,
                        found: format!("cell {cell} needs more"),
                    });
                };
                self.cells.connectivity.extend_from_slice(points);
                self.cells.ends.push(self.cells.connectivity.len() as i64);
                rest = after;
            }
        }
        if let Some(cell_type) = cell_type {
            for cell in already..self.cells.ends.len() {
                let start = cell.checked_sub(1).map_or(0, |before| self.cells.ends[before]);
                let two = self.cells.ends[cell].saturating_sub(start) == 2;
                self.cells.types.push(if cell_type == POLY_LINE && two { LINE } else { cell_type });
            }
        }
        Ok(())
    }

    /// `OFFSETS vtktypeint64` and the numbers.
    fn named_array(&mut self, name: &str, count: u64) -> Result<Vec<i64>, FormatError> {
        let Some(line) = self.stream.full_line() else {
            return Err(self.stream.truncated(name));
        };
        let line = String::from_utf8_lossy(line).into_owned();
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        if !words.first().is_some_and(|w| w.eq_ignore_ascii_case(name)) {
            return Err(self.stream.syntax(name, &line));
        }
        let scalar = self.scalar(words.get(1))?;
        Ok(whole(self.stream.array(scalar, count, name)?))
    }

    /// Notes about an array, up to a blank line.
    pub(super) fn metadata(&mut self) {
        while self.stream.line().is_some_and(|line| !line.trim_ascii().is_empty()) {}
    }

    /// Turns the cells into elements, once.
    fn complete(&mut self) -> Result<(), FormatError> {
        if self.complete.is_some() {
            return Ok(());
        }
        if self.cells.types.len() != self.cells.ends.len() {
            return Err(FormatError::Count {
                place: self.stream.place(),
                what: "cells in CELLS".to_owned(),
                said: self.cells.ends.len() as u64,
                found: format!("CELL_TYPES holds {}", self.cells.types.len()),
            });
        }
        let points = self.draft.nodes.len();
        let place = || self.stream.place();
        cells::add(&mut self.draft, &mut self.map, &self.cells, (0, points), &place)?;
        self.complete = Some((points, self.map.len()));
        Ok(())
    }
}

/// Integers, whatever their width.
fn whole(values: Values) -> Vec<i64> {
    match values {
        Values::I64(v) => v,
        Values::F64(v) => v.into_iter().map(|x| x as i64).collect(),
    }
}
