//! The suite that every backend passes: programs of all shapes against the [oracle](crate::oracle), within the error
//! bound that the oracle computes.
//!
//! A backend crate instantiates it with one line: `souple_kernels::conformance!(MyBackend::open());`

use crate::oracle::Precision;
use crate::{Backend, CompileError, Input, Kernel, LANES, Number, Scratch, oracle};
use souple_program::{Buffer, Op, Program, Section, Statement, Value, parse, print};

/// A small generator of pseudo-random numbers (xorshift64*), the same on every machine.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Starts from a seed.
    pub fn new(seed: u64) -> Random {
        Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// A whole number below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        ((self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33) as usize) % n
    }

    /// A number in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.below(1 << 30) as f64 / (1u64 << 30) as f64
    }
}

/// A valid program of random operations: straight, or with one or two loops.
pub fn random_program(random: &mut Random, operations: usize) -> Program {
    let points = 1 + random.below(5);
    let loops = random.below(3);
    let mut p = Program {
        name: "random".into(),
        points,
        inputs: vec![
            Buffer { name: "a".into(), len: 4, per_point: false },
            Buffer { name: "b".into(), len: 3, per_point: true },
            Buffer { name: "g".into(), len: 6, per_point: false },
        ],
        outputs: vec![Buffer { name: "once".into(), len: 3, per_point: false }],
        tables: vec![(0..points).map(|q| 0.5 + q as f64).collect()],
        sections: Vec::new(),
        value_count: 0,
    };
    if loops > 0 {
        p.outputs.push(Buffer { name: "each".into(), len: 2, per_point: true });
    }
    let mut next = 0;
    let mut everywhere: Vec<Value> = Vec::new();
    let mut statements: Vec<Statement> = Vec::new();
    let mut define = |list: &mut Vec<Statement>, op: Op| {
        list.push(Statement { value: Value(next), op });
        next += 1;
        Value(next - 1)
    };
    let effect = |op| Statement { value: Value(u32::MAX), op };
    for (buffer, len) in [(0, 4), (2, 6)] {
        for index in 0..len {
            everywhere.push(define(&mut statements, Op::Input { buffer, index }));
        }
    }
    everywhere.push(define(&mut statements, Op::Constant(-1.25)));
    let part = operations / (loops + 1);
    for _ in 0..part {
        let op = random_op(random, &everywhere);
        everywhere.push(define(&mut statements, op));
    }
    for l in 0..loops {
        let accumulators: Vec<Value> = (0..2).map(|_| define(&mut statements, Op::Accumulator)).collect();
        p.sections.push(Section::Straight(std::mem::take(&mut statements)));
        let mut body = Vec::new();
        let mut known = everywhere.clone();
        for index in 0..3 {
            known.push(define(&mut body, Op::Input { buffer: 1, index }));
        }
        known.push(define(&mut body, Op::Table(0)));
        for _ in 0..part {
            let op = random_op(random, &known);
            known.push(define(&mut body, op));
        }
        let pick = |random: &mut Random| known[known.len() - 1 - random.below(4.min(known.len()))];
        let (a, b) = (pick(random), pick(random));
        body.push(effect(Op::Accumulate { into: accumulators[0], a }));
        body.push(effect(Op::AccumulateProduct { into: accumulators[1], a, b }));
        body.push(effect(Op::AccumulateNegProduct { into: accumulators[0], a: b, b: a }));
        if l == 0 {
            body.push(effect(Op::Output { buffer: 1, index: 0, a }));
            body.push(effect(Op::Output { buffer: 1, index: 1, a: b }));
        }
        p.sections.push(Section::Loop(body));
        everywhere.extend(accumulators);
    }
    for index in 0..3 {
        let a = everywhere[everywhere.len() - 1 - index];
        statements.push(effect(Op::Output { buffer: 0, index, a }));
    }
    p.sections.push(Section::Straight(statements));
    p.value_count = next as usize;
    p
}

/// A random operation on known values; functions get arguments that they are defined for only by chance, which is as
/// it should be: infinities and NaN must come out the same.
fn random_op(random: &mut Random, known: &[Value]) -> Op {
    // Recent values are likelier: long chains, and values that stay alive for long.
    let mut v = || {
        let n = known.len();
        if random.below(3) == 0 { known[random.below(n)] } else { known[n - 1 - random.below(n.min(12))] }
    };
    let (a, b, c) = (v(), v(), v());
    match random.below(24) {
        0..=5 => Op::Add(a, b),
        6..=9 => Op::Sub(a, b),
        10..=14 => Op::Mul(a, b),
        15 => Op::Neg(a),
        16..=17 => Op::MulAdd(a, b, c),
        18 => Op::MulSub(a, b, c),
        19 => Op::NegMulAdd(a, b, c),
        20 => Op::Recip(a),
        21 => Op::Sqrt(a),
        22 => [Op::Ln(a), Op::Exp(a)][random.below(2)],
        _ => Op::Pow(a, b),
    }
}

