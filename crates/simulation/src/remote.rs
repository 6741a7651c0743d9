//! Simulations whose state lives on a graphics device: steps there, and what comes back when somebody asks.
//!
//! ```text
//! advance ──► step on the device ──► iterations, kinetic energy                  every step, a few dozen bytes
//! probes, frame, checkpoint, displacement ──► the state, once until the next step
//! ```
//!
//! A device that is lost takes its state with it: the simulation goes back to the state that came back last and says so.

use crate::gpu::{StepError, Stepped, Transfers};
use crate::run::Simulation;
use souple_solver::SecondOrder as _;
use souple_solver::step::State;
use std::sync::OnceLock;

impl Simulation {
    /// One step on the device; the number of linear iterations, or what went wrong.
    pub(crate) fn step_on_device(&mut self, warnings: &mut Vec<String>) -> Result<usize, String> {
        let h = self.scene.time.step.value;
        let remote = self.on_device.as_mut().expect("the caller saw it");
        let t = self.steps as f64 * h;
        match remote.device.step(&self.scene, &self.system, t) {
            Ok(Stepped { iterations, energy, warning }) => {
                remote.energy = energy;
                remote.stale = true;
                remote.fetched = OnceLock::new();
                self.state.t = (self.steps + 1) as f64 * h;
                warnings.extend(warning.map(|w| format!("step {}: {w}", self.steps + 1)));
                Ok(iterations)
            }
            Err(StepError::State) => {
                let failed = remote.device.read();
                let undone = remote.device.undo();
                match failed.and_then(|failed| undone.map(|()| failed)) {
                    Ok(failed) => Err(self.what_failed(t + h, &failed)),
                    Err(lost) => Err(self.forget_device(&lost)),
                }
            }
            Err(StepError::Lost(lost)) => Err(self.forget_device(&lost)),
        }
    }

    /// Why a state is not acceptable, in the words of the processor.
    fn what_failed(&mut self, t: f64, failed: &State) -> String {
        let finite = failed.u.iter().chain(&failed.v).all(|x| x.is_finite());
        let refused = if finite { self.system.admissible(t, &failed.u, &failed.v).err() } else { None };
        refused.map_or_else(
            || "the displacement, or the force before it, is not finite in single precision".to_owned(),
            |failure| failure.message,
        )
    }

    /// Goes back to the state that came back last.
    fn forget_device(&mut self, lost: &str) -> String {
        let remote = self.on_device.as_mut().expect("the caller saw it");
        remote.stale = false;
        remote.fetched = OnceLock::new();
        self.steps = remote.known;
        self.state.t = self.steps as f64 * self.scene.time.step.value;
        format!(
            "{lost}; the steps since t = {} s, whose state came back last, are gone with it (write more often with \
             --checkpoint-every, go on with --resume or on --device cpu)",
            self.state.t
        )
    }

    /// The present state; read from the device where it is there.
    pub(crate) fn present(&self) -> &State {
        match &self.on_device {
            Some(remote) if remote.stale => remote.fetched.get_or_init(|| {
                let mut state = remote.device.read().unwrap_or_else(|_| self.state.clone());
                state.t = self.state.t;
                state
            }),
            _ => &self.state,
        }
    }

    /// Makes the host's state the present one.
    pub(crate) fn fetch(&mut self) {
        if self.on_device.as_ref().is_none_or(|remote| !remote.stale) {
            return;
        }
        let state = self.present().clone();
        self.state = state;
        if let Some(remote) = &mut self.on_device {
            remote.stale = false;
            remote.known = self.steps;
        }
    }

    /// Makes the host's state that of the device.
    pub(crate) fn send(&mut self) {
        if let Some(remote) = &mut self.on_device {
            remote.device.write(&self.state);
            remote.energy = crate::run::kinetic(&self.state.v, &self.system.mass);
            remote.stale = false;
            remote.fetched = OnceLock::new();
            remote.known = self.steps;
        }
    }

    /// Bytes moved between host and graphics device since loading; `None` on the processor.
    pub fn transfers(&self) -> Option<Transfers> {
        self.on_device.as_ref().map(|remote| remote.device.transfers())
    }

    /// Gives the graphics device up as if its driver had lost it: what follows is what happens then.
    pub fn lose_device(&mut self) {
        if let Some(remote) = &mut self.on_device {
            remote.device.lose();
        }
    }
}
