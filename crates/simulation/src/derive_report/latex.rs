//! The teaching view of an association: a small LaTeX document that goes from displacements to forces, step by step.
//!
//! ```text
//! N_a, u_a ──► H = Σ u_a ⊗ ∇N_a ──► F ──► strain ──► ψ ──► P = ∂ψ/∂H ──► W = Σ_q ψ dV ──► f_a = −∂W/∂u_a
//! ```
//!
//! Every formula is printed from the expressions that the programs are made of; none is typed here, except the general
//! definitions between them.

use super::typeset::{align, formula, row, text};
use super::{Association, Derived, roots, tables};
use souple_laws::Kinematics;
use souple_symbols::print::{Style, definitions, expression};
use souple_symbols::{Expr, Graph, Matrix, Time};

const AXES: [&str; 3] = ["x", "y", "z"];

/// The document. It needs only `amsmath` and is plain enough for any LaTeX of the last twenty years.
pub fn latex(derived: &Derived) -> String {
    let Association { element, law, rule, .. } = derived.association;
    let (name, law_name) = (text(element.id), text(law.name));
    let sections = [
        shape_functions(derived),
        displacement_gradient(derived),
        strain(derived),
        energy_density(derived),
        stress(derived),
        energy(derived),
        force(derived),
    ];
    let references: Vec<String> = law.references.iter().map(|r| format!("\\item {}\n", text(r))).collect();
    let references = if references.is_empty() {
        String::new()
    } else {
        format!("\\section*{{References}}\n\\begin{{itemize}}\n{}\\end{{itemize}}\n", references.concat())
    };
    format!(
        "\\documentclass[10pt]{{article}}\n\
         \\usepackage[utf8]{{inputenc}}\n\
         \\usepackage[T1]{{fontenc}}\n\
         \\usepackage[a3paper,landscape,margin=15mm]{{geometry}}\n\
         \\usepackage{{amsmath}}\n\
         \\allowdisplaybreaks\n\
         \\title{{From displacements to forces: {name} with the law of {law_name}}}\n\
         \\author{{}}\n\\date{{}}\n\
         \\begin{{document}}\n\\maketitle\n\
         {name}: {} of {} nodes; quadrature {} of {} point{}.\n{}\n\
         Auxiliary quantities $t_0, t_1, \\dots$ name what a formula uses more than once; each section has its own.\n\n\
         {}{references}\\end{{document}}\n",
        element.family.name(),
        element.node_count(),
        text(rule.id),
        rule.points.len(),
        if rule.points.len() == 1 { "" } else { "s" },
        text(law.about),
        sections.concat(),
    )
}

/// The element's shape functions in a graph of their own, with the reference coordinates.
struct Reference {
    graph: Graph,
    xi: [Expr; 3],
    shape: Vec<Expr>,
}

fn reference(derived: &Derived) -> Reference {
    let mut graph = Graph::new();
    let xi = ["xi", "eta", "zeta"].map(|name| graph.symbol(name, Time::Derive));
    let shape = (derived.association.element.shape)(&mut graph, xi);
    Reference { graph, xi, shape }
}

fn shape_functions(derived: &Derived) -> String {
    let Reference { graph, shape, .. } = reference(derived);
    let rows: Vec<String> = shape
        .iter()
        .enumerate()
        .map(|(a, &n)| row(&format!("N_{{{a}}}"), &expression(&graph, n, Style::Latex)))
        .collect();
    format!(
        "\\section{{Displacements}}\n\
         Inside the element, rest positions and displacements are interpolated from the nodes $a$ with the shape functions\n\
         $N_a$ of the reference coordinates $\\boldsymbol\\xi = ({})$:\n\
         \\begin{{equation*}}\n  \\mathbf{{X}} = \\sum_a N_a \\mathbf{{X}}_a, \\qquad \\mathbf{{u}} = \\sum_a N_a \\mathbf{{u}}_a\n\
         \\end{{equation*}}\n{}",
        coordinates(derived.definition.dimension).join(", "),
        align(&rows)
    )
}

fn coordinates(dimension: usize) -> &'static [&'static str] {
    &["\\xi", "\\eta", "\\zeta"][..dimension]
}

