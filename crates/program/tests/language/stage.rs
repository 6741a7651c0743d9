//! Cut and lowering through [`stage`]: programs of different times together give what the expressions say.

use souple_kernels::oracle;
use souple_program::{BufferRequest, Costs, Counts, OutputRequest, Section, Staged, stage, verify};
use souple_symbols::{Expr, Graph, Time};
use std::collections::BTreeMap;

fn buffer(name: &str, leaves: &[Expr]) -> BufferRequest {
    BufferRequest { name: name.into(), leaves: leaves.to_vec() }
}

fn output(program: &str, time: Time, values: &[Expr]) -> OutputRequest {
    OutputRequest { program: program.into(), time, name: program.into(), values: values.to_vec(), cached: true }
}

/// Runs all programs in order; values of all buffers by name.
fn run(staged: &Staged, inputs: &[(&str, Vec<f64>)]) -> BTreeMap<String, Vec<f64>> {
    let mut known: BTreeMap<String, Vec<f64>> = inputs.iter().map(|(n, v)| (n.to_string(), v.clone())).collect();
    for p in &staged.programs {
        verify(&p.program).unwrap();
        let own: Vec<Vec<f64>> = p.program.inputs.iter().map(|b| known[&b.name].clone()).collect();
        for (b, values) in p.program.outputs.iter().zip(oracle::run(&p.program, &own)) {
            known.insert(b.name.clone(), values.iter().map(|v| v.value).collect());
        }
    }
    known
}

/// A product A v whose matrix costs much to make: cheap storage makes it once, dear storage makes it each time from the
/// little that it depends on, and the results are the same.
#[test]
fn what_is_carried_follows_from_the_costs() {
    let mut g = Graph::new();
    let p = g.symbol("p", Time::Setup);
    let v: Vec<Expr> = (0..4).map(|k| g.symbol(format!("v_{k}"), Time::Apply)).collect();
    let product: Vec<Expr> = (0..4)
        .map(|i| {
            let terms: Vec<Expr> = (0..4)
                .map(|j| {
                    let power = g.powi(p, 3 * i + j + 2);
                    let entry = g.exp(power);
                    g.mul(entry, v[j as usize])
                })
                .collect();
            g.sum(&terms)
        })
        .collect();
    let staged = |carry| {
        let inputs = [buffer("p", &[p]), buffer("v", &v)];
        stage(&g, &inputs, &[output("product", Time::Apply, &product)], Costs { carry })
    };
    let functions = |s: &Staged| Counts::of(s.program("product").unwrap()).functions;
    let (cheap, dear) = (staged(1), staged(1_000_000));
    assert_eq!(functions(&cheap), 0, "all entries are stored");
    assert_eq!(dear.setup_to_step, (1, 0), "nothing but p itself is stored");
    assert!(functions(&dear) >= 10);
    let inputs = [("p", vec![0.4]), ("v", vec![1.0, -2.0, 0.5, 3.0])];
    let (a, b) = (run(&cheap, &inputs), run(&dear, &inputs));
    for (x, y) in a["product"].iter().zip(&b["product"]) {
        assert!((x - y).abs() <= 1e-13 * x.abs(), "{x:e} and {y:e}");
    }
}

/// A linear map is known before the step: with cheap storage nothing is carried from the step to an application.
#[test]
fn a_linear_map_carries_nothing_from_the_step() {
    let mut g = Graph::new();
    let a = g.symbol("a", Time::Setup);
    let u = g.symbol("u", Time::Step);
    let v = g.symbol("v", Time::Apply);
    let squared = g.powi(a, 2);
    let (force, applied) = (g.mul(squared, u), g.mul(squared, v));
    let inputs = [buffer("a", &[a]), buffer("u", &[u]), buffer("v", &[v])];
    let outputs = [output("force", Time::Step, &[force]), output("product", Time::Apply, &[applied])];
    let staged = stage(&g, &inputs, &outputs, Costs { carry: 0 });
    assert_eq!((staged.setup_to_step, staged.step_to_apply), ((1, 0), (0, 0)));
    assert_eq!(staged.program("product").unwrap().input("u"), None);
    let found = run(&staged, &[("a", vec![3.0]), ("u", vec![2.0]), ("v", vec![-1.0])]);
    assert_eq!((found["force"][0], found["product"][0]), (18.0, -9.0));
}

/// A point sum inside another one: the outer loop comes after the inner one, and both give what evaluation says.
#[test]
fn nested_point_sums_become_two_loops() {
    let mut g = Graph::with_points(3);
    let [x, y] = ["x", "y"].map(|n| g.symbol(n, Time::Step));
    let (t, w) = (g.table(&[0.5, -1.0, 2.0]), g.table(&[1.0, 3.0, 0.25]));
    let tx = g.mul(t, x);
    let inner_term = g.add(tx, y);
    let inner_term = g.powi(inner_term, 2);
    let inner = g.point_sum(inner_term);
    let difference = g.sub(inner, tx);
    let outer_term = g.product(&[w, difference, difference]);
    let outer = g.point_sum(outer_term);
    let result = g.sub(outer, inner);
    let inputs = [buffer("x", &[x, y])];
    let staged = stage(&g, &inputs, &[output("result", Time::Step, &[result, inner])], Costs::default());
    let program = staged.program("result").unwrap();
    let loops = program.sections.iter().filter(|s| matches!(s, Section::Loop(_))).count();
    assert_eq!(loops, 2);
    let values = [0.7, -1.3];
    let found = run(&staged, &[("x", values.to_vec())]);
    let expected = g.evaluate(&[result, inner], &[(x, values[0]), (y, values[1])]);
    for (f, e) in found["result"].iter().zip(&expected) {
        assert!((f - e).abs() <= 1e-13 * e.abs(), "{f:e}, expected {e:e}");
    }
    // By hand: Σ (t x + y)² over t = 0.5, −1, 2.
    let by_hand = (-0.95_f64).powi(2) + (-2.0_f64).powi(2) + 0.1_f64.powi(2);
    assert!((found["result"][1] - by_hand).abs() < 1e-14, "{}", found["result"][1]);
}

/// Values that vary over the points are carried per point and written per point.
#[test]
fn varying_values_are_carried_per_point() {
    let mut g = Graph::with_points(4);
    let p = g.symbol("p", Time::Setup);
    let u = g.symbol("u", Time::Step);
    let t = g.table(&[1.0, 2.0, 3.0, 5.0]);
    let tp = g.mul(t, p);
    let entry = g.exp(tp);
    let each = g.mul(entry, u);
    let total = g.point_sum(each);
    let inputs = [buffer("p", &[p]), buffer("u", &[u])];
    let outputs = [output("each", Time::Step, &[each]), output("total", Time::Step, &[total])];
    let staged = stage(&g, &inputs, &outputs, Costs { carry: 1 });
    // The entries, one per point; and their sum, since u leaves the sum over the points.
    assert_eq!(staged.setup_to_step, (1, 1));
    let found = run(&staged, &[("p", vec![0.1]), ("u", vec![2.0])]);
    let expected: Vec<f64> = [1.0, 2.0, 3.0, 5.0].iter().map(|t: &f64| 2.0 * (0.1 * t).exp()).collect();
    for (f, e) in found["each"].iter().zip(&expected) {
        assert!((f - e).abs() <= 1e-14 * e, "{f:e}, expected {e:e}");
    }
    let sum: f64 = expected.iter().sum();
    assert!((found["total"][0] - sum).abs() <= 1e-14 * sum);
}
