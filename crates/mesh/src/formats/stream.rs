//! A cursor over the bytes of a mesh file, for text, binary and their mixtures.
//!
//! Formats such as MSH, legacy VTK and PLY put lines of text in front of numbers that are text or binary; one cursor
//! reads both, so that each section of a format is read by one function whatever its encoding.
//! Counts that a file claims are checked against the bytes that are left before anything is allocated for them.

use super::error::{FormatError, Place};
use super::field::Values;

/// Order of the bytes of a binary number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Endian {
    Little,
    Big,
}

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    Binary(Endian),
}

/// Type of a binary number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    pub(super) fn size(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::I64 | Scalar::U64 | Scalar::F64 => 8,
        }
    }

    pub(super) fn is_float(self) -> bool {
        matches!(self, Scalar::F32 | Scalar::F64)
    }

    /// The integer in the first `size()` bytes.
    fn integer(self, b: &[u8], endian: Endian) -> i64 {
        let mut wide = [0; 8];
        wide[..b.len()].copy_from_slice(b);
        if endian == Endian::Big {
            wide[..b.len()].reverse();
        }
        let bits = u64::from_le_bytes(wide);
        match self {
            Scalar::I8 => bits as u8 as i8 as i64,
            Scalar::I16 => bits as u16 as i16 as i64,
            Scalar::I32 => bits as u32 as i32 as i64,
            Scalar::F32 => f32::from_bits(bits as u32) as i64,
            Scalar::F64 => f64::from_bits(bits) as i64,
            Scalar::U8 | Scalar::U16 | Scalar::U32 | Scalar::I64 | Scalar::U64 => bits as i64,
        }
    }

    /// The number in the first `size()` bytes.
    fn float(self, b: &[u8], endian: Endian) -> f64 {
        let mut wide = [0; 8];
        wide[..b.len()].copy_from_slice(b);
        if endian == Endian::Big {
            wide[..b.len()].reverse();
        }
        match self {
            Scalar::F32 => f64::from(f32::from_bits(u64::from_le_bytes(wide) as u32)),
            Scalar::F64 => f64::from_le_bytes(wide),
            _ => self.integer(b, endian) as f64,
        }
    }

    /// All numbers of these bytes; what is left over at the end is ignored.
    pub(super) fn decode(self, bytes: &[u8], endian: Endian) -> Values {
        let items = bytes.chunks_exact(self.size());
        if self.is_float() {
            Values::F64(items.map(|b| self.float(b, endian)).collect())
        } else {
            Values::I64(items.map(|b| self.integer(b, endian)).collect())
        }
    }
}

/// The cursor.
pub(super) struct Stream<'a> {
    pub(super) bytes: &'a [u8],
    /// Next byte to read.
    pub(super) at: usize,
    /// Start of what was read last: where errors point.
    last: usize,
    pub(super) encoding: Encoding,
}

