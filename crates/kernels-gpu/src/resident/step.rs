//! Steps: what the host sends, what it waits for, what comes back.

use super::chunks::{self, Chunk, Programs, Vectors};
use super::kernels::{
    BEGIN, CLOSE, CONTROL_WORDS, ENERGY, EXPLICIT, FINISH, JUDGE, LOAD, MOVED, MOVED_END, PICK, RIGHT, Slot, WORKGROUP,
};
use super::model::{Batch, Model};
use super::solve::{Solve, Summed, Summing};
use super::times::{Marks, Part, Times};
use super::traffic::{Counters, Purpose, Traffic};
use super::vectors::{Bound, Memory, PARAMETER_WORDS};
use crate::device::{DeviceError, Gpu, Pipeline};
use std::sync::{Mutex, PoisonError};

/// The numbers of a step; `ahead` and the rest say which method it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// How the acceleration is found.
    pub stage: Stage,
    /// û − u + β v̂ = `ahead` · v for free unknowns: the known part that K multiplies.
    pub ahead: f64,
    /// α of mass-proportional damping.
    pub drag: f64,
    /// β of damping by K.
    pub rate: f64,
    /// u₁ = u + `end_v` v + `end_a` a.
    pub end_v: f64,
    /// See there.
    pub end_a: f64,
    /// v₁ = `keep` (v + `step` a).
    pub step: f64,
    /// See there.
    pub keep: f64,
    /// Factors of the loads.
    pub factors: Vec<f64>,
    /// For each moved unknown: u and v at the stage, u and v at the end.
    pub targets: Vec<[f64; 4]>,
}

/// How an acceleration is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stage {
    /// M a = F.
    Explicit,
    /// (`mass` M + `second` K) a = F, from the last acceleration or from zero.
    Implicit {
        /// Weight of the masses.
        mass: f64,
        /// Weight of the second derivatives.
        second: f64,
        /// Relative tolerance of the residual.
        relative: f64,
        /// Absolute tolerance.
        absolute: f64,
        /// Most iterations.
        iterations: u32,
        /// Whether the solve starts from the last acceleration.
        start: Start,
    },
}

/// Where a solve starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// From nothing.
    Zero,
    /// From the acceleration of the step before.
    Previous,
}

/// How a step ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The solve met its tolerance, or nothing had to be solved.
    Converged,
    /// The solve used all its iterations; the step was made.
    Exhausted,
    /// A direction without positive curvature was met; the step was made with what was known before it, and with the
    /// preconditioned right-hand side where it was the first.
    Indefinite,
    /// Something was not finite, out of reach, or not positive that must be; the state is the one before the step.
    Failed,
}

/// What a step gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// How it ended.
    pub ending: Ending,
    /// Iterations of the solve.
    pub iterations: usize,
    /// Norm of the residual.
    pub residual: f64,
    /// Norm of the first residual.
    pub initial_residual: f64,
    /// ½ Σ m v² at the end.
    pub energy: f64,
}

/// u, v and the last acceleration, one per unknown, as the device has them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// u.
    pub u: Vec<f64>,
    /// v.
    pub v: Vec<f64>,
    /// The last acceleration of an implicit stage.
    pub a: Vec<f64>,
}

/// A model on a device, with its state.
pub struct Resident {
    pub(super) gpu: Gpu,
    pub(super) memory: Memory,
    pub(super) pick: Pipeline,
    pub(super) traffic: Counters,
    programs: Programs,
    /// Kept alive, too: bind groups refer to what chunks own.
    chunks: Vec<Chunk>,
    segments: usize,
    force: Summed,
    begin: Bound,
    right: Bound,
    loads: Vec<(wgpu::Buffer, Bound)>,
    moved: Option<(wgpu::Buffer, Bound, Bound)>,
    solve: Option<Solve>,
    explicit: Bound,
    finish: Bound,
    energy: Bound,
    checks: Vec<(Vec<chunks::Bound>, Vec<Bound>)>,
    close: Bound,
    staging: wgpu::Buffer,
    /// u, its low part, v and a before the step.
    backup: [wgpu::Buffer; 4],
    reach: f64,
    pub(super) axes: usize,
    expected: usize,
    /// Where the time of steps went, while that is watched.
    times: Option<Mutex<Times>>,
}

/// Iterations that are sent before the first solve tells how many it takes.
const FIRST_GUESS: usize = 16;
/// Iterations that are sent at once, at most: a driver may take a longer submission for a hanging one.
const MOST_AT_ONCE: usize = 256;

