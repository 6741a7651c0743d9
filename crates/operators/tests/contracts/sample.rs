//! One distorted element for each element × law × rule, with displacements that leave it right side out.
//!
//! Lengths, moduli and densities are near one, so that relative and absolute errors are the same thing.

use souple_elements::{Element, Rule};
use souple_kernels::Interpreter;
use souple_kernels::conformance::Random;
use souple_laws::{Bound, Law, Parameter};
use souple_operators::{BlockSpec, Elements, Masses, Threads};
use souple_program::Costs;
use std::sync::{Arc, LazyLock, Mutex};

/// One element, alone in its model.
pub(crate) struct Sample {
    pub(crate) element: &'static Element,
    pub(crate) law: &'static Law,
    pub(crate) rule: &'static Rule,
    /// Number of space dimensions.
    pub(crate) space: usize,
    pub(crate) nodes: Vec<[f64; 3]>,
    pub(crate) density: f64,
    pub(crate) elements: Elements,
    pub(crate) masses: Masses,
    pub(crate) random: Random,
}

impl Sample {
    fn new((element, law, rule, space): Case, seed: u64) -> Sample {
        let mut random = Random::new(seed);
        let nodes = distorted(element, space, &mut random);
        let density = 1.7;
        let (elements, masses) = one_element(element, law, rule, space, &nodes, density);
        Sample { element, law, rule, space, nodes, density, elements, masses, random }
    }

    pub(crate) fn name(&self) -> String {
        format!("{} in {}D / {} / {}", self.element.id, self.space, self.law.id, self.rule.id)
    }

    /// Whether the element has fewer dimensions than space.
    pub(crate) fn embedded(&self) -> bool {
        self.element.dimension() < self.space
    }

    pub(crate) fn dimension(&self) -> usize {
        self.space
    }

    /// A random homogeneous deformation with a random displacement of every node on top, [node, axis] in m.
    pub(crate) fn displacement(&mut self) -> Vec<f64> {
        let gradient = self.gradient();
        let noise = 0.03 * spacing(self.element);
        let u = self.homogeneous(&gradient);
        let u: Vec<f64> = u.iter().map(|v| v + noise * self.random.between(-1.0, 1.0)).collect();
        let crushed = self.elements.crushed(&u, 0.2);
        assert!(crushed.is_empty(), "{}: this test deforms too much: J = {crushed:?}", self.name());
        u
    }

    /// A random displacement gradient, [row, column] in 3 × 3, zero beyond the dimension.
    pub(crate) fn gradient(&mut self) -> [[f64; 3]; 3] {
        let d = self.dimension();
        let mut h = [[0.0; 3]; 3];
        for row in &mut h[..d] {
            for entry in &mut row[..d] {
                *entry = self.random.between(-0.12, 0.12);
            }
        }
        h
    }

    /// Displacements `H X`.
    pub(crate) fn homogeneous(&self, h: &[[f64; 3]; 3]) -> Vec<f64> {
        let d = self.dimension();
        self.nodes.iter().flat_map(|x| (0..d).map(move |i| (0..3).map(|j| h[i][j] * x[j]).sum())).collect()
    }

    /// Any nodal vector with entries between −1 and 1.
    pub(crate) fn direction(&mut self) -> Vec<f64> {
        (0..self.elements.len()).map(|_| self.random.between(-1.0, 1.0)).collect()
    }

    /// Internal forces in N.
    pub(crate) fn force(&mut self, u: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; u.len()];
        self.elements.add_force(u, &mut out);
        out
    }

    /// `(∂f/∂u) v` at the state linearised last.
    pub(crate) fn tangent(&mut self, v: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; v.len()];
        self.elements.add_tangent(1.0, v, &mut out);
        out
    }
}

/// Thickness or cross-section of the elements that do not fill their space.
pub(crate) const SECTION: f64 = 0.6;

/// A model of one element with admissible parameters.
pub(crate) fn one_element(
    element: &'static Element,
    law: &'static Law,
    rule: &'static Rule,
    space: usize,
    nodes: &[[f64; 3]],
    density: f64,
) -> (Elements, Masses) {
    let spec = BlockSpec {
        element,
        law,
        rule,
        parameters: parameters(law),
        density,
        viscosity: None,
        section: if element.dimension() < space { SECTION } else { 1.0 },
        connectivity: (0..nodes.len() as u32).collect(),
        ids: vec![0],
    };
    let threads = Arc::new(Threads::new(1).unwrap());
    Elements::new(space, nodes, vec![spec], &Interpreter::default(), threads, Costs::default()).unwrap()
}

/// Elements up to here are compiled with every law by tests that compare programs, larger ones with some.
const SMALL: usize = 8;
/// Likewise for elements that do not fill their space.
const SMALL_EMBEDDED: usize = 3;

