//! Just enough of Rust's lexical structure to tell code from comments and from strings.
//!
//! [`code_only`] gives a text of the same lines in which everything that is not code is blank, so that a search in it
//! cannot be misled by a comment or by a string, and line numbers stay true.

/// The text with comments blanked, and strings and characters reduced to their quotes.
pub(crate) fn code_only(text: &str) -> String {
    let chars: Vec<char> = text.chars().collect();
    let mut out = String::with_capacity(text.len());
    let mut i = 0;
    while i < chars.len() {
        let end = skipped(&chars, i);
        if end == i {
            out.push(chars[i]);
            i += 1;
        } else {
            let quote = if chars[i] == '/' { ' ' } else { '"' };
            out.push(quote);
            out.extend(chars[i + 1..end].iter().map(|&c| if c == '\n' { '\n' } else { ' ' }));
            if quote == '"' {
                out.pop();
                out.push('"');
            }
            i = end;
        }
    }
    out
}

/// End of the comment, string or character that starts at `i`; `i` itself when none does.
fn skipped(chars: &[char], i: usize) -> usize {
    let at = |k: usize| chars.get(k).copied().unwrap_or('\0');
    match (at(i), at(i + 1)) {
        ('/', '/') => (i..chars.len()).find(|&k| chars[k] == '\n').unwrap_or(chars.len()),
        ('/', '*') => block_comment_end(chars, i),
        ('"', _) => string_end(chars, i + 1),
        ('\'', '\\') => (i + 3..chars.len()).find(|&k| chars[k] == '\'').map_or(chars.len(), |k| k + 1),
        // A character has its closing quote two places on; a lifetime does not.
        ('\'', c) if c != '\'' && at(i + 2) == '\'' => i + 3,
        ('r', '"' | '#')
            if i == 0 || !is_word(chars[i - 1]) || (chars[i - 1] == 'b' && !(i > 1 && is_word(chars[i - 2]))) =>
        {
            let hashes = (i + 1..chars.len()).take_while(|&k| chars[k] == '#').count();
            // `r#name` is an identifier.
            if at(i + 1 + hashes) == '"' { raw_string_end(chars, i + 2 + hashes, hashes) } else { i }
        }
        _ => i,
    }
}

fn block_comment_end(chars: &[char], start: usize) -> usize {
    let mut depth = 0;
    let mut k = start;
    while k < chars.len() {
        match (chars[k], chars.get(k + 1)) {
            ('/', Some('*')) => {
                depth += 1;
                k += 2;
            }
            ('*', Some('/')) => {
                depth -= 1;
                k += 2;
                if depth == 0 {
                    return k;
                }
            }
            _ => k += 1,
        }
    }
    chars.len()
}

fn string_end(chars: &[char], mut k: usize) -> usize {
    while k < chars.len() {
        match chars[k] {
            '\\' => k += 2,
            '"' => return k + 1,
            _ => k += 1,
        }
    }
    chars.len()
}

fn raw_string_end(chars: &[char], mut k: usize, hashes: usize) -> usize {
    while k < chars.len() {
        if chars[k] == '"' && chars[k + 1..].iter().take(hashes).filter(|&&c| c == '#').count() == hashes {
            return k + 1 + hashes;
        }
        k += 1;
    }
    chars.len()
}

/// Whether a character can be part of an identifier.
pub(crate) fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The identifiers and words of a line, in order.
pub(crate) fn identifiers(line: &str) -> impl Iterator<Item = &str> {
    line.split(|c: char| !is_word(c)).filter(|w| !w.is_empty())
}

/// The words that an identifier is made of, in lower case: `tet4_of`, `Tet4Of` and `TET4_OF` are all `tet4`, `of`.
pub(crate) fn words(identifier: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut before = '_';
    for c in identifier.chars() {
        let starts = c.is_uppercase() && !before.is_uppercase();
        if (c == '_' || starts) && words.last().is_some_and(|w| !w.is_empty()) {
            words.push(String::new());
        }
        if c != '_' {
            words.last_mut().expect("there is always one").extend(c.to_lowercase());
        }
        before = c;
    }
    words.retain(|w| !w.is_empty());
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever is in comments, strings and characters disappears; code, lifetimes and line numbers stay.
    #[test]
    fn only_code_is_left() {
        let text = "let a = \"unsafe \\\" x\"; // unsafe\n/* unsafe /* nested */\nunsafe */ fn f<'a>(c: &'a str) { '\"'; '\\''; b\"q\" }\n\
                    let r = r#\"unsafe \" \"#; let r#type = br\"x\"; for_r(\"y\");";
        let code = code_only(text);
        assert_eq!(code.lines().count(), text.lines().count());
        assert!(!code.contains("unsafe"), "{code}");
        for kept in ["let a =", "fn f<'a>(c: &'a str)", "let r#type = b", "for_r("] {
            assert!(code.contains(kept), "`{kept}` is missing in:\n{code}");
        }
        assert_eq!(code.chars().filter(|&c| c == '"').count() % 2, 0);
    }

    /// Every style of identifier falls into the same words.
    #[test]
    fn identifiers_fall_into_words() {
        for style in ["tet4_of_law", "Tet4OfLaw", "tet4OfLaw", "TET4_OF_LAW", "_tet4__of_law_"] {
            assert_eq!(words(style), ["tet4", "of", "law"], "{style}");
        }
    }
}