fn displacement_gradient(derived: &Derived) -> String {
    let d = derived.association.element.dimension();
    let Reference { mut graph, xi, shape } = reference(derived);
    let mut rows = Vec::new();
    for (a, &n) in shape.iter().enumerate() {
        for (k, coordinate) in coordinates(d).iter().enumerate() {
            let slope = graph.derivative(n, xi[k]);
            let name = format!("\\partial N_{{{a}}}/\\partial {coordinate}");
            rows.push(row(&name, &expression(&graph, slope, Style::Latex)));
        }
    }
    if derived.definition.embedding.is_some() {
        return format!(
            "\\section{{Displacement gradient}}\n\
             The slopes of the shape functions in the reference cell, and along orthonormal tangents $\\mathbf{{T}}$ in space,\n\
             from $\\partial\\mathbf{{X}}/\\partial\\boldsymbol\\xi = \\sum_a \\mathbf{{X}}_a \\otimes \\partial \
             N_a/\\partial\\boldsymbol\\xi = \\mathbf{{T}}\\mathbf{{R}}$ with an upper triangular $\\mathbf{{R}}$:\n\
             {}\
             \\begin{{equation*}}\n  \\nabla N_a = \\mathbf{{R}}^{{-\\mathsf{{T}}}} \
             \\frac{{\\partial N_a}}{{\\partial\\boldsymbol\\xi}}, \\qquad \
             \\mathbf{{H}} = \\sum_a \\mathbf{{u}}_a \\otimes \\nabla N_a, \\qquad \
             dV_q = w_q \\det\\mathbf{{R}} \\cdot s, \\quad s \\text{{ the thickness or cross-section}}\n\\end{{equation*}}\n",
            align(&rows)
        );
    }
    let missing = if d < 3 {
        "Directions that the element does not have contribute nothing: their entries of $\\mathbf{H}$ are zero, which in \
         two dimensions means plane strain.\n"
    } else {
        ""
    };
    format!(
        "\\section{{Displacement gradient}}\n\
         The slopes of the shape functions in the reference cell, and in space by the inverse of the position gradient\n\
         $\\partial\\mathbf{{X}}/\\partial\\boldsymbol\\xi = \\sum_a \\mathbf{{X}}_a \\otimes \\partial N_a/\\partial\\boldsymbol\\xi$:\n\
         {}\
         \\begin{{equation*}}\n  \\nabla N_a = \\left(\\frac{{\\partial\\mathbf{{X}}}}{{\\partial\\boldsymbol\\xi}}\\right)^{{-\\mathsf{{T}}}} \
         \\frac{{\\partial N_a}}{{\\partial\\boldsymbol\\xi}}, \\qquad \
         \\mathbf{{H}} = \\nabla\\mathbf{{u}} = \\sum_a \\mathbf{{u}}_a \\otimes \\nabla N_a, \\qquad \
         H_{{ij}} = \\sum_a u_{{a,i}} \\, \\partial N_a/\\partial X_j\n\\end{{equation*}}\n{missing}",
        align(&rows)
    )
}

/// F, then those measures that the law's formula names.
fn strain(derived: &Derived) -> String {
    if derived.definition.embedding.is_some() {
        return String::from(
            "\\section{Deformation}\nStrain in the frame of the tangents, and $n$ across them, where the stress vanishes:\n\
             \\begin{equation*}\n  \\mathbf{E} = \\tfrac{1}{2}\\left(\\mathbf{T}^{\\mathsf{T}}\\mathbf{H} + \
             \\mathbf{H}^{\\mathsf{T}}\\mathbf{T} + \\mathbf{H}^{\\mathsf{T}}\\mathbf{H}\\right), \\qquad \
             \\frac{\\partial\\psi}{\\partial n} = 0\n\\end{equation*}\n",
        );
    }
    let d = derived.definition.dimension;
    let mut graph = Graph::new();
    let zero = graph.int(0);
    let gradient = Matrix::from_fn(3, |i, j| {
        if i < d && j < d { graph.symbol(format!("H_{}{}", AXES[i], AXES[j]), Time::Step) } else { zero }
    });
    let mut k = Kinematics::new(&mut graph, gradient, Vec::new());
    let named = letters(derived.association.law.formula);
    let has = |c: char| named.contains(&c);
    let invariants = has('I') || has('Ī');
    let mut tensors = vec![("F", "\\mathbf{F} = \\mathbf{I} + \\mathbf{H}", k.F())];
    if has('C') || invariants {
        tensors.push(("C", "\\mathbf{C} = \\mathbf{F}^{\\mathsf{T}}\\mathbf{F}", k.C()));
    }
    if has('E') {
        let definition = "\\mathbf{E} = \\tfrac{1}{2}\\left(\\mathbf{F}^{\\mathsf{T}}\\mathbf{F} - \\mathbf{I}\\right)";
        tensors.push(("E", definition, k.E()));
    }
    if has('ε') {
        let definition =
            "\\boldsymbol\\varepsilon = \\tfrac{1}{2}\\left(\\mathbf{H} + \\mathbf{H}^{\\mathsf{T}}\\right)";
        tensors.push(("\\varepsilon", definition, k.epsilon()));
    }
    let mut scalars = Vec::new();
    if has('J') || has('Ī') {
        scalars.push(("J = \\det\\mathbf{F}", k.J()));
    }
    if invariants {
        scalars.push(("I_1 = \\operatorname{tr}\\mathbf{C}", k.I1()));
    }
    let mut out = String::from(
        "\\section{Deformation}\nThe deformation gradient, and the measures of strain in which the law is written:\n",
    );
    for (letter, definition, tensor) in tensors {
        let symmetric = letter != "F";
        let mut rows = vec![format!("  &{definition} \\\\\n")];
        for i in 0..d {
            for j in if symmetric { i } else { 0 }..d {
                let name = format!("{letter}_{{{}{}}}", AXES[i], AXES[j]);
                rows.push(row(&name, &expression(&graph, tensor.at(i, j), Style::Latex)));
            }
        }
        out.push_str(&align(&rows));
    }
    let rows: Vec<String> = scalars.iter().map(|(n, e)| row(n, &expression(&graph, *e, Style::Latex))).collect();
    out.push_str(&align(&rows));
    out
}

