//! Point and cell data of a legacy VTK file.

use super::arrays::Array;
use super::legacy_read::Reader;
use crate::formats::error::FormatError;
use crate::formats::field::Location;
use crate::formats::stream::{Encoding, Scalar};

impl Reader<'_> {
    /// `POINT_DATA n` or `CELL_DATA n` and all attributes that follow, up to the next of these two.
    pub(super) fn attributes(&mut self, words: &[&str]) -> Result<(), FormatError> {
        let location = if words[0].eq_ignore_ascii_case("POINT_DATA") { Location::Nodes } else { Location::Elements };
        let said = self.number(words, 1)?;
        let (points, cells) = self.complete.expect("the cells are complete before their data is read");
        let count = if location == Location::Nodes { points } else { cells };
        if said != count as u64 {
            return Err(FormatError::Count {
                place: self.stream.place(),
                what: format!("values in {}", words[0]),
                said,
                found: format!("the mesh has {count}"),
            });
        }
        loop {
            let (at, keyword) = (self.stream.at, self.stream.peek_word().unwrap_or("").to_ascii_uppercase());
            if matches!(keyword.as_str(), "" | "POINT_DATA" | "CELL_DATA") {
                self.stream.at = at;
                return Ok(());
            }
            let Some(line) = self.stream.full_line() else {
                return Ok(());
            };
            let line = String::from_utf8_lossy(line).into_owned();
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            self.attribute(&keyword, &words, location, count as u64)?;
        }
    }

    fn attribute(&mut self, keyword: &str, words: &[&str], location: Location, count: u64) -> Result<(), FormatError> {
        let components = match keyword {
            "SCALARS" => words.get(3).map_or(Ok(1), |_| self.number(words, 3))?,
            "VECTORS" | "NORMALS" => 3,
            "TENSORS" => 9,
            "TENSORS6" => 6,
            "GLOBAL_IDS" | "PEDIGREE_IDS" | "EDGE_FLAGS" => 1,
            "TEXTURE_COORDINATES" => self.number(words, 2)?,
            "METADATA" => {
                self.metadata();
                return Ok(());
            }
            "FIELD" => return self.field(words, Some((location, count))),
            "COLOR_SCALARS" | "LOOKUP_TABLE" => return self.colours(keyword, words, count),
            _ => return Err(self.stream.syntax("an attribute such as SCALARS or FIELD", &words.join(" "))),
        };
        let scalar = self.scalar(words.get(if keyword == "TEXTURE_COORDINATES" { 3 } else { 2 }))?;
        if keyword == "SCALARS" && self.stream.peek_word().is_some_and(|w| w.eq_ignore_ascii_case("LOOKUP_TABLE")) {
            self.stream.full_line();
        }
        self.array(words.get(1).unwrap_or(&"unnamed"), components, scalar, location, count)
    }

    fn array(
        &mut self,
        name: &str,
        components: u64,
        scalar: Scalar,
        location: Location,
        count: u64,
    ) -> Result<(), FormatError> {
        let values = self.stream.array(scalar, count.saturating_mul(components), &format!("array {name}"))?;
        let components = usize::try_from(components).unwrap_or(usize::MAX);
        self.arrays.push(Array { name: decoded(name), components, location, first: 0, values });
        Ok(())
    }

    /// `FIELD name n` and its n arrays; without a location they are about the whole file and passed over.
    pub(super) fn field(&mut self, words: &[&str], about: Option<(Location, u64)>) -> Result<(), FormatError> {
        let arrays = self.number(words, 2)?;
        for _ in 0..self.stream.claim(arrays, 3, 6, "arrays of a field")? {
            let mut line = self.stream.full_line();
            while line.is_some_and(|l| l.starts_with(b"METADATA")) {
                self.metadata();
                line = self.stream.full_line();
            }
            let Some(line) = line else {
                return Err(self.stream.truncated("an array of a field"));
            };
            let line = String::from_utf8_lossy(line).into_owned();
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            let (components, count) = (self.number(&words, 1)?, self.number(&words, 2)?);
            if words.get(3) == Some(&"string") {
                self.strings(components.saturating_mul(count))?;
                self.draft.report.ignore(format!("array {} (text)", decoded(words[0])));
                continue;
            }
            let scalar = self.scalar(words.get(3))?;
            match about {
                Some((location, expected)) if count == expected => {
                    self.array(words[0], components, scalar, location, count)?;
                }
                _ => {
                    self.stream.array(scalar, components.saturating_mul(count), "an array of a field")?;
                    self.draft.report.ignore(format!("array {}", decoded(words[0])));
                }
            }
        }
        Ok(())
    }

    /// Text, one value per line; in binary each with its length in front, in as many bytes as its first two bits say.
    fn strings(&mut self, count: u64) -> Result<(), FormatError> {
        for _ in 0..self.stream.claim(count, 0, 1, "text values")? {
            if self.stream.encoding == Encoding::Text {
                self.stream.line();
                continue;
            }
            let first = self.stream.take(1, "the length of a text value")?[0];
            let more = match first >> 6 {
                3 => 0,
                2 => 1,
                1 => 3,
                _ => 7,
            };
            let bytes = self.stream.take(more, "the length of a text value")?;
            let length = bytes.iter().fold(usize::from(first & 63), |n, &b| (n << 8) | usize::from(b));
            self.stream.take(length, "a text value")?;
        }
        Ok(())
    }

    /// Colours say nothing about the mesh: one byte per number in binary, a real number in text.
    fn colours(&mut self, keyword: &str, words: &[&str], count: u64) -> Result<(), FormatError> {
        let per_value = self.number(words, 2)?;
        let numbers =
            if keyword == "LOOKUP_TABLE" { per_value.saturating_mul(4) } else { per_value.saturating_mul(count) };
        let scalar = if self.stream.encoding == Encoding::Text { Scalar::F32 } else { Scalar::U8 };
        self.stream.array(scalar, numbers, "colours")?;
        self.draft.report.ignore(format!("array {} (colours)", decoded(words.get(1).unwrap_or(&"unnamed"))));
        Ok(())
    }
}

/// VTK writes blanks and the like in names as %20.
fn decoded(name: &str) -> String {
    let mut bytes = Vec::with_capacity(name.len());
    let mut rest = name.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let code = after.get(..2).and_then(|hex| std::str::from_utf8(hex).ok());
        match code.and_then(|hex| u8::from_str_radix(hex, 16).ok()).filter(|_| first == b'%') {
            Some(byte) => {
                bytes.push(byte);
                rest = &after[2..];
            }
            None => {
                bytes.push(first);
                rest = after;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
