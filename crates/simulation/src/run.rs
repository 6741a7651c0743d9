//! A simulation: built from a scene, advanced step by step, observed in between.

use crate::gpu::{self, OnDevice};
use crate::interaction::{Controls, Interaction};
use crate::motion::{Motion, Turn};
use crate::phases::{PhaseTimes, Watched, timed_contact};
use crate::prepare::{self, PrepareError, Prepared};
use crate::probes::{ExpectationResult, Measured, ProbeValue};
use crate::remote::{Known, Probed};
use crate::system::{FlatLoad, System};
use serde::Serialize;
use souple_kernels::{Backend, CompileError, Interpreter};
use souple_kernels_cpu::{Cpu, InstructionSet};
use souple_operators::{Average, Elements, Threads};
use souple_program::Costs;
use souple_scene::expect::Expectation;
use souple_scene::integrator::{Method as SceneMethod, Tangent};
use souple_scene::linear_solver::{LinearMethod, Operator, Precision, Preconditioner};
use souple_scene::output::Field as SceneField;
use souple_scene::probe::Quantity;
use souple_scene::{Scene, SceneErrors};
use souple_solver::newton::LineSearch;
use souple_solver::quasi_static::{QuasiStaticOptions, QuasiStaticStatus, quasi_static};
use souple_solver::rest::RestMonitor;
use souple_solver::step::{State, StepOptions, StepStatus, StepWorkspace, WarmStart, step};
use souple_solver::vector::norm;
use souple_solver::{Elimination, LanczosOptions, Method, NewtonOptions, StepBound, critical_step};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;
use std::sync::{Arc, OnceLock};
use thiserror::Error;
use web_time::Instant;

/// Where and how a simulation runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunOptions {
    /// `"cpu"`, `"cpu:avx512"`, `"cpu:avx2"`, `"cpu:baseline"`, `"interpreter"`, or a graphics device: `"gpu"`,
    /// `"gpu:1"`, `"gpu:lavapipe"`.
    pub device: String,
    /// Number of threads; 0 takes as many as the machine has.
    pub threads: usize,
}

impl Default for RunOptions {
    fn default() -> RunOptions {
        RunOptions { device: "cpu".into(), threads: 0 }
    }
}

/// Why a simulation cannot start. The text lists every problem found, with its place in the scene.
#[derive(Debug, Error)]
pub enum LoadError {
    /// The scene's text is wrong.
    #[error(transparent)]
    Scene(#[from] SceneErrors),
    /// The scene does not fit its meshes, or asks for what is not supported.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// There is no such device here.
    #[error("there is no device `{name}` here; there are: {known}")]
    Device {
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// The device refused a program.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// Threads could not be started.
    #[error("{0}")]
    Threads(String),
    /// The scene asks for something that it cannot have.
    #[error("{0}")]
    Refused(String),
}

/// Why a simulation stopped before its end. The state is the last good one.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{message}")]
pub struct RunError {
    /// What happened, when, to which elements, and what to try.
    pub message: String,
}

/// How a simulation ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Ending {
    /// The end time was reached.
    #[serde(rename = "finished")]
    Finished,
    /// The bodies came to rest before.
    #[serde(rename = "at rest")]
    AtRest,
    /// It diverged.
    #[serde(rename = "failed")]
    Failed,
}

/// What one step did.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// Steps made so far.
    pub step: u64,
    /// Simulated time in s.
    pub time: f64,
    /// Iterations of the linear solver in this step.
    pub cg_iterations: usize,
    /// Norm of what the last linear solve left over, relative to where it began; 0 where nothing was solved.
    pub residual: f64,
    /// Kinetic energy in J.
    pub kinetic_energy: f64,
    /// Whether the simulation is over, and how.
    pub finished: Option<Ending>,
    /// Whether the scene wants this state written.
    pub output_due: bool,
    /// What a person should know about this step.
    pub warnings: Vec<String>,
}

