//! PLY: a header that describes records, then the records, in text or binary.

use super::draft::Draft;
use super::error::FormatError;
use super::polygon;
use super::stream::{Encoding, Endian, Scalar, Stream};

/// One property of a record.
struct Property {
    name: String,
    /// Type of the length in front of a list.
    length: Option<Scalar>,
    scalar: Scalar,
}

/// A kind of record.
struct Records {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

impl Records {
    /// Numbers and bytes that a record has at least.
    fn least(&self) -> (usize, usize) {
        let bytes = self.properties.iter().map(|p| p.length.unwrap_or(p.scalar).size()).sum();
        (self.properties.len(), bytes)
    }
}

pub(super) fn read(bytes: &[u8]) -> Result<Draft, FormatError> {
    let mut stream = Stream::new(bytes);
    let (records, encoding) = header(&mut stream)?;
    stream.encoding = encoding;
    let encoding = match encoding {
        Encoding::Text => "text",
        Encoding::Binary(Endian::Little) => "binary, little-endian",
        Encoding::Binary(Endian::Big) => "binary, big-endian",
    };
    let mut draft = Draft::new(format!("PLY, {encoding}"), bytes.len());
    for records in &records {
        match records.name.as_str() {
            "vertex" => vertices(&mut stream, &mut draft, records)?,
            "face" => faces(&mut stream, &mut draft, records)?,
            _ => {
                draft.report.ignore(format!("element {}", records.name));
                let (numbers, least) = records.least();
                for _ in 0..stream.claim(records.count, numbers, least, &records.name)? {
                    record(&mut stream, records, |_, _| {})?;
                }
            }
        }
    }
    Ok(draft)
}

fn header(stream: &mut Stream<'_>) -> Result<(Vec<Records>, Encoding), FormatError> {
    let mut records: Vec<Records> = Vec::new();
    let mut encoding = None;
    let mut first = true;
    loop {
        let Some(line) = stream.full_line() else {
            return Err(stream.truncated("end_header"));
        };
        let line = String::from_utf8_lossy(line).into_owned();
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        match words.as_slice() {
            ["ply"] if first => {}
            _ if first => return Err(stream.syntax("ply", &line)),
            ["format", name, _] => {
                encoding = Some(match *name {
                    "ascii" => Encoding::Text,
                    "binary_little_endian" => Encoding::Binary(Endian::Little),
                    "binary_big_endian" => Encoding::Binary(Endian::Big),
                    _ => return Err(stream.syntax("ascii, binary_little_endian or binary_big_endian", name)),
                });
            }
            ["comment" | "obj_info", ..] => {}
            ["element", name, count] => {
                let count = count.parse().map_err(|_| stream.syntax("element NAME COUNT", &line))?;
                records.push(Records { name: (*name).to_owned(), count, properties: Vec::new() });
            }
            ["property", rest @ ..] => {
                let property = property(rest).ok_or_else(|| stream.syntax("property TYPE NAME", &line))?;
                let Some(last) = records.last_mut() else {
                    return Err(stream.syntax("an element before its properties", &line));
                };
                last.properties.push(property);
            }
            ["end_header"] => break,
            _ => return Err(stream.syntax("format, element, property or end_header", &line)),
        }
        first = false;
    }
    match encoding {
        Some(encoding) => Ok((records, encoding)),
        None => Err(stream.syntax("a format line in the header", "none")),
    }
}

fn property(words: &[&str]) -> Option<Property> {
    let scalar = |name: &str| {
        Some(match name {
            "char" | "int8" => Scalar::I8,
            "uchar" | "uint8" => Scalar::U8,
            "short" | "int16" => Scalar::I16,
            "ushort" | "uint16" => Scalar::U16,
            "int" | "int32" => Scalar::I32,
            "uint" | "uint32" => Scalar::U32,
            "float" | "float32" => Scalar::F32,
            "double" | "float64" => Scalar::F64,
            _ => return None,
        })
    };
    match words {
        ["list", length, of, name] => {
            Some(Property { name: (*name).to_owned(), length: Some(scalar(length)?), scalar: scalar(of)? })
        }
        [of, name] => Some(Property { name: (*name).to_owned(), length: None, scalar: scalar(of)? }),
        _ => None,
    }
}

/// Reads one record and shows each property's values.
fn record(stream: &mut Stream<'_>, records: &Records, mut show: impl FnMut(&str, &[f64])) -> Result<(), FormatError> {
    for property in &records.properties {
        let length = match property.length {
            Some(of) => {
                let length = stream.float(of, "the length of a list")?;
                let valid = length >= 0.0 && length.fract() == 0.0;
                let length = if valid { length as u64 } else { u64::MAX };
                stream.claim(length, 1, property.scalar.size(), &format!("values of {}", property.name))?
            }
            None => 1,
        };
        let mut values = Vec::with_capacity(length);
        for _ in 0..length {
            values.push(stream.float(property.scalar, &property.name)?);
        }
        show(&property.name, &values);
    }
    Ok(())
}

fn vertices(stream: &mut Stream<'_>, draft: &mut Draft, records: &Records) -> Result<(), FormatError> {
    let has = |axis: &str| records.properties.iter().any(|p| p.name == axis && p.length.is_none());
    if !(has("x") && has("y")) {
        return Err(stream.syntax("properties x, y and z of a vertex", "others"));
    }
    let (numbers, least) = records.least();
    for node in 0..stream.claim(records.count, numbers, least, "vertices")? {
        let mut position = [0.0; 3];
        record(stream, records, |name, values| match name {
            "x" => position[0] = values[0],
            "y" => position[1] = values[0],
            "z" => position[2] = values[0],
            _ => {}
        })?;
        draft.node(position, node, || stream.place())?;
    }
    Ok(())
}

fn faces(stream: &mut Stream<'_>, draft: &mut Draft, records: &Records) -> Result<(), FormatError> {
    let (numbers, least) = records.least();
    let known = draft.nodes.len();
    let mut corners: Vec<f64> = Vec::new();
    for face in 0..stream.claim(records.count, numbers, least, "faces")? {
        corners.clear();
        record(stream, records, |name, values| {
            if matches!(name, "vertex_indices" | "vertex_index") {
                corners.extend_from_slice(values);
            }
        })?;
        let mut nodes = Vec::with_capacity(corners.len());
        for &corner in &corners {
            let inside = corner >= 0.0 && corner < known as f64 && corner.fract() == 0.0;
            if !inside {
                return Err(FormatError::OutOfRange {
                    place: stream.place(),
                    who: format!("face {face}"),
                    what: format!("vertex {corner}"),
                    defined: format!("{known} vertices, counted from 0"),
                });
            }
            nodes.push(corner as u32);
        }
        polygon::add(draft, &nodes);
    }
    Ok(())
}
