//! What is known early is computed early.

use crate::sample::with_default_rules;
use souple_operators::{Association, Derived, derive};
use souple_program::{Costs, verify};

fn rolled(element: &'static souple_elements::Element, law: &'static souple_laws::Law, carry: u64) -> Derived {
    derive(Association::new(element, law), Costs { carry })
}

/// The tangent of a linear law depends on no state, whatever storing costs: nothing is carried from a step, and its
/// programs read no displacement.
#[test]
fn tangents_of_linear_laws_are_known_at_set_up() {
    let hooke = souple_laws::by_id("hooke").unwrap();
    for element in souple_elements::all() {
        for carry in [0, 6] {
            let derived = rolled(element, hooke, carry);
            assert_eq!(derived.staged.step_to_apply, (0, 0), "{} at {carry}", element.id);
            for name in ["tangent_apply", "tangent_apply_uncached", "tangent_blocks"] {
                let program = derived.staged.program(name).unwrap();
                assert_eq!(program.input("displacement"), None, "{} {name}", element.id);
            }
        }
    }
}

/// Free storage leaves an application nothing to compute but products with the direction: at most one multiplication
/// and one addition for each entry of the element's stiffness matrix in factored form.
#[test]
fn free_storage_saves_operations_in_each_application() {
    let stvk = souple_laws::by_id("stvk").unwrap();
    for element in souple_elements::all().iter().filter(|e| e.node_count() <= 10) {
        let operations = |carry| {
            let derived = rolled(element, stvk, carry);
            souple_program::Counts::of(derived.staged.program("tangent_apply").unwrap()).operations
        };
        let (free, usual, dear) = (operations(0), operations(6), operations(1000));
        assert!(free <= usual && usual <= dear, "{}: {free}, {usual}, {dear}", element.id);
    }
}

/// Rest positions and parameters are read by set-up programs only, and a direction by applications only; every program
/// is valid.
#[test]
fn programs_read_what_is_known_at_their_time() {
    for (element, law, _) in with_default_rules() {
        for staged in &rolled(element, law, 6).staged.programs {
            let program = &staged.program;
            verify(program).unwrap_or_else(|e| panic!("{} / {}: {e}", element.id, law.id));
            let apply = program.name.starts_with("tangent_apply");
            assert_eq!(program.input("direction").is_some(), apply, "{} {}", element.id, program.name);
            if ["force", "energy", "linearise", "tangent_apply"].contains(&program.name.as_str()) {
                assert_eq!(program.input("rest"), None, "{} {}", element.id, program.name);
            }
        }
    }
}
