//! What leaves a simulation: pictures of a state, summaries, checkpoints.

use crate::gpu::Transfers;
use crate::interaction::ByHand;
use crate::prepare::PreparedBody;
use crate::probes::{Measured, ProbeValue};
use crate::run::{Ending, RunError, Simulation};
use crate::tensor::{Symmetric, principal_stretches, rows, von_mises};
use serde::Serialize;
use souple_mesh::ElementId;
use souple_mesh::formats::{Field, Location, Values, VtuOptions, write_vtu};
use souple_operators::{Average, Mean};
use souple_scene::output::Field as SceneField;
use std::collections::BTreeMap;

/// The result of a run in numbers.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Title of the scene.
    pub title: String,
    /// Steps made.
    pub steps: u64,
    /// Simulated time in s.
    pub simulated_s: f64,
    /// Time it took in s.
    pub wall_s: f64,
    /// Time per step in ms.
    pub step_ms: Quantiles,
    /// Iterations of the linear solver per step.
    pub cg_iterations: Iterations,
    /// Deformable elements by kind.
    pub elements: BTreeMap<String, usize>,
    /// Number of nodes.
    pub nodes: usize,
    /// What it ran on.
    pub device: String,
    /// Probe, quantity, value.
    pub probes: BTreeMap<String, BTreeMap<String, ProbeValue>>,
    /// Bytes moved between host and graphics device since loading; none on the processor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transfers: Option<Transfers>,
    /// How it ended; failed also when it was stopped before its end.
    pub status: Ending,
}

/// Distribution of the time per step.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Quantiles {
    /// Mean.
    pub mean: f64,
    /// Median.
    pub p50: f64,
    /// 99th percentile.
    pub p99: f64,
}

/// Iterations of the linear solver per step.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Iterations {
    /// Mean.
    pub mean: f64,
    /// Maximum.
    pub max: usize,
}

impl Simulation {
    /// The run so far in numbers.
    pub fn summary(&mut self) -> Summary {
        let mut sorted = self.step_ms.clone();
        sorted.sort_by(f64::total_cmp);
        let at = |q: f64| -> f64 {
            let last = sorted.len().saturating_sub(1);
            sorted.get((q * last as f64).round() as usize).copied().unwrap_or(0.0)
        };
        let count = self.step_ms.len().max(1) as f64;
        let mut elements = BTreeMap::new();
        for block in &self.prepared.blocks {
            *elements.entry(block.element.id.to_string()).or_insert(0) += block.len();
        }
        Summary {
            title: self.scene.title.clone(),
            steps: self.steps,
            simulated_s: self.state.t,
            wall_s: self.started.elapsed().as_secs_f64(),
            step_ms: Quantiles { mean: self.step_ms.iter().sum::<f64>() / count, p50: at(0.5), p99: at(0.99) },
            cg_iterations: Iterations {
                mean: self.iterations.iter().sum::<usize>() as f64 / count,
                max: self.iterations.iter().copied().max().unwrap_or(0),
            },
            elements,
            nodes: self.prepared.nodes.len(),
            device: self.device.clone(),
            probes: self.probes(),
            transfers: self.transfers(),
            status: self.ending.unwrap_or(Ending::Failed),
        }
    }