/// Letters of a formula that stand alone, as names of tensors and invariants do.
fn letters(formula: &str) -> Vec<char> {
    let characters: Vec<char> = formula.chars().collect();
    let alone = |k: usize| {
        let letter = |c: Option<&char>| c.is_some_and(|c| c.is_ascii_alphabetic());
        let before = k.checked_sub(1).and_then(|before| characters.get(before));
        !letter(before) && !letter(characters.get(k + 1))
    };
    // FᵀF is a product of names: a raised T separates, as any character that is no letter does.
    (0..characters.len()).filter(|&k| alone(k)).map(|k| characters[k]).collect()
}

/// Rows of the definitions that lead to roots.
fn defined(derived: &Derived, roots: &[(String, Expr)]) -> String {
    let lines = definitions(&derived.definition.graph, roots, Style::Latex);
    let rows: Vec<String> = lines.iter().map(|(name, formula)| row(name, formula)).collect();
    align(&rows)
}

fn energy_density(derived: &Derived) -> String {
    let law = derived.association.law;
    let parameters: Vec<String> = law
        .parameters
        .iter()
        .map(|p| {
            let unit = if p.unit == "1" { String::new() } else { format!(" [{}]", text(p.unit)) };
            format!("\\item \\texttt{{{}}}{unit}: {}\n", text(p.name), text(p.about))
        })
        .collect();
    let parameters = if parameters.is_empty() {
        String::new()
    } else {
        format!("with the parameters\n\\begin{{itemize}}\n{}\\end{{itemize}}\n", parameters.concat())
    };
    format!(
        "\\section{{Energy density}}\nThe law states an energy per volume of the rest shape,\n\
         \\begin{{equation*}}\n  \\psi = {}\n\\end{{equation*}}\n{parameters}\
         Written in the displacement gradient:\n{}",
        formula(law.formula),
        defined(derived, &[("\\psi".to_owned(), derived.definition.energy_density)])
    )
}

fn stress(derived: &Derived) -> String {
    let d = derived.association.element.dimension();
    let components: Vec<(String, Expr)> = derived
        .definition
        .stress
        .iter()
        .enumerate()
        .map(|(k, &e)| (format!("P_{{{}{}}}", AXES[k / d], AXES[k % d]), e))
        .collect();
    format!(
        "\\section{{Stress}}\nThe first Piola--Kirchhoff stress is the derivative of the energy density,\n\
         \\begin{{equation*}}\n  \\mathbf{{P}} = \\frac{{\\partial\\psi}}{{\\partial\\mathbf{{H}}}}, \\qquad \
         P_{{ij}} = \\frac{{\\partial\\psi}}{{\\partial H_{{ij}}}}\n\\end{{equation*}}\n{}",
        defined(derived, &components)
    )
}

fn energy(derived: &Derived) -> String {
    let rule = derived.association.rule;
    let d = derived.association.element.dimension();
    let columns = "r".repeat(d + 2);
    let mut body = String::new();
    for (q, (point, weight)) in rule.points.iter().zip(&rule.weights).enumerate() {
        let numbers: Vec<String> = point[..d].iter().chain([weight]).map(|x| format!("${}$", number(*x))).collect();
        body.push_str(&format!("{q} & {} \\\\\n", numbers.join(" & ")));
    }
    let heads: Vec<String> = coordinates(d).iter().map(|c| format!("${c}$")).collect();
    format!(
        "\\section{{Energy}}\nThe energy of the element is the sum over the points $q$ of the quadrature,\n\
         \\begin{{equation*}}\n  W = \\sum_q \\psi\\left(\\mathbf{{H}}(\\boldsymbol\\xi_q)\\right) dV_q, \\qquad \
         dV_q = w_q \\det\\frac{{\\partial\\mathbf{{X}}}}{{\\partial\\boldsymbol\\xi}}(\\boldsymbol\\xi_q)\n\\end{{equation*}}\n\
         \\begin{{center}}\n\\begin{{tabular}}{{{columns}}}\n$q$ & {} & $w_q$ \\\\\n\\hline\n{body}\\end{{tabular}}\n\\end{{center}}\n",
        heads.join(" & ")
    )
}

