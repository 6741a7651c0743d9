//! Changes with the steps at which they were made: enough to repeat a session without a window.

use crate::interaction::{ControlError, Controls, Pull, Tool};
use crate::run::{RunError, Simulation};
use serde::{Deserialize, Serialize};

/// One thing that a person does to a simulation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Change {
    /// Gravity in m/s².
    Gravity([f64; 3]),
    /// Time step in s.
    TimeStep(f64),
    /// Velocity damping in 1/s.
    VelocityDamping(f64),
    /// A parameter of a block of like elements.
    Parameter {
        /// The block.
        block: usize,
        /// The parameter, in the order of the law.
        parameter: usize,
        /// Its value in SI units.
        value: f64,
    },
    /// A spring in a hand: made, moved, or made stiffer.
    Pull {
        /// Which hand.
        number: u32,
        /// The spring.
        pull: Pull,
    },
    /// A hand lets go.
    Release {
        /// Which hand.
        number: u32,
    },
    /// The tool as it is from now on; none takes it away.
    Tool(Option<Tool>),
    /// These nodes stay where they are.
    Hold(Vec<u32>),
    /// These nodes move, whatever held them.
    Free(Vec<u32>),
}

impl Change {
    /// The controls after this change.
    fn applied(&self, simulation: &Simulation) -> Result<Controls, ControlError> {
        let mut controls = simulation.controls().clone();
        match self {
            Change::Gravity(gravity) => controls.gravity = *gravity,
            Change::TimeStep(step) => controls.step = *step,
            Change::VelocityDamping(damping) => controls.velocity_damping = *damping,
            Change::Parameter { block, parameter, value } => {
                let place = controls.parameters.get_mut(*block).and_then(|list| list.get_mut(*parameter));
                match place {
                    Some(place) => *place = *value,
                    None => return Err(ControlError(format!("there is no parameter {parameter} of block {block}"))),
                }
            }
            Change::Pull { number, pull } => {
                controls.pulls.insert(*number, pull.clone());
            }
            Change::Release { number } => {
                controls.pulls.remove(number);
            }
            Change::Tool(tool) => controls.tool.clone_from(tool),
            Change::Hold(nodes) => {
                let d = simulation.dimension();
                let u = simulation.displacement();
                for &node in nodes {
                    let first = node as usize * d;
                    let Some(here) = u.get(first..first + d) else {
                        return Err(ControlError(format!("there is no node {node} to hold")));
                    };
                    controls.held.insert(node, std::array::from_fn(|k| here.get(k).copied().unwrap_or(0.0)));
                    controls.freed.remove(&node);
                }
            }
            Change::Free(nodes) => {
                for node in nodes {
                    controls.held.remove(node);
                    controls.freed.insert(*node);
                }
            }
        }
        Ok(controls)
    }

    /// Makes the change.
    ///
    /// # Errors
    /// What is out of range or cannot be here.
    pub fn make(&self, simulation: &mut Simulation) -> Result<(), ControlError> {
        let controls = self.applied(simulation)?;
        simulation.set_controls(&controls)
    }
}

/// A change and when it was made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stamped {
    /// Steps made before it.
    pub step: u64,
    /// The change.
    pub change: Change,
}

/// Changes in the order in which they were made.
pub type Script = Vec<Stamped>;

/// Advances a simulation to a step, making the changes that a session made on the way.
///
/// # Errors
/// When a step fails or a change cannot be made here.
pub fn replay(simulation: &mut Simulation, script: &[Stamped], until: u64) -> Result<(), RunError> {
    let mut next = script.partition_point(|s| s.step < simulation.steps);
    while simulation.steps < until && simulation.ending.is_none() {
        while let Some(stamped) = script.get(next).filter(|s| s.step <= simulation.steps) {
            stamped.change.make(simulation).map_err(|e| RunError { message: e.to_string() })?;
            next += 1;
        }
        simulation.advance()?;
    }
    Ok(())
}
