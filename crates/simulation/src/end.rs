//! When a simulation is over: at the scene's end, or at rest before it.
//!
//! Not here: failures, which steps tell by themselves.

use crate::run::{Ending, Simulation};
use souple_solver::rest::Rest;

impl Simulation {
    /// From now on neither the scene's end nor rest ends the simulation: somebody may want to touch it.
    pub fn run_on(&mut self) {
        self.endless = true;
        self.ending = self.ending.filter(|e| *e == Ending::Failed);
    }

    /// Begins to watch for rest at this state.
    pub(crate) fn watch_for_rest(&mut self) {
        let energy = self.kinetic_energy() / self.prepared.nodes.len() as f64;
        if let Some(monitor) = &mut self.rest {
            monitor.begin(self.state.t, energy);
        }
    }

    /// Notices the end, or rest before it.
    pub(crate) fn settle(&mut self) {
        if self.endless {
            return;
        }
        let h = self.scene.time.step.value;
        if self.state.t >= self.end_time() - 1e-9 * h {
            self.ending = Some(Ending::Finished);
        }
        let energy = self.kinetic_energy() / self.prepared.nodes.len() as f64;
        if let Some(monitor) = &mut self.rest
            && matches!(monitor.check(self.state.t, || energy), Rest::AtRest(_))
        {
            self.ending = Some(Ending::AtRest);
        }
    }
}
