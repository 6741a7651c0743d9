//! What a step of a simulation costs, and which part of it.
//!
//! A bar held at one end bends under its weight: implicit Euler with one linearisation per step, and either a fixed number
//! of iterations of conjugate gradients, so that every step does the same work whatever the numbers are, or as many as a
//! tolerance needs, with the preconditioner that scenes have.

use crate::machine::{Machine, machine};
use crate::stopwatch::{Spread, quantile};
use serde::Serialize;
use souple_simulation::{LoadError, PhaseTimes, RunError, RunOptions, Simulation};
use std::time::Instant;
use thiserror::Error;

/// Steps before the measured ones: programs are compiled, caches and predictors meet the data.
const WARM_UP: usize = 3;

/// What fills a generated bar.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Filling {
    /// Elements of one kind, by id.
    Element(String),
    /// Four sections: prisms, pyramids, hexahedra and tetrahedra, with layers of pyramids where faces do not meet.
    Mixed,
}

/// How far systems of equations are solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solve {
    /// By exactly so many iterations of conjugate gradients, without a preconditioner.
    Iterations(usize),
    /// To this relative residual, with the default preconditioner.
    Tolerance(f64),
}

/// A bar to generate.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// What fills it.
    pub filling: Filling,
    /// Ids of laws with Young's modulus and Poisson's ratio, along the bar in equal lengths; at least one.
    pub laws: Vec<String>,
    /// About how many elements.
    pub elements: usize,
    /// How far systems of equations are solved.
    pub solve: Solve,
    /// How the matrix is applied, in the words of scenes: `"auto"`, `"matrix-free"`, `"assembled"`.
    pub operator: String,
}

/// Why nothing was measured.
#[derive(Debug, Error)]
pub enum StepError {
    /// The scene could not be loaded.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A step failed.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The scene ended too soon.
    #[error("the scene ends after {made} steps; {wanted} and {WARM_UP} before them are to be measured: set time.end")]
    Ended {
        /// Steps made.
        made: usize,
        /// Steps wanted.
        wanted: usize,
    },
}

/// Cells of a bar, four times as long as thick, with about so many elements of `per_cell` in each.
fn cells(elements: usize, per_cell: f64) -> [usize; 3] {
    let cells = (elements as f64 / per_cell).max(1.0);
    let thick = (cells / 4.0).cbrt().round().max(1.0);
    let long = (cells / (thick * thick)).round().max(4.0);
    [long as usize, thick as usize, thick as usize]
}

impl Bar {
    /// Its scene.
    pub fn scene(&self) -> String {
        let (per_cell, sections) = match &self.filling {
            Filling::Element(id) => {
                let per_cell = match id.as_str() {
                    name if name.starts_with("tet") || name.starts_with("pyramid") => 6.0,
                    name if name.starts_with("prism") => 2.0,
                    _ => 1.0,
                };
                (per_cell, format!("sections = [{{ until = 1.0, element = \"{id}\" }}]"))
            }
            Filling::Mixed => (
                3.75,
                "transition = \"pyramids\"\nsections = [\n  { until = 0.25, element = \"prism6\" },\n  \
                 { until = 0.5, element = \"pyramid5\" },\n  { until = 0.75, element = \"hex8\" },\n  \
                 { until = 1.0, element = \"tet4\" },\n]"
                    .to_owned(),
            ),
        };
        let [x, y, z] = cells(self.elements, per_cell);
        // Cells are cubes.
        let length = 4.0;
        let thick = length * y as f64 / x as f64;
        let solve = match self.solve {
            Solve::Iterations(count) => {
                format!("preconditioner = \"none\"\ntolerance = 1e-30\nmax_iterations = {count}")
            }
            Solve::Tolerance(tolerance) => format!("tolerance = {tolerance:?}"),
        };
        // A later law replaces an earlier one from where it begins.
        let materials: String = (self.laws.iter().enumerate())
            .map(|(k, law)| {
                let from = length * k as f64 / self.laws.len() as f64;
                let region = match k {
                    0 => "\"all\"".to_owned(),
                    _ => format!("{{ box = {{ min = [{from:?}, 0, 0], max = [{length:?}, {thick:?}, {thick:?}] }} }}"),
                };
                format!("[[body.material]]\nregion = {region}\nlaw = \"{law}\"\nyoung = 1e6\npoisson = 0.3\n")
            })
            .collect();
        format!(
            "title = \"Bar for measuring\"
gravity = [0.0, -9.81, 0.0]

[time]
step = 0.01
end = 1e6

[integrator]
method = \"implicit-euler\"

[linear_solver]
operator = \"{operator}\"
{solve}

[[body]]
name = \"bar\"
density = 1000.0
[body.mesh]
generator = \"bar\"
size = [{length:?}, {thick:?}, {thick:?}]
cells = [{x}, {y}, {z}]
{sections}
{materials}[[body.fix]]
region = \"x_min\"
",
            operator = self.operator,
        )
    }
}