impl Resident {
    /// Puts a model on a device, at u = v = 0.
    ///
    /// # Errors
    /// When a buffer does not fit, with numbers, or a program is not compiled.
    pub fn new<'m>(gpu: &Gpu, model: &'m Model<'m>) -> Result<Resident, DeviceError> {
        let memory = Memory::new(gpu, model)?;
        let (axes, rows) = (model.axes, memory.len / model.axes);
        let widest = if model.batches.iter().any(|b| b.diagonal.is_some()) { axes * axes } else { axes };
        let all = chunks::chunks(gpu, &model.batches, widest)?;
        let fixed = chunks::fixed(gpu, &model.batches)?;
        let mut programs = Programs::default();
        let segments = chunks::segments_of(gpu, "contributions", &model.batches, &all, rows, axes)?;
        let summing = Summing::new(gpu)?;
        let vectors = Vectors { state: memory.get(Slot::U), direction: memory.get(Slot::V), fixed: &fixed };
        let batches = &model.batches[..];
        let force = {
            let which = |b: &'m Batch<'m>| Some(b.force);
            let bound = chunks::bind(gpu, &mut programs, batches, &all, &vectors, Some(&segments), &which)?;
            summing.plain(gpu, &memory, bound, &segments, memory.get(Slot::R))
        };
        let solve = match batches.iter().all(|b| b.product.is_some()) {
            true => Some(Solve::new(gpu, model, &memory, &all, &mut programs, &fixed, &segments, &summing)?),
            false => None,
        };
        let checks = {
            let which = |b: &'m Batch<'m>| b.check;
            let bound = chunks::bind(gpu, &mut programs, batches, &all, &vectors, None, &which)?;
            let mut judges = Vec::new();
            if !bound.is_empty() {
                let pipeline = JUDGE.compile(gpu)?;
                for chunk in &all {
                    let Some(program) = batches[chunk.batch].check else { continue };
                    let values = chunk.kept(&program.outputs[0].name).expect("a check writes into its chunk");
                    let own = [(Slot::Values, values), (Slot::Result, memory.get(Slot::Judged))];
                    let groups = (values.size() as usize / 4).div_ceil(WORKGROUP).clamp(1, WORKGROUP);
                    judges.push(memory.bind(gpu, &JUDGE, &pipeline, &own, groups));
                }
            }
            if bound.is_empty() { Vec::new() } else { vec![(bound, judges)] }
        };
        let words = |what: &str, values: &[u32]| {
            let content: &[u8] = bytemuck::cast_slice(values);
            gpu.buffer(what, content.len() as u64, Some(content))
        };
        let mut loads = Vec::new();
        for load in model.loads.iter().filter(|l| !l.is_empty()) {
            let unknowns: Vec<u32> = load.iter().map(|l| l.0).collect();
            let values: Vec<u32> = load.iter().map(|l| (l.1 as f32).to_bits()).collect();
            let (unknowns, values) = (words("loaded unknowns", &unknowns)?, words("loads", &values)?);
            let factor = gpu.buffer("factor of a load", 4, None)?;
            let own = [(Slot::Loaded, &unknowns), (Slot::LoadValues, &values), (Slot::LoadFactor, &factor)];
            let bound = memory.kernel(gpu, &LOAD, &own, load.len().div_ceil(WORKGROUP))?;
            loads.push((factor, bound));
        }
        let moved = if model.moved.is_empty() {
            None
        } else {
            let unknowns = words("moved unknowns", &model.moved)?;
            let targets = gpu.buffer("where they move", 24 * model.moved.len() as u64, None)?;
            let own = [(Slot::Moved, &unknowns), (Slot::Targets, &targets)];
            let groups = model.moved.len().div_ceil(WORKGROUP);
            let first = memory.kernel(gpu, &MOVED, &own, groups)?;
            let last = memory.kernel(gpu, &MOVED_END, &own, groups)?;
            Some((targets, first, last))
        };
        let bytes = 4 * memory.len as u64;
        let spare = || gpu.buffer("the state before a step", bytes, None);
        let backup = [spare()?, spare()?, spare()?, spare()?];
        let kernel = |text| memory.kernel(gpu, text, &[], memory.groups);
        Ok(Resident {
            force,
            begin: kernel(&BEGIN)?,
            right: kernel(&RIGHT)?,
            loads,
            moved,
            solve,
            explicit: kernel(&EXPLICIT)?,
            finish: kernel(&FINISH)?,
            energy: kernel(&ENERGY)?,
            checks,
            close: memory.kernel(gpu, &CLOSE, &[], 1)?,
            pick: PICK.compile(gpu)?,
            traffic: Counters::default(),
            staging: gpu.staging(4 * CONTROL_WORDS as u64),
            backup,
            reach: model.reach,
            axes,
            expected: FIRST_GUESS,
            times: None,
            gpu: gpu.clone(),
            programs,
            chunks: all,
            segments: segments.len(),
            memory,
        })
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Parts that the items were cut into so that a program sees all it needs: one per batch where everything fits.
    pub fn chunks(&self) -> usize {
        self.chunks.len()
    }

