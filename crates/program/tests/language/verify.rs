//! Violations that have no text form; those that have one are in `filetests/verify`.

use souple_program::{Op, Program, Section, Statement, Value, parse, verify};

fn valid() -> Program {
    let text = "program p\npoints 1\ninput a 1\noutput o 1\nstraight\n  v0 = input a[0]\n  output o[0] = v0\nend\n";
    let program = parse(text).unwrap();
    verify(&program).unwrap();
    program
}

fn violation(change: impl Fn(&mut Program)) -> String {
    let mut program = valid();
    change(&mut program);
    verify(&program).unwrap_err().to_string()
}

fn statements(p: &mut Program) -> &mut Vec<Statement> {
    let Section::Straight(s) = &mut p.sections[0] else { panic!("a straight section") };
    s
}

/// Numbers of buffers and values that do not exist are refused by name of program and place.
#[test]
fn numbers_without_meaning_are_refused() {
    assert_eq!(
        violation(|p| statements(p)[0].op = Op::Input { buffer: 3, index: 0 }),
        "program `p`, section 0, statement 0: there is no input 3"
    );
    assert_eq!(
        violation(|p| statements(p)[1].op = Op::Output { buffer: 1, index: 0, a: Value(0) }),
        "program `p`, section 0, statement 1: there is no output 1"
    );
    assert_eq!(
        violation(|p| p.value_count = 0),
        "program `p`, section 0, statement 0: v0 is not below the declared count of values"
    );
}
