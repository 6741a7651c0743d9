//! What deriving an association gave: operations, carried values, expressions and programs, for a person or a machine.
//!
//! Nothing is derived here ([`souple_operators::derive()`] does), nothing is printed: everything is a value or a text.
//! The teaching view, from shape functions to forces, is [`latex`].

#[cfg(feature = "gpu")]
mod device_text;
mod explanation;
mod latex;
mod typeset;

#[cfg(feature = "gpu")]
pub use device_text::{Language, device_text};
pub use explanation::explanation;
pub use latex::latex;
pub use souple_forms::Loops;
pub use souple_operators::{Association, Derived, derive};
pub use souple_program::Costs;

use serde::Serialize;
use souple_program::{Counts, Program, Section};
use souple_symbols::print::{Style, definitions};
use souple_symbols::{Expr, Node};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// What can be shown of an association: the six derived outputs, and the set-up.
pub const OUTPUTS: [&str; 7] =
    ["energy", "force", "tangent_apply", "tangent_blocks", "lumped_mass", "shape_mass", "setup"];

/// The programs of an association, in the order in which they run.
pub const PROGRAMS: [&str; 7] =
    ["setup", "energy", "force", "linearise", "tangent_apply", "tangent_apply_uncached", "tangent_blocks"];

/// Numbers about one association. Operations count one per addition or multiplication, two per fused pair.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Id of the element.
    pub element: &'static str,
    /// Number of space dimensions; more than the element's make it a cable or a membrane.
    pub dimension: usize,
    /// Id of the law.
    pub law: &'static str,
    /// Id of the quadrature.
    pub quadrature: &'static str,
    /// Its number of points.
    pub points: usize,
    /// Whether the sum over points stays a loop.
    pub loops: &'static str,
    /// What one program stores for later ones.
    pub carried: Carried,
    /// Operations of each program for the whole element.
    pub operations: BTreeMap<&'static str, usize>,
    /// Operations of each program per quadrature point: of one pass through its loop, or, where nothing loops, the
    /// operations of the whole element divided by the points.
    pub per_point: BTreeMap<&'static str, f64>,
    /// Operations of each program outside its loops.
    pub once: BTreeMap<&'static str, usize>,
    /// Of the operations, divisions, roots and functions.
    pub functions: BTreeMap<&'static str, usize>,
    /// Values read and written by each program for the whole element.
    pub memory: BTreeMap<&'static str, usize>,
    /// Statements of each program, loops not multiplied out: the length of the code.
    pub statements: BTreeMap<&'static str, usize>,
    /// Nodes of the shared graph of expressions.
    pub graph_nodes: usize,
}

/// Values stored by one program for later ones, counted as once + those of one point.
#[derive(Clone, Debug, Serialize)]
pub struct Carried {
    /// From the set-up to steps and applications.
    pub setup_to_step: usize,
    /// From a step to its applications.
    pub step_to_apply: usize,
    /// The same, apart.
    pub detail: CarriedDetail,
}

/// Carried values apart.
#[derive(Clone, Debug, Serialize)]
pub struct CarriedDetail {
    /// From the set-up to steps and applications.
    pub setup_to_step: Crossing,
    /// From a step to its applications.
    pub step_to_apply: Crossing,
}

/// Values that cross the border between two binding times.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Crossing {
    /// Stored once for the element.
    pub once: usize,
    /// Stored for each quadrature point.
    pub per_point: usize,
    /// Stored for the element in all.
    pub per_element: usize,
}

/// Counts everything.
pub fn report(derived: &Derived) -> Report {
    let Association { element, law, rule, loops, dimension } = derived.association;
    let crossing = |(once, per_point): (usize, usize)| Crossing {
        once,
        per_point,
        per_element: once + per_point * rule.points.len(),
    };
    let detail = CarriedDetail {
        setup_to_step: crossing(derived.staged.setup_to_step),
        step_to_apply: crossing(derived.staged.step_to_apply),
    };
    let sum = |c: Crossing| c.once + c.per_point;
    let mut report = Report {
        element: element.id,
        dimension,
        law: law.id,
        quadrature: rule.id,
        points: rule.points.len(),
        loops: match loops {
            Loops::Rolled => "rolled",
            Loops::Unrolled => "unrolled",
        },
        carried: Carried { setup_to_step: sum(detail.setup_to_step), step_to_apply: sum(detail.step_to_apply), detail },
        operations: BTreeMap::new(),
        per_point: BTreeMap::new(),
        once: BTreeMap::new(),
        functions: BTreeMap::new(),
        memory: BTreeMap::new(),
        statements: BTreeMap::new(),
        graph_nodes: derived.definition.graph.len(),
    };
    for (name, program) in programs(derived) {
        let counts = Counts::of(program);
        let looped = program.sections.iter().any(|s| matches!(s, Section::Loop(_)));
        let per_point =
            if looped { counts.per_point as f64 } else { counts.operations as f64 / rule.points.len() as f64 };
        report.operations.insert(name, counts.operations);
        report.per_point.insert(name, per_point);
        report.once.insert(name, counts.once);
        report.functions.insert(name, counts.functions);
        report.memory.insert(name, counts.loads + counts.stores);
        report.statements.insert(name, counts.statements);
    }
    report
}

