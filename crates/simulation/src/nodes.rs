//! Nodes that somebody looks at again and again: those of the surface, for pictures.
//!
//! Which nodes is said once; where the state is on a graphics device, only their numbers come back then, 4 bytes per
//! axis, however large the model is. Probes that ask for nodes alone are read in the same way, but exactly.

use crate::gpu::{OfNodes, Rows};
use crate::run::{RunError, Simulation};

/// Some nodes of a simulation, for [`Simulation::positions_of`] of that simulation.
pub struct Nodes {
    numbers: Vec<u32>,
    rows: Option<Rows>,
}

impl Nodes {
    /// Numbers over all bodies, in the order in which they were given.
    pub fn numbers(&self) -> &[u32] {
        &self.numbers
    }
}

impl Simulation {
    /// Prepares the reading of some nodes, by their numbers over all bodies; see [`surface::nodes`](crate::surface::nodes)
    /// for those that are drawn.
    ///
    /// # Errors
    /// When there is no such node, or the graphics device is lost or has no room.
    pub fn nodes(&self, numbers: &[u32]) -> Result<Nodes, RunError> {
        let count = self.prepared.nodes.len();
        if let Some(wrong) = numbers.iter().find(|&&n| n as usize >= count) {
            let message = format!("there is no node {wrong}: this scene has {count}, numbered from 0");
            return Err(RunError { message });
        }
        let rows = match &self.on_device {
            None => None,
            Some(remote) => Some(remote.device.rows(numbers).map_err(|message| RunError { message })?),
        };
        Ok(Nodes { numbers: numbers.to_vec(), rows })
    }

    /// Positions of some nodes in m, [node][axis], in single precision; axes that the scene does not have stay at rest.
    ///
    /// # Errors
    /// When the graphics device that has them is lost.
    pub fn positions_of(&self, nodes: &Nodes) -> Result<Vec<[f32; 3]>, RunError> {
        let d = self.system.dimension;
        let rest = |n: u32| self.prepared.nodes[n as usize];
        let at = |n: u32, u: &[f64]| -> [f32; 3] {
            let rest = rest(n);
            std::array::from_fn(|k| (rest[k] + u.get(k).copied().unwrap_or(0.0)) as f32)
        };
        let numbers = nodes.numbers.iter().copied();
        match (&self.on_device, &nodes.rows) {
            (Some(remote), Some(rows)) if remote.stale && remote.fetched.get().is_none() => {
                let u = remote.device.read_rows(rows, OfNodes::Rounded).map_err(|message| RunError { message })?;
                Ok(numbers.zip(u.chunks(d)).map(|(n, u)| at(n, u)).collect())
            }
            _ => {
                let u = &self.present().u;
                Ok(numbers.map(|n| at(n, &u[n as usize * d..(n as usize + 1) * d])).collect())
            }
        }
    }
}
