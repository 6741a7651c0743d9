//! Text that people write, as LaTeX: formulas with Greek letters and superscripts, names with dashes, long sums over
//! several lines.

/// A formula written with Unicode (`λ/2 tr(E)² + μ tr(E²)`) as LaTeX mathematics.
///
/// Words of several letters become upright; a character without a translation becomes its code point, so that the
/// result is plain ASCII and always compiles.
pub(super) fn formula(text: &str) -> String {
    let mut out = String::new();
    let mut word = String::new();
    let mut characters = text.chars().peekable();
    while let Some(c) = characters.next() {
        // A combining bar or dot stands behind its letter.
        if let Some(accent) = characters.peek().copied().and_then(accent) {
            characters.next();
            flush(&mut out, &mut word);
            out.push_str(&format!("\\{accent}{{{}}}", symbol(c)));
            continue;
        }
        if c.is_ascii_alphabetic() {
            word.push(c);
            continue;
        }
        // `c10` is a name with an index, `λ_m` too, and `^( … )` raises all of its bracket.
        let index = word.len() == 1 && c.is_ascii_digit();
        flush(&mut out, &mut word);
        if index || (c == '_' && characters.peek().is_some_and(|n| n.is_alphanumeric())) {
            let mut low = if index { c.to_string() } else { String::new() };
            while let Some(next) =
                characters.next_if(|n| if index { n.is_ascii_digit() } else { n.is_ascii_alphanumeric() })
            {
                low.push(next);
            }
            out.push_str(&format!("_{{{low}}}"));
        } else if c == '^' && characters.peek() == Some(&'(') {
            characters.next();
            let mut depth = 1;
            let inside: String = characters
                .by_ref()
                .take_while(|n| {
                    depth += i32::from(*n == '(') - i32::from(*n == ')');
                    depth > 0
                })
                .collect();
            out.push_str(&format!("^{{{}}}", formula(&inside)));
        } else if let Some(first) = raised(c) {
            let mut digits = first.to_owned();
            while let Some(next) = characters.peek().copied().and_then(raised) {
                digits.push_str(next);
                characters.next();
            }
            out.push_str(&format!("^{{{digits}}}"));
        } else if let Some(digit) = lowered(c) {
            out.push_str(&format!("_{{{digit}}}"));
        } else {
            out.push_str(&symbol(c));
        }
    }
    flush(&mut out, &mut word);
    out
}

/// A known function or a single letter as it is, any other word upright.
fn flush(out: &mut String, word: &mut String) {
    match word.as_str() {
        "" => {}
        "ln" | "exp" | "det" | "min" | "max" | "log" | "sin" | "cos" => out.push_str(&format!("\\{word} ")),
        "sqrt" => out.push_str("\\mathrm{sqrt}"),
        w if w.len() == 1 => out.push_str(w),
        w => out.push_str(&format!("\\mathrm{{{w}}}")),
    }
    word.clear();
}

fn accent(c: char) -> Option<&'static str> {
    Some(match c {
        '\u{304}' | '\u{305}' => "bar",
        '\u{302}' => "hat",
        '\u{303}' => "tilde",
        '\u{307}' => "dot",
        _ => return None,
    })
}

fn raised(c: char) -> Option<&'static str> {
    Some(match c {
        '⁰' => "0",
        '¹' => "1",
        '²' => "2",
        '³' => "3",
        '⁴' => "4",
        '⁵' => "5",
        '⁶' => "6",
        '⁷' => "7",
        '⁸' => "8",
        '⁹' => "9",
        '⁺' => "+",
        '⁻' => "-",
        'ᵀ' => "\\mathsf{T}",
        'ⁿ' => "n",
        'ᵏ' => "k",
        'ⁱ' => "i",
        'ᵃ' => "a",
        'ᵅ' => "\\alpha",
        'ᵝ' => "\\beta",
        'ᵖ' => "p",
        'ᵐ' => "m",
        'ᵉ' => "e",
        _ => return None,
    })
}