    /// Buffers that contributions to forces were cut into.
    pub fn segments(&self) -> usize {
        self.segments
    }

    /// Bytes moved since the model was put on the device, by what they were for.
    pub fn traffic(&self) -> Traffic {
        self.traffic.read()
    }

    fn send_to(&self, purpose: Purpose, buffer: &wgpu::Buffer, content: &[u8]) {
        self.gpu.write(buffer, content);
        self.traffic.sent(purpose, content.len());
    }

    /// Overwrites the state.
    ///
    /// # Panics
    /// When the lengths differ.
    pub fn write(&mut self, state: &State) {
        let len = self.memory.len;
        assert!(state.u.len() == len && state.v.len() == len, "one number per unknown");
        let high: Vec<f32> = state.u.iter().map(|&u| u as f32).collect();
        let low: Vec<f32> = state.u.iter().zip(&high).map(|(&u, &h)| (u - f64::from(h)) as f32).collect();
        let v: Vec<f32> = state.v.iter().map(|&v| v as f32).collect();
        let mut a: Vec<f32> = state.a.iter().map(|&a| a as f32).collect();
        a.resize(len, 0.0);
        for (slot, values) in [(Slot::U, high), (Slot::ULow, low), (Slot::V, v), (Slot::A, a)] {
            self.send_to(Purpose::State, self.memory.get(slot), bytemuck::cast_slice(&values));
        }
    }

