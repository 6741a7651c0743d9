//! The scene of each simulation, as far as the database tells it: the base scene with the changes of that member.
//!
//! What it is not: what was run. Further keys of a bar's sections are not in the database, so that materials are taken
//! from what was recorded with the simulation, and only geometry, supports and loads from here.

use super::data::{Group, Simulation};
use crate::group::{self, Source, Value};
use crate::{bar_in_scene, folder_scene};
use souple_simulation::prepare::catalogue;
use souple_simulation::scene::{Catalogue, Scene, parse_with_overrides};

/// Scenes of one group.
#[derive(Debug)]
pub struct Scenes<'g> {
    group: &'g Group,
    catalogue: Catalogue,
    bars: Vec<group::Bar>,
}

/// A value as it stands in the database.
pub fn value(text: &str) -> Value {
    match (text.parse::<i64>(), text.parse::<f64>()) {
        (Ok(x), _) => Value::Whole(x),
        (_, Ok(x)) => Value::Number(x),
        _ => Value::Toml(text.to_owned()),
    }
}

impl<'g> Scenes<'g> {
    /// Those of this group.
    pub fn of(group: &'g Group) -> Scenes<'g> {
        let section = |s: &super::data::Section| group::Section {
            until: s.until,
            law: s.law.clone(),
            element: s.element.clone(),
            quadrature: s.quadrature.clone(),
            parameters: Vec::new(),
        };
        let bar = |b: &super::data::Bar| group::Bar {
            name: b.name.clone(),
            device: None,
            sections: b.sections.iter().map(section).collect(),
        };
        Scenes { group, catalogue: catalogue(), bars: group.bars.iter().map(bar).collect() }
    }

    /// The scene of a simulation; none where it cannot be made again.
    pub fn scene(&self, simulation: &Simulation) -> Option<Scene> {
        let values: Vec<Value> =
            simulation.values.iter().map(|v| v.as_deref().map(value)).collect::<Option<Vec<_>>>()?;
        let named = || self.group.parameters.iter().map(|p| p.name.as_str()).zip(&values);
        let bar = simulation.bar.map(|b| &self.bars[b]);
        let source = if self.group.source == "params.csv" { Source::Folder } else { Source::Toml };
        let changes = match source {
            Source::Folder => folder_scene::overrides(&named().collect::<Vec<_>>(), bar?),
            Source::Toml => {
                let mut all = match bar {
                    Some(bar) => bar_in_scene::overrides(bar, &self.group.scene).ok()?,
                    None => Vec::new(),
                };
                let materials = bar.map_or(1, |b| b.sections.len());
                all.extend(named().flat_map(|(key, value)| crate::plan::assignments(key, value, materials)));
                all
            }
        };
        let changes: Vec<&str> = changes.iter().map(String::as_str).collect();
        parse_with_overrides(&self.group.scene, "scene", &changes, &self.catalogue).ok().map(|(scene, _)| scene)
    }
}