/// The programs that exist, in the order of [`PROGRAMS`].
fn programs(derived: &Derived) -> impl Iterator<Item = (&'static str, &Program)> {
    PROGRAMS.into_iter().filter_map(|name| derived.staged.program(name).map(|p| (name, p)))
}

/// The numbers of a report as a table for people.
pub fn summary(r: &Report) -> String {
    let mut text = format!(
        "{}{} × {}, quadrature {} ({} point{}, {})\n\n",
        r.element,
        embedding(r),
        r.law,
        r.quadrature,
        r.points,
        if r.points == 1 { "" } else { "s" },
        r.loops
    );
    let mut line = |l: String| {
        text.push_str(l.trim_end());
        text.push('\n');
    };
    line(format!("{:24}{:>8}{:>12}{:>12}", "carried values", "once", "per point", "per element"));
    for (name, c) in
        [("set-up to step", r.carried.detail.setup_to_step), ("step to application", r.carried.detail.step_to_apply)]
    {
        line(format!("  {name:22}{:>8}{:>12}{:>12}", c.once, c.per_point, c.per_element));
    }
    line(String::new());
    line(format!(
        "{:24}{:>8}{:>12}{:>12}{:>11}{:>9}{:>12}",
        "operations", "once", "per point", "per element", "functions", "memory", "statements"
    ));
    for (name, operations) in PROGRAMS.into_iter().filter_map(|n| r.operations.get(n).map(|o| (n, o))) {
        let per_point = r.per_point[name];
        let per_point = if per_point.fract() == 0.0 { format!("{per_point}") } else { format!("{per_point:.1}") };
        line(format!(
            "  {name:22}{:>8}{per_point:>12}{operations:>12}{:>11}{:>9}{:>12}",
            r.once[name], r.functions[name], r.memory[name], r.statements[name]
        ));
    }
    text
}

/// How an element lies in a space of more dimensions; nothing when it fills its space.
fn embedding(r: &Report) -> String {
    let embedded = souple_elements::by_id(r.element).is_some_and(|e| e.dimension() < r.dimension);
    if embedded { format!(" in {} dimensions", r.dimension) } else { String::new() }
}

/// The text of the program that computes an output (or of a program of [`PROGRAMS`] by its own name).
///
/// `None` when there is no such output.
pub fn program_text(derived: &Derived, output: &str) -> Option<String> {
    let name = match output {
        "lumped_mass" | "shape_mass" => "setup",
        other => other,
    };
    derived.staged.program(name).map(souple_program::print)
}

/// An output as named definitions, shared parts first: one `name = formula` per line.
///
/// `None` when there is no such output.
pub fn expressions(derived: &Derived, output: &str) -> Option<String> {
    let roots = roots(derived, output, Style::Text)?;
    let g = &derived.definition.graph;
    let mut text = String::new();
    for (table, values) in tables(derived, &roots) {
        let values: Vec<String> = values.iter().map(f64::to_string).collect();
        writeln!(text, "table{table} = [{}]", values.join(", ")).expect("writing to a string cannot fail");
    }
    for (name, formula) in definitions(g, &roots, Style::Text) {
        writeln!(text, "{name} = {formula}").expect("writing to a string cannot fail");
    }
    Some(text)
}