fn force(derived: &Derived) -> String {
    let components = roots(derived, "force", Style::Latex).expect("force is an output");
    let tables = tables(derived, &components);
    let constants = if tables.is_empty() {
        String::new()
    } else {
        let rows: Vec<String> = tables
            .iter()
            .map(|(t, values)| {
                let values: Vec<String> = values.iter().map(|&v| number(v)).collect();
                row(&format!("\\tau_{{{t}}}"), &values.join(" ; "))
            })
            .collect();
        format!("The constants $\\tau$ have one value for each point $q$:\n{}", align(&rows))
    };
    format!(
        "\\section{{Forces}}\nThe forces on the nodes are what the energy loses when the nodes give way:\n\
         \\begin{{equation*}}\n  \\mathbf{{f}}_a = -\\frac{{\\partial W}}{{\\partial\\mathbf{{u}}_a}} \
         = -\\sum_q \\mathbf{{P}} \\, \\nabla N_a \\, dV_q\n\\end{{equation*}}\n\
         Derived component by component, with $G_{{a}}$ for $\\nabla N_a$ and common factors shared:\n{}{constants}",
        defined(derived, &components)
    )
}

/// A number with its powers of ten written as such.
fn number(x: f64) -> String {
    let plain = x.to_string();
    if plain.len() <= 20 {
        return plain;
    }
    let scientific = format!("{x:e}");
    match scientific.split_once('e') {
        Some((mantissa, exponent)) if exponent != "0" => format!("{mantissa} \\cdot 10^{{{exponent}}}"),
        _ => plain,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::derive_report::{Costs, derive};

    fn document(element: &str, law: &str) -> String {
        let element = souple_elements::by_id(element).unwrap();
        let law = souple_laws::by_id(law).unwrap();
        let rule = element.default_rule();
        latex(&derive(Association { rule, ..Association::new(element, law) }, Costs::default()))
    }

    /// What every LaTeX needs: environments and brackets closed in each row, and no character without a meaning.
    fn assert_well_formed(document: &str) {
        let mut open = Vec::new();
        for (at, line) in document.lines().enumerate() {
            for piece in line.split('\\').skip(1) {
                let name = |p: &str| p.split('{').nth(1).and_then(|n| n.split('}').next()).unwrap_or("").to_owned();
                if piece.starts_with("begin") {
                    open.push(name(piece));
                } else if piece.starts_with("end{") {
                    assert_eq!(open.pop(), Some(name(piece)), "line {}: {line}", at + 1);
                }
            }
            let lefts = line.matches("\\left").count();
            assert_eq!(lefts, line.matches("\\right").count(), "line {}: {line}", at + 1);
            let braces = line.replace("\\{", "").replace("\\}", "");
            assert_eq!(braces.matches('{').count(), braces.matches('}').count(), "line {}: {line}", at + 1);
            let strange = line.chars().find(|c| !c.is_ascii() && !matches!(c, '\u{c0}'..='\u{17f}'));
            assert_eq!(strange, None, "line {}: {line}", at + 1);
        }
        assert!(open.is_empty(), "{open:?}");
        assert!(!document.contains("\\mathrm{U"), "a character without translation");
        assert!(document.starts_with("\\documentclass") && document.ends_with("\\end{document}\n"));
    }

    /// The document of every law is well formed and has every step.
    #[test]
    fn every_law_is_taught() {
        for law in souple_laws::all() {
            let text = document("tri3", law.id);
            assert_well_formed(&text);
            for step in ["N_{2} &=", "\\psi &=", "P_{yy} &=", "f_{2y} &="] {
                assert!(text.contains(step), "{}: no {step}", law.id);
            }
        }
    }

    /// The document of every family is well formed, with rational shape functions and tables of constants too.
    #[test]
    fn every_family_is_taught() {
        for element in ["edge2", "quad4", "tet4", "pyramid5", "prism6"] {
            let text = document(element, "hooke");
            assert_well_formed(&text);
            let nodes = souple_elements::by_id(element).unwrap().node_count();
            assert!(text.contains(&format!("N_{{{}}} &=", nodes - 1)), "{element}");
        }
    }

    /// The strain that a law's formula names is shown, others are not.
    #[test]
    fn the_strain_of_the_law_is_shown() {
        let (stvk, hooke) = (document("tri3", "stvk"), document("tri3", "hooke"));
        assert!(stvk.contains("E_{xy} &=") && !stvk.contains("\\varepsilon_{xy} &="));
        assert!(hooke.contains("\\varepsilon_{xy} &=") && !hooke.contains("E_{xy} &="));
    }
}