    /// The state.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn read(&self) -> Result<State, DeviceError> {
        let singles = |slot: Slot| -> Result<Vec<f32>, DeviceError> {
            let content = self.gpu.download(self.memory.get(slot))?;
            self.traffic.came_back(Purpose::State, content.len());
            Ok(bytemuck::pod_collect_to_vec(&content))
        };
        let double =
            |values: Vec<f32>| -> Vec<f64> { values.into_iter().take(self.memory.len).map(f64::from).collect() };
        let (high, low) = (double(singles(Slot::U)?), double(singles(Slot::ULow)?));
        let u = high.iter().zip(&low).map(|(h, l)| h + l).collect();
        Ok(State { u, v: double(singles(Slot::V)?), a: double(singles(Slot::A)?) })
    }

    /// Goes back to the state before the last step.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn undo(&mut self) -> Result<(), DeviceError> {
        let mut encoder = self.gpu.encoder();
        self.copy_state(&mut encoder, |own, spare| (spare, own));
        self.gpu.inner.queue.submit([encoder.finish()]);
        self.gpu.alive()
    }

    fn copy_state<'s>(
        &'s self,
        encoder: &mut wgpu::CommandEncoder,
        direction: impl Fn(&'s wgpu::Buffer, &'s wgpu::Buffer) -> (&'s wgpu::Buffer, &'s wgpu::Buffer),
    ) {
        for (slot, spare) in [Slot::U, Slot::ULow, Slot::V, Slot::A].into_iter().zip(&self.backup) {
            let (from, to) = direction(self.memory.get(slot), spare);
            encoder.copy_buffer_to_buffer(from, 0, to, 0, spare.size());
        }
    }

    /// Makes a step. After [`Ending::Failed`] the failed state is still there to be read; [`Resident::undo`] goes back.
    ///
    /// # Errors
    /// When the device is lost.
    ///
    /// # Panics
    /// When factors or targets are fewer or more than the model has, or an implicit stage is asked of a model without
    /// products.
    pub fn step(&mut self, step: &Step) -> Result<Outcome, DeviceError> {
        assert_eq!(step.factors.len(), self.loads.len(), "one factor per load");
        self.gpu.alive()?;
        self.send(step);
        let mut encoder = self.gpu.encoder();
        self.copy_state(&mut encoder, |own, spare| (own, spare));
        if matches!(step.stage, Stage::Explicit | Stage::Implicit { start: Start::Zero, .. }) {
            encoder.clear_buffer(self.memory.get(Slot::A), 0, None);
        }
        // Where nothing is multiplied the right-hand side must not hold what an earlier solve left.
        encoder.clear_buffer(self.memory.get(Slot::Q), 0, None);
        let (most, mut batch) = match step.stage {
            Stage::Explicit => (0, 0),
            Stage::Implicit { iterations, .. } => (iterations as usize, self.expected.min(iterations as usize)),
        };
        let mut marks = self.marks(batch);
        {
            let mut pass = Self::pass(&mut marks, &mut encoder, Part::Force);
            self.right_hand_side(step, &mut pass);
        }
        {
            let mut pass = Self::pass(&mut marks, &mut encoder, Part::Rest);
            match (step.stage, &self.solve) {
                (Stage::Explicit, _) => self.explicit.dispatch(&mut pass),
                (Stage::Implicit { .. }, Some(solve)) => solve.prepare(&self.programs, &mut pass),
                (Stage::Implicit { .. }, None) => panic!("an implicit stage needs products"),
            }
        }
        let mut sent = 0;
        loop {
            batch = batch.min(MOST_AT_ONCE);
            match (step.stage, &self.solve, &mut marks) {
                (Stage::Implicit { .. }, Some(solve), Some(marks)) => {
                    for _ in 0..batch {
                        solve.product(&self.programs, &mut marks.pass(&mut encoder, Part::Product));
                        solve.update(&mut marks.pass(&mut encoder, Part::Rest));
                    }
                }
                (Stage::Implicit { .. }, Some(solve), None) => {
                    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                    (0..batch).for_each(|_| solve.iterate(&self.programs, &mut pass));
                }
                _ => {}
            }
            self.end_of_step(&mut Self::pass(&mut marks, &mut encoder, Part::End));
            if let Some(marks) = &marks {
                marks.send(&mut encoder);
            }
            sent += batch;
            let record = self.memory.get(Slot::Control);
            encoder.copy_buffer_to_buffer(record, 0, &self.staging, 0, 4 * CONTROL_WORDS as u64);
            self.gpu.inner.queue.submit([encoder.finish()]);
            let record = self.gpu.read(&self.staging, 4 * CONTROL_WORDS as u64)?;
            self.traffic.came_back(Purpose::Step, record.len());
            let record = Record::of(&record);
            if let (Some(marks), Some(times)) = (&marks, &self.times) {
                marks.add_to(&self.gpu, &mut times.lock().unwrap_or_else(PoisonError::into_inner))?;
                self.traffic.came_back(Purpose::Step, marks.bytes() as usize);
            }
            if record.done {
                if matches!(step.stage, Stage::Implicit { .. }) {
                    self.expected = record.iterations + 1 + record.iterations / 16;
                }
                return Ok(record.outcome());
            }
            if sent > most {
                // The device counts iterations itself: this many without an end is a device that lost its mind.
                return Err(DeviceError::Lost {
                    message: format!("a solve of at most {most} iterations did not end after {sent}"),
                    device: self.gpu.description().name.clone(),
                });
            }
            batch = sent.max(1);
            encoder = self.gpu.encoder();
            marks = self.marks(batch);
        }
    }

    /// Begins to time the parts of steps, where the device tells the time of its work.
    pub fn watch(&mut self) {
        self.times = self.gpu.description().features.timestamps.then(Mutex::default);
    }

    /// What the parts of steps took since this was last asked; none where that is not watched, or the device does not
    /// tell.
    pub fn times(&self) -> Option<Times> {
        let times = self.times.as_ref()?;
        Some(std::mem::take(&mut *times.lock().unwrap_or_else(PoisonError::into_inner)))
    }

    /// Room for the readings of a submission of so many iterations, if somebody watches.
    fn marks(&self, iterations: usize) -> Option<Marks> {
        self.times.as_ref().map(|_| Marks::new(&self.gpu, 3 + 2 * iterations.min(MOST_AT_ONCE)))
    }

    /// A pass that belongs to a part of the step.
    fn pass<'e>(marks: &mut Option<Marks>, encoder: &'e mut wgpu::CommandEncoder, part: Part) -> wgpu::ComputePass<'e> {
        match marks {
            Some(marks) => marks.pass(encoder, part),
            None => encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default()),
        }
    }

    fn right_hand_side(&self, step: &Step, pass: &mut wgpu::ComputePass<'_>) {
        self.force.dispatch(&self.programs, pass);
        self.begin.dispatch(pass);
        if let Some((_, first, _)) = &self.moved {
            first.dispatch(pass);
        }
        match &self.solve {
            Some(solve) if step.ahead != 0.0 || (self.moved.is_some() && step.stage != Stage::Explicit) => {
                solve.known_part.dispatch(&self.programs, pass);
            }
            // Nothing to multiply: q was cleared.
            _ => {}
        }
        self.loads.iter().for_each(|(_, load)| load.dispatch(pass));
        self.right.dispatch(pass);
    }

    fn end_of_step(&self, pass: &mut wgpu::ComputePass<'_>) {
        self.finish.dispatch(pass);
        if let Some((_, _, last)) = &self.moved {
            last.dispatch(pass);
        }
        for (programs, judges) in &self.checks {
            programs.iter().for_each(|p| p.dispatch(&self.programs, pass));
            judges.iter().for_each(|j| j.dispatch(pass));
        }
        self.energy.dispatch(pass);
        self.close.dispatch(pass);
    }

    /// The numbers of the step, the factors, the targets.
    fn send(&self, step: &Step) {
        let (mass, second, relative, absolute, iterations) = match step.stage {
            Stage::Explicit => (1.0, 0.0, 0.0, 0.0, 0),
            Stage::Implicit { mass, second, relative, absolute, iterations, .. } => {
                (mass, second, relative, absolute, iterations)
            }
        };
        let whole = [self.memory.len as u32, self.axes as u32, self.memory.groups as u32, iterations];
        let numbers = [
            step.ahead, step.drag, mass, second, step.end_v, step.end_a, step.step, step.keep, relative, absolute,
            self.reach, step.rate,
        ];
        let mut words: Vec<u32> = whole.to_vec();
        words.extend(numbers.iter().map(|&x| (x as f32).to_bits()));
        // `nothing`, and what fills the last place.
        words.resize(PARAMETER_WORDS, 0);
        self.send_to(Purpose::Step, self.memory.get(Slot::Parameters), bytemuck::cast_slice(&words));
        for ((factor, _), value) in self.loads.iter().zip(&step.factors) {
            self.send_to(Purpose::Step, factor, bytemuck::cast_slice(&[*value as f32]));
        }
        if let Some((targets, _, _)) = &self.moved {
            let singles: Vec<f32> = step
                .targets
                .iter()
                .flat_map(|&[stage_u, stage_v, end_u, end_v]| {
                    let low = |x: f64| (x - f64::from(x as f32)) as f32;
                    [stage_u as f32, low(stage_u), stage_v as f32, end_u as f32, low(end_u), end_v as f32]
                })
                .collect();
            assert_eq!(4 * singles.len() as u64, targets.size(), "one target per moved unknown");
            self.send_to(Purpose::Step, targets, bytemuck::cast_slice(&singles));
        }
    }

    /// Runs the product of the linear solver this many times and waits for it: for measurements.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn products(&self, times: usize) -> Result<(), DeviceError> {
        let mut encoder = self.gpu.encoder();
        if let Some(solve) = &self.solve {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            (0..times).for_each(|_| solve.product(&self.programs, &mut pass));
        }
        let record = self.memory.get(Slot::Control);
        encoder.copy_buffer_to_buffer(record, 0, &self.staging, 0, 4 * CONTROL_WORDS as u64);
        self.gpu.inner.queue.submit([encoder.finish()]);
        let record = self.gpu.read(&self.staging, 4 * CONTROL_WORDS as u64)?;
        self.traffic.came_back(Purpose::Step, record.len());
        Ok(())
    }
}

/// What the device wrote down.
struct Record {
    done: bool,
    iterations: usize,
    status: u32,
    residual_squared: f32,
    initial_squared: f32,
    energy: f32,
    bad: f32,
    judged: f32,
}

impl Record {
    fn of(bytes: &[u8]) -> Record {
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(bytes);
        let number = |k: usize| f32::from_bits(words[k]);
        Record {
            done: words[0] != 0,
            iterations: words[1] as usize,
            status: words[3],
            residual_squared: number(7),
            initial_squared: number(8),
            energy: number(10),
            bad: number(11),
            judged: number(13),
        }
    }

    fn outcome(&self) -> Outcome {
        let unfit = self.bad != 0.0 || self.judged != 0.0;
        let ending = match self.status {
            _ if unfit => Ending::Failed,
            1 => Ending::Converged,
            2 => Ending::Exhausted,
            3 => Ending::Indefinite,
            _ => Ending::Failed,
        };
        let root = |x: f32| f64::from(x).sqrt();
        Outcome {
            ending,
            iterations: self.iterations,
            residual: root(self.residual_squared),
            initial_residual: root(self.initial_squared),
            energy: f64::from(self.energy),
        }
    }
}
