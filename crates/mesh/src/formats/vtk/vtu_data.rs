//! The bytes of a VTU data array: text, base64 or raw, compressed or not.
//!
//! Uncompressed: `[length in bytes][data]`. Compressed: `[number of blocks][block size][size of the last block, or 0]
//! [compressed sizes …][block][block] …`. A number of the header has 4 or 8 bytes; in base64 the header is encoded on
//! its own by VTK and together with the data by some other writers.

use crate::formats::error::{FormatError, Place};
use crate::formats::field::Values;
use crate::formats::stream::{Endian, Scalar, parse_float};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use std::io::Read as _;

/// zlib expands one byte to at most this many.
const ZLIB_EXPANSION: usize = 1032;

/// The part of a file behind `<AppendedData>`.
pub(super) struct Appended<'a> {
    pub(super) raw: bool,
    /// What follows the underscore.
    pub(super) data: &'a [u8],
    /// Where that is in the file.
    pub(super) at: usize,
}

/// How the arrays of a file are stored.
pub(super) struct Storage<'a> {
    pub(super) appended: Option<Appended<'a>>,
    /// Type of the numbers in a header.
    pub(super) header: Scalar,
    pub(super) endian: Endian,
    pub(super) zlib: bool,
    /// Bytes that may still be decoded, so that a small file cannot ask for the same expansion a thousand times.
    pub(super) budget: usize,
}

impl Storage<'_> {
    /// What any file of this length can honestly hold, twice.
    pub(super) fn budget_of(bytes: usize) -> usize {
        bytes.saturating_mul(2 * ZLIB_EXPANSION)
    }

    /// The numbers of a `<DataArray>` whose name for messages is `what`.
    pub(super) fn array(&mut self, node: roxmltree::Node<'_, '_>, what: &str) -> Result<Values, FormatError> {
        let line = node.document().text_pos_at(node.range().start).row as usize;
        let place = Place::Line(line);
        let scalar = scalar(node, &place)?;
        let text = || node.children().filter_map(|c| c.text()).collect::<String>();
        match node.attribute("format") {
            Some("ascii") => parse(&text(), scalar, what, &place),
            Some("binary") => {
                let chars: Vec<u8> = text().bytes().filter(|b| !b.is_ascii_whitespace()).collect();
                Ok(scalar.decode(&self.decode(&Bytes::Base64(&chars), what, &place)?, self.endian))
            }
            Some("appended") => {
                let offset = node.attribute("offset").and_then(|o| o.trim().parse::<usize>().ok());
                let Some(appended) = &self.appended else {
                    return Err(FormatError::Truncated { place, expected: "<AppendedData>".to_owned() });
                };
                let rest = offset.and_then(|o| Some((o, appended.data.get(o..)?)));
                let Some((offset, rest)) = rest else {
                    return Err(FormatError::Syntax {
                        place,
                        expected: format!("an offset of {what} inside the appended data"),
                        found: format!("\"{}\"", node.attribute("offset").unwrap_or("none")),
                    });
                };
                let place = Place::Byte(appended.at + offset);
                let bytes = if appended.raw { Bytes::Raw(rest) } else { Bytes::Base64(rest) };
                Ok(scalar.decode(&self.decode(&bytes, what, &place)?, self.endian))
            }
            other => Err(FormatError::Unsupported {
                place,
                what: format!("format \"{}\" of {what}", other.unwrap_or("none")),
                advice: "VTK defines ascii, binary and appended".to_owned(),
            }),
        }
    }

    fn decode(&mut self, bytes: &Bytes<'_>, what: &str, place: &Place) -> Result<Vec<u8>, FormatError> {
        let truncated = || FormatError::Truncated { place: place.clone(), expected: format!("the data of {what}") };
        let (header, endian) = (self.header, self.endian);
        let word = header.size();
        let number = |bytes: &[u8]| match header.decode(bytes, endian) {
            Values::I64(v) => v.first().and_then(|&n| usize::try_from(n).ok()),
            Values::F64(_) => None,
        };
        let first = number(&bytes.start(word).ok_or_else(truncated)?).ok_or_else(truncated)?;
        let claim = |said: usize, found: usize| FormatError::Count {
            place: place.clone(),
            what: format!("bytes for {what}"),
            said: said as u64,
            found: format!("{found} follow"),
        };
        if !self.zlib {
            self.spend(first, what, place)?;
            return bytes.after_header(word, first).ok_or_else(|| claim(first, bytes.len()));
        }
        if first == 0 {
            return Ok(Vec::new());
        }
        let header_size = first.checked_add(3).and_then(|n| n.checked_mul(word)).filter(|&n| n <= bytes.len());
        let header_size = header_size.ok_or_else(|| claim(first, bytes.len()))?;
        let header = bytes.start(header_size).ok_or_else(truncated)?;
        let mut sizes = header.chunks_exact(word).map(number);
        let mut next = || sizes.next().flatten().ok_or_else(truncated);
        let (_, block, last) = (next()?, next()?, next()?);
        let compressed: Vec<usize> = (0..first).map(|_| next()).collect::<Result<_, _>>()?;
        let total = compressed.iter().try_fold(0usize, |sum, &n| sum.checked_add(n)).ok_or_else(truncated)?;
        let data = bytes.beside_header(header_size, total).ok_or_else(|| claim(total, bytes.len()))?;
        let mut out = Vec::new();
        let mut rest = &data[..];
        for (at, &size) in compressed.iter().enumerate() {
            let expected = if at + 1 == first && last != 0 { last } else { block };
            let (one, after) = rest.split_at(size);
            rest = after;
            self.spend(expected.min(size.saturating_mul(ZLIB_EXPANSION)), what, place)?;
            let before = out.len();
            // One byte more than expected tells a block that is longer than it says.
            let mut inflated = flate2::read::ZlibDecoder::new(one).take(expected as u64 + 1);
            let result = inflated.read_to_end(&mut out);
            if result.is_err() || out.len() - before != expected {
                return Err(FormatError::Count {
                    place: place.clone(),
                    what: format!("bytes in compressed block {at} of {what}"),
                    said: expected as u64,
                    found: match result {
                        Ok(found) => format!("it holds {found}"),
                        Err(e) => format!("it cannot be inflated ({e})"),
                    },
                });
            }
        }
        Ok(out)
    }

    fn spend(&mut self, bytes: usize, what: &str, place: &Place) -> Result<(), FormatError> {
        self.budget = self.budget.checked_sub(bytes).ok_or_else(|| FormatError::Unsupported {
            place: place.clone(),
            what: format!("{what}, which expands to more than a file of this size can hold,"),
            advice: "write the file again".to_owned(),
        })?;
        Ok(())
    }
}