/// How an input of a test arrives.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Uniform,
    Lanes,
    /// In rows of this length.
    Gathered(usize),
}

impl Kind {
    /// Any way in which a buffer of this length can arrive: rows have a length that divides it.
    fn any(len: usize, random: &mut Random) -> Kind {
        match random.below(4) {
            0 => Kind::Uniform,
            1 => Kind::Lanes,
            _ => {
                let widths: Vec<usize> = (1..=len).filter(|w| len.is_multiple_of(*w)).collect();
                Kind::Gathered(widths[random.below(widths.len())])
            }
        }
    }
}

/// Compares a backend with the oracle on one program, with inputs that arrive in any way.
///
/// # Panics
/// When a value differs by more than the oracle's bound; the message holds the program's text.
pub fn compare(backend: &dyn Backend, program: &Program, random: &mut Random) {
    let kernel = backend.compile(program).unwrap_or_else(|e| panic!("{e}\n{}", print(program)));
    compare_kernel(&backend.about().name, &*kernel, Precision::DOUBLE, program, random);
}

/// The same in single precision; false when the backend has none.
///
/// # Panics
/// When a value differs by more than the oracle's bound for singles, or when the program is refused for another reason.
pub fn compare_singles(backend: &dyn Backend, program: &Program, random: &mut Random) -> bool {
    let kernel = match backend.compile_singles(program) {
        Ok(kernel) => kernel,
        Err(CompileError::Unsupported { .. }) => return false,
        Err(e) => panic!("{e}\n{}", print(program)),
    };
    let name = format!("{} in singles", backend.about().name);
    compare_kernel(&name, &*kernel, Precision::SINGLE, program, random);
    true
}

fn compare_kernel<T: Number>(
    name: &str,
    kernel: &dyn Kernel<T>,
    precision: Precision,
    program: &Program,
    random: &mut Random,
) {
    let groups = 1 + random.below(11);
    let items = groups * LANES;
    let points = program.points;
    let kinds: Vec<Kind> = program.inputs.iter().map(|b| Kind::any(b.len, random)).collect();
    let mut data: Vec<Vec<T>> = Vec::new();
    let mut rows: Vec<Vec<u32>> = Vec::new();
    for (kind, b) in kinds.iter().zip(&program.inputs) {
        let total = b.total(points);
        let (count, row_count) = match kind {
            Kind::Uniform => (total, 0),
            Kind::Lanes => (items * total, 0),
            Kind::Gathered(width) => (items * width, items * (total / width)),
        };
        data.push((0..count).map(|_| T::from_f64(random.between(-2.0, 2.0))).collect());
        rows.push((0..row_count).map(|_| random.below(items) as u32).collect());
    }
    let inputs: Vec<Input<'_, T>> = (0..kinds.len())
        .map(|k| match kinds[k] {
            Kind::Uniform => Input::Uniform(&data[k]),
            Kind::Lanes => Input::Lanes(&data[k]),
            Kind::Gathered(width) => Input::Gathered { values: &data[k], rows: &rows[k], width },
        })
        .collect();
    let nan = T::from_f64(f64::NAN);
    let mut outputs: Vec<Vec<T>> = program.outputs.iter().map(|b| vec![nan; items * b.total(points)]).collect();
    let mut slices: Vec<&mut [T]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
    kernel.run(&mut Scratch::default(), groups, &inputs, &mut slices);
    for item in 0..items {
        let (group, lane) = (item / LANES, item % LANES);
        let own: Vec<Vec<f64>> = program
            .inputs
            .iter()
            .enumerate()
            .map(|(k, b)| {
                let n = b.total(points);
                (0..n)
                    .map(|row| match kinds[k] {
                        Kind::Uniform => data[k][row].to_f64(),
                        Kind::Lanes => data[k][(group * n + row) * LANES + lane].to_f64(),
                        Kind::Gathered(w) => {
                            let index = rows[k][(group * (n / w) + row / w) * LANES + lane] as usize;
                            data[k][index * w + row % w].to_f64()
                        }
                    })
                    .collect()
            })
            .collect();
        let expected = oracle::run_in(program, &own, precision);
        for ((b, want), got) in program.outputs.iter().zip(&expected).zip(&outputs) {
            let n = b.total(points);
            for (row, w) in want.iter().enumerate() {
                let g = got[(group * n + row) * LANES + lane].to_f64();
                let same = (g - w.value).abs() <= w.error || (!w.error.is_finite()) || !w.value.is_finite();
                assert!(
                    same,
                    "{name}: item {item}, {}[{row}] is {g:e}, the oracle says {:e} ± {:e}\n{}",
                    b.name,
                    w.value,
                    w.error,
                    print(program)
                );
            }
        }
    }
}

