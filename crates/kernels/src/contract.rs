//! The contract between programs and what runs them.

use souple_program::{Program, VerifyError};
use std::sync::Arc;
use thiserror::Error;

/// Items per group: one 512-bit vector of doubles.
pub const LANES: usize = 8;

/// What a backend says of itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct About {
    /// The name by which it is opened (`"interpreter"`, `"cpu"`).
    pub name: String,
    /// What it runs on, in words (`"AVX-512, 8 doubles per operation"`).
    pub description: String,
}

/// Why a program could not be compiled.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum CompileError {
    /// The program breaks the rules of the language.
    #[error(transparent)]
    Invalid(#[from] VerifyError),
    /// The backend lacks something that the program needs.
    #[error("the backend `{backend}` cannot run the program `{program}`: it lacks {capability}")]
    Unsupported {
        /// Name of the backend.
        backend: String,
        /// Name of the program.
        program: String,
        /// What is missing.
        capability: String,
    },
}

/// Where a kernel reads one input buffer of doubles, or of singles.
#[derive(Clone, Copy, Debug)]
pub enum Input<'a, T = f64> {
    /// In lane order: [group][place][lane], or [group][point][place][lane] for a per-point buffer.
    Lanes(&'a [T]),
    /// From rows of a shared array: place `p` of a lane is `values[width · index + p mod width]` with `index` at
    /// [group][p / width][lane] of `rows`.
    Gathered {
        /// The shared array, [row][width].
        values: &'a [T],
        /// Which rows, [group][row place][lane].
        rows: &'a [u32],
        /// Length of a row.
        width: usize,
    },
    /// The same values for every item.
    Uniform(&'a [T]),
}

/// Memory that a kernel works in. Make one per thread, reuse it.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    /// Vectors of lanes.
    pub slots: Vec<[f64; LANES]>,
    /// Vectors of lanes of kernels in singles.
    pub singles: Vec<[f32; LANES]>,
}

/// A program made executable, on doubles or on singles.
pub trait Kernel<T = f64>: Send + Sync {
    /// The program that it runs.
    fn program(&self) -> &Program;

    /// Runs `groups` groups.
    ///
    /// `inputs` and `outputs` follow the order of the program's buffers and hold exactly these groups; every place of
    /// every output is written.
    ///
    /// # Panics
    /// When a buffer is shorter than the groups need.
    fn run(&self, scratch: &mut Scratch, groups: usize, inputs: &[Input<'_, T>], outputs: &mut [&mut [T]]);
}

/// Compiles programs for one kind of device.
pub trait Backend: Send + Sync {
    /// What it is.
    fn about(&self) -> &About;

    /// Makes a program executable.
    ///
    /// # Errors
    /// When the program is not valid or needs what the backend lacks.
    fn compile(&self, program: &Program) -> Result<Arc<dyn Kernel>, CompileError>;

    /// Makes a program executable in single precision: inputs, outputs and all arithmetic are `f32`, constants are
    /// rounded.
    ///
    /// # Errors
    /// When the program is not valid or the backend has no singles, which is what it says unless it overrides this.
    fn compile_singles(&self, program: &Program) -> Result<Arc<dyn Kernel<f32>>, CompileError> {
        Err(CompileError::Unsupported {
            backend: self.about().name.clone(),
            program: program.name.clone(),
            capability: "arithmetic in single precision".into(),
        })
    }
}
