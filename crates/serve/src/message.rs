//! Binary messages: a header that says what follows, and arrays of numbers that a page uses as they are.
//!
//! ```text
//! u32 length of the header ─ header, JSON in UTF-8, blanks up to a multiple of 4 ─ array ─ array ─ …
//! ```
//!
//! Everything is little-endian, and every array begins at a multiple of 4 bytes. The header's `arrays` names them in order:
//! `{"name": "positions", "type": "f32", "length": 300}`.

use serde_json::{Map, Value, json};

/// Numbers of one kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Array<'a> {
    /// Single precision.
    F32(&'a [f32]),
    /// Unsigned, 32 bits.
    U32(&'a [u32]),
    /// Unsigned, 16 bits; padded to a multiple of 4 bytes.
    U16(&'a [u16]),
}

impl Array<'_> {
    fn describe(&self, name: &str) -> Value {
        let (kind, length) = match self {
            Array::F32(values) => ("f32", values.len()),
            Array::U32(values) => ("u32", values.len()),
            Array::U16(values) => ("u16", values.len()),
        };
        json!({ "name": name, "type": kind, "length": length })
    }

    fn append(&self, out: &mut Vec<u8>) {
        match self {
            Array::F32(values) => values.iter().for_each(|v| out.extend(v.to_le_bytes())),
            Array::U32(values) => values.iter().for_each(|v| out.extend(v.to_le_bytes())),
            Array::U16(values) => values.iter().for_each(|v| out.extend(v.to_le_bytes())),
        }
        out.resize(out.len().next_multiple_of(4), 0);
    }
}

/// A message of a header and arrays by name.
pub fn encode(mut header: Map<String, Value>, arrays: &[(&str, Array<'_>)]) -> Vec<u8> {
    header.insert("arrays".into(), arrays.iter().map(|(name, array)| array.describe(name)).collect());
    let mut text = Value::Object(header).to_string();
    while !text.len().is_multiple_of(4) {
        text.push(' ');
    }
    let mut out = Vec::with_capacity(4 + text.len());
    // A header is a few kilobytes; only a scene with millions of materials would not fit, and memory ends before.
    out.extend((text.len() as u32).to_le_bytes());
    out.extend(text.as_bytes());
    for (_, array) in arrays {
        array.append(&mut out);
    }
    out
}

/// A message taken apart: for tests and for clients in Rust.
#[derive(Clone, Debug, PartialEq)]
pub struct Decoded {
    /// The header.
    pub header: Value,
    bytes: Vec<u8>,
    /// Name, kind, first byte and length of each array.
    places: Vec<(String, String, usize, usize)>,
}

/// A message that is not one.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("not a message of this protocol: {0}")]
pub struct DecodeError(String);

/// Takes a message apart.
///
/// # Errors
/// When lengths do not fit, or the header is not what it should be.
pub fn decode(bytes: &[u8]) -> Result<Decoded, DecodeError> {
    let refuse = |why: &str| DecodeError(why.into());
    let (length, rest) = bytes.split_first_chunk::<4>().ok_or_else(|| refuse("shorter than four bytes"))?;
    let length = u32::from_le_bytes(*length) as usize;
    let text = rest.get(..length).ok_or_else(|| refuse("the header is longer than the message"))?;
    let header: Value = serde_json::from_slice(text).map_err(|e| refuse(&e.to_string()))?;
    let mut at = 4 + length;
    let mut places = Vec::new();
    for array in header["arrays"].as_array().ok_or_else(|| refuse("no list of arrays"))? {
        let text = |key: &str| array[key].as_str().unwrap_or_default().to_owned();
        let size = match array["type"].as_str() {
            Some("f32" | "u32") => 4,
            Some("u16") => 2,
            _ => return Err(refuse("an array of unknown type")),
        };
        let length = array["length"].as_u64().unwrap_or(0) as usize;
        places.push((text("name"), text("type"), at, length));
        at += length.saturating_mul(size).next_multiple_of(4);
    }
    if at != bytes.len() {
        return Err(DecodeError(format!("{} bytes where the header says {at}", bytes.len())));
    }
    Ok(Decoded { header, bytes: bytes.to_vec(), places })
}

impl Decoded {
    fn words(&self, name: &str, kind: &str) -> Option<impl Iterator<Item = [u8; 4]> + '_> {
        let (_, _, at, length) = self.places.iter().find(|p| p.0 == name && p.1 == kind)?;
        let words = self.bytes[*at..at + 4 * length].chunks_exact(4);
        Some(words.map(|w| [w[0], w[1], w[2], w[3]]))
    }

    /// An array of single precision.
    pub fn f32(&self, name: &str) -> Option<Vec<f32>> {
        Some(self.words(name, "f32")?.map(f32::from_le_bytes).collect())
    }

    /// An array of unsigned numbers.
    pub fn u32(&self, name: &str) -> Option<Vec<u32>> {
        Some(self.words(name, "u32")?.map(u32::from_le_bytes).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is encoded is decoded, whatever the length of the header; arrays begin at multiples of four.
    #[test]
    fn messages_come_back() {
        for padding in 0..5 {
            let mut header = Map::new();
            header.insert("kind".into(), "é".repeat(padding).into());
            let arrays = [
                ("a", Array::F32(&[1.5, f32::NAN, -0.0])),
                ("c", Array::U16(&[1, 2, 3])),
                ("b", Array::U32(&[7, u32::MAX])),
            ];
            let bytes = encode(header, &arrays);
            let decoded = decode(&bytes).unwrap();
            assert_eq!(decoded.header["kind"], "é".repeat(padding));
            let bits: Vec<u32> = decoded.f32("a").unwrap().iter().map(|x| x.to_bits()).collect();
            assert_eq!(bits, [1.5f32, f32::NAN, -0.0].map(f32::to_bits));
            assert_eq!(decoded.u32("b").unwrap(), [7, u32::MAX]);
            assert!(decoded.places.iter().all(|p| p.2.is_multiple_of(4)));
            for length in 0..bytes.len() {
                assert!(decode(&bytes[..length]).is_err(), "{length} bytes");
            }
        }
    }
}
