//! Simulations on a device: the scene's numbers become those of its steps, and its outcomes become words.

use super::model::{Needs, diagonals, factors, model, preconditioner};
use super::refuse::refuse;
use super::report::AdapterReport;
use super::{Moved, OfNodes, StepError, Stepped, Transfers, cache};
use crate::phases::PhaseTimes;
use crate::prepare::Prepared;
use crate::run::LoadError;
use crate::system::System;
pub(crate) use souple_kernels_gpu::resident::Rows;
use souple_kernels_gpu::resident::{self, Ending, Form, Outcome, Resident, Stage, Start, Step};
use souple_kernels_gpu::{Adapter, DeviceError, Gpu};
use souple_scene::Scene;
use souple_scene::integrator::Method;
use souple_solver::step::State;
use std::collections::BTreeSet;

/// Adapters of this machine, the one that `gpu` means first.
pub(crate) fn adapters() -> Option<Vec<AdapterReport>> {
    Some(souple_kernels_gpu::adapters().iter().map(report).collect())
}

fn report(adapter: &Adapter) -> AdapterReport {
    let d = &adapter.description;
    AdapterReport {
        id: format!("gpu:{}", adapter.place),
        name: d.name.clone(),
        driver: format!("{} {}", d.driver, d.driver_version).trim().to_owned(),
        interface: d.interface.clone(),
        kind: d.kind.clone(),
        max_buffer_bytes: d.limits.buffer_bytes,
        max_binding_bytes: d.limits.binding_bytes,
        max_bindings: d.limits.bindings,
        double_precision: d.features.doubles,
        pipeline_cache: d.features.pipeline_cache,
        timestamps: d.features.timestamps,
        notes: d.shortcomings(),
        refused: Gpu::of(adapter, None).err().map(|e| e.to_string()),
    }
}

/// Opens a graphics device by the part of its name behind `gpu:`, with the pipelines that earlier runs kept.
///
/// # Errors
/// When there is no adapter, none of that name, or its driver refuses.
pub fn open_gpu(name: &str) -> Result<Gpu, LoadError> {
    let refused = |e: souple_kernels_gpu::OpenError| LoadError::Refused(format!("{e}; or use --device cpu"));
    let adapter = souple_kernels_gpu::find(&souple_kernels_gpu::adapters(), name).map_err(refused)?;
    let (kept, note) = cache::read(&adapter.description);
    let gpu = Gpu::of(&adapter, kept.as_deref()).map_err(refused)?;
    note.into_iter().for_each(|n| gpu.note(n));
    Ok(gpu)
}

/// A simulation on a device.
pub(crate) struct OnDevice {
    resident: Resident,
    /// Unknowns that motions move, ascending.
    moved: Vec<u32>,
    /// Room for positions and velocities that motions prescribe.
    prescribed: [Vec<f64>; 2],
    /// Bytes moved before the last step.
    before_step: Moved,
}

impl OnDevice {
    pub(crate) fn load(
        name: &str,
        scene: &Scene,
        file: &str,
        system: &System,
        prepared: &Prepared,
        warnings: &mut Vec<String>,
    ) -> Result<OnDevice, LoadError> {
        warnings.extend(refuse(scene, file, &system.elements, prepared.constraints.len())?);
        let gpu = open_gpu(name)?;
        let device = OnDevice::on(&gpu, scene, system).map_err(|e| {
            LoadError::Refused(format!("{e} (--device gpu{}{name})", if name.is_empty() { "" } else { ":" }))
        })?;
        warnings.extend(gpu.take_notes());
        if let Some(data) = gpu.cache_data() {
            cache::write(gpu.description(), &data);
        }
        Ok(device)
    }

    /// Puts a system on a device that is open.
    pub(crate) fn on(gpu: &Gpu, scene: &Scene, system: &System) -> Result<OnDevice, DeviceError> {
        let explicit = scene.integrator.method.value.is_explicit();
        let needs =
            if explicit && scene.integrator.rayleigh.stiffness == 0.0 { Needs::Forces } else { Needs::Products };
        let d = system.dimension;
        let mut moved = BTreeSet::new();
        for motion in &system.motions {
            for &node in &motion.nodes {
                moved.extend((0..d).filter(|&k| motion.axes[k]).map(|k| node * d as u32 + k as u32));
            }
        }
        let moved: Vec<u32> = moved.into_iter().collect();
        let preconditioner = preconditioner(scene.linear_solver.preconditioner.value);
        let own = diagonals(system, preconditioner, needs);
        let model = model(system, &own, preconditioner, needs, &moved);
        let resident = Resident::new(gpu, &model)?;
        let room = if moved.is_empty() { 0 } else { system.mass.len() };
        let prescribed = [vec![0.0; room], vec![0.0; room]];
        Ok(OnDevice { resident, moved, prescribed, before_step: Moved::default() })
    }

    pub(crate) fn description(&self) -> String {
        let d = self.resident.gpu().description();
        format!("gpu: {} through {} ({}), single precision", d.name, d.interface, d.driver)
    }

    /// Bytes since the system was put on the device.
    pub(crate) fn transfers(&self) -> Transfers {
        let traffic = self.resident.traffic();
        let [steps, nodes, states] = [traffic.step, traffic.rows, traffic.state]
            .map(|t| Moved { uploaded: t.uploaded, downloaded: t.downloaded });
        let uploaded = steps.uploaded + nodes.uploaded + states.uploaded;
        let downloaded = steps.downloaded + nodes.downloaded + states.downloaded;
        let last_step = Moved {
            uploaded: uploaded - self.before_step.uploaded,
            downloaded: downloaded - self.before_step.downloaded,
        };
        Transfers { uploaded, downloaded, steps, nodes, states, last_step }
    }

