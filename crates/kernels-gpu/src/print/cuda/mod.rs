//! CUDA C, the second language that programs are printed in: it shows that a language is one folder, and its compiler
//! reads what the walk prints with other eyes than WGSL's.
//!
//! Nothing runs it here. Its logarithm, exponential and power are right to a few units in the last place (CUDA C++
//! Programming Guide, "Mathematical Functions"), so that it needs no functions of ours.

use super::walk::{Dialect, Function};
use super::wgsl::{about, comments, measured, name};
use super::{Binding, Layout};
use souple_program::Program;
use std::fmt::Write as _;

/// The language.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cuda;

impl Dialect for Cuda {
    fn head(&self, program: &Program, layout: &Layout, bindings: &[Binding], provenance: &[String]) -> String {
        let mut out = String::new();
        comments(&mut out, program, provenance);
        let _ = writeln!(out, "extern \"C\" __global__ void __launch_bounds__({}) run(", layout.workgroup);
        for binding in bindings {
            let entry = match binding {
                Binding::Output(_) => "float *__restrict__",
                Binding::Rows(_) => "const unsigned *__restrict__",
                _ => "const float *__restrict__",
            };
            let _ = writeln!(out, "    {entry} {}, // {}", name(*binding), about(program, *binding));
        }
        let lanes = layout.lanes;
        let _ = write!(
            out,
            "    unsigned items\n) {{\n    const unsigned item = blockIdx.x * blockDim.x + threadIdx.x;\n    \
             if (item >= items) return;\n    const unsigned group = item / {lanes}u;\n    \
             const unsigned lane = item % {lanes}u;\n"
        );
        if measured(program).is_none() {
            out.push_str("    // Nothing is written.\n");
        }
        out
    }

    fn tail(&self, _: &[Function]) -> String {
        "}\n".into()
    }

    fn define(&self, name: &str, value: &str) -> String {
        format!("const float {name} = {value};")
    }

    fn define_address(&self, name: &str, value: &str) -> String {
        format!("const unsigned {name} = {value};")
    }

    fn accumulator(&self, name: &str) -> String {
        format!("float {name} = 0.0f;")
    }

    fn begin_loop(&self, points: usize) -> String {
        format!("for (unsigned q = 0u; q < {points}u; q++) {{")
    }

    fn constant(&self, value: f32) -> String {
        format!("{value:?}f")
    }

    fn load(&self, binding: Binding, address: &str) -> String {
        format!("{}[{address}]", name(binding))
    }

    fn store(&self, output: usize, address: &str, value: &str) -> String {
        format!("out{output}[{address}] = {value};")
    }

    fn multiply_add(&self, a: &str, b: &str, c: &str) -> String {
        format!("fmaf({a}, {b}, {c})")
    }

    fn call(&self, function: Function, arguments: &[&str]) -> String {
        let name = match function {
            Function::Sqrt => "sqrtf",
            Function::Ln => "logf",
            Function::Exp => "expf",
            Function::Pow => "powf",
        };
        format!("{name}({})", arguments.join(", "))
    }
}
