//! Different programs for the same thing agree: with and without carried values, with and without loops.

use crate::sample::{Case, SECTION, Sample, associations, distorted, parameters};
use souple_elements::Element;
use souple_forms::Loops;
use souple_kernels::conformance::Random;
use souple_kernels::oracle::{self, Bounded};
use souple_laws::Law;
use souple_operators::{Association, Derived, derive};
use souple_program::{Costs, LINEARISE, Program, SETUP};
use std::collections::BTreeMap;

/// What one item reads: leaves by buffer name, and carried values as they are computed.
pub(crate) type Item = BTreeMap<String, Vec<f64>>;

/// A random item of an association: a distorted element with displacements and a direction.
pub(crate) fn item(element: &Element, law: &Law, space: usize, random: &mut Random) -> Item {
    let rest: Vec<f64> = distorted(element, space, random).iter().flat_map(|x| x[..space].to_vec()).collect();
    let mut vector = |size: f64| -> Vec<f64> { rest.iter().map(|_| random.between(-size, size)).collect() };
    let (displacement, direction) = (vector(0.02), vector(1.0));
    Item::from([
        ("rest".to_string(), rest),
        ("parameters".to_string(), parameters(law)),
        ("density".to_string(), vec![1.3]),
        ("section".to_string(), vec![0.7]),
        ("displacement".to_string(), displacement),
        ("direction".to_string(), direction),
    ])
}

/// The input buffers of a program, in its order.
pub(crate) fn inputs(program: &Program, item: &Item) -> Vec<Vec<f64>> {
    let values = |name: &str| item.get(name).unwrap_or_else(|| panic!("{}: who gives `{name}`?", program.name)).clone();
    program.inputs.iter().map(|b| values(&b.name)).collect()
}

/// Runs all programs of an association in order of time, adding carried values to the item; outputs by program and
/// buffer.
pub(crate) fn run_all(derived: &Derived, item: &mut Item) -> BTreeMap<(String, String), Vec<Bounded>> {
    let mut all = BTreeMap::new();
    // Set-up before steps before applications; among the steps, who reads what a step carried comes later anyway.
    for staged in &derived.staged.programs {
        let program = &staged.program;
        let outputs = oracle::run(program, &inputs(program, item));
        for (buffer, values) in program.outputs.iter().zip(outputs) {
            if [SETUP, LINEARISE].contains(&program.name.as_str()) && buffer.name.ends_with("values") {
                item.insert(buffer.name.clone(), values.iter().map(|v| v.value).collect());
            }
            all.insert((program.name.clone(), buffer.name.clone()), values);
        }
    }
    all
}

/// A buffer that the set-up of a sample's association carries, for an element at `rest`.
pub(crate) fn carried_from_setup(sample: &Sample, rest: &[f64], buffer: &str) -> Vec<f64> {
    let (_, derived) = sample.elements.blocks().next().unwrap();
    let mut item = Item::from([
        ("rest".to_string(), rest.to_vec()),
        ("parameters".to_string(), parameters(sample.law)),
        ("density".to_string(), vec![sample.density]),
        ("section".to_string(), vec![SECTION]),
    ]);
    let program = derived.staged.program(SETUP).unwrap();
    let outputs = oracle::run(program, &inputs(program, &item));
    for (b, values) in program.outputs.iter().zip(outputs) {
        item.insert(b.name.clone(), values.iter().map(|v| v.value).collect());
    }
    item[buffer].clone()
}

fn derived((element, law, rule, dimension): Case, loops: Loops, costs: Costs) -> Derived {
    derive(Association { element, law, rule, loops, dimension }, costs)
}

fn assert_agree(what: &str, a: &[Bounded], b: &[Bounded]) {
    assert_eq!(a.len(), b.len(), "{what}: lengths");
    let scale = a.iter().fold(0.0_f64, |m, v| m.max(v.value.abs()));
    for (k, (x, y)) in a.iter().zip(b).enumerate() {
        // Where terms of size one cancel (an energy near rest), their rounding is more than that.
        let rounding = (x.error + y.error).max(8.0 * f64::EPSILON);
        let close = (x.value - y.value).abs() <= (1e-12 * scale).max(rounding);
        assert!(close, "{what}: entry {k} is {:e} and {:e}, scale {scale:e}", x.value, y.value);
    }
}

/// Tangent products with and without the values carried from the linearisation agree; so do the forces of the two
/// programs that give them.
#[test]
fn carried_values_change_nothing() {
    let mut random = Random::new(11);
    for case in associations() {
        let (element, law, rule, space) = case;
        let derived = derived(case, Loops::Rolled, Costs::default());
        let all = run_all(&derived, &mut item(element, law, space, &mut random));
        let of = |program: &str, buffer: &str| &all[&(program.to_string(), buffer.to_string())];
        let what = format!("{} / {} / {}", element.id, law.id, rule.id);
        let cached = of("tangent_apply", "tangent_apply");
        assert_agree(&what, cached, of("tangent_apply_uncached", "tangent_apply"));
        assert_agree(&what, of("force", "force"), of(LINEARISE, "force"));
    }
}

/// Programs with a loop over the points and programs with every point written out agree.
#[test]
fn rolled_and_unrolled_loops_agree() {
    let mut random = Random::new(12);
    let mut compared = 0;
    for case in associations() {
        let (element, law, rule, space) = case;
        // Unrolled programs of large elements take minutes; they are the same code over more nodes.
        let size = element.node_count() * rule.points.len();
        let limit = if ["hooke", "stvk"].contains(&law.id) { 80 } else { 32 };
        if size > limit || rule.points.len() == 1 {
            continue;
        }
        let start = item(element, law, space, &mut random);
        let run = |loops| run_all(&derived(case, loops, Costs::default()), &mut start.clone());
        let (rolled, unrolled) = (run(Loops::Rolled), run(Loops::Unrolled));
        for (key, values) in &rolled {
            if key.1.ends_with("values") {
                continue;
            }
            let what = format!("{} / {} / {}: {key:?}", element.id, law.id, rule.id);
            let other = &unrolled[key];
            // What is the same at all points is given once by a loop, and for each point without one.
            let repeated: Vec<Bounded> = values.iter().copied().cycle().take(other.len()).collect();
            assert_eq!(other.len() % values.len(), 0, "{what}: lengths");
            assert_agree(&what, &repeated, other);
        }
        compared += 1;
    }
    assert!(compared >= 30, "{compared} associations");
}

/// What storing costs changes what is carried, and no result.
#[test]
fn costs_change_no_result() {
    let mut random = Random::new(13);
    for &element in souple_elements::all().iter().filter(|e| e.degree == 1) {
        for &law in souple_laws::all() {
            let rule = element.default_rule();
            let start = item(element, law, element.dimension(), &mut random);
            let case = (element, law, rule, element.dimension());
            let run = |carry| run_all(&derived(case, Loops::Rolled, Costs { carry }), &mut start.clone());
            let (cheap, dear) = (run(0), run(1000));
            for (key, values) in cheap.iter().filter(|(k, _)| !k.1.ends_with("values")) {
                assert_agree(&format!("{} / {}: {key:?}", element.id, law.id), values, &dear[key]);
            }
        }
    }
}
