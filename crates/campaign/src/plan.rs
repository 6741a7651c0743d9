//! From a group to its simulations: bars × devices × samples of the hypercube × values of all other parameters.
//!
//! Number n counts like an odometer whose quickest wheel is the first parameter.

use crate::bar_in_scene;
use crate::folder_scene;
use crate::group::{CASE, Group, Source, Value, Variation};
use crate::problem::Problems;

/// More simulations in one group are taken for a mistake.
pub const SIMULATIONS_AT_MOST: usize = 1_000_000;

/// One simulation of a group.
#[derive(Clone, Debug, PartialEq)]
pub struct Planned {
    /// Its number in the group, from 0.
    pub number: usize,
    /// Index of its bar, where the group has bars.
    pub bar: Option<usize>,
    /// Its device.
    pub device: String,
    /// Its value of each parameter of the group.
    pub values: Vec<Value>,
    /// The changes of the base scene, `key=value`, in the order in which they are made.
    pub overrides: Vec<String>,
}

/// All simulations of a group, in their order.
///
/// # Errors
///
/// When there are too many, or a bar does not fit into the base scene.
pub fn plan(group: &Group) -> Result<Vec<Planned>, Problems> {
    let mut problems = Problems::default();
    let refuse =
        |message: String| Problems(vec![crate::problem::Problem { file: group.name.clone(), line: 0, message }]);
    let drawn = |variation: Variation| matches!(variation, Variation::LatinHypercube { .. });
    let sizes: Vec<usize> = group.parameters.iter().filter(|p| !drawn(p.variation)).map(|p| p.values.len()).collect();
    let product = |counts: &[usize]| counts.iter().try_fold(1usize, |all, &n| all.checked_mul(n));
    let bars = group.bars.len().max(1);
    let count = product(&sizes).and_then(|n| product(&[n, group.samples, bars, group.devices.len()]));
    let Some(count) = count.filter(|&n| n <= SIMULATIONS_AT_MOST) else {
        return Err(refuse(format!(
            "the group has more than {SIMULATIONS_AT_MOST} simulations; let less vary, or draw samples of a hypercube"
        )));
    };
    let fitted: Vec<Vec<String>> = match group.source {
        Source::Folder => Vec::new(),
        Source::Toml => group
            .bars
            .iter()
            .map(|bar| {
                bar_in_scene::overrides(bar, &group.scene.text).unwrap_or_else(|why| {
                    let file = group.scene.path.as_ref().map_or(String::new(), |p| p.display().to_string());
                    problems.add(&file, 0, format!("bar \"{}\": {why}", bar.name));
                    Vec::new()
                })
            })
            .collect(),
    };
    let simulations = (0..count).map(|number| {
        let mut rest = number;
        let mut wheel = |size: usize| {
            let at = rest % size;
            rest /= size;
            at
        };
        let mut indices: Vec<usize> =
            group.parameters.iter().map(|p| if drawn(p.variation) { 0 } else { wheel(p.values.len()) }).collect();
        let sample = wheel(group.samples);
        let device = group.devices[wheel(group.devices.len())].clone();
        let bar = (!group.bars.is_empty()).then(|| wheel(group.bars.len()));
        for (index, parameter) in indices.iter_mut().zip(&group.parameters) {
            if drawn(parameter.variation) {
                *index = sample;
            }
        }
        let values: Vec<Value> =
            group.parameters.iter().zip(&indices).map(|(p, &index)| p.values[index].clone()).collect();
        let named = || group.parameters.iter().map(|p| p.name.as_str()).zip(&values);
        let own = bar.map(|b| &group.bars[b]);
        let overrides = match (group.source, own) {
            (Source::Folder, Some(bar)) => folder_scene::overrides(&named().collect::<Vec<_>>(), bar),
            (Source::Folder, None) => Vec::new(),
            (Source::Toml, _) => {
                let mut all = bar.map_or(Vec::new(), |b| fitted[b].clone());
                let materials = own.map_or(1, |b| b.sections.len());
                // With cases, the first parameter is theirs, and it is the first wheel of the odometer.
                if let Some(case) = group.cases.get(number % group.cases.len().max(1)) {
                    all.extend(case.set.iter().map(|(key, value)| format!("{key}={value}")));
                }
                let keys = named().filter(|(name, _)| group.cases.is_empty() || *name != CASE);
                all.extend(keys.flat_map(|(key, value)| assignments(key, value, materials)));
                all
            }
        };
        let device = own.and_then(|b| b.device.clone()).unwrap_or(device);
        Planned { number, bar, device, values, overrides }
    });
    let simulations: Vec<Planned> = if problems.0.is_empty() { simulations.collect() } else { Vec::new() };
    problems.none_or(Some(simulations))
}

/// `key=value`; `material.*.young` once for every material.
pub(crate) fn assignments(key: &str, value: &Value, materials: usize) -> Vec<String> {
    if !key.contains("material.*.") {
        return vec![format!("{key}={value}")];
    }
    (0..materials).map(|i| format!("{}={value}", key.replacen("material.*.", &format!("material.{i}."), 1))).collect()
}