fn lowered(c: char) -> Option<&'static str> {
    Some(match c {
        '₀' => "0",
        '₁' => "1",
        '₂' => "2",
        '₃' => "3",
        '₄' => "4",
        '₅' => "5",
        '₆' => "6",
        '₇' => "7",
        '₈' => "8",
        '₉' => "9",
        'ᵢ' => "i",
        'ⱼ' => "j",
        'ₖ' => "k",
        'ₘ' => "m",
        'ₙ' => "n",
        'ₐ' => "a",
        'ₚ' => "p",
        'ₜ' => "t",
        'ₛ' => "s",
        'ₑ' => "e",
        _ => return None,
    })
}

/// One character of a formula.
fn symbol(c: char) -> String {
    if let Some(name) = greek(c) {
        return format!("\\{name} ");
    }
    match c {
        '−' | '–' => "-".to_owned(),
        '·' | '⋅' => "\\cdot ".to_owned(),
        '×' => "\\times ".to_owned(),
        '∇' => "\\nabla ".to_owned(),
        '∂' => "\\partial ".to_owned(),
        '∫' => "\\int ".to_owned(),
        'Σ' | '∑' => "\\sum ".to_owned(),
        'Π' | '∏' => "\\prod ".to_owned(),
        '√' => "\\surd ".to_owned(),
        '∞' => "\\infty ".to_owned(),
        '⊗' => "\\otimes ".to_owned(),
        '≤' => "\\le ".to_owned(),
        '≥' => "\\ge ".to_owned(),
        '≠' => "\\ne ".to_owned(),
        '≈' => "\\approx ".to_owned(),
        '∈' => "\\in ".to_owned(),
        '→' => "\\to ".to_owned(),
        '±' => "\\pm ".to_owned(),
        '½' => "\\tfrac{1}{2}".to_owned(),
        '⅓' => "\\tfrac{1}{3}".to_owned(),
        '⅔' => "\\tfrac{2}{3}".to_owned(),
        '¼' => "\\tfrac{1}{4}".to_owned(),
        '¾' => "\\tfrac{3}{4}".to_owned(),
        '⟨' => "\\langle ".to_owned(),
        '⟩' => "\\rangle ".to_owned(),
        '‖' => "\\|".to_owned(),
        '…' => "\\dots ".to_owned(),
        'Ī' => "\\bar{I}".to_owned(),
        'Ē' => "\\bar{E}".to_owned(),
        'ā' => "\\bar{a}".to_owned(),
        'ė' => "\\dot{e}".to_owned(),
        'Ė' => "\\dot{E}".to_owned(),
        'Ḟ' => "\\dot{F}".to_owned(),
        'Ċ' => "\\dot{C}".to_owned(),
        '′' => "'".to_owned(),
        '%' | '&' | '#' | '_' | '{' | '}' | '$' => format!("\\{c}"),
        '\\' => "\\backslash ".to_owned(),
        '~' => "\\sim ".to_owned(),
        ',' => ",\\;".to_owned(),
        ';' => ";\\;".to_owned(),
        c if c.is_ascii() => c.to_string(),
        c => format!("\\mathrm{{U{:04X}}}", u32::from(c)),
    }
}

fn greek(c: char) -> Option<&'static str> {
    Some(match c {
        'α' => "alpha",
        'β' => "beta",
        'γ' => "gamma",
        'δ' => "delta",
        'Δ' => "Delta",
        'ε' | 'ϵ' => "varepsilon",
        'ζ' => "zeta",
        'η' => "eta",
        'θ' => "theta",
        'κ' => "kappa",
        'λ' => "lambda",
        'μ' | 'µ' => "mu",
        'ν' => "nu",
        'ξ' => "xi",
        'π' => "pi",
        'ρ' => "rho",
        'σ' => "sigma",
        'τ' => "tau",
        'φ' | 'ϕ' => "varphi",
        'χ' => "chi",
        'ψ' => "psi",
        'Ψ' => "Psi",
        'ω' => "omega",
        'Ω' => "Omega",
        _ => return None,
    })
}

