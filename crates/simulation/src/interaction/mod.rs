//! What a person does to a running simulation: pulling, pushing, holding, and turning its knobs.
//!
//! ```text
//! Controls ── set_controls ──► gravity, step, damping, parameters, held nodes          at once
//!          ── begin_step ────► forces of springs in hands and of the tool on nodes     at every step
//! ```
//!
//! Nothing here knows a window or a clock: the same controls at the same steps give the same trajectory, whoever sets them.

mod by_hand;
mod contact;
mod controls;
mod touch;

pub use by_hand::{ByHand, ChangedParameter};
pub use controls::{ControlError, Controls, Pull, Tool};

pub(crate) use touch::Touch;

use crate::run::{Simulation, hold, method, open_device, refuse_large_step};
use crate::surface::{faces, triangles};
use contact::{contacts, hunt_crossley};
use std::collections::{BTreeMap, BTreeSet};
use touch::NodalForce;

/// What the interaction keeps between steps.
#[derive(Debug, Default)]
pub(crate) struct Interaction {
    /// Surface triangles on node numbers, cut when a tool first appears.
    triangles: Option<Vec<[u32; 3]>>,
    /// Masters of the nodes that follow others.
    followers: BTreeMap<u32, Vec<(u32, f64)>>,
    /// Force of the bodies on the tool in the last step, in N.
    tool_force: [f64; 3],
}

/// A pull as it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PullState {
    /// Where the body is held, in m.
    pub point: [f64; 3],
    /// Where the other end of the spring is, in m.
    pub target: [f64; 3],
    /// Force on the body in N.
    pub force: [f64; 3],
}

impl Simulation {
    /// What a person may change, as it is now.
    pub fn controls(&self) -> &Controls {
        &self.controls
    }

    /// Where they differ from those that the scene gives.
    pub fn changed_by_hand(&self) -> ByHand {
        ByHand::between(&self.scene_controls, &self.controls)
    }

    /// What a scene starts with.
    pub(crate) fn initial_controls(scene: &souple_scene::Scene, prepared: &crate::prepare::Prepared) -> Controls {
        Controls {
            gravity: scene.gravity,
            step: scene.time.step.value,
            velocity_damping: scene.integrator.velocity_damping,
            parameters: prepared.blocks.iter().map(|block| block.parameters.clone()).collect(),
            pulls: BTreeMap::new(),
            tool: None,
            held: BTreeMap::new(),
            freed: BTreeSet::new(),
        }
    }

    /// Changes what a person may change; nothing changes when there is an error.
    ///
    /// # Errors
    /// What is out of range or cannot be here, and what was expected.
    pub fn set_controls(&mut self, controls: &Controls) -> Result<(), ControlError> {
        self.check_controls(controls)?;
        if self.on_device.is_some() && *controls != self.controls {
            let message = "a simulation on a graphics device cannot be touched or changed; use --device cpu";
            return Err(ControlError(message.into()));
        }
        if controls.step != self.controls.step || controls.velocity_damping != self.controls.velocity_damping {
            self.set_pace(controls)?;
        }
        if controls.parameters != self.controls.parameters {
            self.set_parameters(&controls.parameters)?;
        }
        if controls.gravity != self.controls.gravity {
            let d = self.system.dimension;
            let weight = |k: usize| self.shape_mass[k / d] * controls.gravity[k % d];
            let mut gravity: Vec<f64> = (0..self.system.mass.len()).map(weight).collect();
            self.system.elimination.restrict(&mut gravity);
            self.system.gravity = gravity;
        }
        if controls.held != self.controls.held || controls.freed != self.controls.freed {
            self.set_held(controls);
        }
        if controls.tool.is_some() && self.interaction.triangles.is_none() {
            let all = faces(&self.prepared);
            let cut = |face: &crate::surface::Face| -> Vec<[u32; 3]> {
                triangles(face.kind).iter().map(|t| t.map(|n| face.nodes[n as usize])).collect()
            };
            self.interaction.triangles = Some(all.iter().flat_map(cut).collect());
        }
        self.controls = controls.clone();
        Ok(())
    }