impl<'a> Stream<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Stream { bytes, at: 0, last: 0, encoding: Encoding::Text }
    }

    /// Where the last thing was read: a line when the file is text, an offset when it is binary.
    pub(super) fn place(&self) -> Place {
        match self.encoding {
            Encoding::Binary(_) => Place::Byte(self.last),
            Encoding::Text => Place::Line(1 + self.bytes[..self.last].iter().filter(|&&b| b == b'\n').count()),
        }
    }

    pub(super) fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    pub(super) fn truncated(&mut self, expected: &str) -> FormatError {
        self.last = self.bytes.len();
        FormatError::Truncated { place: self.place(), expected: expected.to_owned() }
    }

    pub(super) fn syntax(&self, expected: &str, found: &str) -> FormatError {
        let shown: String = found.chars().take(60).collect();
        FormatError::Syntax { place: self.place(), expected: expected.to_owned(), found: format!("\"{shown}\"") }
    }

    /// Checks that `count` items of `numbers` numbers and `bytes` bytes each (in text, in binary) can still be there.
    pub(super) fn claim(&self, count: u64, numbers: usize, bytes: usize, what: &str) -> Result<usize, FormatError> {
        let (each, unit) = match self.encoding {
            // A number needs a digit and a separator, the last one in the file no separator.
            Encoding::Text => (2 * numbers.max(1), 2 * numbers.max(1) - 1),
            Encoding::Binary(_) => (bytes.max(1), bytes.max(1)),
        };
        let room = if self.remaining() >= unit { (self.remaining() - unit) / each + 1 } else { 0 };
        match usize::try_from(count) {
            Ok(count) if count <= room => Ok(count),
            _ => Err(FormatError::Count {
                place: self.place(),
                what: what.to_owned(),
                said: count,
                found: format!("only {} bytes follow", self.remaining()),
            }),
        }
    }

    /// The rest of the current line, without its end; `None` at the end of the file.
    pub(super) fn line(&mut self) -> Option<&'a [u8]> {
        if self.at >= self.bytes.len() {
            return None;
        }
        self.last = self.at;
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
        self.at += (end + 1).min(rest.len());
        Some(rest[..end].strip_suffix(b"\r").unwrap_or(&rest[..end]))
    }

    /// The next line that is not blank.
    pub(super) fn full_line(&mut self) -> Option<&'a [u8]> {
        loop {
            let line = self.line()?.trim_ascii();
            if !line.is_empty() {
                return Some(line);
            }
        }
    }

    /// The next word: what stands between white space.
    pub(super) fn word(&mut self, expected: &str) -> Result<&'a str, FormatError> {
        let Some(skip) = self.bytes[self.at..].iter().position(|b| !b.is_ascii_whitespace()) else {
            return Err(self.truncated(expected));
        };
        self.at += skip;
        self.last = self.at;
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += end;
        std::str::from_utf8(&rest[..end]).map_err(|_| self.syntax(expected, &String::from_utf8_lossy(&rest[..end])))
    }

    /// The next word without moving.
    pub(super) fn peek_word(&mut self) -> Option<&'a str> {
        let (at, last) = (self.at, self.last);
        let word = self.word("").ok();
        (self.at, self.last) = (at, last);
        word
    }

    /// Exactly `count` raw bytes.
    pub(super) fn take(&mut self, count: usize, expected: &str) -> Result<&'a [u8], FormatError> {
        self.last = self.at;
        if count > self.remaining() {
            return Err(self.truncated(expected));
        }
        self.at += count;
        Ok(&self.bytes[self.last..self.at])
    }

    /// One integer of this type (any width in text).
    pub(super) fn integer(&mut self, scalar: Scalar, expected: &str) -> Result<i64, FormatError> {
        match self.encoding {
            Encoding::Binary(endian) => Ok(scalar.integer(self.take(scalar.size(), expected)?, endian)),
            Encoding::Text => {
                let word = self.word(expected)?;
                word.parse().map_err(|_| self.syntax(expected, word))
            }
        }
    }

    /// One real number of this type.
    pub(super) fn float(&mut self, scalar: Scalar, expected: &str) -> Result<f64, FormatError> {
        match self.encoding {
            Encoding::Binary(endian) => Ok(scalar.float(self.take(scalar.size(), expected)?, endian)),
            Encoding::Text => {
                let word = self.word(expected)?;
                parse_float(word).ok_or_else(|| self.syntax(expected, word))
            }
        }
    }

    /// A 32-bit integer.
    pub(super) fn int(&mut self, expected: &str) -> Result<i64, FormatError> {
        self.integer(Scalar::I32, expected)
    }

    /// A count: 64 bits in binary, never negative.
    pub(super) fn size(&mut self, expected: &str) -> Result<u64, FormatError> {
        let value = self.integer(Scalar::U64, expected)?;
        u64::try_from(value).map_err(|_| self.syntax(expected, &value.to_string()))
    }

    /// A 64-bit real number.
    pub(super) fn double(&mut self, expected: &str) -> Result<f64, FormatError> {
        self.float(Scalar::F64, expected)
    }

    /// `count` numbers of one type.
    pub(super) fn array(&mut self, scalar: Scalar, count: u64, what: &str) -> Result<Values, FormatError> {
        let count = self.claim(count, 1, scalar.size(), what)?;
        match self.encoding {
            Encoding::Binary(endian) => Ok(scalar.decode(self.take(count * scalar.size(), what)?, endian)),
            Encoding::Text if scalar.is_float() => {
                let mut values = Vec::with_capacity(count);
                for _ in 0..count {
                    values.push(self.float(scalar, what)?);
                }
                Ok(Values::F64(values))
            }
            Encoding::Text => {
                let mut values = Vec::with_capacity(count);
                for _ in 0..count {
                    values.push(self.integer(scalar, what)?);
                }
                Ok(Values::I64(values))
            }
        }
    }
}

/// A real number as meshers write it: Fortran's `1.0D+03` too.
pub(super) fn parse_float(word: &str) -> Option<f64> {
    if let Ok(value) = word.parse() {
        return Some(value);
    }
    word.replace(['d', 'D'], "e").parse().ok()
}
