//! Programs as Rust source.
//!
//! One statement is one line; order and operations are those of the program, so that what a compiler adds is scheduling
//! and registers alone. Straight sections are straight, loops are loops over the points.

use souple_program::{Op, Program, Section, Statement, Value};
use std::fmt::Write as _;
use thiserror::Error;

/// Why a program cannot be printed.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum PrintError {
    /// An operation that explicit vectors lack.
    #[error("the program `{program}` calls {what}, which explicit vectors do not have; print another program")]
    Function {
        /// Name of the program.
        program: String,
        /// Which function.
        what: &'static str,
    },
}

/// How an input arrives.
#[derive(Clone, Copy, PartialEq)]
enum Arrival {
    Gathered,
    Uniform,
    Lanes,
}

fn arrival(name: &str) -> Arrival {
    match name {
        "rest" | "displacement" | "direction" => Arrival::Gathered,
        "parameters" | "density" | "section" => Arrival::Uniform,
        _ => Arrival::Lanes,
    }
}

/// The source of a module with one function, `run`, of the type in [`Ahead`](super::Ahead).
///
/// # Errors
/// When the program calls a function that explicit vectors lack.
pub fn rust(element: &str, law: &str, program: &Program) -> Result<String, PrintError> {
    let mut body = String::new();
    for section in &program.sections {
        match section {
            Section::Straight(statements) => lines(&mut body, program, statements, Place::Straight)?,
            Section::Loop(statements) => {
                writeln!(body, "                for point in 0..{} {{", program.points).expect(INFALLIBLE);
                lines(&mut body, program, statements, Place::Loop)?;
                body.push_str("                }\n");
            }
        }
    }
    let mut buffers = String::new();
    let mut each = String::new();
    let points = program.points;
    for (k, b) in program.inputs.iter().enumerate() {
        let n = b.len;
        let (whole, of_group) = match (arrival(&b.name), b.per_point) {
            (Arrival::Gathered, _) => (
                format!("let (values{k}, rows{k}) = gathered::<{}>(&inputs[{k}]);", n / 3),
                format!("let in{k} = gather::<S, {}>(values{k}, &rows{k}[group], part);", n / 3),
            ),
            (Arrival::Uniform, _) => (
                format!(
                    "let Input::Uniform(in{k}) = inputs[{k}] else {{ unreachable!(\"the batch gives parameters uniformly\") }};"
                ),
                String::new(),
            ),
            (Arrival::Lanes, false) => {
                (format!("let all{k} = lanes::<{n}>(&inputs[{k}]);"), format!("let in{k} = &all{k}[group];"))
            }
            (Arrival::Lanes, true) => (
                format!("let all{k} = lanes_at_points::<{n}, {points}>(&inputs[{k}]);"),
                format!("let in{k} = &all{k}[group];"),
            ),
        };
        writeln!(buffers, "        {whole}").expect(INFALLIBLE);
        if !of_group.is_empty() {
            writeln!(each, "                {of_group}").expect(INFALLIBLE);
        }
    }
    buffers.push_str("        let mut outputs = outputs.iter_mut();\n");
    for (k, b) in program.outputs.iter().enumerate() {
        let kind = if b.per_point {
            format!("places_at_points::<{}, {points}>", b.len)
        } else {
            format!("places::<{}>", b.len)
        };
        let next = "outputs.next().expect(\"the caller gives every output\")";
        writeln!(buffers, "        let whole{k} = {kind}({next});").expect(INFALLIBLE);
        writeln!(each, "                let out{k} = &mut whole{k}[group];").expect(INFALLIBLE);
    }
    let tables: Vec<String> = program.tables.iter().map(|t| format!("{t:?}")).collect();
    let tables = match tables.len() {
        0 => String::new(),
        n => format!(
            "\n/// Constants per point, [table][point].\nconst TABLES: [[f64; {points}]; {n}] = [{}];\n",
            tables.join(", ")
        ),
    };
    let imports = imports(program);
    Ok(format!(
        "//! The program `{name}` of {element} with {law}. Printed by a test, never edited (see the module above).

use crate::ahead::{{Call, {imports}}};
use crate::vectors::{{Vectors, {loads}parts, store}};
use pulp::{{Simd, WithSimd}};
{uniform}{tables}
/// Runs the program.
pub(super) fn run(vectors: Vectors, call: Call<'_, '_>) {{
    vectors.run(Work(call));
}}

struct Work<'a, 'b>(Call<'a, 'b>);

impl WithSimd for Work<'_, '_> {{
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {{
        let Call {{ groups, inputs, outputs }} = self.0;
{buffers}        for group in 0..groups {{
            for part in 0..parts::<S>() {{
{each}{body}            }}
        }}
    }}
}}
",
        name = program.name,
        uniform = if program.inputs.iter().any(|b| arrival(&b.name) == Arrival::Uniform) {
            "use souple_kernels::Input;\n"
        } else {
            ""
        },
        loads = if program.inputs.iter().any(|b| arrival(&b.name) == Arrival::Lanes) { "load, " } else { "" },
    ))
}