    /// The present state of each body as a VTU file: name of the body and bytes.
    ///
    /// # Errors
    /// When a mesh cannot be written; the message says why.
    pub fn frame(&mut self) -> Result<Vec<(String, Vec<u8>)>, RunError> {
        self.fetch();
        let d = self.system.dimension;
        let spread = |values: &[f64]| -> Vec<[f64; 3]> {
            values.chunks(d).map(|v| std::array::from_fn(|k| v.get(k).copied().unwrap_or(0.0))).collect()
        };
        let displacement = spread(&self.state.u);
        let velocity = spread(&self.state.v);
        let fields = self.scene.output.fields.clone();
        let wants = |f: SceneField| fields.contains(&f);
        let count: usize = self.prepared.blocks.iter().map(souple_operators::BlockSpec::len).sum();
        let mut nodal: Vec<(&str, Vec<[f64; 3]>)> = Vec::new();
        if wants(SceneField::Displacement) {
            nodal.push(("displacement", displacement.clone()));
        }
        if wants(SceneField::Velocity) {
            nodal.push(("velocity", velocity));
        }
        if wants(SceneField::Force) {
            let mut force = vec![0.0; self.state.u.len()];
            self.system.elements.add_force(&self.state.u, &mut force);
            nodal.push(("force", spread(&force)));
        }
        if wants(SceneField::Reaction) {
            let mut measured =
                Measured { system: &mut self.system, t: self.state.t, u: &self.state.u, v: &self.state.v };
            let reactions = measured.reactions();
            nodal.push(("reaction", spread(&reactions)));
        }
        // Name, components, values of all elements.
        let mut elemental: Vec<(&str, usize, Vec<f64>)> = Vec::new();
        let mut mean = |average| -> Vec<Symmetric> {
            let mut tensors = vec![[0.0; 6]; count];
            let give = |id, mean: Mean| tensors[id as usize] = mean.tensor;
            self.system.elements.each_mean(average, &self.state.u, give);
            tensors
        };
        if wants(SceneField::Stress) || wants(SceneField::VonMisesStress) {
            let stress = mean(Average::Stress);
            if wants(SceneField::Stress) {
                elemental.push(("stress", 9, stress.iter().copied().flat_map(rows).collect()));
            }
            if wants(SceneField::VonMisesStress) {
                elemental.push(("von mises stress", 1, stress.into_iter().map(von_mises).collect()));
            }
        }
        if wants(SceneField::Strain) || wants(SceneField::PrincipalStretches) {
            let strain = mean(Average::Strain);
            if wants(SceneField::PrincipalStretches) {
                let stretches = strain.iter().copied().flat_map(principal_stretches).collect();
                elemental.push(("principal stretches", 3, stretches));
            }
            if wants(SceneField::Strain) {
                elemental.push(("strain", 9, strain.into_iter().flat_map(rows).collect()));
            }
        }
        if wants(SceneField::EnergyDensity) {
            let mut volumes = vec![1.0; count];
            let rest = vec![0.0; self.state.u.len()];
            self.system.elements.each_volume(&rest, |id, v| volumes[id as usize] = v);
            let mut density = vec![0.0; count];
            self.system.elements.each_energy(&self.state.u, |id, e| density[id as usize] = e / volumes[id as usize]);
            elemental.push(("energy density", 1, density));
        }
        if wants(SceneField::VolumeRatio) {
            let mut ratio = vec![0.0; count];
            let rest = vec![0.0; self.state.u.len()];
            self.system.elements.each_volume(&rest, |id, v| ratio[id as usize] = 1.0 / v);
            self.system.elements.each_volume(&self.state.u, |id, v| ratio[id as usize] *= v);
            elemental.push(("volume ratio", 1, ratio));
        }
        if wants(SceneField::Material) {
            let mut material = vec![0.0; count];
            for (number, block) in self.prepared.blocks.iter().enumerate() {
                for &id in &block.ids {
                    material[id as usize] = number as f64;
                }
            }
            elemental.push(("material", 1, material));
        }
        let mut frames = Vec::new();
        for body in &self.prepared.bodies {
            let nodes = body.first_node as usize..body.first_node as usize + body.mesh.nodes.len();
            let numbers = body.numbers();
            let mut mesh = body.mesh.clone();
            for (node, u) in mesh.nodes.iter_mut().zip(&displacement[nodes.clone()]) {
                for axis in 0..3 {
                    node[axis] += u[axis];
                }
            }
            let mut fields: Vec<Field> = nodal
                .iter()
                .map(|(name, values)| Field {
                    name: (*name).into(),
                    components: 3,
                    location: Location::Nodes,
                    values: Values::F64(values[nodes.clone()].iter().flatten().copied().collect()),
                })
                .collect();
            for &(name, components, ref values) in &elemental {
                fields.push(Field {
                    name: name.into(),
                    components,
                    location: Location::Elements,
                    values: Values::F64(of_all_elements(body, &numbers, components, values)),
                });
            }
            let bytes = write_vtu(&mesh, &fields, &VtuOptions::default())
                .map_err(|e| RunError { message: format!("body `{}` cannot be written: {e}", body.name) })?;
            frames.push((body.name.clone(), bytes));
        }
        Ok(frames)
    }

    /// The whole state, and what was changed by hand, for [`Simulation::restore`].
    pub fn checkpoint(&self) -> Vec<u8> {
        let by_hand = self.changed_by_hand();
        if by_hand.is_empty() {
            let mut bytes = MAGIC.to_vec();
            bytes.extend(self.state_bytes());
            return bytes;
        }
        let text = serde_json::to_vec(&by_hand).expect("numbers and lists of numbers are JSON");
        let mut bytes = MAGIC_BY_HAND.to_vec();
        bytes.extend_from_slice(&(text.len() as u64).to_le_bytes());
        bytes.extend(text);
        bytes.extend(self.state_bytes());
        bytes
    }

    /// The state alone, for [`Simulation::restore_state`].
    pub(crate) fn state_bytes(&self) -> Vec<u8> {
        let (steps, t, state) = self.saved();
        let mut bytes = Vec::new();
        let mut put = |x: f64| bytes.extend_from_slice(&x.to_bits().to_le_bytes());
        put(steps as f64);
        put(t);
        put(state.u.len() as f64);
        let previous = state.previous.as_ref();
        let lists: [&[f64]; 6] = [
            &state.u,
            &state.v,
            &state.guess,
            &state.acceleration,
            previous.map_or(&[], |p| &p.u),
            previous.map_or(&[], |p| &p.v),
        ];
        put(previous.map_or(0.0, |p| p.step));
        for list in lists {
            put(list.len() as f64);
            list.iter().for_each(|&x| put(x));
        }
        bytes
    }