/// A sentence as LaTeX text: mathematical characters in dollars, special ones escaped, accents kept.
pub(super) fn text(sentence: &str) -> String {
    let mut out = String::new();
    let mut mathematics = String::new();
    let close = |out: &mut String, mathematics: &mut String| {
        if !mathematics.is_empty() {
            out.push_str(&format!("${}$", formula(mathematics)));
            mathematics.clear();
        }
    };
    for c in sentence.chars() {
        // Letters of European languages compile as they are; everything else beyond ASCII is mathematics.
        let latin = matches!(c, '\u{c0}'..='\u{17f}') && !matches!(c, '×' | '÷');
        if !c.is_ascii() && !latin && !matches!(c, '–' | '’' | '“' | '”') {
            mathematics.push(c);
            continue;
        }
        close(&mut out, &mut mathematics);
        match c {
            '–' => out.push_str("--"),
            '’' => out.push('\''),
            '“' => out.push_str("``"),
            '”' => out.push_str("''"),
            '%' | '&' | '#' | '_' | '{' | '}' | '$' => out.push_str(&format!("\\{c}")),
            '^' => out.push_str("\\textasciicircum{}"),
            '~' => out.push_str("\\textasciitilde{}"),
            '\\' => out.push_str("\\textbackslash{}"),
            c => out.push(c),
        }
    }
    close(&mut out, &mut mathematics);
    out
}

/// Characters of source after which a new line is begun: about the width of a page.
const WIDTH: usize = 150;

/// A row `name &= formula` of an `align*` environment, long sums over several lines.
///
/// Lines break before a plus or minus that stands in no bracket, and after a comma of a list; `\left … \right` and
/// braces are never cut.
pub(super) fn row(name: &str, formula: &str) -> String {
    let mut lines = vec![String::new()];
    let (mut depth, mut at) = (0i32, 0);
    while at < formula.len() {
        let rest = &formula[at..];
        for (opening, change) in [("\\left", 1), ("\\right", -1), ("{", 1), ("}", -1)] {
            // `\leftarrow` and the like do not occur in printed expressions.
            if rest.starts_with(opening) {
                depth += change;
            }
        }
        let line = lines.last_mut().expect("there is always one");
        let breaks = rest.starts_with(" + ") || rest.starts_with(" - ") || rest.starts_with(" ;");
        if depth == 0 && breaks && line.len() > WIDTH {
            lines.push(String::new());
        }
        let c = rest.chars().next().expect("the rest is not empty");
        lines.last_mut().expect("there is always one").push(c);
        at += c.len_utf8();
    }
    format!("  {name} &= {} \\\\\n", lines.join(" \\\\\n  &\\quad "))
}

/// An `align*` environment of rows; empty without rows.
pub(super) fn align(rows: &[String]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let mut body = rows.concat();
    // The last row ends without a break.
    body.truncate(body.trim_end().trim_end_matches("\\\\").trim_end().len());
    format!("\\begin{{align*}}\n{body}\n\\end{{align*}}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Formulas of laws become mathematics.
    #[test]
    fn formulas_are_translated() {
        assert_eq!(formula("λ/2 tr(E)² + μ"), "\\lambda /2 \\mathrm{tr}(E)^{2} + \\mu ");
        assert_eq!(formula("J⁻²"), "J^{-2}");
        assert_eq!(formula("FᵀF − I₁"), "F^{\\mathsf{T}}F - I_{1}");
        assert_eq!(formula("ln J"), "\\ln  J");
        assert_eq!(formula("c10 λ_m^(2i−2) E_f"), "c_{10} \\lambda _{m}^{2i-2} E_{f}");
        assert_eq!(formula("☃"), "\\mathrm{U2603}");
    }

    /// Sentences keep their accents and escape what TeX would read as a command.
    #[test]
    fn sentences_are_escaped() {
        assert_eq!(text("modèles – 50 % of λ_1"), "modèles -- 50 \\% of $\\lambda $\\_1");
    }

    /// A long sum is broken between its terms, never inside a bracket, and nothing is lost.
    #[test]
    fn long_sums_are_broken() {
        let term = "\\left(a + b\\right)\\,c_{1}";
        let sum = vec![term; 40].join(" + ");
        let written = row("W", &sum);
        assert!(written.matches("\\\\").count() > 3, "{written}");
        for line in written.lines() {
            assert_eq!(line.matches("\\left").count(), line.matches("\\right").count(), "{line}");
        }
        let joined: String = written.replace(" \\\\\n  &\\quad ", "");
        assert!(joined.contains(&sum));
    }
}
