//! From n-ary sums and products to two-operand nodes.
//!
//! An n-ary product can be multiplied in any order, so the order is chosen for sharing: the pair of factors that
//! occurs together in most products is multiplied first, in all of them, and so on until no pair occurs twice; sums
//! likewise.
//! What remains is ordered by binding time, earliest first, so that operands of the same time stand together: this is
//! where the grouped constants of the first thesis come from.
//!
//! Signs cost nothing where possible: a sum adds or subtracts a term, and a minus in front of a product that has a
//! factor of an earlier time moves into that factor, where it is computed once.

use crate::eigenvectors::{Eigen, eigen, sinhc};
use crate::{Dag, Operation, Ref};
use souple_symbols::{Expr, Function, Graph, Node, Number, Time};
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

/// When and where something is known: earlier and non-varying come first.
type Class = (Time, bool);

/// What a product or a sum is made of, before it is a dag node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Atom {
    Constant(Number),
    Node(Expr),
    Recip(Expr),
    /// Index into the products.
    Product(usize),
    /// A pair that was found to be shared: two atoms, and whether the second is subtracted (sums only).
    Pair(usize, usize, bool),
}

/// An atom with a sign: atom number · 2 + (1 if negative).
type Signed = usize;

#[derive(Default)]
struct Atoms {
    list: Vec<(Atom, Class)>,
    found: HashMap<Atom, usize>,
}

impl Atoms {
    fn add(&mut self, atom: Atom, class: Class) -> usize {
        *self.found.entry(atom).or_insert_with(|| {
            self.list.push((atom, class));
            self.list.len() - 1
        })
    }

    fn class(&self, signed: Signed) -> Class {
        self.list[signed / 2].1
    }

    fn pair(&mut self, a: usize, b: usize, minus: bool) -> usize {
        let class = self.list[a].1.max(self.list[b].1);
        self.add(Atom::Pair(a, b, minus), class)
    }
}

/// Makes the dag of `roots`. The second result gives the node of each root.
pub fn associate(g: &Graph, roots: &[Expr]) -> (Dag, Vec<Ref>) {
    let order = g.reachable(roots);
    let mut work = Work { g, factors: Atoms::default(), products: Vec::new(), known: HashMap::new() };
    let mut product_of: HashMap<Expr, (bool, usize)> = HashMap::new();
    let mut terms = Atoms::default();
    let mut sums: Vec<Vec<Signed>> = Vec::new();
    let mut sum_of: HashMap<Expr, usize> = HashMap::new();
    for &e in &order {
        match g.node(e) {
            Node::Product(c, factors) => {
                let product = work.product(*c, factors, e);
                product_of.insert(e, product);
            }
            Node::Sum(constant, list) => {
                let mut items: Vec<Signed> = Vec::with_capacity(list.len() + 1);
                if !constant.is_zero() {
                    let atom = terms.add(Atom::Constant(constant.abs()), (Time::Derive, false));
                    items.push(2 * atom + usize::from(constant.is_negative()));
                }
                for &(k, t) in list.iter() {
                    let class = (g.time(t), g.varies(t));
                    let (negative, atom) = match g.node(t) {
                        Node::Product(c, factors) => {
                            let (negative, product) = work.product(*c * k, factors, t);
                            (negative, terms.add(Atom::Product(product), class))
                        }
                        _ if k.abs().is_one() => (k.is_negative(), terms.add(Atom::Node(t), class)),
                        _ => {
                            let (negative, product) = work.product(k, &[(t, 1)], t);
                            (negative, terms.add(Atom::Product(product), class))
                        }
                    };
                    items.push(2 * atom + usize::from(negative));
                }
                sum_of.insert(e, sums.len());
                sums.push(items);
            }
            _ => {}
        }
    }
    let Work { mut factors, mut products, .. } = work;
    share_pairs(&mut factors, &mut products);
    share_pairs(&mut terms, &mut sums);

    let mut builder = Builder {
        dag: Dag::with_points(g.points()),
        built: HashMap::new(),
        factors,
        products,
        terms,
        factor_refs: HashMap::new(),
        product_refs: HashMap::new(),
        term_refs: HashMap::new(),
        eigen: HashMap::new(),
    };
    for &e in &order {
        let value = match g.node(e) {
            Node::Constant(c) => (c.is_negative(), builder.dag.constant(c.abs().to_f64())),
            Node::Symbol(_) => (false, builder.dag.leaf(Operation::Leaf(e), g.time(e), g.varies(e))),
            Node::Table(t) => (false, builder.dag.table(g.table_values(*t))),
            Node::Product(..) => {
                let (negative, product) = product_of[&e];
                let (sign, r) = builder.product(product);
                (negative ^ sign, r)
            }
            Node::Sum(..) => builder.sum(&sums[sum_of[&e]]),
            Node::Named(_, o) => builder.built[o],
            Node::PointSum(o) => {
                let (negative, r) = builder.built[o];
                (negative, builder.dag.add(Operation::PointSum(r)))
            }
            Node::Function(function, operands) => {
                let refs: Vec<Ref> = operands.iter().map(|o| builder.positive(*o)).collect();
                let operation = match function {
                    Function::Sqrt => Operation::Sqrt(refs[0]),
                    Function::Ln => Operation::Ln(refs[0]),
                    Function::Exp => Operation::Exp(refs[0]),
                    Function::Pow => Operation::Pow(refs[0], refs[1]),
                    Function::Sinhc => {
                        let value = sinhc(&mut builder.dag, refs[0]);
                        builder.built.insert(e, (false, value));
                        continue;
                    }
                    Function::Eigenvalue(which) => {
                        let value = builder.eigen(&refs).values[usize::from(*which)];
                        builder.built.insert(e, (false, value));
                        continue;
                    }
                    Function::Eigenvector(row, which) => {
                        let value = builder.eigen(&refs).vectors[usize::from(*row)][usize::from(*which)];
                        builder.built.insert(e, (false, value));
                        continue;
                    }
                    // Their value is written out: it is their first operand.
                    Function::PowerTrace | Function::PowerEntry(..) | Function::Root(_) => {
                        builder.built.insert(e, (false, refs[0]));
                        continue;
                    }
                    Function::RootSum => {
                        let root = builder.root_sum(refs[0], refs[1], refs[2]);
                        builder.built.insert(e, (false, root));
                        continue;
                    }
                };
                (false, builder.dag.add(operation))
            }
        };
        builder.built.insert(e, value);
    }
    let refs = roots.iter().map(|r| builder.positive(*r)).collect();
    (builder.dag, refs)
}