    /// Goes back to a checkpoint of the same scene, with what had been changed by hand then
    /// ([`Simulation::changed_by_hand`]) and without what has been changed since.
    ///
    /// # Errors
    /// When the bytes are not a checkpoint, one of another model, or changed what cannot be changed here.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), RunError> {
        let (by_hand, state) = match (bytes.strip_prefix(MAGIC), bytes.strip_prefix(MAGIC_BY_HAND)) {
            (Some(state), _) => (ByHand::default(), state),
            (_, Some(rest)) => {
                let (count, rest) = rest.split_first_chunk().ok_or_else(|| refuse("it is truncated"))?;
                let count = usize::try_from(u64::from_le_bytes(*count)).unwrap_or(usize::MAX);
                let (text, state) = rest.split_at_checked(count).ok_or_else(|| refuse("it is truncated"))?;
                let read = serde_json::from_slice(text);
                (read.map_err(|e| refuse(&format!("what was changed by hand is damaged: {e}")))?, state)
            }
            _ => return Err(refuse("it is not one of this program")),
        };
        let controls = by_hand.over(&self.scene_controls).map_err(|e| refuse(&e.to_string()))?;
        let before = self.controls.clone();
        self.set_controls(&controls).map_err(|e| refuse(&e.to_string()))?;
        self.restore_state(state).inspect_err(|_| {
            // These were accepted before.
            let _ = self.set_controls(&before);
        })
    }

    /// Goes back to a state; what was changed by hand stays.
    pub(crate) fn restore_state(&mut self, bytes: &[u8]) -> Result<(), RunError> {
        let (words, tail) = bytes.as_chunks::<8>();
        if !tail.is_empty() {
            return Err(refuse("it is truncated"));
        }
        let mut values = words.iter().map(|w| f64::from_bits(u64::from_le_bytes(*w)));
        let mut next = || values.next().ok_or_else(|| refuse("it is truncated"));
        let (steps, t, len, h) = (next()?, next()?, next()?, next()?);
        if len as usize != self.state.u.len() {
            let have = self.state.u.len();
            return Err(refuse(&format!("it has {len} unknowns and the scene has {have}")));
        }
        let mut lists: Vec<Vec<f64>> = Vec::new();
        for _ in 0..6 {
            let count = next()? as usize;
            if count > words.len() {
                return Err(refuse("it is damaged"));
            }
            lists.push((0..count).map(|_| next()).collect::<Result<_, _>>()?);
        }
        let whole = |list: &Vec<f64>| list.len() == len as usize;
        let fits = |list: &Vec<f64>| list.is_empty() || whole(list);
        if !lists[..2].iter().all(whole) || !lists[2..].iter().all(fits) || lists[4].len() != lists[5].len() {
            return Err(refuse("it is damaged"));
        }
        let mut lists = lists.into_iter();
        let mut take = || lists.next().expect("six lists were read");
        (self.state.u, self.state.v, self.state.guess, self.state.acceleration) = (take(), take(), take(), take());
        let (u, v) = (take(), take());
        self.state.previous = (!u.is_empty()).then_some(souple_solver::step::Previous { u, v, step: h });
        self.state.t = t;
        self.steps = steps as u64;
        // Times are multiples of the step, unless the step was changed on the way to this state.
        let multiple = self.steps as f64 * self.scene.time.step.value == t;
        self.origin = if multiple { (0, 0.0) } else { (self.steps, t) };
        self.ending = None;
        self.skip_written_outputs();
        self.send();
        self.watch_for_rest();
        Ok(())
    }
}

/// Values of all elements of a body's mesh, zeros where they do not deform, from those of all deformable elements.
fn of_all_elements(body: &PreparedBody, numbers: &[(ElementId, u32)], components: usize, values: &[f64]) -> Vec<f64> {
    let mut all = Vec::new();
    for id in body.mesh.element_ids() {
        match numbers.binary_search_by_key(&id, |n| n.0) {
            Ok(at) => {
                let first = (body.first_element + numbers[at].1) as usize * components;
                all.extend_from_slice(&values[first..first + components]);
            }
            Err(_) => all.resize(all.len() + components, 0.0),
        }
    }
    all
}

fn refuse(message: &str) -> RunError {
    RunError { message: format!("the checkpoint cannot be used: {message}") }
}

/// First bytes of a checkpoint: the state follows.
const MAGIC: &[u8] = b"souple checkpoint 1\n";
/// First bytes of a checkpoint with changes by hand: their length in bytes, they as JSON, and the state follow.
const MAGIC_BY_HAND: &[u8] = b"souple checkpoint 2\n";
