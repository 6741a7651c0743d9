//! Lines of an input file: keywords with parameters, and data.

use crate::formats::error::{FormatError, Place};

/// A keyword line, put together from its continuation lines.
pub(super) struct Keyword {
    /// Upper case, without the star, blanks reduced to one.
    pub(super) name: String,
    /// Parameters in upper case with their values as written.
    parameters: Vec<(String, String)>,
}

impl Keyword {
    /// The value of a parameter; empty for a bare one.
    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.parameters.iter().find(|(n, _)| n == name).map(|(_, value)| value.as_str())
    }
}

/// One file, line by line. Comments and blank lines are left out.
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    line: usize,
    /// Name of the file when it is an included one.
    file: Option<String>,
}

impl<'a> Lines<'a> {
    pub(super) fn new(bytes: &'a [u8], file: Option<String>) -> Self {
        Lines { rest: bytes, line: 0, file }
    }

    /// The line read last.
    pub(super) fn place(&self) -> Place {
        match &self.file {
            Some(file) => Place::IncludedLine { file: file.clone(), line: self.line },
            None => Place::Line(self.line),
        }
    }

    fn raw(&mut self) -> Option<&'a [u8]> {
        loop {
            if self.rest.is_empty() {
                return None;
            }
            let end = self.rest.iter().position(|&b| b == b'\n');
            let line = &self.rest[..end.unwrap_or(self.rest.len())];
            self.rest = &self.rest[end.map_or(self.rest.len(), |e| e + 1)..];
            self.line += 1;
            let line = line.trim_ascii();
            if !line.is_empty() && !line.starts_with(b"**") {
                return Some(line);
            }
        }
    }

    /// The next line when it is data; `None` before a keyword and at the end.
    pub(super) fn data(&mut self) -> Option<&'a [u8]> {
        let (rest, line) = (self.rest, self.line);
        let data = self.raw()?;
        if data.starts_with(b"*") {
            (self.rest, self.line) = (rest, line);
            return None;
        }
        Some(data)
    }

    /// The next keyword; data in front of it is an error.
    pub(super) fn keyword(&mut self) -> Result<Option<Keyword>, FormatError> {
        let Some(first) = self.raw() else {
            return Ok(None);
        };
        let mut text = String::from_utf8_lossy(first).into_owned();
        let Some(_) = text.strip_prefix('*') else {
            return Err(self.syntax("a keyword (*NODE, *ELEMENT, …)", &text));
        };
        while text.ends_with(',') {
            let Some(more) = self.data() else {
                break;
            };
            text.push_str(&String::from_utf8_lossy(more));
        }
        let mut parts = fields(&text[1..]).into_iter();
        let name = parts.next().unwrap_or_default().to_ascii_uppercase();
        let name = name.split_ascii_whitespace().collect::<Vec<_>>().join(" ");
        let parameters = parts.filter(|p| !p.is_empty()).map(|p| {
            let (name, value) = p.split_once('=').unwrap_or((&p, ""));
            (name.trim().to_ascii_uppercase(), value.trim().trim_matches('"').to_owned())
        });
        Ok(Some(Keyword { name, parameters: parameters.collect() }))
    }

    pub(super) fn syntax(&self, expected: &str, found: &str) -> FormatError {
        let found: String = found.chars().take(60).collect();
        FormatError::Syntax { place: self.place(), expected: expected.to_owned(), found: format!("\"{found}\"") }
    }
}

/// What stands between commas, trimmed; a comma between quotes separates nothing.
pub(super) fn fields(text: &str) -> Vec<String> {
    let mut parts = vec![String::new()];
    let mut quoted = false;
    for c in text.chars() {
        quoted ^= c == '"';
        if c == ',' && !quoted {
            parts.push(String::new());
        } else if let Some(part) = parts.last_mut() {
            part.push(c);
        }
    }
    parts.iter().map(|p| p.trim().to_owned()).collect()
}
