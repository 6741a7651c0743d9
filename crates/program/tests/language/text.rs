//! The text form loses nothing.

use souple_kernels::conformance::{Random, random_program};
use souple_program::{Op, Program, Section, Statement, Value, parse, print};

/// Programs of random operations come back equal, and print the same again.
#[test]
fn random_programs_come_back() {
    let mut random = Random::new(41);
    for length in 0..200 {
        let program = random_program(&mut random, length);
        let text = print(&program);
        let back = parse(&text).unwrap_or_else(|e| panic!("{e}\n{text}"));
        assert_eq!(back, program);
        assert_eq!(print(&back), text);
    }
}

/// Constants come back to the last bit: zeros with their sign, subnormal numbers, limits, infinities; and NaN as NaN.
#[test]
fn special_constants_come_back() {
    let specials = [
        0.0,
        -0.0,
        0.1,
        -1.0 / 3.0,
        f64::MIN_POSITIVE,
        5e-324,
        f64::MAX,
        f64::MIN,
        f64::EPSILON,
        1e22,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
    ];
    let statement = |k: usize, c: f64| Statement { value: Value(k as u32), op: Op::Constant(c) };
    let program = Program {
        name: "constants".into(),
        points: specials.len(),
        inputs: Vec::new(),
        outputs: Vec::new(),
        tables: vec![specials.to_vec()],
        sections: vec![Section::Straight(specials.iter().enumerate().map(|(k, &c)| statement(k, c)).collect())],
        value_count: specials.len(),
    };
    let back = parse(&print(&program)).unwrap();
    let same = |a: f64, b: f64| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
    assert!(back.tables[0].iter().zip(&specials).all(|(&a, &b)| same(a, b)), "{:?}", back.tables[0]);
    for (s, &c) in back.sections[0].statements().iter().zip(&specials) {
        let Op::Constant(found) = s.op else { panic!("{:?} is no constant", s.op) };
        assert!(same(found, c), "{found:?} was {c:?}");
    }
}

/// Blank lines, comments and other indentation mean nothing.
#[test]
fn layout_means_nothing() {
    let tight = "program p\npoints 1\noutput o 1\nstraight\n  v0 = 2.5\n  output o[0] = v0\nend\n";
    let loose =
        "# about\n\nprogram  p\npoints 1\n   output o 1\nstraight\nv0   =  2.5\n# why\n\toutput o[0] = v0\n\nend";
    assert_eq!(parse(tight), parse(loose));
    assert_eq!(print(&parse(loose).unwrap()), tight);
}