/// The expressions of an output with their names.
fn roots(derived: &Derived, output: &str, style: Style) -> Option<Vec<(String, Expr)>> {
    let d = &derived.definition;
    let axes = ["x", "y", "z"];
    let name = |base: &str, index: String| match style {
        Style::Text => format!("{base}_{index}"),
        Style::Latex => format!("{base}_{{{index}}}"),
    };
    let nodal = |base: &str, values: &[Expr]| -> Vec<(String, Expr)> {
        let at = |k: usize| name(base, format!("{}{}", k / d.dimension, axes[k % d.dimension]));
        values.iter().enumerate().map(|(k, &e)| (at(k), e)).collect()
    };
    let scalar = |base: &str, values: &[Expr]| -> Vec<(String, Expr)> {
        values.iter().enumerate().map(|(a, &e)| (name(base, a.to_string()), e)).collect()
    };
    Some(match output {
        "energy" => vec![("W".to_owned(), d.energy)],
        "force" => nodal("f", &d.force),
        "tangent_apply" => nodal("df", &d.tangent_apply),
        "tangent_blocks" => {
            let pairs = (0..d.node_count).flat_map(|a| (a..d.node_count).map(move |b| (a, b)));
            let places = pairs.flat_map(|(a, b)| (0..d.dimension * d.dimension).map(move |k| (a, b, k)));
            places
                .zip(&d.tangent_blocks)
                .map(|((a, b, k), &e)| {
                    let (i, j) = (axes[k / d.dimension], axes[k % d.dimension]);
                    (name("K", format!("{a}{i}_{b}{j}")), e)
                })
                .collect()
        }
        "lumped_mass" => scalar("m", &d.lumped_mass),
        "shape_mass" => scalar("M", &d.shape_mass),
        "setup" => [scalar("m", &d.lumped_mass), scalar("M", &d.shape_mass)].concat(),
        _ => return None,
    })
}

/// Tables of constants per point that expressions read: number and values.
fn tables<'d>(derived: &'d Derived, roots: &[(String, Expr)]) -> Vec<(u32, &'d [f64])> {
    let g = &derived.definition.graph;
    let roots: Vec<Expr> = roots.iter().map(|r| r.1).collect();
    let found = g.reachable(&roots).into_iter().filter_map(|e| match g.node(e) {
        Node::Table(t) => Some(*t),
        _ => None,
    });
    let mut numbers: Vec<u32> = found.collect();
    numbers.sort_unstable();
    numbers.dedup();
    numbers.into_iter().map(|t| (t, g.table_values(t))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn derived(element: &str, law: &str, loops: Loops) -> Derived {
        let element = souple_elements::by_id(element).unwrap();
        let law = souple_laws::by_id(law).unwrap();
        derive(Association { loops, ..Association::new(element, law) }, Costs::default())
    }

    /// Operations of the element are those outside the loop plus those of each point, and carried values add up.
    #[test]
    fn counts_add_up() {
        for (element, loops) in [("tet4", Loops::Rolled), ("quad4", Loops::Rolled), ("quad4", Loops::Unrolled)] {
            let r = report(&derived(element, "stvk", loops));
            for name in PROGRAMS {
                let (all, once, each) = (r.operations[name], r.once[name], r.per_point[name]);
                assert!(all > 0, "{element} {name}");
                let looped = once < all;
                let sum = if looped { once as f64 + each * r.points as f64 } else { each * r.points as f64 };
                assert!((sum - all as f64).abs() < 1e-6, "{element} {name}: {sum} {all}");
            }
            let c = r.carried.detail.setup_to_step;
            assert_eq!(c.per_element, c.once + r.points * c.per_point);
            assert_eq!(r.carried.setup_to_step, c.once + c.per_point);
        }
    }

    /// Every output has expressions that end in its own names, and a program text that the parser reads back.
    #[test]
    fn every_output_is_shown() {
        let d = derived("quad4", "stvk", Loops::Rolled);
        for output in OUTPUTS {
            let text = expressions(&d, output).unwrap();
            let (last, _) = roots(&d, output, Style::Text).unwrap().pop().unwrap();
            assert!(text.lines().last().unwrap().starts_with(&format!("{last} = ")), "{output}");
            let program = souple_program::parse(&program_text(&d, output).unwrap()).unwrap();
            souple_program::verify(&program).unwrap();
        }
        assert!(expressions(&d, "stress").is_none() && program_text(&d, "stress").is_none());
    }

    /// A table that a formula reads is written out before it.
    #[test]
    fn tables_are_defined() {
        let text = expressions(&derived("quad4", "hooke", Loops::Rolled), "energy").unwrap();
        let used = text.lines().filter(|l| !l.starts_with("table")).collect::<String>();
        let defined = text.lines().filter(|l| l.starts_with("table"));
        let tables: Vec<&str> = defined.map(|l| l.split(' ').next().unwrap()).collect();
        assert!(!tables.is_empty() && tables.iter().all(|t| used.contains(t)), "{text}");
    }
}