/// Times per step in ms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PhaseSpreads {
    /// Forces.
    pub force: Spread,
    /// Linearisation, with assembly where there is a matrix; none on a graphics device, where forces contain it.
    pub linearise: Option<Spread>,
    /// Products of the linear solver.
    pub product: Spread,
    /// The rest of the linear solver: preconditioner, vectors.
    pub rest_of_solve: Spread,
    /// All else.
    pub other: Spread,
}

/// What was measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// On what.
    pub machine: Machine,
    /// Name of the device.
    pub device: String,
    /// Threads.
    pub threads: usize,
    /// Number of elements.
    pub elements: usize,
    /// Number of unknowns.
    pub unknowns: usize,
    /// Iterations of the linear solver per step, in the median.
    pub iterations: f64,
    /// Time per step in ms.
    pub step_ms: Spread,
    /// 99 of 100 steps took less, in ms.
    pub step_ms_p99: f64,
    /// Where it went; none where a graphics device does not tell the time of its work.
    pub phases_ms: Option<PhaseSpreads>,
}

/// Runs so many steps of a scene after a few that do not count. `read` gives the bytes of mesh files.
///
/// # Errors
/// When the scene cannot be loaded, fails, or ends too soon.
pub fn measure(
    scene: &str,
    file: &str,
    read: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
    options: &RunOptions,
    steps: usize,
    progress: &mut dyn FnMut(&str),
) -> Result<Report, StepError> {
    progress(&format!("loading {file}"));
    let (mut simulation, _) = Simulation::load(scene, file, &[], read, options)?;
    // Watched, a graphics device makes its steps in more pieces: whole steps are measured first, parts in as many after.
    let on_graphics = options.device == "gpu" || options.device.starts_with("gpu:");
    if !on_graphics {
        simulation.watch();
    }
    progress(&format!("{} elements, {steps} steps", simulation.element_count()));
    let mut samples: Vec<(f64, PhaseTimes, usize)> = Vec::with_capacity(steps);
    let mut parts: Vec<(f64, PhaseTimes, usize)> = Vec::new();
    let mut told = true;
    let all = if on_graphics { 2 * steps } else { steps };
    for made in 0..WARM_UP + all {
        if made == WARM_UP + steps {
            simulation.watch();
        }
        let start = Instant::now();
        let advanced = simulation.advance()?;
        let ms = start.elapsed().as_secs_f64() * 1e3;
        let phases = simulation.phases();
        if made >= WARM_UP {
            let sample = (ms, phases.unwrap_or_default(), advanced.cg_iterations);
            if made < WARM_UP + steps {
                samples.push(sample);
            }
            if !on_graphics || made >= WARM_UP + steps {
                told &= phases.is_some();
                parts.push(sample);
            }
        }
        if advanced.finished.is_some() && made + 1 < WARM_UP + all {
            return Err(StepError::Ended { made: made + 1, wanted: all });
        }
    }
    let of = |pick: &dyn Fn(&(f64, PhaseTimes, usize)) -> f64| samples.iter().map(pick).collect::<Vec<f64>>();
    let spread = |pick: &dyn Fn(&(f64, PhaseTimes, usize)) -> f64| Spread::of(&of(pick));
    let part =
        |pick: &dyn Fn(&(f64, PhaseTimes, usize)) -> f64| Spread::of(&parts.iter().map(pick).collect::<Vec<_>>());
    let known = |p: &PhaseTimes| p.force + p.linearise + p.product + p.rest_of_solve;
    let threads = match options.threads {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        n => n,
    };
    Ok(Report {
        machine: machine(),
        device: if on_graphics { simulation.summary().device } else { options.device.clone() },
        threads,
        elements: simulation.element_count(),
        unknowns: simulation.unknowns(),
        iterations: spread(&|s| s.2 as f64).median,
        step_ms: spread(&|s| s.0),
        step_ms_p99: quantile(&of(&|s| s.0), 0.99),
        phases_ms: told.then(|| PhaseSpreads {
            force: part(&|s| s.1.force),
            linearise: (!on_graphics).then(|| part(&|s| s.1.linearise)),
            product: part(&|s| s.1.product),
            rest_of_solve: part(&|s| s.1.rest_of_solve),
            other: part(&|s| (s.0 - known(&s.1)).max(0.0)),
        }),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bar has about as many elements as asked for.
    #[test]
    fn bars_have_about_the_number_of_elements() {
        for (elements, per_cell) in [(1300, 6.0), (10_000, 6.0), (10_000, 1.0), (1_000_000, 6.0)] {
            let [x, y, z] = cells(elements, per_cell);
            let found = (x * y * z) as f64 * per_cell;
            assert!((found / elements as f64 - 1.0).abs() < 0.2, "{elements}: {found}");
        }
    }
}
