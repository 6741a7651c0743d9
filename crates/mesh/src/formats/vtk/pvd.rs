//! PVD: a list of files with the time of each, which ParaView plays as one animation.

use super::vtu_write::escaped;
use std::fmt::Write as _;

/// One step of a time series.
#[derive(Clone, Debug, PartialEq)]
pub struct PvdEntry {
    /// Time in seconds.
    pub time: f64,
    /// File of that time, relative to the PVD file.
    pub file: String,
}

/// The text of a PVD file.
pub fn write_pvd(entries: &[PvdEntry]) -> String {
    let mut text =
        String::from("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n");
    for entry in entries {
        let file = escaped(&entry.file);
        let _ = writeln!(text, "    <DataSet timestep=\"{:?}\" group=\"\" part=\"0\" file=\"{file}\"/>", entry.time);
    }
    text.push_str("  </Collection>\n</VTKFile>\n");
    text
}
