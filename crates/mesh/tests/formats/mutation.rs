//! Damaged files: whatever is cut off or changed, the answer is a mesh or an error.

use crate::samples;
use souple_mesh::formats::{FormatError, ReadOptions, read, read_vtu_with_fields};

/// About this many cuts and this many changed bytes per file keep the whole test at a few seconds.
const TRIALS: usize = 200;

/// Reads, and looks at the result so that a mesh that contradicts itself is found too.
fn try_read(name: &str, bytes: &[u8]) -> Result<(), FormatError> {
    let (mesh, report) = read(name, bytes, ReadOptions::default())?;
    for block in &mesh.blocks {
        assert_eq!(block.connectivity.len() % block.element.node_count(), 0);
        assert!(block.connectivity.iter().all(|&n| (n as usize) < mesh.nodes.len()));
    }
    for region in mesh.regions.values() {
        assert!(region.nodes.iter().all(|&n| (n as usize) < mesh.nodes.len()));
        assert!(region.elements.iter().all(|e| (e.index as usize) < mesh.blocks[e.block as usize].len()));
        assert!(region.nodes.is_sorted() && region.elements.is_sorted());
    }
    assert!(mesh.nodes.iter().flatten().all(|x| x.is_finite()));
    assert_eq!(report.nodes, mesh.nodes.len());
    if name.ends_with("vtu") {
        read_vtu_with_fields(bytes, ReadOptions::default())?;
    }
    Ok(())
}

/// A file cut off anywhere is read or refused.
#[test]
fn any_truncation_is_survived() {
    let mut refused = 0;
    for (name, bytes) in samples() {
        let step = bytes.len().div_ceil(TRIALS);
        for end in (0..bytes.len()).step_by(step) {
            refused += usize::from(try_read(&name, &bytes[..end]).is_err());
        }
    }
    assert!(refused > 1000, "hardly anything was refused: is anything read?");
}

/// A file with one byte changed is read or refused.
#[test]
fn any_changed_byte_is_survived() {
    let mut refused = 0;
    for (name, bytes) in samples() {
        let step = bytes.len().div_ceil(TRIALS);
        let mut changed = bytes.clone();
        for at in (0..bytes.len()).step_by(step) {
            // Four changes that matter to text and to binary numbers: a bit, a high bit, a digit, a letter.
            for new in [bytes[at] ^ 1, bytes[at] ^ 0x80, b'9', b'x'] {
                changed[at] = new;
                refused += usize::from(try_read(&name, &changed).is_err());
            }
            changed[at] = bytes[at];
        }
    }
    assert!(refused > 1000, "hardly anything was refused: is anything read?");
}

/// Sections cut out of a file leave something that is read or refused: counts and references no longer fit.
#[test]
fn any_hole_is_survived() {
    for (name, bytes) in samples() {
        let step = bytes.len().div_ceil(40);
        for start in (0..bytes.len()).step_by(step) {
            for length in [1, 8, step, 5 * step] {
                let end = (start + length).min(bytes.len());
                let _ = try_read(&name, &[&bytes[..start], &bytes[end..]].concat());
            }
        }
    }
}