/// A scene in motion.
pub struct Simulation {
    pub(crate) scene: Scene,
    pub(crate) prepared: Prepared,
    pub(crate) system: System,
    pub(crate) state: State,
    pub(crate) device: String,
    /// What [`RunOptions::device`] named.
    pub(crate) device_name: String,
    /// Means over elements that can be computed without compiling anything more.
    pub(crate) prepared_means: Vec<Average>,
    pub(crate) steps: u64,
    pub(crate) ending: Option<Ending>,
    pub(crate) step_ms: Vec<f64>,
    pub(crate) iterations: Vec<usize>,
    pub(crate) started: Instant,
    /// What a person may change.
    pub(crate) controls: Controls,
    /// What the scene gives for them.
    pub(crate) scene_controls: Controls,
    residual: f64,
    pub(crate) endless: bool,
    pub(crate) interaction: Interaction,
    /// ∫ρN of each node in kg: what gravity acts on.
    pub(crate) shape_mass: Vec<f64>,
    /// Step and time since which the length of steps has not changed.
    pub(crate) origin: (u64, f64),
    next_output: u64,
    workspace: StepWorkspace,
    pub(crate) rest: Option<RestMonitor>,
    /// Steps on a graphics device, and what the host knows of its state.
    pub(crate) on_device: Option<Remote>,
}

/// A simulation whose state is on a graphics device.
pub(crate) struct Remote {
    pub(crate) device: OnDevice,
    /// Kinetic energy of the present state in J, which the device computed.
    pub(crate) energy: f64,
    /// Whether [`Simulation::state`] is older than the device's; `fetched` then holds what was read since.
    pub(crate) stale: bool,
    pub(crate) fetched: OnceLock<State>,
    /// Steps made when [`Simulation::state`] came back last.
    pub(crate) known: u64,
    /// What probes read of the present state, where they look at nodes alone.
    pub(crate) probed: Option<Probed>,
    /// That the device was found lost between two steps, in words; the next step says it.
    pub(crate) lost: Option<String>,
}

/// Opens a device by name.
///
/// # Errors
/// When this machine has no such device; the message lists those that it has.
pub fn open_device(name: &str) -> Result<Box<dyn Backend>, LoadError> {
    let set = |set: InstructionSet| Cpu::with(set).map(|c| Box::new(c) as Box<dyn Backend>);
    let found = match name {
        "cpu" => Some(Box::new(Cpu::open()) as Box<dyn Backend>),
        "interpreter" => Some(Box::new(Interpreter::default()) as Box<dyn Backend>),
        other => other
            .strip_prefix("cpu:")
            .and_then(|wanted| InstructionSet::ALL.into_iter().find(|s| s.name() == wanted))
            .and_then(set),
    };
    found.ok_or_else(|| {
        let sets = InstructionSet::ALL.into_iter().filter(|s| s.available()).map(|s| format!("cpu:{}", s.name()));
        let known: Vec<String> = ["cpu".to_string(), "interpreter".to_string()].into_iter().chain(sets).collect();
        LoadError::Device { name: name.into(), known: known.join(", ") }
    })
}

