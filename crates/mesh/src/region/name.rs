//! What an error says about names: the most similar one, and those that exist.

/// The most similar of the known names, unless it shares little with what was asked for.
pub(super) fn nearest(asked: &str, known: &[String]) -> Option<String> {
    let similarity = |name: &String| strsim::jaro_winkler(&asked.to_lowercase(), &name.to_lowercase());
    let best = known.iter().map(|name| (similarity(name), name)).reduce(|a, b| if b.0 > a.0 { b } else { a });
    best.filter(|(similarity, _)| *similarity >= 0.7).map(|(_, name)| name.clone())
}

pub(super) fn hint(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |name| format!(" (did you mean `{name}`?)"))
}

pub(super) fn list(known: &[String]) -> String {
    match known {
        [] => "none".to_owned(),
        names => names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "),
    }
}
