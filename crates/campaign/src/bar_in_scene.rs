//! Putting a bar into a base scene: its sections, and a material for each of them.
//!
//! The first body of the scene must be a generated bar that has `sections`. Each section's material is that body's first
//! one with the section's law and region, and with what the section says itself.

use crate::group::Bar;
use toml::de::{DeTable, DeValue};

/// The changes of the scene, `key=value`.
///
/// # Errors
///
/// In words, when the scene has no place for a bar.
pub(crate) fn overrides(bar: &Bar, scene: &str) -> Result<Vec<String>, String> {
    let parsed = DeTable::parse(scene).map_err(|e| format!("the base scene is not valid TOML: {}", e.message()))?;
    let body = first(parsed.get_ref(), "body").ok_or("the base scene has no [[body]] to put a bar into")?;
    let mesh = match body.get("mesh").map(|v| v.get_ref()) {
        Some(DeValue::Table(mesh)) => mesh,
        _ => return Err("the base scene's first body has no [body.mesh]".to_owned()),
    };
    if mesh.get("sections").is_none() {
        return Err("the base scene's first body must be a bar with `sections`: write \
             `sections = [{ until = 1.0, element = \"hex8\" }]` in place of `element` or `file`"
            .to_owned());
    }
    let inherited = inherited(body, scene)?;
    let sections: Vec<String> =
        bar.sections.iter().map(|s| format!("{{ until = {:?}, element = {:?} }}", s.until, s.element)).collect();
    let materials: Vec<String> = bar
        .sections
        .iter()
        .enumerate()
        .map(|(index, section)| {
            let own = |key: &str| section.parameters.iter().any(|(name, _)| name == key);
            let further = inherited.iter().filter(|(key, _)| !own(key)).chain(&section.parameters);
            let further: String = further.map(|(key, value)| format!(", {key} = {value}")).collect();
            format!("{{ region = \"section_{index}\", law = {:?}{further} }}", section.law)
        })
        .collect();
    let mut all = vec![
        format!("body.0.mesh.sections=[{}]", sections.join(", ")),
        format!("body.0.material=[{}]", materials.join(", ")),
    ];
    for (index, section) in bar.sections.iter().enumerate() {
        let new = !bar.sections[..index].iter().any(|s| s.element == section.element);
        if let Some(quadrature) = section.quadrature.as_ref().filter(|_| new) {
            all.push(format!("body.0.quadrature.{}={quadrature}", section.element));
        }
    }
    Ok(all)
}

/// The first table of a list of tables.
fn first<'t>(table: &'t DeTable<'t>, key: &str) -> Option<&'t DeTable<'t>> {
    match table.get(key)?.get_ref() {
        DeValue::Array(items) => match items.iter().next()?.get_ref() {
            DeValue::Table(table) => Some(table),
            _ => None,
        },
        _ => None,
    }
}

/// What the first material says, apart from its region and law, as it is written.
fn inherited(body: &DeTable<'_>, scene: &str) -> Result<Vec<(String, String)>, String> {
    let Some(material) = first(body, "material") else { return Ok(Vec::new()) };
    let mut found = Vec::new();
    for (key, value) in material.iter() {
        let name = key.get_ref().to_string();
        if ["region", "law", "energy"].contains(&name.as_str()) {
            continue;
        }
        let written = &scene[value.span()];
        if matches!(value.get_ref(), DeValue::Table(_)) && !written.starts_with('{') {
            return Err(format!("write `{name}` of the base scene's first material as {name} = {{ … }}"));
        }
        found.push((name, written.to_owned()));
    }
    Ok(found)
}