/// Where the bytes are.
enum Bytes<'a> {
    Raw(&'a [u8]),
    Base64(&'a [u8]),
}

/// Number of characters that encode so many bytes.
fn encoded(bytes: usize) -> Option<usize> {
    bytes.div_ceil(3).checked_mul(4)
}

fn decode64(chars: &[u8]) -> Option<Vec<u8>> {
    STANDARD.decode(chars).ok()
}

impl Bytes<'_> {
    /// Upper bound of the bytes that are here.
    fn len(&self) -> usize {
        match self {
            Bytes::Raw(b) => b.len(),
            Bytes::Base64(c) => c.len() / 4 * 3,
        }
    }

    /// The first bytes.
    fn start(&self, count: usize) -> Option<Vec<u8>> {
        match self {
            Bytes::Raw(b) => b.get(..count).map(<[u8]>::to_vec),
            Bytes::Base64(c) => {
                let mut bytes = decode64(c.get(..encoded(count)?)?)?;
                bytes.truncate(count);
                (bytes.len() == count).then_some(bytes)
            }
        }
    }

    /// Bytes after a header that was encoded on its own.
    fn beside_header(&self, header: usize, count: usize) -> Option<Vec<u8>> {
        match self {
            Bytes::Raw(b) => b.get(header..header.checked_add(count)?).map(<[u8]>::to_vec),
            Bytes::Base64(c) => Bytes::Base64(c.get(encoded(header)?..)?).start(count),
        }
    }

    /// Bytes after a header that was encoded on its own (then it ends in `=`) or together with them.
    fn after_header(&self, header: usize, count: usize) -> Option<Vec<u8>> {
        match self {
            Bytes::Base64(c) if c.get(encoded(header)? - 1) != Some(&b'=') => {
                Some(self.start(header.checked_add(count)?)?.split_off(header))
            }
            _ => self.beside_header(header, count),
        }
    }
}

fn scalar(node: roxmltree::Node<'_, '_>, place: &Place) -> Result<Scalar, FormatError> {
    Ok(match node.attribute("type") {
        Some("Int8") => Scalar::I8,
        Some("UInt8") => Scalar::U8,
        Some("Int16") => Scalar::I16,
        Some("UInt16") => Scalar::U16,
        Some("Int32") => Scalar::I32,
        Some("UInt32") => Scalar::U32,
        Some("Int64") => Scalar::I64,
        Some("UInt64") => Scalar::U64,
        Some("Float32") => Scalar::F32,
        Some("Float64") => Scalar::F64,
        other => {
            return Err(FormatError::Syntax {
                place: place.clone(),
                expected: "a type of numbers (Int32, Float64, …)".to_owned(),
                found: format!("\"{}\"", other.unwrap_or("none")),
            });
        }
    })
}

fn parse(text: &str, scalar: Scalar, what: &str, place: &Place) -> Result<Values, FormatError> {
    let wrong = |word: &str| FormatError::Syntax {
        place: place.clone(),
        expected: format!("a number of {what}"),
        found: format!("\"{}\"", word.chars().take(60).collect::<String>()),
    };
    let words = text.split_ascii_whitespace();
    if scalar.is_float() {
        let numbers = words.map(|w| parse_float(w).ok_or_else(|| wrong(w)));
        return Ok(Values::F64(numbers.collect::<Result<_, _>>()?));
    }
    let numbers = words.map(|w| w.parse::<i64>().map_err(|_| wrong(w)));
    Ok(Values::I64(numbers.collect::<Result<_, _>>()?))
}