    /// Chunks of elements and buffers of contributions that the model was cut into.
    #[cfg(test)]
    pub(crate) fn parts(&self) -> [usize; 2] {
        [self.resident.chunks(), self.resident.segments()]
    }

    /// What the device counts itself, from its opening on.
    #[cfg(test)]
    pub(crate) fn all_transfers(&self) -> souple_kernels_gpu::Transfers {
        self.resident.gpu().transfers()
    }

    pub(crate) fn write(&mut self, state: &State) {
        let (u, v, a) = (state.u.clone(), state.v.clone(), state.guess.clone());
        self.resident.write(&resident::State { u, v, a });
    }

    /// The state; its time is the caller's.
    pub(crate) fn read(&self) -> Result<State, String> {
        let resident::State { u, v, a } = self.resident.read().map_err(|e| e.to_string())?;
        Ok(State { u, v, guess: a, ..State::default() })
    }

    /// Prepares the reading of some nodes.
    pub(crate) fn rows(&self, nodes: &[u32]) -> Result<Rows, String> {
        self.resident.rows(nodes).map_err(|e| e.to_string())
    }

    /// Numbers of these nodes, [node, axis].
    pub(crate) fn read_rows(&self, rows: &Rows, what: OfNodes) -> Result<Vec<f64>, String> {
        let form = match what {
            OfNodes::Rounded => Form::Rounded,
            OfNodes::Displacements => Form::Whole,
            OfNodes::Velocities => Form::Velocity,
        };
        self.resident.read_rows(rows, form).map_err(|e| e.to_string())
    }

    pub(crate) fn undo(&mut self) -> Result<(), String> {
        self.resident.undo().map_err(|e| e.to_string())
    }

    /// Begins to time the parts of steps.
    pub(crate) fn watch(&mut self) {
        self.resident.watch();
    }

    /// What they took in ms since this was last asked, where the device tells.
    pub(crate) fn phases(&self) -> Option<PhaseTimes> {
        let t = self.resident.times()?;
        // Forces and what products need of them are one program on a device.
        let (force, product, rest_of_solve) = (1e3 * t.force, 1e3 * t.product, 1e3 * t.rest_of_solve);
        Some(PhaseTimes { contact: 0.0, force, linearise: 0.0, product, rest_of_solve })
    }

    /// Gives the device up as if its driver had lost it.
    pub(crate) fn lose(&mut self) {
        self.resident.gpu().destroy();
    }

    /// A step from time `t`.
    pub(crate) fn step(&mut self, scene: &Scene, system: &System, t: f64) -> Result<Stepped, StepError> {
        let Transfers { uploaded, downloaded, .. } = self.transfers();
        self.before_step = Moved { uploaded, downloaded };
        let step = self.numbers(scene, system, t);
        let outcome = self.resident.step(&step).map_err(|e| StepError::Lost(e.to_string()))?;
        if outcome.ending == Ending::Failed {
            return Err(StepError::State);
        }
        Ok(Stepped { iterations: outcome.iterations, energy: outcome.energy, warning: warning(&outcome) })
    }

    /// The method of a scene as numbers; the formulas are those of the integrators on the processor.
    fn numbers(&mut self, scene: &Scene, system: &System, t: f64) -> Step {
        let h = scene.time.step.value;
        let [alpha, beta] = system.rayleigh;
        let solver = &scene.linear_solver;
        // û − u, where the stage is, b and c of û + b a and v̂ + c a, and the end of the step.
        let (known, at, b, c, end_a) = match scene.integrator.method.value {
            Method::ImplicitMidpoint => (0.5 * h, t + 0.5 * h, 0.25 * h * h, 0.5 * h, 0.5 * h * h),
            Method::SymplecticEuler => (0.0, t, 0.0, 0.0, h * h),
            Method::ExplicitEuler => (0.0, t, 0.0, 0.0, 0.0),
            _ => (h, t + h, h * h, h, h * h),
        };
        let stage = if scene.integrator.method.value.is_explicit() {
            Stage::Explicit
        } else {
            Stage::Implicit {
                mass: 1.0 + c * alpha,
                second: b + c * beta,
                relative: solver.tolerance,
                absolute: solver.absolute_tolerance,
                iterations: solver.max_iterations,
                start: if solver.warm_start { Start::Previous } else { Start::Zero },
            }
        };
        Step {
            stage,
            ahead: known + beta,
            drag: alpha,
            rate: beta,
            end_v: h,
            end_a,
            step: h,
            keep: (-scene.integrator.velocity_damping * h).exp(),
            factors: factors(system, at),
            targets: self.targets(system, at, t + h),
        }
    }

    /// u and v of moved unknowns at the stage and at the end.
    fn targets(&mut self, system: &System, stage: f64, end: f64) -> Vec<[f64; 4]> {
        let mut targets = vec![[0.0; 4]; self.moved.len()];
        let [u, v] = &mut self.prescribed;
        for (first, time) in [(0, stage), (2, end)] {
            for motion in &system.motions {
                motion.prescribe(time, &system.nodes, system.dimension, u, v);
            }
            for (target, &unknown) in targets.iter_mut().zip(&self.moved) {
                (target[first], target[first + 1]) = (u[unknown as usize], v[unknown as usize]);
            }
        }
        targets
    }
}

fn warning(outcome: &Outcome) -> Option<String> {
    let Outcome { iterations, residual, initial_residual, .. } = outcome;
    let why = match outcome.ending {
        Ending::Converged | Ending::Failed => return None,
        Ending::Exhausted => "it used all it was allowed",
        Ending::Indefinite => "it met a direction of negative curvature",
    };
    Some(format!(
        "the linear solver stopped after {iterations} iterations above its tolerance: {why} (residual {residual:.3e} N of \
         {initial_residual:.3e} N at its start)"
    ))
}
