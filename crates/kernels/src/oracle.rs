//! The oracle: one item at a time, one operation at a time, in plain `f64`, with a bound on the rounding error of every
//! value.
//!
//! The bound covers any order of rounding that a backend may choose (fused or separate multiply-adds, functions that
//! are right to four units in the last place), so that a comparison needs no tolerance of taste.
//! Where such a bound says nothing, [`spread`] estimates the error from random roundings.

use souple_program::{Op, Program, Section, Statement};

/// A value and how far a correct backend may be from it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounded {
    /// The value.
    pub value: f64,
    /// Bound on the absolute error of any correct evaluation.
    pub error: f64,
}

/// Outputs of a program for one item, [buffer][point][place] (one point for buffers that are not per point).
///
/// `inputs` is [buffer][point][place] likewise.
pub fn run(program: &Program, inputs: &[Vec<f64>]) -> Vec<Vec<Bounded>> {
    evaluate(program, inputs, &mut |value, _| value)
}

/// Relative errors of the roundings that [`spread`] tries, in units of [`f64::EPSILON`], at most.
const ROUNDING: f64 = 1.0;
/// The same for functions.
const FUNCTION: f64 = 4.0;
/// How many times [`spread`] tries.
const TRIES: u64 = 8;
/// What the largest deviation found is multiplied with for those that were not.
const MARGIN: f64 = 40.0;

/// As [`run`], with an estimate in place of the bound: how far outputs move when every operation is rounded at random.
///
/// For programs whose intermediate values depend on roundings much more than their results do. An iteration that
/// corrects itself is one: each step adds to the bound what the next steps take away again.
pub fn spread(program: &Program, inputs: &[Vec<f64>]) -> Vec<Vec<Bounded>> {
    let mut outputs = run(program, inputs);
    for values in &mut outputs {
        let largest = values.iter().fold(0.0, |m: f64, v| m.max(v.value.abs()));
        values.iter_mut().for_each(|v| v.error = 8.0 * f64::EPSILON * largest);
    }
    for seed in 0..TRIES {
        let mut random = crate::conformance::Random::new(seed);
        let mut disturb = |value: f64, op: &Op| {
            let size = match op {
                Op::Recip(_) | Op::Sqrt(_) | Op::Ln(_) | Op::Exp(_) | Op::Pow(..) => FUNCTION,
                _ => ROUNDING,
            };
            value * (1.0 + size * f64::EPSILON * random.between(-1.0, 1.0))
        };
        let moved = evaluate(program, inputs, &mut disturb);
        for (value, moved) in outputs.iter_mut().flatten().zip(moved.iter().flatten()) {
            value.error = value.error.max(MARGIN * (moved.value - value.value).abs());
        }
    }
    outputs
}

/// `disturb` is given the result of each operation that rounds, and gives what goes on.
fn evaluate(program: &Program, inputs: &[Vec<f64>], disturb: &mut dyn FnMut(f64, &Op) -> f64) -> Vec<Vec<Bounded>> {
    let exact = |value: f64| Bounded { value, error: 0.0 };
    let mut outputs: Vec<Vec<Bounded>> =
        program.outputs.iter().map(|b| vec![Bounded::default(); b.total(program.points)]).collect();
    let mut values = vec![Bounded::default(); program.value_count];
    for section in &program.sections {
        let (statements, passes) = match section {
            Section::Straight(s) => (s, 1),
            Section::Loop(s) => (s, program.points),
        };
        for point in 0..passes {
            for s in statements {
                let v = |v: souple_program::Value| values[v.index()];
                let result = match s.op {
                    Op::Constant(c) => exact(c),
                    Op::Input { buffer, index } => {
                        let b = &program.inputs[buffer];
                        exact(inputs[buffer][if b.per_point { point * b.len + index } else { index }])
                    }
                    Op::Table(t) => exact(program.tables[t][point]),
                    Op::Add(a, b) => sum(v(a), v(b), 1.0),
                    Op::Sub(a, b) => sum(v(a), v(b), -1.0),
                    Op::Mul(a, b) => product(v(a), v(b)),
                    Op::Neg(a) => Bounded { value: -v(a).value, error: v(a).error },
                    Op::MulAdd(a, b, c) => sum(product(v(a), v(b)), v(c), 1.0),
                    Op::MulSub(a, b, c) => sum(product(v(a), v(b)), v(c), -1.0),
                    Op::NegMulAdd(a, b, c) => sum(v(c), product(v(a), v(b)), -1.0),
                    Op::Recip(a) => {
                        let value = 1.0 / v(a).value;
                        function(value, v(a).error * value * value, v(a))
                    }
                    Op::Sqrt(a) => {
                        let value = v(a).value.sqrt();
                        function(value, 0.5 * v(a).error / value, v(a))
                    }
                    Op::Ln(a) => function(v(a).value.ln(), v(a).error / v(a).value.abs(), v(a)),
                    Op::Exp(a) => {
                        let value = v(a).value.exp();
                        function(value, v(a).error * value, v(a))
                    }
                    Op::Pow(a, b) => {
                        let value = v(a).value.powf(v(b).value);
                        let by_base = (v(b).value * value / v(a).value).abs() * v(a).error;
                        let by_exponent = (value * v(a).value.ln()).abs() * v(b).error;
                        function(value, by_base + by_exponent, v(a))
                    }
                    Op::Accumulator => exact(0.0),
                    Op::Accumulate { a, .. } => sum(v(into(s)), v(a), 1.0),
                    Op::AccumulateProduct { a, b, .. } => sum(v(into(s)), product(v(a), v(b)), 1.0),
                    Op::AccumulateNegProduct { a, b, .. } => sum(v(into(s)), product(v(a), v(b)), -1.0),
                    Op::Output { buffer, index, a } => {
                        let b = &program.outputs[buffer];
                        outputs[buffer][if b.per_point { point * b.len + index } else { index }] = v(a);
                        continue;
                    }
                };
                let rounds =
                    !matches!(s.op, Op::Constant(_) | Op::Input { .. } | Op::Table(_) | Op::Accumulator | Op::Neg(_));
                let value = if rounds { disturb(result.value, &s.op) } else { result.value };
                values[into(s).index()] = Bounded { value, ..result };
            }
        }
    }
    outputs
}

/// Where the result of a statement goes: the accumulator of those that have one.
fn into(s: &Statement) -> souple_program::Value {
    match s.op {
        Op::Accumulate { into, .. } | Op::AccumulateProduct { into, .. } | Op::AccumulateNegProduct { into, .. } => {
            into
        }
        _ => s.value,
    }
}

fn rounded(value: f64, error: f64) -> Bounded {
    Bounded { value, error: error * (1.0 + 4.0 * f64::EPSILON) + value.abs() * f64::EPSILON + f64::MIN_POSITIVE }
}

fn sum(a: Bounded, b: Bounded, sign: f64) -> Bounded {
    rounded(a.value + sign * b.value, a.error + b.error)
}

fn product(a: Bounded, b: Bounded) -> Bounded {
    let error = a.error * b.value.abs() + b.error * a.value.abs() + a.error * b.error;
    rounded(a.value * b.value, error)
}

/// A function value whose first-order error is given; doubled for the higher orders, and infinite where the argument
/// is so uncertain that the first order means nothing.
fn function(value: f64, error: f64, argument: Bounded) -> Bounded {
    let uncertain = argument.error > 0.1 * argument.value.abs();
    let error = if uncertain { f64::INFINITY } else { 2.0 * error };
    let bounded = rounded(value, error);
    Bounded { value, error: bounded.error + 4.0 * f64::EPSILON * value.abs() }
}
