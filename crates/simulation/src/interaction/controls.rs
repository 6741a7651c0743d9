//! Everything that a person may change while a simulation runs, as plain data.
//!
//! Controls are absolute: setting the same ones twice changes nothing, and a simulation with the same scene, state and
//! controls takes the same steps. So a history keeps them beside states, and going back is setting them.

use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// What a person may change.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Controls {
    /// Gravity in m/s².
    pub gravity: [f64; 3],
    /// Time step in s.
    pub step: f64,
    /// Velocity damping in 1/s.
    pub velocity_damping: f64,
    /// Parameters of each block of like elements, in the order of its law, SI units.
    pub parameters: Vec<Vec<f64>>,
    /// Springs in hands, by number.
    pub pulls: BTreeMap<u32, Pull>,
    /// The tool that pushes.
    pub tool: Option<Tool>,
    /// Nodes that are held, with the displacement at which they are held in m.
    pub held: BTreeMap<u32, [f64; 3]>,
    /// Nodes that the scene holds or moves and that were let go.
    pub freed: BTreeSet<u32>,
}

/// A spring between a point of a body and a point in space.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pull {
    /// Nodes around the point of the body, with weights that add up to 1.
    pub anchor: Vec<(u32, f64)>,
    /// The point in space in m.
    pub target: [f64; 3],
    /// Stiffness in N/m.
    pub stiffness: f64,
}

/// A sphere, or a capsule where its two ends differ, that bodies cannot enter without being pushed back.
///
/// Law of Hunt and Crossley (J. Appl. Mech. 42, 1975) with Hertz' exponent, per contact at depth δ:
///
/// ```text
/// F = k δ^(3/2) (1 + (3/2) c δ̇), never pulling
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tool {
    /// Ends of its axis in m.
    pub ends: [[f64; 3]; 2],
    /// Velocity of the tool in m/s, for its damping.
    pub velocity: [f64; 3],
    /// Radius in m.
    pub radius: f64,
    /// k in N/m^(3/2).
    pub stiffness: f64,
    /// c in s/m.
    pub damping: f64,
}

/// A change of the controls that cannot be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ControlError(pub String);

impl Controls {
    /// Checks numbers against what they mean; the model's sizes are given.
    ///
    /// # Errors
    /// The first thing that is wrong, with what was expected.
    pub fn check(&self, node_count: usize) -> Result<(), ControlError> {
        let positive = |name: &str, value: f64, unit: &str| match value > 0.0 && value.is_finite() {
            true => Ok(()),
            false => Err(ControlError(format!("{name} must be a positive number of {unit}, found {value}"))),
        };
        let finite = |name: &str, values: &[f64]| match values.iter().all(|v| v.is_finite()) {
            true => Ok(()),
            false => Err(ControlError(format!("{name} must be finite, found {values:?}"))),
        };
        let known = |name: &str, node: u32| match (node as usize) < node_count {
            true => Ok(()),
            false => Err(ControlError(format!("{name}: there is no node {node}; there are {node_count}"))),
        };
        finite("gravity", &self.gravity)?;
        positive("the time step", self.step, "seconds")?;
        if !(self.velocity_damping >= 0.0 && self.velocity_damping.is_finite()) {
            let found = self.velocity_damping;
            return Err(ControlError(format!("velocity damping must be at least 0 per second, found {found}")));
        }
        for pull in self.pulls.values() {
            positive("the stiffness of a pull", pull.stiffness, "newtons per metre")?;
            finite("the target of a pull", &pull.target)?;
            let sum: f64 = pull.anchor.iter().map(|a| a.1).sum();
            if pull.anchor.iter().any(|a| a.1 < 0.0) || sum.is_nan() || (sum - 1.0).abs() > 1e-6 {
                let message = "the weights of a pull's nodes must not be negative and add up to 1";
                return Err(ControlError(message.into()));
            }
            pull.anchor.iter().try_for_each(|a| known("a pull", a.0))?;
        }
        if let Some(tool) = &self.tool {
            positive("the radius of the tool", tool.radius, "metres")?;
            positive("the stiffness of the tool", tool.stiffness, "N/m^(3/2)")?;
            finite("the tool", &[tool.ends[0], tool.ends[1], tool.velocity].concat())?;
            if !(tool.damping >= 0.0 && tool.damping.is_finite()) {
                return Err(ControlError(format!("the tool's damping must be at least 0, found {}", tool.damping)));
            }
        }
        for (&node, displacement) in &self.held {
            known("a held region", node)?;
            finite("a held displacement", displacement)?;
        }
        self.freed.iter().try_for_each(|&node| known("a freed region", node))
    }
}