struct Work<'g> {
    g: &'g Graph,
    factors: Atoms,
    products: Vec<Vec<Signed>>,
    known: HashMap<Vec<Signed>, usize>,
}

impl Work<'_> {
    /// The product `c · Π factors`, and whether a minus stays in front of it. `e` is the node whose time it has.
    fn product(&mut self, c: Number, factors: &[(Expr, i32)], e: Expr) -> (bool, usize) {
        let mut items: Vec<Signed> = Vec::new();
        for &(f, n) in factors {
            let atom = if n > 0 { Atom::Node(f) } else { Atom::Recip(f) };
            let id = self.factors.add(atom, (self.g.time(f), self.g.varies(f)));
            items.extend(std::iter::repeat_n(2 * id, n.unsigned_abs() as usize));
        }
        let time = self.g.time(e);
        let earlier = factors.iter().any(|f| self.g.time(f.0) < time);
        let (negative, c) = if c.is_negative() && !earlier { (true, -c) } else { (false, c) };
        if !c.is_one() {
            items.push(2 * self.factors.add(Atom::Constant(c), (Time::Derive, false)));
        }
        items.sort_unstable();
        let next = self.products.len();
        let id = *self.known.entry(items.clone()).or_insert(next);
        if id == next {
            self.products.push(items);
        }
        (negative, id)
    }
}

/// A pair as it may occur in several sets: atoms in order, and whether their signs differ.
type Pair = (usize, usize, bool);

