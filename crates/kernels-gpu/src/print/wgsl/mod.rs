//! WGSL, the language of WebGPU: <https://www.w3.org/TR/WGSL/>.
//!
//! Logarithms, exponentials and powers are printed as functions of our own (`functions.wgsl`): the language lets a
//! device be wrong by thousands of units in the last place near ln 1, and every device would be wrong differently.

use super::walk::{Dialect, Function};
use super::{Binding, Layout};
use souple_program::{Counts, Program};
use std::fmt::Write as _;

/// The language.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wgsl;

/// Functions that the language has, but not to four units in the last place.
pub const FUNCTIONS: &str = include_str!("functions.wgsl");

impl Dialect for Wgsl {
    fn head(&self, program: &Program, layout: &Layout, bindings: &[Binding], provenance: &[String]) -> String {
        let mut out = String::new();
        comments(&mut out, program, provenance);
        for (number, binding) in bindings.iter().enumerate() {
            let (name, what) = (name(*binding), about(program, *binding));
            let (access, entry) = match binding {
                Binding::Output(_) => ("read_write", "f32"),
                Binding::Rows(_) => ("read", "u32"),
                _ => ("read", "f32"),
            };
            let _ =
                writeln!(out, "@group(0) @binding({number}) var<storage, {access}> {name}: array<{entry}>; // {what}");
        }
        let (lanes, workgroup) = (layout.lanes, layout.workgroup);
        let _ = write!(
            out,
            "\n@compute @workgroup_size({workgroup})\nfn main(\n    @builtin(workgroup_id) workgroup: vec3<u32>,\n    \
             @builtin(num_workgroups) workgroups: vec3<u32>,\n    @builtin(local_invocation_index) invocation: u32,\n) {{\n    \
             let item = (workgroup.y * workgroups.x + workgroup.x) * {workgroup}u + invocation;\n"
        );
        if let Some((k, places)) = measured(program) {
            let _ = writeln!(out, "    if (item >= arrayLength(&out{k}) / {places}u) {{ return; }}");
        }
        if calls_own(program) {
            // See `opaque` in the functions.
            out.push_str("    nothing = workgroups.z - 1u;\n");
        }
        let _ = writeln!(out, "    let group = item / {lanes}u;\n    let lane = item % {lanes}u;");
        out
    }

    fn tail(&self, functions: &[Function]) -> String {
        let own = functions.iter().any(|f| *f != Function::Sqrt);
        if own { format!("}}\n\n{FUNCTIONS}") } else { "}\n".into() }
    }

    fn define(&self, name: &str, value: &str) -> String {
        format!("let {name} = {value};")
    }

    fn define_address(&self, name: &str, value: &str) -> String {
        format!("let {name} = {value};")
    }

    fn accumulator(&self, name: &str) -> String {
        format!("var {name} = 0.0f;")
    }

    fn begin_loop(&self, points: usize) -> String {
        format!("for (var q = 0u; q < {points}u; q++) {{")
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
        format!("fma({a}, {b}, {c})")
    }

    fn call(&self, function: Function, arguments: &[&str]) -> String {
        let name = match function {
            Function::Sqrt => "sqrt",
            Function::Ln => "ln_of",
            Function::Exp => "exp_of",
            Function::Pow => "pow_of",
        };
        format!("{name}({})", arguments.join(", "))
    }
}

/// Whether a program calls a function that the tail defines.
fn calls_own(program: &Program) -> bool {
    use souple_program::Op::{Exp, Ln, Pow};
    let mut statements = program.sections.iter().flat_map(|s| s.statements());
    statements.any(|s| matches!(s.op, Ln(_) | Exp(_) | Pow(..)))
}

/// The first output that has any places, and how many: its length tells how many items there are.
pub(super) fn measured(program: &Program) -> Option<(usize, usize)> {
    let places = |(k, b): (usize, &souple_program::Buffer)| (k, b.total(program.points));
    program.outputs.iter().enumerate().map(places).find(|(_, places)| *places > 0)
}

/// Name of a binding in the text.
pub(super) fn name(binding: Binding) -> String {
    match binding {
        Binding::Uniforms => "uniforms".into(),
        Binding::Rows(t) => format!("rows{t}"),
        Binding::Input(k) => format!("in{k}"),
        Binding::Output(k) => format!("out{k}"),
    }
}

/// What a binding holds, in words.
pub(super) fn about(program: &Program, binding: Binding) -> String {
    match binding {
        Binding::Uniforms => "the same for all items; tables of constants per point".into(),
        Binding::Rows(_) => "numbers of rows".into(),
        Binding::Input(k) => program.inputs[k].name.clone(),
        Binding::Output(k) => program.outputs[k].name.clone(),
    }
}

/// Where the program comes from and what it costs, as comments.
pub(super) fn comments(out: &mut String, program: &Program, provenance: &[String]) {
    for line in provenance {
        let _ = writeln!(out, "// {line}");
    }
    let c = Counts::of(program);
    let _ = writeln!(
        out,
        "// Program `{}`, {} points: {} operations per item ({} per point, {} once; {} functions), {} loads, {} stores.",
        program.name, program.points, c.operations, c.per_point, c.once, c.functions, c.loads, c.stores
    );
    let _ = writeln!(out, "// Printed from the program; change that, not this.\n");
}
