//! "Did you mean …?": the nearest of the names that exist.
//!
//! Distance is the number of insertions, deletions, replacements and swaps of neighbours that turn one word into the
//! other, letters compared without case and with `_` and space read as `-`.

/// The candidate nearest to `found`, or `None` when none is near enough to be a likely misspelling.
///
/// Near enough is at most a third of the longer word's letters.
/// Among equally near candidates the first one wins.
pub fn nearest<'c>(found: &str, candidates: impl IntoIterator<Item = &'c str>) -> Option<&'c str> {
    // The cost grows with the product of the lengths; a word this long is not a misspelt name.
    if found.len() > 200 {
        return None;
    }
    let found = folded(found);
    let mut best: Option<(usize, &str)> = None;
    for candidate in candidates {
        let folded = folded(candidate);
        let distance = strsim::osa_distance(&found, &folded);
        let longest = found.chars().count().max(folded.chars().count());
        if distance * 3 <= longest && best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

fn folded(word: &str) -> String {
    word.chars().map(|c| if c == '_' || c == ' ' { '-' } else { c.to_ascii_lowercase() }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_of_the_keys_finds_the_word_that_was_meant() {
        let words = ["region", "law", "implicit-euler", "x_max"];
        for (typed, meant) in [
            ("regoin", "region"),
            ("Region", "region"),
            ("implicit_euler", "implicit-euler"),
            ("implict-euler", "implicit-euler"),
            ("x_mx", "x_max"),
            ("lw", "law"),
        ] {
            assert_eq!(nearest(typed, words), Some(meant), "{typed}");
        }
    }

    #[test]
    fn unrelated_words_get_no_suggestion() {
        for typed in ["", "temperature", "q", &"x".repeat(10_000)] {
            assert_eq!(nearest(typed, ["region", "law", "implicit-euler"]), None, "{typed}");
        }
    }
}