    fn check_controls(&self, controls: &Controls) -> Result<(), ControlError> {
        controls.check(self.prepared.nodes.len())?;
        if controls.tool.is_some() && self.system.dimension != 3 {
            let axes = self.system.dimension;
            return Err(ControlError(format!("the tool needs a scene with three axes; this one has {axes}")));
        }
        if controls.parameters.len() != self.prepared.blocks.len() {
            let (found, expected) = (controls.parameters.len(), self.prepared.blocks.len());
            return Err(ControlError(format!("{found} lists of parameters for {expected} blocks of elements")));
        }
        for (block, values) in self.prepared.blocks.iter().zip(&controls.parameters) {
            if values.len() != block.law.parameters.len() {
                let expected = block.law.parameters.len();
                let message = format!("law `{}` has {expected} parameters, found {}", block.law.id, values.len());
                return Err(ControlError(message));
            }
            for (parameter, &value) in block.law.parameters.iter().zip(values) {
                if !parameter.accepts(value) {
                    let (name, law, about) = (parameter.name, block.law.id, parameter.about);
                    return Err(ControlError(format!("`{name}` of law `{law}` cannot be {value}: {about}")));
                }
            }
        }
        Ok(())
    }

    /// Step and damping. Explicit methods refuse what the scene would have been refused for.
    fn set_pace(&mut self, controls: &Controls) -> Result<(), ControlError> {
        let before = (self.scene.time.step.value, self.scene.integrator.velocity_damping);
        self.scene.time.step.value = controls.step;
        self.scene.integrator.velocity_damping = controls.velocity_damping;
        if let Some(method) = method(&self.scene)
            && method.is_explicit()
        {
            let mut warnings = Vec::new();
            let checked =
                refuse_large_step(&mut self.system, &self.state, method, &self.scene, "the new step", &mut warnings);
            let rayleigh = &self.scene.integrator.rayleigh;
            self.system.rayleigh = [rayleigh.mass, rayleigh.stiffness];
            if let Err(error) = checked {
                (self.scene.time.step.value, self.scene.integrator.velocity_damping) = before;
                return Err(ControlError(error.to_string()));
            }
        }
        if before.0 != controls.step {
            self.origin = (self.steps, self.state.t);
        }
        Ok(())
    }

    fn set_parameters(&mut self, parameters: &[Vec<f64>]) -> Result<(), ControlError> {
        let device = open_device(&self.device_name).map_err(|e| ControlError(e.to_string()))?;
        for (number, values) in parameters.iter().enumerate() {
            if self.prepared.blocks[number].parameters != *values {
                self.system
                    .elements
                    .set_parameters(number, values, &*device)
                    .map_err(|e| ControlError(format!("the device refuses the new parameters: {e}")))?;
                self.prepared.blocks[number].parameters.clone_from(values);
            }
        }
        Ok(())
    }

    fn set_held(&mut self, controls: &Controls) {
        let d = self.system.dimension;
        hold(&mut self.system, &self.scene, &self.prepared, &controls.freed);
        let mut held = Vec::new();
        for (&node, displacement) in &controls.held {
            for axis in 0..d {
                let unknown = node as usize * d + axis;
                self.system.prescribed[unknown] = true;
                held.push((unknown, displacement[axis]));
            }
        }
        self.system.settle();
        let followers = &self.interaction.followers;
        held.retain(|(unknown, _)| !followers.contains_key(&((unknown / d) as u32)));
        self.system.touch.held = held;
        self.system.forget_factors();
        // What is let go starts from where it is; what the solver remembered was of other unknowns.
        self.state.guess.clear();
    }

    /// Takes note of the nodes that follow others: what touches them touches their masters.
    pub(crate) fn note_followers(&mut self) {
        let pairs = self.prepared.constraints.iter().map(|c| (c.node, c.masters.clone()));
        self.interaction.followers = pairs.collect();
    }

