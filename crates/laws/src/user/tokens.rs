//! The words of a formula: numbers, names and signs, each with its column.

use super::error::Problem;

/// A word of a formula.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Number(f64),
    Name(String),
    Sign(char),
    End,
}

impl Token {
    /// As messages say it.
    pub(super) fn shown(&self) -> String {
        match self {
            Token::Number(value) => format!("the number {value}"),
            Token::Name(name) => format!("`{name}`"),
            Token::Sign(sign) => format!("`{sign}`"),
            Token::End => "the end of the energy".to_owned(),
        }
    }
}

/// Words with their columns (characters, from 1); the last one is [`Token::End`]. Errors have the column first.
pub(super) fn tokens(text: &str) -> Result<Vec<(Token, usize)>, (usize, Problem)> {
    let characters: Vec<char> = text.chars().collect();
    let mut tokens = Vec::new();
    let mut at = 0;
    while at < characters.len() {
        let (start, c) = (at, characters[at]);
        if c.is_whitespace() {
            at += 1;
        } else if c.is_ascii_digit() || c == '.' {
            at = number_end(&characters, start);
            let written: String = characters[start..at].iter().collect();
            match written.parse::<f64>() {
                Ok(value) if value.is_finite() => tokens.push((Token::Number(value), start + 1)),
                _ => return Err((start + 1, Problem::Number { found: written })),
            }
        } else if c.is_alphabetic() || c == '_' {
            while at < characters.len() && is_letter_or_digit(characters[at]) {
                at += 1;
            }
            tokens.push((Token::Name(characters[start..at].iter().collect()), start + 1));
        } else if "+-*/^()[],".contains(c) {
            at += 1;
            if c == '*' && characters.get(at) == Some(&'*') {
                return Err((start + 1, Problem::Character { found: '*', hint: "; a power is written `^`" }));
            }
            tokens.push((Token::Sign(c), start + 1));
        } else {
            return Err((start + 1, Problem::Character { found: c, hint: hint(c) }));
        }
    }
    tokens.push((Token::End, characters.len() + 1));
    Ok(tokens)
}

/// What a name may go on with: raised digits are no part of it.
pub(super) fn is_letter_or_digit(c: char) -> bool {
    c.is_alphabetic() || c.is_ascii_digit() || c == '_'
}

/// Where the digits, the point and the exponent that start at `start` end.
fn number_end(characters: &[char], start: usize) -> usize {
    let is_digit = |at: usize| characters.get(at).is_some_and(char::is_ascii_digit);
    let mut at = start;
    while is_digit(at) || characters.get(at) == Some(&'.') {
        at += 1;
    }
    if matches!(characters.get(at), Some('e' | 'E')) {
        let sign = usize::from(matches!(characters.get(at + 1), Some('+' | '-')));
        // Without digits it is no exponent but the strain E after a number, which the parser refuses with a better word.
        if is_digit(at + 1 + sign) {
            at += 1 + sign;
            while is_digit(at) {
                at += 1;
            }
        }
    }
    at
}

fn hint(c: char) -> &'static str {
    match c {
        '²' | '³' | '⁴' => "; a power is written `^2`",
        '·' | '×' => "; a product is written `*`, a scalar product `dot(a, b)`",
        ':' => "; the double product of tensors is written `dot(A, B)`",
        '−' | '–' => "; the minus sign is `-`",
        '=' => "; write only the energy density, without `W =`",
        '{' | '}' => "; use parentheses `(`, `)`",
        '\'' => "; a transpose is written `transpose(F)`",
        _ => "",
    }
}
