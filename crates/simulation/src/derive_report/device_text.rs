//! Programs in the languages of graphics devices, as they are run there.

use super::Derived;
use souple_kernels_gpu::print::{Access, Dialect, Layout, Loops, PrintError, cuda::Cuda, print, wgsl::Wgsl};

/// A language of devices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// WGSL, of WebGPU.
    Wgsl,
    /// CUDA C.
    Cuda,
}

/// The text of the program that computes an output (or of a program by its own name): its provenance and operation count
/// stand in its head.
///
/// `None` when there is no such output.
///
/// # Errors
/// When a constant does not fit single precision.
pub fn device_text(derived: &Derived, output: &str, language: Language) -> Result<Option<String>, PrintError> {
    let name = match output {
        "lumped_mass" | "shape_mass" => "setup",
        other => other,
    };
    let Some(program) = derived.staged.program(name) else { return Ok(None) };
    let a = &derived.association;
    let nodes = a.element.node_count();
    let access = |b: &souple_program::Buffer| match b.name.as_str() {
        "displacement" | "direction" | "rest" => Access::Gathered { width: b.len / nodes, table: 0 },
        "parameters" | "density" | "section" => Access::Uniform,
        _ => Access::Lanes,
    };
    let inputs = program.inputs.iter().map(access).collect();
    let layout = Layout { lanes: 64, workgroup: 64, inputs, loops: Loops::Rolled };
    let provenance = [
        format!("Derived from the element {} and the law {}: {}.", a.element.id, a.law.id, a.law.formula),
        format!("Quadrature {}, {} points, {} dimensions.", a.rule.id, a.rule.points.len(), a.dimension),
    ];
    let dialect: &dyn Dialect = match language {
        Language::Wgsl => &Wgsl,
        Language::Cuda => &Cuda,
    };
    print(program, &layout, dialect, &provenance).map(|printed| Some(printed.source))
}