    /// Finds the forces of hands and tool at the beginning of a step.
    pub(crate) fn begin_step(&mut self) {
        self.system.touch.forces.clear();
        self.interaction.tool_force = [0.0; 3];
        for pull in self.controls.pulls.values() {
            let point = self.anchored(&pull.anchor);
            let force: [f64; 3] = std::array::from_fn(|k| pull.stiffness * (pull.target[k] - point[k]));
            let stiffness = std::array::from_fn(|r| std::array::from_fn(|c| f64::from(r == c) * pull.stiffness));
            let forces = self.spread(&pull.anchor, force, stiffness);
            self.system.touch.forces.extend(forces);
        }
        let (Some(tool), Some(triangles)) = (&self.controls.tool, &self.interaction.triangles) else { return };
        let mut total = [0.0; 3];
        let mut forces = Vec::new();
        for contact in contacts(tool, triangles, &|n| self.position(n)) {
            let speed = self.mean_velocity(&contact.nodes);
            let n = contact.normal;
            let rate: f64 = (0..3).map(|k| -n[k] * (speed[k] - tool.velocity[k])).sum();
            let (size, slope) = hunt_crossley(tool, contact.depth, rate);
            let force = n.map(|x| size * x);
            (0..3).for_each(|k| total[k] -= force[k]);
            let stiffness = std::array::from_fn(|r| std::array::from_fn(|c| slope * n[r] * n[c]));
            forces.extend(self.spread(&contact.nodes, force, stiffness));
        }
        self.system.touch.forces.extend(forces);
        self.interaction.tool_force = total;
    }

    /// A force and its stiffness given to nodes by weights, those of following nodes to their masters.
    fn spread(&self, nodes: &[(u32, f64)], force: [f64; 3], stiffness: [[f64; 3]; 3]) -> Vec<NodalForce> {
        let d = self.system.dimension;
        let mut forces = Vec::new();
        for &(node, weight) in nodes {
            let alone = [(node, 1.0)];
            let masters = self.interaction.followers.get(&node).map_or(&alone[..], |m| &m[..]);
            for &(node, share) in masters {
                let w = weight * share;
                let stiffness = stiffness.map(|row| row.map(|x| w * x));
                let u = |k: usize| if k < d { self.present().u[node as usize * d + k] } else { 0.0 };
                let at_zero =
                    std::array::from_fn(|r| w * force[r] + (0..d).map(|c| stiffness[r][c] * u(c)).sum::<f64>());
                forces.push(NodalForce { node, at_zero, stiffness });
            }
        }
        forces
    }

    fn position(&self, node: u32) -> [f64; 3] {
        let d = self.system.dimension;
        let rest = self.prepared.nodes[node as usize];
        std::array::from_fn(|k| rest[k] + if k < d { self.present().u[node as usize * d + k] } else { 0.0 })
    }

    fn anchored(&self, anchor: &[(u32, f64)]) -> [f64; 3] {
        let mut point = [0.0; 3];
        for &(node, weight) in anchor {
            let p = self.position(node);
            (0..3).for_each(|k| point[k] += weight * p[k]);
        }
        point
    }

    fn mean_velocity(&self, nodes: &[(u32, f64)]) -> [f64; 3] {
        let d = self.system.dimension;
        let mut mean = [0.0; 3];
        for &(node, weight) in nodes {
            (0..d).for_each(|k| mean[k] += weight * self.present().v[node as usize * d + k]);
        }
        mean
    }

    /// A pull as it stands: where it holds the body, and its force.
    pub fn pull(&self, number: u32) -> Option<PullState> {
        let pull = self.controls.pulls.get(&number)?;
        let point = self.anchored(&pull.anchor);
        let force = std::array::from_fn(|k| pull.stiffness * (pull.target[k] - point[k]));
        Some(PullState { point, target: pull.target, force })
    }

    /// Force of the bodies on the tool at the beginning of the last step, in N.
    pub fn tool_force(&self) -> [f64; 3] {
        self.interaction.tool_force
    }
}
