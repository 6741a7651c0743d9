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

/// Roundoff of a kind of number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precision {
    /// Distance from 1 to the next number.
    pub epsilon: f64,
    /// Smallest normal number.
    pub smallest: f64,
    /// Largest number.
    pub largest: f64,
}

impl Precision {
    /// `f64`.
    pub const DOUBLE: Precision = Precision { epsilon: f64::EPSILON, smallest: f64::MIN_POSITIVE, largest: f64::MAX };
    /// `f32`.
    pub const SINGLE: Precision =
        Precision { epsilon: f32::EPSILON as f64, smallest: f32::MIN_POSITIVE as f64, largest: f32::MAX as f64 };
}

/// Outputs of a program for one item in doubles; see [`run_in`].
pub fn run(program: &Program, inputs: &[Vec<f64>]) -> Vec<Vec<Bounded>> {
    run_in(program, inputs, Precision::DOUBLE)
}

/// Outputs of a program for one item, [buffer][point][place] (one point for buffers that are not per point).
///
/// `inputs` is [buffer][point][place] likewise. Values are computed in `f64`; the bound is that of a backend that rounds
/// every constant and every operation to `precision`, and infinite where it may overflow.
pub fn run_in(program: &Program, inputs: &[Vec<f64>], precision: Precision) -> Vec<Vec<Bounded>> {
    evaluate(program, inputs, precision, &mut |value, _| value)
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
        let moved = evaluate(program, inputs, Precision::DOUBLE, &mut disturb);
        for (value, moved) in outputs.iter_mut().flatten().zip(moved.iter().flatten()) {
            value.error = value.error.max(MARGIN * (moved.value - value.value).abs());
        }
    }
    outputs
}

/// `disturb` is given the result of each operation that rounds, and gives what goes on.
fn evaluate(
    program: &Program,
    inputs: &[Vec<f64>],
    p: Precision,
    disturb: &mut dyn FnMut(f64, &Op) -> f64,
) -> Vec<Vec<Bounded>> {
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
                    Op::Constant(c) => constant(p, c),
                    Op::Input { buffer, index } => {
                        let b = &program.inputs[buffer];
                        exact(inputs[buffer][if b.per_point { point * b.len + index } else { index }])
                    }
                    Op::Table(t) => constant(p, program.tables[t][point]),
                    Op::Add(a, b) => sum(p, v(a), v(b), 1.0),
                    Op::Sub(a, b) => sum(p, v(a), v(b), -1.0),
                    Op::Mul(a, b) => product(p, v(a), v(b)),
                    Op::Neg(a) => Bounded { value: -v(a).value, error: v(a).error },
                    Op::MulAdd(a, b, c) => sum(p, product(p, v(a), v(b)), v(c), 1.0),
                    Op::MulSub(a, b, c) => sum(p, product(p, v(a), v(b)), v(c), -1.0),
                    Op::NegMulAdd(a, b, c) => sum(p, v(c), product(p, v(a), v(b)), -1.0),
                    Op::Recip(a) => {
                        let value = 1.0 / v(a).value;
                        function(p, value, v(a).error * value * value, v(a))
                    }
                    Op::Sqrt(a) => {
                        let value = v(a).value.sqrt();
                        function(p, value, 0.5 * v(a).error / value, v(a))
                    }
                    Op::Ln(a) => function(p, v(a).value.ln(), v(a).error / v(a).value.abs(), v(a)),
                    Op::Exp(a) => power(p, v(a).value.exp(), v(a).error),
                    Op::Pow(a, b) => {
                        let (base, exponent) = (v(a), v(b));
                        let by_base = (exponent.value / base.value).abs() * base.error;
                        let by_exponent = base.value.ln().abs() * exponent.error;
                        let value = base.value.powf(exponent.value);
                        // A negative base has a power only where the exponent is a whole number, to the last digit.
                        let defined = base.value > 0.0 || exponent.error == 0.0;
                        let uncertain = base.error > 0.1 * base.value.abs() || !defined;
                        let logarithm = if exponent.error == 0.0 { by_base } else { by_base + by_exponent };
                        power(p, value, if uncertain { f64::INFINITY } else { logarithm })
                    }
                    Op::Accumulator => exact(0.0),
                    Op::Accumulate { a, .. } => sum(p, v(into(s)), v(a), 1.0),
                    Op::AccumulateProduct { a, b, .. } => sum(p, v(into(s)), product(p, v(a), v(b)), 1.0),
                    Op::AccumulateNegProduct { a, b, .. } => sum(p, v(into(s)), product(p, v(a), v(b)), -1.0),
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

/// A constant, which only doubles hold exactly.
fn constant(p: Precision, value: f64) -> Bounded {
    if p == Precision::DOUBLE { Bounded { value, error: 0.0 } } else { rounded(p, value, 0.0) }
}

fn rounded(p: Precision, value: f64, error: f64) -> Bounded {
    let error = error * (1.0 + 4.0 * p.epsilon) + value.abs() * p.epsilon + p.smallest;
    let overflows = value.abs() + error > p.largest;
    Bounded { value, error: if overflows { f64::INFINITY } else { error } }
}

fn sum(p: Precision, a: Bounded, b: Bounded, sign: f64) -> Bounded {
    rounded(p, a.value + sign * b.value, a.error + b.error)
}

fn product(p: Precision, a: Bounded, b: Bounded) -> Bounded {
    let error = a.error * b.value.abs() + b.error * a.value.abs() + a.error * b.error;
    rounded(p, a.value * b.value, error)
}

/// A function value whose first-order error is given; doubled for the higher orders, and infinite where the argument
/// is so uncertain that the first order means nothing.
fn function(p: Precision, value: f64, error: f64, argument: Bounded) -> Bounded {
    let uncertain = argument.error > 0.1 * argument.value.abs();
    let error = if uncertain { f64::INFINITY } else { 2.0 * error };
    let bounded = rounded(p, value, error);
    Bounded { value, error: bounded.error + 4.0 * p.epsilon * value.abs() }
}

/// An exponential whose logarithm has an error: first order doubled, and infinite where that means nothing.
fn power(p: Precision, value: f64, error: f64) -> Bounded {
    let error = if error > 0.1 { f64::INFINITY } else { 2.0 * error * value.abs() };
    let bounded = rounded(p, value, error);
    Bounded { value, error: bounded.error + 4.0 * p.epsilon * value.abs() }
}
