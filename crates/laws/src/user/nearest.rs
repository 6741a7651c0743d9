//! "Did you mean …?" for the names of formulas.

/// The candidate nearest to `found`: at most a third of the longer name's letters inserted, deleted, replaced or
/// swapped with their neighbour. Letters are compared without case; among equally near ones the first wins.
pub(super) fn nearest<'c>(found: &str, candidates: impl IntoIterator<Item = &'c str>) -> Option<&'c str> {
    // The cost grows with the product of the lengths; a word this long is not a misspelt name.
    if found.len() > 100 {
        return None;
    }
    let found = found.to_lowercase();
    let mut best: Option<(usize, &str)> = None;
    for candidate in candidates {
        let folded = candidate.to_lowercase();
        let distance = strsim::osa_distance(&found, &folded);
        let longest = found.chars().count().max(folded.chars().count());
        if distance * 3 <= longest && best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}
