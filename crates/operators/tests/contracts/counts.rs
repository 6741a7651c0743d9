//! What the derived programs cost, with ceilings that must not be broken.

use souple_elements::Element;
use souple_laws::Law;
use souple_operators::{Association, Derived, derive};
use souple_program::{Costs, Counts, Program};
use std::fmt::Write as _;

fn derived(element: &'static Element, law: &str) -> Derived {
    let law = souple_laws::by_id(law).unwrap();
    derive(Association::new(element, law), Costs::default())
}

/// Operations in all, over the number of points of the quadrature, rounded up.
fn per_point(derived: &Derived, program: &Program) -> usize {
    Counts::of(program).operations.div_ceil(derived.association.rule.points.len())
}

/// The golden table of a law: for each element, what is carried, then a line per program.
pub(crate) fn table(law: &Law) -> String {
    let mut out = String::from(
        "# Programs of each element with the default rule, loops rolled.\n\
         # Carried values: once + per point. Programs: operations (per point, rounded up), of which functions.\n",
    );
    for element in souple_elements::all() {
        let d = derived(element, law.id);
        let ((a, b), (c, e)) = (d.staged.setup_to_step, d.staged.step_to_apply);
        let head = format!("{} {} {}", element.id, law.id, d.association.rule.id);
        writeln!(out, "\n{head}: setup to step {a} + {b}, step to apply {c} + {e}").unwrap();
        let mut programs: Vec<&Program> = d.staged.programs.iter().map(|p| &p.program).collect();
        programs.sort_by(|p, q| p.name.cmp(&q.name));
        for program in programs {
            let counts = Counts::of(program);
            let (total, each) = (counts.operations, per_point(&d, program));
            writeln!(out, "  {:<22} {total:>7} ({each}), {}", program.name, counts.functions).unwrap();
        }
    }
    out
}

/// The counts of the linear solids stay below those of a straightforward derivation, which the design set as limits,
/// per quadrature point: carried values, force, tangent product.
#[test]
fn counts_stay_below_their_ceilings() {
    let ceilings = [
        ("tet4", "stvk", 11, 230, 270),
        ("tet4", "hooke", 12, 147, 135),
        ("hex8", "stvk", 26, 375, 414),
        ("prism6", "stvk", 20, 309, 348),
        ("pyramid5", "stvk", 17, 276, 315),
    ];
    for (element, law, carried, force, tangent) in ceilings {
        let d = derived(souple_elements::by_id(element).unwrap(), law);
        let (once, each) = d.staged.setup_to_step;
        assert!(once + each <= carried, "{element} {law} carries {once} + {each} values, not {carried}");
        for (name, ceiling) in [("force", force), ("tangent_apply", tangent)] {
            let found = per_point(&d, d.staged.program(name).unwrap());
            assert!(found <= ceiling, "{element} {law}: {found} operations of `{name}` per point, not {ceiling}");
        }
    }
}