const INFALLIBLE: &str = "writing to a string cannot fail";

/// What the module uses of the one above it.
fn imports(program: &Program) -> String {
    let mut names = Vec::new();
    let mut add = |wanted: bool, found: &[&'static str]| {
        if wanted {
            names.extend_from_slice(found);
        }
    };
    let inputs = |a: Arrival, per_point: Option<bool>| {
        program.inputs.iter().any(|b| arrival(&b.name) == a && per_point.is_none_or(|p| p == b.per_point))
    };
    let outputs = |per_point| program.outputs.iter().any(|b| b.per_point == per_point);
    add(inputs(Arrival::Gathered, None), &["gather", "gathered"]);
    add(inputs(Arrival::Lanes, Some(false)), &["lanes"]);
    add(inputs(Arrival::Lanes, Some(true)), &["lanes_at_points"]);
    add(outputs(false), &["places"]);
    add(outputs(true), &["places_at_points"]);
    names.join(", ")
}

/// Where a statement stands.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    Straight,
    Loop,
}

fn lines(out: &mut String, program: &Program, statements: &[Statement], place: Place) -> Result<(), PrintError> {
    let indent = if place == Place::Loop { 20 } else { 16 };
    for s in statements {
        writeln!(out, "{:indent$}{}", "", line(program, s)?).expect(INFALLIBLE);
    }
    Ok(())
}

fn line(p: &Program, s: &Statement) -> Result<String, PrintError> {
    let v = |v: Value| format!("v{}", v.0);
    let function = |what| Err(PrintError::Function { program: p.name.clone(), what });
    // Buffers per point are only met in loops, where `point` is known.
    let at = |kind: &str, b: usize, per_point: bool, index: usize| {
        if per_point { format!("{kind}{b}[point][{index}]") } else { format!("{kind}{b}[{index}]") }
    };
    let right = match s.op {
        Op::Constant(c) => format!("simd.splat_f64s({c:?})"),
        Op::Input { buffer, index } => {
            let b = &p.inputs[buffer];
            match arrival(&b.name) {
                Arrival::Gathered => format!("in{buffer}[{}][{}]", index / 3, index % 3),
                Arrival::Uniform => format!("simd.splat_f64s(in{buffer}[{index}])"),
                Arrival::Lanes => format!("load::<S>(&{}, part)", at("in", buffer, b.per_point, index)),
            }
        }
        Op::Table(t) => format!("simd.splat_f64s(TABLES[{t}][point])"),
        Op::Add(a, b) => format!("simd.add_f64s({}, {})", v(a), v(b)),
        Op::Sub(a, b) => format!("simd.sub_f64s({}, {})", v(a), v(b)),
        Op::Mul(a, b) => format!("simd.mul_f64s({}, {})", v(a), v(b)),
        Op::Neg(a) => format!("simd.neg_f64s({})", v(a)),
        Op::MulAdd(a, b, c) => format!("simd.mul_add_f64s({}, {}, {})", v(a), v(b), v(c)),
        Op::MulSub(a, b, c) => format!("simd.mul_add_f64s({}, {}, simd.neg_f64s({}))", v(a), v(b), v(c)),
        Op::NegMulAdd(a, b, c) => format!("simd.mul_add_f64s(simd.neg_f64s({}), {}, {})", v(a), v(b), v(c)),
        Op::Recip(a) => format!("simd.div_f64s(simd.splat_f64s(1.0), {})", v(a)),
        Op::Sqrt(a) => format!("simd.sqrt_f64s({})", v(a)),
        Op::Ln(_) => return function("ln"),
        Op::Exp(_) => return function("exp"),
        Op::Pow(..) => return function("pow"),
        Op::Accumulator => return Ok(format!("let mut {} = simd.splat_f64s(0.0);", v(s.value))),
        Op::Accumulate { into, a } => return Ok(format!("{0} = simd.add_f64s({0}, {1});", v(into), v(a))),
        Op::AccumulateProduct { into, a, b } => {
            return Ok(format!("{0} = simd.mul_add_f64s({1}, {2}, {0});", v(into), v(a), v(b)));
        }
        Op::AccumulateNegProduct { into, a, b } => {
            return Ok(format!("{0} = simd.mul_add_f64s(simd.neg_f64s({1}), {2}, {0});", v(into), v(a), v(b)));
        }
        Op::Output { buffer, index, a } => {
            let place = at("out", buffer, p.outputs[buffer].per_point, index);
            return Ok(format!("store::<S>(&mut {place}, part, {});", v(a)));
        }
    };
    Ok(format!("let {} = {right};", v(s.value)))
}
