//! What a person or a machine reads.

use souple_campaign::database::Table;
use std::io::{ErrorKind, Write as _};

/// Prints a result, ended by a line break.
pub(crate) fn say(text: &str) -> Result<(), String> {
    let mut out = std::io::stdout().lock();
    match writeln!(out, "{}", text.trim_end_matches('\n')).and_then(|()| out.flush()) {
        // Whoever reads has seen enough.
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(format!("cannot write to standard output: {e}")),
        _ => Ok(()),
    }
}

/// Says something beside the result.
pub(crate) fn note(message: &str) {
    // Nobody is left to tell when standard error is closed.
    let _ = writeln!(std::io::stderr().lock(), "{message}");
}

/// Columns as wide as their widest cell, two spaces between them.
pub(crate) fn text_table(table: &Table) -> String {
    let lines: Vec<&Vec<String>> = std::iter::once(&table.heads).chain(&table.rows).collect();
    let width = |c: usize| lines.iter().map(|line| line[c].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..table.heads.len()).map(width).collect();
    let mut out = String::new();
    for line in &lines {
        let cells: Vec<String> = line.iter().zip(&widths).map(|(cell, w)| format!("{cell:w$}")).collect();
        out.push_str(cells.join("  ").trim_end());
        out.push('\n');
    }
    out
}

/// Comma-separated values (RFC 4180).
pub(crate) fn csv(table: &Table) -> String {
    let cell = |text: &String| {
        if text.contains(['"', ',', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.clone() }
    };
    let line = |cells: &Vec<String>| cells.iter().map(cell).collect::<Vec<_>>().join(",") + "\r\n";
    std::iter::once(&table.heads).chain(&table.rows).map(line).collect()
}