impl Simulation {
    /// Reads a scene and builds everything that it needs.
    ///
    /// `overrides` are `key=value` pairs; `read` gives the bytes of a mesh file by the path written in the scene.
    /// The second result are warnings.
    ///
    /// # Errors
    /// Everything that is wrong with the scene, its meshes or the options, with places.
    pub fn load(
        text: &str,
        scene_file: &str,
        overrides: &[String],
        read: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
        options: &RunOptions,
    ) -> Result<(Simulation, Vec<String>), LoadError> {
        let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
        let (scene, found) = souple_scene::parse_with_overrides(text, scene_file, &overrides, &prepare::catalogue())?;
        let mut warnings: Vec<String> = found.iter().map(|w| w.in_file(scene_file).to_string()).collect();
        let (prepared, more) = prepare::prepare(&scene, scene_file, read)?;
        warnings.extend(more);
        let threads = match options.threads {
            0 => std::thread::available_parallelism().map_or(1, usize::from),
            n => n,
        };
        let threads = Arc::new(Threads::new(threads).map_err(LoadError::Threads)?);
        // What a graphics device does not do for itself, set-up and probes among them, the processor does.
        let adapter = gpu::adapter_of(&options.device);
        let device = open_device(if adapter.is_some() { "cpu" } else { &options.device })?;
        let (mut elements, masses) = Elements::new(
            prepared.dimension,
            &prepared.nodes,
            prepared.blocks.clone(),
            &*device,
            threads.clone(),
            Costs::default(),
        )?;
        if scene.integrator.tangent == Tangent::Projected {
            elements.set_tangent(souple_operators::Tangent::Projected, &*device, Costs::default())?;
        }
        let prepared_means = means(&scene);
        elements.prepare_means(&prepared_means, &*device, Costs::default())?;
        let mut solver = scene.linear_solver.clone();
        if adapter.is_some() {
            // The host keeps no matrix of a system that it does not solve.
            solver.method.value = LinearMethod::Cg;
            solver.operator.value = Operator::MatrixFree;
            solver.preconditioner.value = Preconditioner::None;
            solver.precision.value = Precision::Double;
        }
        let following = prepared.constraints.iter().map(|c| (c.node, &c.masters[..]));
        let elimination = Elimination::new(elements.dimension(), following);
        let nodes = prepared.nodes.clone();
        let mut system = System::new(elements, &masses, scene.gravity, nodes, elimination, solver, threads);
        constrain(&mut system, &scene, &prepared);
        let len = system.mass.len();
        let mut state = State::at_rest(len);
        let d = system.dimension;
        for (n, velocity) in prepared.velocities.iter().enumerate() {
            state.v[n * d..(n + 1) * d].copy_from_slice(&velocity[..d]);
        }
        let (mut u, mut v) = (std::mem::take(&mut state.u), std::mem::take(&mut state.v));
        souple_solver::SecondOrder::prescribe(&system, 0.0, &mut u, &mut v);
        (state.u, state.v) = (u, v);
        let integrator = &scene.integrator;
        if let Some(method) = method(&scene)
            && method.is_explicit()
        {
            refuse_large_step(&mut system, &state, method, &scene, scene_file, &mut warnings)?;
        }
        system.rayleigh = [integrator.rayleigh.mass, integrator.rayleigh.stiffness];
        let rest =
            scene.time.stop.as_ref().map(|stop| {
                RestMonitor::new(stop.mean_kinetic_energy, stop.check_every.unwrap_or(scene.time.step.value))
            });
        let put = |name: &str| OnDevice::load(name, &scene, scene_file, &system, &prepared, &mut warnings);
        let mut on_device = adapter.map(put).transpose()?.map(Remote::new);
        let workspace = if on_device.is_some() {
            StepWorkspace::default()
        } else {
            StepWorkspace::new(len, method(&scene).unwrap_or(Method::ImplicitEuler))
        };
        if let Some(remote) = &mut on_device {
            remote.device.write(&state);
            remote.energy = kinetic(&state.v, &system.mass);
        }
        let controls = Simulation::initial_controls(&scene, &prepared);
        let mut simulation = Simulation {
            scene_controls: controls.clone(),
            controls,
            interaction: Interaction::default(),
            residual: 0.0,
            endless: false,
            shape_mass: masses.shape,
            origin: (0, 0.0),
            device_name: if adapter.is_some() { "cpu".into() } else { options.device.clone() },
            prepared_means,
            device: match &on_device {
                Some(remote) => remote.device.description(),
                None => device.about().name.clone() + ": " + &device.about().description,
            },
            on_device,
            scene,
            prepared,
            system,
            state,
            steps: 0,
            ending: None,
            step_ms: Vec::new(),
            iterations: Vec::new(),
            started: Instant::now(),
            next_output: 1,
            workspace,
            rest,
        };
        simulation.note_followers();
        simulation.watch_for_rest();
        Ok((simulation, warnings))
    }

