//! What was changed by hand: where controls differ from those that the scene gives. Checkpoints carry it.
//!
//! ```text
//! controls = scene's controls + ByHand
//! ```
//!
//! Only differences are kept, so that a scene may be changed (a longer end, another material) between a checkpoint and the
//! run that goes on from it.

use super::{ControlError, Controls, Pull, Tool};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// A parameter of a law that has another value than the scene gives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChangedParameter {
    /// The block of like elements.
    pub block: usize,
    /// The parameter, in the order of the law.
    pub parameter: usize,
    /// Its value in SI units.
    pub value: f64,
}

/// Where controls differ from the scene's.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ByHand {
    /// Gravity in m/s².
    pub gravity: Option<[f64; 3]>,
    /// Time step in s.
    pub step: Option<f64>,
    /// Velocity damping in 1/s.
    pub velocity_damping: Option<f64>,
    /// Parameters of laws.
    pub parameters: Vec<ChangedParameter>,
    /// Springs in hands, by number.
    pub pulls: BTreeMap<u32, Pull>,
    /// The tool that pushes.
    pub tool: Option<Tool>,
    /// Nodes that are held, with the displacement at which they are held in m.
    pub held: BTreeMap<u32, [f64; 3]>,
    /// Nodes that the scene holds or moves and that were let go.
    pub freed: BTreeSet<u32>,
}

impl ByHand {
    /// What leads from the scene's controls to these.
    pub fn between(scene: &Controls, now: &Controls) -> ByHand {
        let mut parameters = Vec::new();
        for (block, (before, after)) in scene.parameters.iter().zip(&now.parameters).enumerate() {
            for (parameter, (&old, &value)) in before.iter().zip(after).enumerate() {
                if old != value {
                    parameters.push(ChangedParameter { block, parameter, value });
                }
            }
        }
        ByHand {
            gravity: (scene.gravity != now.gravity).then_some(now.gravity),
            step: (scene.step != now.step).then_some(now.step),
            velocity_damping: (scene.velocity_damping != now.velocity_damping).then_some(now.velocity_damping),
            parameters,
            pulls: now.pulls.clone(),
            tool: now.tool.clone(),
            held: now.held.clone(),
            freed: now.freed.clone(),
        }
    }

    /// Whether nothing was changed.
    pub fn is_empty(&self) -> bool {
        *self == ByHand::default()
    }

    /// The scene's controls with these changes.
    ///
    /// # Errors
    /// When a parameter is one that the scene does not have.
    pub fn over(&self, scene: &Controls) -> Result<Controls, ControlError> {
        let mut controls = Controls {
            gravity: self.gravity.unwrap_or(scene.gravity),
            step: self.step.unwrap_or(scene.step),
            velocity_damping: self.velocity_damping.unwrap_or(scene.velocity_damping),
            parameters: scene.parameters.clone(),
            pulls: self.pulls.clone(),
            tool: self.tool.clone(),
            held: self.held.clone(),
            freed: self.freed.clone(),
        };
        for &ChangedParameter { block, parameter, value } in &self.parameters {
            let place = controls.parameters.get_mut(block).and_then(|list| list.get_mut(parameter));
            *place.ok_or_else(|| ControlError(format!("the scene has no parameter {parameter} of block {block}")))? =
                value;
        }
        Ok(controls)
    }

    /// What was changed, in words, each a few.
    pub fn words(&self) -> Vec<String> {
        let mut words = Vec::new();
        if let Some([x, y, z]) = self.gravity {
            words.push(format!("gravity ({x}, {y}, {z}) m/s²"));
        }
        if let Some(step) = self.step {
            words.push(format!("time step {step} s"));
        }
        if let Some(damping) = self.velocity_damping {
            words.push(format!("velocity damping {damping} 1/s"));
        }
        let mut count = |number: usize, what: &str| {
            if number > 0 {
                words.push(format!("{number} {what}"));
            }
        };
        count(self.parameters.len(), "parameters of laws");
        count(self.pulls.len(), "springs in hands");
        count(usize::from(self.tool.is_some()), "tool");
        count(self.held.len(), "held nodes");
        count(self.freed.len(), "freed nodes");
        words
    }
}