fn pairs_of(set: &[Signed]) -> Vec<Pair> {
    let mut pairs = Vec::with_capacity(set.len() * set.len() / 2);
    for (i, &a) in set.iter().enumerate() {
        for &b in &set[i + 1..] {
            pairs.push((a.min(b) / 2, a.max(b) / 2, (a ^ b) & 1 == 1));
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// Replaces the pair that occurs in most sets by one atom, in all of them, until none occurs twice.
fn share_pairs(atoms: &mut Atoms, sets: &mut [Vec<Signed>]) {
    let mut users: HashMap<Pair, Vec<usize>> = HashMap::new();
    for (at, set) in sets.iter().enumerate() {
        for pair in pairs_of(set) {
            users.entry(pair).or_default().push(at);
        }
    }
    let rank = |atoms: &Atoms, pair: Pair, count: usize| {
        let class = atoms.list[pair.0].1.max(atoms.list[pair.1].1);
        (count, Reverse(class), Reverse(pair))
    };
    let mut heap: BinaryHeap<_> =
        users.iter().filter(|u| u.1.len() > 1).map(|(&p, u)| rank(atoms, p, u.len())).collect();
    while let Some((count, class, Reverse(pair))) = heap.pop() {
        let Some(list) = users.get(&pair) else { continue };
        if list.len() != count {
            if list.len() > 1 {
                heap.push((list.len(), class, Reverse(pair)));
            }
            continue;
        }
        let list = users.remove(&pair).expect("looked up above");
        let new = atoms.pair(pair.0, pair.1, pair.2);
        for at in list {
            let set = &mut sets[at];
            let before = pairs_of(set);
            let Some((i, j)) = find(set, pair) else { continue };
            // The sign of the pair is that of its first atom.
            let first = if set[i] / 2 == pair.0 { set[i] } else { set[j] };
            let sign = first & 1;
            set.remove(i.max(j));
            set.remove(i.min(j));
            set.push(2 * new + sign);
            set.sort_unstable();
            let after = pairs_of(set);
            for p in before.iter().filter(|p| **p != pair && after.binary_search(p).is_err()) {
                if let Some(list) = users.get_mut(p) {
                    list.retain(|&u| u != at);
                }
            }
            for &p in after.iter().filter(|p| before.binary_search(p).is_err()) {
                let list = users.entry(p).or_default();
                list.push(at);
                if list.len() > 1 {
                    let entry = rank(atoms, p, list.len());
                    heap.push(entry);
                }
            }
            // The same pair may still be in this set (x·x·x·x).
            if after.binary_search(&pair).is_ok() {
                users.entry(pair).or_default().push(at);
            }
        }
    }
}

fn find(set: &[Signed], pair: Pair) -> Option<(usize, usize)> {
    for i in 0..set.len() {
        for j in i + 1..set.len() {
            let (a, b) = (set[i], set[j]);
            if (a.min(b) / 2, a.max(b) / 2, (a ^ b) & 1 == 1) == pair {
                return Some((i, j));
            }
        }
    }
    None
}

struct Builder {
    dag: Dag,
    /// Sign and node of every expression.
    built: HashMap<Expr, (bool, Ref)>,
    factors: Atoms,
    products: Vec<Vec<Signed>>,
    terms: Atoms,
    factor_refs: HashMap<usize, (bool, Ref)>,
    product_refs: HashMap<usize, (bool, Ref)>,
    term_refs: HashMap<usize, (bool, Ref)>,
    /// Matrices that were decomposed.
    eigen: HashMap<[Ref; 6], Eigen>,
}

/// Newton steps for [`Function::RootSum`]: nine reach the last bit while the largest number is at most ten times the
/// others; at a hundred times, where the two largest roots nearly meet, they leave a relative error of 5e-9.
const ROOT_SUM_STEPS: usize = 9;

impl Builder {
    fn eigen(&mut self, entries: &[Ref]) -> Eigen {
        let entries: [Ref; 6] = entries.try_into().expect("a symmetric matrix has six entries");
        if let Some(known) = self.eigen.get(&entries) {
            return *known;
        }
        let found = eigen(&mut self.dag, entries);
        self.eigen.insert(entries, found);
        found
    }

    /// The largest root s of s⁴ − 2a s² − 8c s + a² − 4b by Newton's method from √(3a), written out.
    ///
    /// Why not an operation of its own: it would be one more for every backend, for what arithmetic says as well.
    fn root_sum(&mut self, a: Ref, b: Ref, c: Ref) -> Ref {
        use Operation::{Add, Mul, Recip, Sqrt, Sub};
        let dag = &mut self.dag;
        let [two, three, four, eight] = [2.0, 3.0, 4.0, 8.0].map(|x| dag.constant(x));
        let tripled = dag.add(Mul(a, three));
        let mut s = dag.add(Sqrt(tripled));
        let squared = dag.add(Mul(a, a));
        let fourfold = dag.add(Mul(b, four));
        let constant = dag.add(Sub(squared, fourfold));
        let eightfold = dag.add(Mul(c, eight));
        let doubled = dag.add(Mul(c, two));
        for _ in 0..ROOT_SUM_STEPS {
            let square = dag.add(Mul(s, s));
            let rest = dag.add(Sub(square, a));
            let inner = dag.add(Sub(rest, a));
            let cubic = dag.add(Mul(inner, s));
            let shifted = dag.add(Sub(cubic, eightfold));
            let quartic = dag.add(Mul(shifted, s));
            let value = dag.add(Add(quartic, constant));
            let cube = dag.add(Mul(rest, s));
            let slope = dag.add(Sub(cube, doubled));
            let steep = dag.add(Mul(slope, four));
            let inverse = dag.add(Recip(steep));
            let step = dag.add(Mul(value, inverse));
            s = dag.add(Sub(s, step));
        }
        s
    }

    fn positive(&mut self, e: Expr) -> Ref {
        let (negative, r) = self.built[&e];
        if negative { self.dag.add(Operation::Neg(r)) } else { r }
    }

    fn factor(&mut self, atom: usize) -> (bool, Ref) {
        if let Some(&known) = self.factor_refs.get(&atom) {
            return known;
        }
        let value = match self.factors.list[atom].0 {
            Atom::Constant(c) => (false, self.dag.constant(c.to_f64())),
            Atom::Node(e) => self.built[&e],
            Atom::Recip(e) => {
                let (negative, r) = self.built[&e];
                (negative, self.dag.add(Operation::Recip(r)))
            }
            Atom::Pair(a, b, _) => {
                let ((s, x), (t, y)) = (self.factor(a), self.factor(b));
                (s ^ t, self.dag.add(Operation::Mul(x, y)))
            }
            Atom::Product(_) => unreachable!("products are not factors: the graph opens them"),
        };
        self.factor_refs.insert(atom, value);
        value
    }

    fn product(&mut self, product: usize) -> (bool, Ref) {
        if let Some(&known) = self.product_refs.get(&product) {
            return known;
        }
        let mut items = self.products[product].clone();
        items.sort_by_key(|&i| (self.factors.class(i), i));
        let mut result: Option<(bool, Ref)> = None;
        for item in items {
            let (sign, r) = self.factor(item / 2);
            result = Some(match result {
                None => (sign, r),
                Some((s, acc)) => (s ^ sign, self.dag.add(Operation::Mul(acc, r))),
            });
        }
        let value = result.expect("a product has at least one factor");
        self.product_refs.insert(product, value);
        value
    }

    fn term(&mut self, atom: usize) -> (bool, Ref) {
        if let Some(&known) = self.term_refs.get(&atom) {
            return known;
        }
        let value = match self.terms.list[atom].0 {
            Atom::Constant(c) => (false, self.dag.constant(c.to_f64())),
            Atom::Node(e) => self.built[&e],
            Atom::Product(p) => self.product(p),
            Atom::Pair(a, b, minus) => {
                let ((s, x), (t, y)) = (self.term(a), self.term(b));
                self.plus((s, x), (t ^ minus, y))
            }
            Atom::Recip(_) => unreachable!("a reciprocal alone is a product"),
        };
        self.term_refs.insert(atom, value);
        value
    }

    /// `a + b` with their signs; the result is negative only when both are.
    fn plus(&mut self, a: (bool, Ref), b: (bool, Ref)) -> (bool, Ref) {
        match (a, b) {
            ((s, x), (t, y)) if s == t => (s, self.dag.add(Operation::Add(x, y))),
            ((false, x), (true, y)) => (false, self.dag.add(Operation::Sub(x, y))),
            ((_, x), (_, y)) => (false, self.dag.add(Operation::Sub(y, x))),
        }
    }

    fn sum(&mut self, items: &[Signed]) -> (bool, Ref) {
        let mut values: Vec<(Class, bool, bool, Ref)> = Vec::with_capacity(items.len());
        for &item in items {
            let (sign, r) = self.term(item / 2);
            let product = matches!(self.dag.node(r).operation, Operation::Mul(..));
            values.push((self.terms.class(item), product, sign ^ (item & 1 == 1), r));
        }
        // Earlier times first; inside one time plain values before products, which a fused multiply-add can take in.
        values.sort();
        let mut total: Option<(bool, Ref)> = None;
        let mut at = 0;
        while at < values.len() {
            let class = values[at].0;
            let end = values[at..].iter().position(|v| v.0 != class).map_or(values.len(), |n| at + n);
            let mut part: Option<(bool, Ref)> = None;
            // Positive terms first, so that a partial sum is negative only if everything in it is.
            let (minus, plus): (Vec<_>, Vec<_>) = values[at..end].iter().partition(|v| v.2);
            for (_, _, sign, r) in plus.into_iter().chain(minus) {
                part = Some(match part {
                    None => (sign, r),
                    Some(acc) => self.plus(acc, (sign, r)),
                });
            }
            let part = part.expect("a class has at least one term");
            total = Some(match total {
                None => part,
                Some(acc) => self.plus(acc, part),
            });
            at = end;
        }
        total.expect("a sum has at least one term")
    }
}
