//! What a person or a machine reads: results on standard output, complaints on standard error.

use crate::failure::{Failure, input};
use serde::Serialize;
use std::io::{ErrorKind, Write};

/// Prints a result, ended by a line break.
pub(crate) fn say(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    let written = out.write_all(text.trim_end_matches('\n').as_bytes()).and_then(|()| out.write_all(b"\n"));
    match written.and_then(|()| out.flush()) {
        Ok(()) => Ok(()),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Err(Failure::OutputClosed),
        Err(error) => Err(input(format!("cannot write to standard output: {error}"))),
    }
}

/// Prints a result as one line of JSON.
pub(crate) fn say_json(value: &(impl Serialize + ?Sized)) -> Result<(), Failure> {
    let line = serde_json::to_string(value).map_err(|e| input(format!("cannot write the result as JSON: {e}")))?;
    say(&line)
}

/// Says why a command failed.
pub(crate) fn complain(failure: &Failure) {
    let message = failure.to_string();
    if !message.is_empty() {
        note(&format!("error: {message}"));
    }
}

/// Says something beside the result: a warning, where files went.
pub(crate) fn note(message: &str) {
    // Nobody is left to tell when standard error is closed.
    let _ = writeln!(std::io::stderr().lock(), "{}", message.trim_end());
}

/// A table for people: columns as wide as their widest cell, two spaces between them, the last column as it is.
pub(crate) fn table(heads: &[&str], rows: &[Vec<String>]) -> String {
    let width = |s: &str| s.chars().count();
    let widths: Vec<usize> = (0..heads.len())
        .map(|c| rows.iter().map(|r| width(&r[c])).chain([width(heads[c])]).max().unwrap_or(0))
        .collect();
    let line = |cells: &mut dyn Iterator<Item = &str>| {
        let mut text = String::new();
        for (c, cell) in cells.enumerate() {
            text.push_str(cell);
            let gap = if c + 1 < heads.len() { widths[c] - width(cell) + 2 } else { 0 };
            text.extend(std::iter::repeat_n(' ', gap));
        }
        text.truncate(text.trim_end().len());
        text.push('\n');
        text
    };
    let mut out = line(&mut heads.iter().copied());
    for row in rows {
        out.push_str(&line(&mut row.iter().map(String::as_str)));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::table;

    /// Columns stand under each other, whatever letters they hold, and lines end without spaces.
    #[test]
    fn columns_are_aligned() {
        let text = table(&["id", "n"], &[vec!["λ".into(), "1".into()], vec!["abc".into(), String::new()]]);
        assert_eq!(text, "id   n\nλ    1\nabc\n");
    }
}