    /// The meshes, elements and regions that the scene became.
    pub fn prepared(&self) -> &Prepared {
        &self.prepared
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Simulated time in s.
    pub fn time(&self) -> f64 {
        self.state.t
    }

    /// When the simulation ends, in s.
    pub fn end_time(&self) -> f64 {
        self.scene.time.end.value
    }

    /// Makes one step. After the end nothing moves any more.
    ///
    /// # Errors
    /// When the step failed: the state is the last good one, and the message says what happened where and when.
    pub fn advance(&mut self) -> Result<Progress, RunError> {
        let mut warnings = Vec::new();
        if self.ending.is_none() {
            self.not_lost()?;
            let before = Instant::now();
            let phases = self.system.phases.clone();
            timed_contact(phases.as_deref(), || self.begin_step());
            let threads = self.system.threads.clone();
            let outcome = if self.on_device.is_some() {
                self.step_on_device(&mut warnings)
            } else {
                threads.awake(|| match self.scene.integrator.method.value {
                    SceneMethod::QuasiStatic => self.balance(),
                    _ => self.integrate(&mut warnings),
                })
            };
            let iterations = outcome.map_err(|message| {
                self.ending = Some(Ending::Failed);
                RunError { message: self.explain(&message) }
            })?;
            self.step_ms.push(before.elapsed().as_secs_f64() * 1e3);
            self.iterations.push(iterations);
            self.steps += 1;
            self.settle();
        }
        let due = self.skip_written_outputs() || self.ending.is_some();
        if self.ending == Some(Ending::Finished) || self.ending == Some(Ending::AtRest) {
            warnings.extend(self.inverted());
        }
        if due && self.on_device.is_some() {
            // Whoever is told that output is due reads the state next; a device that cannot give it fails here.
            self.fetch();
            self.not_lost()?;
        }
        Ok(Progress {
            step: self.steps,
            time: self.state.t,
            cg_iterations: self.iterations.last().copied().unwrap_or(0),
            residual: self.residual,
            kinetic_energy: self.kinetic_energy(),
            finished: self.ending,
            output_due: due,
            warnings,
        })
    }

    /// Moves on to the next time at which the scene wants output; whether one was passed.
    pub(crate) fn skip_written_outputs(&mut self) -> bool {
        let Some(every) = &self.scene.output.every else { return false };
        let now = self.state.t + 1e-9 * self.scene.time.step.value;
        let mut passed = false;
        while now >= self.next_output as f64 * every.value {
            self.next_output += 1;
            passed = true;
        }
        passed
    }

    /// A warning when elements are inside out in the present state: an equilibrium of numbers, not of matter.
    fn inverted(&mut self) -> Option<String> {
        self.fetch();
        let crushed = self.system.elements.crushed(&self.state.u, 0.0);
        let (id, ratio) = *crushed.first()?;
        Some(format!(
            "{} elements are inverted, the worst being {} (volume ratio {ratio:.3}): this state is not physical; \
             use a smaller load or step, a finer mesh, or a law that resists compression",
            crushed.len(),
            self.prepared.describe_element(id)
        ))
    }

    /// Begins to time the parts of steps; from then on [`Simulation::phases`] tells. On a graphics device every product
    /// then waits for its own reading of the clock: steps take a little longer.
    pub fn watch(&mut self) {
        if let Some(remote) = &mut self.on_device {
            remote.device.watch();
        }
        self.system.phases = Some(Arc::default());
    }

    /// Time that the parts of steps took since this was last asked, if it is watched; quasi-static steps are not,
    /// nor are those on a graphics device that does not tell the time of its work.
    pub fn phases(&self) -> Option<PhaseTimes> {
        if let Some(remote) = &self.on_device {
            return remote.device.phases();
        }
        self.system.phases.as_ref().map(|phases| phases.take())
    }

    /// Mass of all bodies in kg.
    pub fn mass(&self) -> f64 {
        self.shape_mass.iter().sum()
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.state.u.len()
    }

    /// Number of elements.
    pub fn element_count(&self) -> usize {
        self.prepared.blocks.iter().map(|block| block.len()).sum()
    }

    /// Kinetic energy of all nodes in J.
    pub fn kinetic_energy(&self) -> f64 {
        match &self.on_device {
            Some(remote) => remote.energy,
            None => kinetic(&self.state.v, &self.system.mass),
        }
    }

    /// When a step ends, in s: a multiple of the step since it was last changed.
    fn time_of(&self, step: u64) -> f64 {
        let (steps, time) = self.origin;
        time + (step - steps) as f64 * self.scene.time.step.value
    }

    /// One step of a time integrator; the number of linear iterations, or what went wrong.
    fn integrate(&mut self, warnings: &mut Vec<String>) -> Result<usize, String> {
        let integrator = &self.scene.integrator;
        let method = method(&self.scene).expect("quasi-static scenes are balanced");
        let h = self.scene.time.step.value;
        let options = StepOptions {
            newton_iterations: integrator.newton_iterations as usize,
            newton_tolerance: integrator.newton_tolerance,
            newton_absolute_tolerance: 0.0,
            line_search: line_search(integrator.line_search),
            warm_start: if self.scene.linear_solver.warm_start { WarmStart::Previous } else { WarmStart::Zero },
        };
        let phases = self.system.phases.clone();
        let (state, workspace) = (&mut self.state, &mut self.workspace);
        let report = match &phases {
            Some(phases) => {
                step(&mut Watched { system: &mut self.system, phases }, state, h, method, &options, workspace)
            }
            None => step(&mut self.system, state, h, method, &options, workspace),
        };
        match report.status {
            StepStatus::Failed(failure) => return Err(failure.message),
            StepStatus::Unconverged(status) => {
                warnings.push(format!("step {}: Newton stopped above its tolerance ({status:?})", self.steps + 1));
            }
            StepStatus::Completed => {}
        }
        self.residual = report.linear.as_ref().map_or(0.0, |linear| match linear.initial_residual > 0.0 {
            true => linear.residual / linear.initial_residual,
            false => 0.0,
        });
        if let Some(linear) = &report.linear
            && !linear.converged()
        {
            warnings.push(format!(
                "step {}: the linear solver stopped after {} iterations above its tolerance ({:?})",
                self.steps + 1,
                linear.iterations,
                linear.status
            ));
        }
        // The time is a multiple of the step, not a sum of roundings.
        self.state.t = self.time_of(self.steps + 1);
        let damping = integrator.velocity_damping;
        if damping > 0.0 {
            let factor = (-damping * h).exp();
            for (v, &held) in self.state.v.iter_mut().zip(&self.system.held) {
                if !held {
                    *v *= factor;
                }
            }
            self.system.elimination.expand(&mut self.state.v);
        }
        Ok(report.linear_iterations)
    }

    /// One step of a sequence of equilibria.
    fn balance(&mut self) -> Result<usize, String> {
        let integrator = &self.scene.integrator;
        let h = self.scene.time.step.value;
        let start = self.time_of(self.steps);
        self.system.load_span = [start, start + h];
        self.system.raising = self.steps == 0;
        let first = 1.0 / f64::from(integrator.load_steps);
        // A step that changes nothing starts balanced: its residual is measured against the forces in play, reactions
        // included, and not against itself.
        let mut forces = vec![0.0; self.state.u.len()];
        self.system.external(start + h, &mut forces);
        let external = norm(&forces);
        forces.fill(0.0);
        self.system.elements.add_force(&self.state.u, &mut forces);
        let in_play = external.max(norm(&forces));
        let options = QuasiStaticOptions {
            initial_step: first,
            max_step: first,
            min_step: first * 1e-4,
            newton: NewtonOptions {
                relative_tolerance: integrator.newton_tolerance,
                absolute_tolerance: integrator.newton_tolerance * in_play,
                max_iterations: integrator.newton_iterations as usize,
                line_search: line_search(integrator.line_search),
                ..NewtonOptions::default()
            },
            ..QuasiStaticOptions::default()
        };
        let mut u = std::mem::take(&mut self.state.u);
        let outcome = quasi_static(&mut self.system, &mut u, &options, &mut |_, _| ControlFlow::Continue(()));
        self.system.elimination.expand(&mut u);
        self.state.u = u;
        self.state.t = start + outcome.factor * h;
        let reached = format!("{:.4} of the load", outcome.factor);
        let why = outcome.last_rejection.map_or(String::new(), |r| format!("; last attempt: {r:?}"));
        match outcome.status {
            QuasiStaticStatus::Finished => {
                self.state.t = self.time_of(self.steps + 1);
                Ok(outcome.linear_iterations)
            }
            QuasiStaticStatus::StepTooSmall { .. } | QuasiStaticStatus::MaxAttempts => {
                Err(format!("no equilibrium was found beyond {reached}{why}"))
            }
            QuasiStaticStatus::Failed(failure) => Err(format!("{} (at {reached})", failure.message)),
            QuasiStaticStatus::Interrupted => Err("interrupted".into()),
        }
    }

    /// A failure with the elements that are worst off in the last good state, and what to try.
    pub(crate) fn explain(&mut self, message: &str) -> String {
        self.fetch();
        let crushed = self.system.elements.crushed(&self.state.u, 0.2);
        let named: Vec<String> = crushed
            .iter()
            .take(5)
            .map(|&(id, ratio)| format!("{} (volume ratio {ratio:.3})", self.prepared.describe_element(id)))
            .collect();
        let worst = match &named[..] {
            [] => {
                let mut all = self.system.elements.crushed(&self.state.u, f64::INFINITY);
                all.truncate(1);
                all.first().map_or(String::new(), |&(id, ratio)| {
                    format!(
                        " No element is crushed yet; the most compressed is {} (volume ratio {ratio:.3}).",
                        self.prepared.describe_element(id)
                    )
                })
            }
            list => format!(" Crushed or inverted: {}{}.", list.join("; "), if crushed.len() > 5 { "; …" } else { "" }),
        };
        let advice = if self.scene.integrator.method.value == SceneMethod::QuasiStatic {
            "more load steps, a finer mesh where elements are crushed, or a law that resists compression"
        } else {
            "a smaller time step, more Newton iterations, or damping"
        };
        format!("the simulation failed after t = {} s: {message}.{worst} What may help: {advice}.", self.state.t)
    }

    /// All probes: name, quantity, value.
    pub fn probes(&mut self) -> BTreeMap<String, BTreeMap<String, ProbeValue>> {
        let known = self.fetch_for_probes();
        let (u, v) = match (known, &self.on_device) {
            (Known::Nodes, Some(Remote { probed: Some(probed), .. })) => (&probed.u, &probed.v),
            _ => (&self.state.u, &self.state.v),
        };
        let mut all = BTreeMap::new();
        for (probe, region) in self.scene.probes.iter().zip(&self.prepared.probes) {
            let mut values = BTreeMap::new();
            let mut measured = Measured { system: &mut self.system, t: self.state.t, u, v };
            for quantity in &probe.quantities {
                let value = measured.measure(quantity.value, region, probe);
                values.insert(quantity.value.to_string(), value);
            }
            all.insert(probe.name.value.clone(), values);
        }
        all
    }

    /// What the scene expects, compared with what was measured.
    pub fn expectations(&mut self) -> Vec<ExpectationResult> {
        let probes = self.probes();
        let scene = &self.scene;
        scene
            .expectations
            .iter()
            .filter_map(|e| match &e.value {
                Expectation::Value(expected) => {
                    let probe = &scene.probes[expected.probe.value];
                    let value = probes.get(&probe.name.value)?.get(&expected.quantity.to_string())?;
                    Some(ExpectationResult::of(expected, probe, value))
                }
                Expectation::MaxCgIterations(limit) => {
                    let most = self.iterations.iter().copied().max().unwrap_or(0) as f64;
                    let limit = f64::from(*limit);
                    let mut result =
                        ExpectationResult::new("most CG iterations".into(), vec![limit], vec![most], limit);
                    result.passed = most <= limit;
                    Some(result)
                }
            })
            .collect()
    }

    /// Displacements, [node, axis], in m.
    pub fn displacement(&self) -> &[f64] {
        &self.present().u
    }

    /// Number of space dimensions.
    pub fn dimension(&self) -> usize {
        self.system.dimension
    }
}

/// ½ Σ m v² in J.
pub(crate) fn kinetic(v: &[f64], mass: &[f64]) -> f64 {
    0.5 * v.iter().zip(mass).map(|(v, m)| m * v * v).sum::<f64>()
}

fn line_search(on: bool) -> LineSearch {
    if on {
        LineSearch::default()
    } else {
        LineSearch { max_shrinks: 0, sufficient_decrease: 0.0, ..LineSearch::default() }
    }
}

/// The solver's method; none when quasi-static.
pub(crate) fn method(scene: &Scene) -> Option<Method> {
    Some(match scene.integrator.method.value {
        SceneMethod::ExplicitEuler => Method::ExplicitEuler,
        SceneMethod::SymplecticEuler => Method::SymplecticEuler,
        SceneMethod::Rk2 => Method::Rk2,
        SceneMethod::Rk4 => Method::Rk4,
        SceneMethod::ImplicitEuler => Method::ImplicitEuler,
        SceneMethod::ImplicitMidpoint => Method::ImplicitMidpoint,
        SceneMethod::Bdf2 => Method::Bdf2,
        SceneMethod::Newmark => {
            let newmark = scene.integrator.newmark;
            Method::Newmark { beta: newmark.beta, gamma: newmark.gamma }
        }
        SceneMethod::QuasiStatic => return None,
    })
}

/// The means over elements that probes and written fields take.
fn means(scene: &Scene) -> Vec<Average> {
    let mut means = Vec::new();
    let fields = &scene.output.fields;
    let probed = |q: Quantity| scene.probes.iter().any(|probe| probe.quantities.iter().any(|p| p.value == q));
    if probed(Quantity::Stress) || fields.contains(&SceneField::Stress) || fields.contains(&SceneField::VonMisesStress)
    {
        means.push(Average::Stress);
    }
    let strain = [SceneField::Strain, SceneField::PrincipalStretches].iter().any(|f| fields.contains(f));
    if strain || probed(Quantity::Strain) || probed(Quantity::PrincipalStretches) {
        means.push(Average::Strain);
    }
    means
}

/// Prescribed unknowns and motions, but for the nodes that were let go.
pub(crate) fn hold(system: &mut System, scene: &Scene, prepared: &Prepared, freed: &BTreeSet<u32>) {
    let d = system.dimension;
    let is_freed = |n: &u32| freed.contains(n);
    system.prescribed.fill(false);
    system.motions.clear();
    for (nodes, axes) in &prepared.fixed {
        for &n in nodes.iter().filter(|n| !is_freed(n)) {
            for axis in (0..d).filter(|&k| axes[k]) {
                system.prescribed[n as usize * d + axis] = true;
            }
        }
    }
    for moved in &prepared.moved {
        let source = &scene.bodies[moved.source.0].value.moves[moved.source.1].value;
        let nodes: Vec<u32> = moved.nodes.iter().copied().filter(|n| !is_freed(n)).collect();
        for &n in &nodes {
            for axis in (0..d).filter(|&k| source.axes[k]) {
                system.prescribed[n as usize * d + axis] = true;
            }
        }
        system.motions.push(Motion {
            nodes,
            axes: source.axes,
            translation: source.translation.clone().unwrap_or_default(),
            rotation: source.rotation.as_ref().map(|r| {
                let length = r.axis.iter().map(|x| x * x).sum::<f64>().sqrt();
                Turn { axis: r.axis.map(|x| x / length), through: r.through, keys: r.keys.clone() }
            }),
        });
    }
    system.settle();
}

/// Prescribed unknowns, motions and loads; what acts on a node that follows others acts on its masters.
fn constrain(system: &mut System, scene: &Scene, prepared: &Prepared) {
    let d = system.dimension;
    hold(system, scene, prepared, &BTreeSet::new());
    let mut at_nodes = vec![0.0; system.mass.len()];
    for load in &prepared.loads {
        at_nodes.fill(0.0);
        for &(n, force) in &load.forces {
            (0..d).for_each(|axis| at_nodes[n as usize * d + axis] += force[axis]);
        }
        system.elimination.restrict(&mut at_nodes);
        let forces = at_nodes.iter().copied().enumerate().filter(|(_, force)| *force != 0.0).collect();
        system.loads.push(FlatLoad { forces, factor: load.factor.clone() });
    }
}

/// Explicit methods: a step beyond the critical one is refused, or warned of if the scene insists.
pub(crate) fn refuse_large_step(
    system: &mut System,
    state: &State,
    method: Method,
    scene: &Scene,
    file: &str,
    warnings: &mut Vec<String>,
) -> Result<(), LoadError> {
    let integrator = &scene.integrator;
    // Damping of velocities acts like Rayleigh's mass term.
    system.rayleigh = [integrator.rayleigh.mass + integrator.velocity_damping, integrator.rayleigh.stiffness];
    let bound = critical_step(system, 0.0, &state.u, &state.v, method, &LanczosOptions::default())
        .map_err(|failure| LoadError::Refused(failure.message))?;
    let h = scene.time.step.value;
    let message = match bound.bound {
        StepBound::Unconditional => return Ok(()),
        StepBound::UpTo(limit) if h <= limit => return Ok(()),
        StepBound::UpTo(limit) => format!(
            "the step of {h:e} s is larger than the critical step of {limit:.3e} s of {} (highest frequency {:.3e} rad/s)",
            method.name(),
            bound.frequency
        ),
        StepBound::NoStep => format!("{} is unstable without damping, whatever the step", method.name()),
    };
    if integrator.allow_unstable_step {
        warnings.push(format!("{}: {message}", scene.time.step.at.in_file(file)));
        return Ok(());
    }
    Err(LoadError::Refused(format!(
        "{}: {message}; use a smaller step, an implicit method, or `allow_unstable_step = true`",
        scene.time.step.at.in_file(file)
    )))
}
