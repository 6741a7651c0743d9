//! Simulations whose state lives on a graphics device: steps there, and what comes back when somebody asks.
//!
//! ```text
//! advance ──► step on the device ──► iterations, kinetic energy                  every step, a few dozen bytes
//! probes of nodes ──► these nodes                                               once until the next step
//! other probes, frame, checkpoint, displacement ──► the state                    once until the next step
//! ```
//!
//! A device that is lost takes its state with it: the simulation goes back to the state that came back last and says so.

use crate::gpu::{OfNodes, OnDevice, Rows, StepError, Stepped, Transfers};
use crate::probes::{Reads, reads};
use crate::run::{Ending, Remote, RunError, Simulation};
use souple_solver::SecondOrder as _;
use souple_solver::step::State;
use std::collections::BTreeSet;
use std::sync::OnceLock;

/// Nodes of probes on a device, and what was read of them.
pub(crate) struct Probed {
    nodes: Vec<u32>,
    rows: Rows,
    /// [node, axis] of all nodes; not a number where nothing was read.
    pub(crate) u: Vec<f64>,
    /// Likewise.
    pub(crate) v: Vec<f64>,
    /// Whether they are those of the present state.
    fresh: bool,
}

/// What the host knows of the present state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Known {
    /// All of it.
    State,
    /// The nodes of probes.
    Nodes,
}

impl Remote {
    /// A device whose state is the host's.
    pub(crate) fn new(device: OnDevice) -> Remote {
        Remote { device, energy: 0.0, stale: false, fetched: OnceLock::new(), known: 0, probed: None, lost: None }
    }

    /// Nothing that was read is of the present state any more.
    fn forget_readings(&mut self) {
        self.fetched = OnceLock::new();
        if let Some(probed) = &mut self.probed {
            probed.fresh = false;
        }
    }
}

impl Simulation {
    /// One step on the device; the number of linear iterations, or what went wrong.
    pub(crate) fn step_on_device(&mut self, warnings: &mut Vec<String>) -> Result<usize, String> {
        if self.on_device.as_ref().is_some_and(|remote| remote.fetched.get().is_some()) {
            // What was read is the state to go back to, should the device be lost; nothing is moved for it.
            self.fetch();
        }
        let h = self.scene.time.step.value;
        let remote = self.on_device.as_mut().expect("the caller saw it");
        let t = self.steps as f64 * h;
        match remote.device.step(&self.scene, &self.system, t) {
            Ok(Stepped { iterations, energy, warning }) => {
                remote.energy = energy;
                remote.stale = true;
                remote.forget_readings();
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
        remote.forget_readings();
        self.steps = remote.known;
        self.state.t = self.steps as f64 * self.scene.time.step.value;
        format!(
            "{lost}; the steps since t = {} s, whose state came back last, are gone with it (have it come back more often with \
             --checkpoint-every, go on with --resume or on --device cpu)",
            self.state.t
        )
    }

    /// The present state; read from the device where it is there. When the device turns out to be lost, the one that came
    /// back last: the next step says so.
    pub(crate) fn present(&self) -> &State {
        self.read_present().unwrap_or(&self.state)
    }

    /// The present state, where the device has it and gives it.
    fn read_present(&self) -> Option<&State> {
        let remote = self.on_device.as_ref().filter(|remote| remote.stale)?;
        if remote.fetched.get().is_none() {
            let mut state = remote.device.read().ok()?;
            state.t = self.state.t;
            // Nobody else wrote it meanwhile, or it is the same.
            let _ = remote.fetched.set(state);
        }
        remote.fetched.get()
    }

    /// A state with the number of its step and its time: the present one, or the one that came back last from a device
    /// that is lost.
    pub(crate) fn saved(&self) -> (u64, f64, &State) {
        match (&self.on_device, self.read_present()) {
            (Some(remote), None) if remote.stale => {
                (remote.known, remote.known as f64 * self.scene.time.step.value, &self.state)
            }
            (_, Some(state)) => (self.steps, state.t, state),
            _ => (self.steps, self.state.t, &self.state),
        }
    }

    /// Makes the host's state the present one; when the device turns out to be lost, goes back to the one that came back
    /// last, and the next step says so.
    pub(crate) fn fetch(&mut self) {
        let Some(remote) = self.on_device.as_mut().filter(|remote| remote.stale) else { return };
        let read = match remote.fetched.take() {
            Some(state) => Ok(state),
            None => remote.device.read(),
        };
        match read {
            Ok(state) => {
                remote.stale = false;
                remote.known = self.steps;
                self.state = State { t: self.state.t, ..state };
            }
            Err(lost) => {
                let message = self.forget_device(&lost);
                if let Some(remote) = &mut self.on_device {
                    remote.lost = Some(message);
                }
            }
        }
    }

    /// Says that the device was found lost since the last step, once.
    pub(crate) fn not_lost(&mut self) -> Result<(), RunError> {
        match self.on_device.as_mut().and_then(|remote| remote.lost.take()) {
            None => Ok(()),
            Some(message) => {
                self.ending = Some(Ending::Failed);
                Err(RunError { message: self.explain(&message) })
            }
        }
    }

    /// Makes known what probes read: their nodes where that is all and the device has it, the state otherwise.
    pub(crate) fn fetch_for_probes(&mut self) -> Known {
        let there = self.on_device.as_ref().is_some_and(|remote| remote.stale && remote.fetched.get().is_none());
        let asked = || self.scene.probes.iter().flat_map(|probe| &probe.quantities).map(|q| reads(q.value));
        if there && asked().all(|what| what != Reads::Everything) {
            let wanted = [(Reads::Displacements, OfNodes::Displacements), (Reads::Velocities, OfNodes::Velocities)];
            let wanted: Vec<OfNodes> = wanted.into_iter().filter(|w| asked().any(|a| a == w.0)).map(|w| w.1).collect();
            if self.fetch_probed(&wanted).is_ok() {
                return Known::Nodes;
            }
        }
        self.fetch();
        Known::State
    }

    /// Reads the nodes of all probes.
    fn fetch_probed(&mut self, wanted: &[OfNodes]) -> Result<(), String> {
        let (len, d) = (self.state.u.len(), self.system.dimension);
        let Some(remote) = &mut self.on_device else { return Ok(()) };
        if remote.probed.is_none() {
            let all: BTreeSet<u32> = self.prepared.probes.iter().flat_map(|region| &region.nodes).copied().collect();
            let nodes: Vec<u32> = all.into_iter().collect();
            let rows = remote.device.rows(&nodes)?;
            remote.probed = Some(Probed { nodes, rows, u: vec![f64::NAN; len], v: vec![f64::NAN; len], fresh: false });
        }
        let Some(probed) = remote.probed.as_mut().filter(|probed| !probed.fresh) else { return Ok(()) };
        for &what in wanted {
            let values = remote.device.read_rows(&probed.rows, what)?;
            let into = if what == OfNodes::Velocities { &mut probed.v } else { &mut probed.u };
            for (&node, values) in probed.nodes.iter().zip(values.chunks(d)) {
                into[node as usize * d..(node as usize + 1) * d].copy_from_slice(values);
            }
        }
        probed.fresh = true;
        Ok(())
    }

    /// Makes the host's state that of the device.
    pub(crate) fn send(&mut self) {
        if let Some(remote) = &mut self.on_device {
            remote.device.write(&self.state);
            remote.energy = crate::run::kinetic(&self.state.v, &self.system.mass);
            remote.stale = false;
            remote.forget_readings();
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