/// Element, law, rule and number of space dimensions.
pub(crate) type Case = (&'static Element, &'static Law, &'static Rule, usize);

/// Every element with every law on its default rule; on the other rules one law after the other in turn: a law enters
/// point by point and does not know the rule. In spaces that they do not fill, elements as in [`associations`].
fn all_associations() -> impl Iterator<Item = Case> {
    chosen(usize::MAX)
}

/// Associations that meet every law, every element, in every space that it fits into, and every listed rule, for tests
/// that derive or compile each of them in several ways: all laws on small elements only, since a law knows no element
/// either.
pub(crate) fn associations() -> impl Iterator<Item = Case> {
    chosen(SMALL)
}

/// All laws on the default rules of elements up to `nodes`, one after the other in turn elsewhere.
fn chosen(nodes: usize) -> impl Iterator<Item = Case> {
    let laws = souple_laws::all();
    let pairs = souple_elements::all().iter().flat_map(|&e| e.quadratures.iter().map(move |id| (e, *id)));
    pairs.enumerate().flat_map(move |(k, (element, id))| {
        let default = id == element.quadratures[0];
        let spaces = element.dimension()..=if default { 3 } else { element.dimension() };
        spaces.flat_map(move |space| {
            let nodes = if space > element.dimension() { SMALL_EMBEDDED } else { nodes };
            let all = default && element.node_count() <= nodes;
            let chosen = (0..laws.len()).filter(move |&l| all || l == (k + space) % laws.len());
            chosen.map(move |l| (element, laws[l], Rule::by_id(id).unwrap(), space))
        })
    })
}

/// Those of [`associations`] with the default rules, of elements that fill their space.
pub(crate) fn with_default_rules() -> impl Iterator<Item = (&'static Element, &'static Law, &'static Rule)> {
    let filling = |(element, _, rule, space): &Case| rule.id == element.quadratures[0] && *space == element.dimension();
    associations().filter(filling).map(|(element, law, rule, _)| (element, law, rule))
}

/// Calls `check` with a sample of every element with every law. Samples are derived once and shared by the tests;
/// random numbers start afresh, so that a test gives the same whatever ran before it.
pub(crate) fn each(check: impl Fn(&mut Sample)) {
    static SAMPLES: LazyLock<Vec<Mutex<Sample>>> = LazyLock::new(|| {
        let numbered = all_associations().enumerate();
        numbered.map(|(k, case)| Mutex::new(Sample::new(case, k as u64))).collect()
    });
    for (k, sample) in SAMPLES.iter().enumerate() {
        // One failing test must not fail the others.
        let mut sample = sample.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        sample.random = Random::new(1000 + k as u64);
        check(&mut sample);
    }
}

/// Parameters well inside their ranges, in the law's order: defaults where there are any that are not zero.
pub(crate) fn parameters(law: &Law) -> Vec<f64> {
    let limit = |b: Bound| match b {
        Bound::None | Bound::NonZero => None,
        Bound::Open(v) | Bound::Closed(v) => Some(v),
    };
    let inside = |p: &Parameter| match (limit(p.minimum), limit(p.maximum)) {
        (Some(low), Some(high)) => low + 0.87 * (high - low),
        (Some(low), None) => low + 1.25,
        (None, Some(high)) => high - 1.25,
        (None, None) => 0.75,
    };
    // A default of zero would leave out what it multiplies.
    let default = |p: &Parameter| p.default.filter(|&value| value != 0.0);
    law.parameters.iter().map(|p| default(p).unwrap_or_else(|| inside(p))).collect()
}

/// The least distance between nodes of the reference element.
fn spacing(element: &Element) -> f64 {
    let distance = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    let nodes = element.nodes;
    let pairs = (0..nodes.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
    pairs.map(|(a, b)| distance(&nodes[a], &nodes[b])).fold(f64::INFINITY, f64::min)
}

/// A skewed map of the reference element, [row, column], whose determinant in each dimension is positive.
pub(crate) const SKEW: [[f64; 3]; 3] = [[1.1, 0.2, -0.1], [0.15, 0.9, 0.25], [-0.2, 0.1, 1.2]];

/// Rest positions under the affine map [`SKEW`]; an element of fewer dimensions than space lies askew in it.
pub(crate) fn skewed(element: &Element, space: usize) -> Vec<[f64; 3]> {
    let d = element.dimension();
    let place = |xi: &[f64; 3]| {
        let mut x = [0.0; 3];
        for i in 0..space {
            x[i] = 0.3 + (0..d).map(|j| SKEW[i][j] * xi[j]).sum::<f64>();
        }
        x
    };
    element.nodes.iter().map(place).collect()
}

/// Rest positions of a distorted element, [node][axis] in m.
pub(crate) fn distorted(element: &Element, space: usize, random: &mut Random) -> Vec<[f64; 3]> {
    let noise = 0.05 * spacing(element);
    let mut nodes = skewed(element, space);
    for x in &mut nodes {
        x[..space].iter_mut().for_each(|c| *c += noise * random.between(-1.0, 1.0));
    }
    nodes
}

/// Largest absolute entry.
pub(crate) fn largest(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// `Σ a b`.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// `a + s b`.
pub(crate) fn plus(a: &[f64], s: f64, b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(x, y)| x + s * y).collect()
}

/// Asserts that two vectors agree to `tolerance`, relative to `scale`.
pub(crate) fn assert_close(what: &str, got: &[f64], want: &[f64], tolerance: f64, scale: f64) {
    assert_eq!(got.len(), want.len(), "{what}: lengths");
    for (k, (g, w)) in got.iter().zip(want).enumerate() {
        let close = (g - w).abs() <= tolerance * scale;
        assert!(close, "{what}: entry {k} is {g:e}, expected {w:e} to {tolerance:e} of {scale:e}");
    }
}