/// `count` random programs of growing length.
pub fn random_programs(backend: &dyn Backend, seed: u64, count: usize) {
    let mut random = Random::new(seed);
    for k in 0..count {
        let program = random_program(&mut random, 4 + (k * 7) % 120);
        compare(backend, &program, &mut random);
    }
}

/// `count` random programs in single precision, where the backend has it.
pub fn random_programs_in_singles(backend: &dyn Backend, seed: u64, count: usize) {
    let mut random = Random::new(seed);
    for k in 0..count {
        let program = random_program(&mut random, 4 + (k * 7) % 120);
        if !compare_singles(backend, &program, &mut random) {
            return;
        }
    }
}

/// Programs with hundreds of values alive at once, in single precision.
pub fn long_programs_in_singles(backend: &dyn Backend, seed: u64) {
    let mut random = Random::new(seed);
    for length in [500, 1500] {
        let program = random_program(&mut random, length);
        assert!(compare_singles(backend, &program, &mut random), "{} has singles", backend.about().name);
    }
}

/// An invalid program is refused with an error in single precision too.
pub fn invalid_is_refused_in_singles(backend: &dyn Backend) {
    assert!(backend.compile_singles(&invalid()).is_err());
}

/// Long programs: hundreds of values alive at once must be spilled correctly.
pub fn long_programs(backend: &dyn Backend, seed: u64) {
    let mut random = Random::new(seed);
    for length in [500, 1500, 3000] {
        let program = random_program(&mut random, length);
        compare(backend, &program, &mut random);
    }
}

/// The text form loses nothing: a program printed and parsed runs the same.
pub fn text_round_trip(backend: &dyn Backend, seed: u64) {
    let mut random = Random::new(seed);
    for _ in 0..20 {
        let program = random_program(&mut random, 60);
        let back = parse(&print(&program)).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(back, program);
        compare(backend, &back, &mut random);
    }
}

/// An invalid program is refused with an error, not run.
pub fn invalid_is_refused(backend: &dyn Backend) {
    assert!(backend.compile(&invalid()).is_err());
}

/// A program that reads a value before it is defined.
fn invalid() -> Program {
    let text = "program bad\npoints 1\noutput o 1\nstraight\n  v1 = v0 + v0\n  output o[0] = v1\nend\n";
    parse(text).unwrap_or_else(|e| panic!("{e}"))
}

/// Instantiates the suite for a backend that has singles only and is not on every machine:
/// `conformance_in_singles!(expression that gives an optional backend)`. Tests pass where there is none.
#[macro_export]
macro_rules! conformance_in_singles {
    ($backend:expr) => {
        /// Random programs in single precision agree with the oracle.
        #[test]
        fn singles_agree_with_the_oracle() {
            let Some(backend) = $backend else { return };
            $crate::conformance::random_programs_in_singles(&backend, 4, 120);
        }

        /// Programs with many live values agree with the oracle.
        #[test]
        fn long_programs_agree_with_the_oracle() {
            let Some(backend) = $backend else { return };
            $crate::conformance::long_programs_in_singles(&backend, 2);
        }

        /// An invalid program is refused.
        #[test]
        fn invalid_programs_are_refused() {
            let Some(backend) = $backend else { return };
            $crate::conformance::invalid_is_refused_in_singles(&backend);
        }
    };
}

/// Instantiates the suite for a backend: `conformance!(expression that gives a backend)`.
#[macro_export]
macro_rules! conformance {
    ($backend:expr) => {
        /// Random programs agree with the oracle within its bound.
        #[test]
        fn random_programs_agree_with_the_oracle() {
            $crate::conformance::random_programs(&$backend, 1, 300);
        }

        /// Random programs in single precision agree with the oracle, or the backend says that it has none.
        #[test]
        fn singles_agree_with_the_oracle() {
            $crate::conformance::random_programs_in_singles(&$backend, 4, 300);
        }

        /// Programs with many live values agree with the oracle.
        #[test]
        fn long_programs_agree_with_the_oracle() {
            $crate::conformance::long_programs(&$backend, 2);
        }

        /// Text form and back runs the same.
        #[test]
        fn text_form_runs_the_same() {
            $crate::conformance::text_round_trip(&$backend, 3);
        }

        /// An invalid program is refused.
        #[test]
        fn invalid_programs_are_refused() {
            $crate::conformance::invalid_is_refused(&$backend);
        }
    };
}

#[cfg(test)]
mod tests {
    crate::conformance!(crate::Interpreter::default());
}
