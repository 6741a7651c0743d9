//! Promises of meshes whose elements do not meet node by node: uniform stress stays uniform across mixed interpolations
//! and hanging nodes, for every pair of elements of a family; nothing is lost, and every solver gives the same.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on says where")]

use souple_elements::{Element, all, by_id};
use souple_simulation::mesh::Mesh;
use souple_simulation::mesh::bar::{self, BarSpec, Section, Split, Transition};
use souple_simulation::mesh::check::{Merge, repair};
use souple_simulation::mesh::constraint::{Cause, conformity};
use souple_simulation::mesh::formats::{MshVersion, write_msh};
use souple_simulation::mesh::topology::Topology;
use souple_simulation::{ProbeValue, RunOptions, Simulation};

const YOUNG: f64 = 1e6;
const POISSON: f64 = 0.3;

/// A bar from x = `from` to `from + 1`, 1 m wide (and high, for solids).
fn piece(element: &'static Element, from: f64, cells: usize) -> Mesh {
    let thick = |axis: usize| axis < element.dimension();
    let spec = BarSpec {
        size: [1.0, 1.0, 1.0],
        cells: std::array::from_fn(|axis| if thick(axis) { cells } else { 1 }),
        origin: [from, 0.0, 0.0],
        sections: vec![Section { until: 1.0, element, split: Split::Usual }],
        transition: Transition::Keep,
    };
    bar::generate(&spec).unwrap().0
}

/// Two meshes as one, nodes at the same place merged.
fn joined(mut first: Mesh, second: &Mesh) -> Mesh {
    let offset = first.nodes.len() as u32;
    first.nodes.extend_from_slice(&second.nodes);
    for block in &second.blocks {
        first.block_mut(block.element).connectivity.extend(block.connectivity.iter().map(|n| n + offset));
    }
    first.regions.clear();
    repair(&mut first, Merge::Within(1e-9)).unwrap();
    first
}

/// A scene of one body from x = 0 to 2: rollers on x = 0, y = 0 and z = 0, traction along x on x = 2.
fn pulled(dimension: usize) -> String {
    let rollers: String = ["x", "y", "z"][..dimension]
        .iter()
        .zip(["[-1, 0, 0]", "[0, -1, 0]", "[0, 0, -1]"])
        .map(|(axis, normal)| {
            format!(
                "[[body.fix]]\nregion = {{ plane = {{ point = [0, 0, 0], normal = {normal} }} }}\naxes = [\"{axis}\"]\n"
            )
        })
        .collect();
    format!(
        r#"
[time]
step = 1.0
end = 1.0
[integrator]
method = "quasi-static"
newton_tolerance = 1e-13
[linear_solver]
method = "direct"
[[body]]
name = "bar"
density = 1000.0
mesh = {{ file = "bar.msh" }}
[[body.material]]
law = "hooke"
young = {YOUNG}
poisson = {POISSON}
{rollers}
[[body.traction]]
region = {{ plane = {{ point = [2, 0, 0], normal = [1, 0, 0] }} }}
traction = [1e3, 0, 0]
"#
    )
}

fn load(mesh: &Mesh, scene: &str, overrides: &[&str], threads: usize) -> Result<(Simulation, Vec<String>), String> {
    let bytes = write_msh(mesh, MshVersion::V41Binary).unwrap();
    let overrides: Vec<String> = overrides.iter().map(|s| (*s).to_string()).collect();
    let options = RunOptions { threads, ..RunOptions::default() };
    Simulation::load(scene, "scene.toml", &overrides, &mut |_| Ok(bytes.clone()), &options).map_err(|e| e.to_string())
}

fn run(mesh: &Mesh, scene: &str, overrides: &[&str]) -> Simulation {
    let (mut simulation, _) = load(mesh, scene, overrides, 1).unwrap();
    while simulation.advance().unwrap().finished.is_none() {}
    simulation
}

/// Largest difference of any node's displacement from that of uniform stress, relative to the largest displacement.
fn error_of_uniform_stress(mesh: &Mesh) -> f64 {
    let d = mesh.dimension();
    let simulation = run(mesh, &pulled(d), &[]);
    // Plane strain stiffens along and shrinks more across.
    let (along, across) = match d {
        2 => (1.0 - POISSON * POISSON, POISSON * (1.0 + POISSON)),
        _ => (1.0, POISSON),
    };
    let stretch = [1e3 / YOUNG * along, -1e3 / YOUNG * across, -1e3 / YOUNG * across];
    let u = simulation.displacement();
    assert_eq!(u.len(), d * mesh.nodes.len());
    let error = |n: usize| (0..d).map(|a| (u[n * d + a] - stretch[a] * mesh.nodes[n][a]).abs()).fold(0.0, f64::max);
    (0..mesh.nodes.len()).map(error).fold(0.0, f64::max) / (2.0 * stretch[0])
}

/// Every pair of elements of one family that fills a bar, different or not.
fn pairs() -> Vec<[&'static Element; 2]> {
    let solid = || all().iter().copied().filter(|e| e.dimension() > 1);
    solid().flat_map(|a| solid().filter(move |b| a.family == b.family).map(move |b| [a, b])).collect()
}

/// A bar of one element beside a bar of another with the same corners passes the patch test, whichever two.
#[test]
fn mixed_interpolations_pass_the_patch_test() {
    let mut tied = 0;
    for [a, b] in pairs().into_iter().filter(|[a, b]| a.node_count() < b.node_count()) {
        let mesh = joined(piece(a, 0.0, 2), &piece(b, 1.0, 2));
        let found = conformity(&mesh, &Topology::new(&mesh).unwrap()).unwrap();
        assert_eq!((found.count(Cause::Hanging), found.rough), (0, 0), "{} {}", a.id, b.id);
        // Plane elements with the same edges have nothing to settle.
        let same = a.edges[0].element == b.edges[0].element && a.dimension() == 2;
        assert_eq!(found.constraints.is_empty(), same, "{} {}", a.id, b.id);
        tied += found.constraints.len();
        let error = error_of_uniform_stress(&mesh);
        assert!(error < 1e-10, "{} beside {}: {error:e}", a.id, b.id);
    }
    assert!(tied > 0);
}

/// Cells half as large beside whole ones pass it too, whichever two elements of a family, except where the finer one
/// cannot represent the coarse one: those pairs are counted as rough.
#[test]
fn hanging_nodes_pass_the_patch_test() {
    let (mut smooth, mut rough) = (0, Vec::new());
    for [a, b] in pairs() {
        let mesh = joined(piece(a, 0.0, 1), &piece(b, 1.0, 2));
        let found = conformity(&mesh, &Topology::new(&mesh).unwrap()).unwrap();
        assert!(!found.constraints.is_empty(), "{} {}", a.id, b.id);
        if found.rough > 0 {
            rough.push((a.id, b.id));
            continue;
        }
        smooth += 1;
        let error = error_of_uniform_stress(&mesh);
        assert!(error < 1e-10, "coarse {} beside fine {}: {error:e}", a.id, b.id);
    }
    // Cubic nodes are no superset of quadratic ones, so a cubic side cannot be reduced to a quadratic one.
    assert!(rough.iter().all(|(a, _)| by_id(a).unwrap().degree == 3), "{rough:?}");
    assert!(smooth > 30, "{smooth} pairs");
}

/// A block of cells on the grid of half cells, those that `fine` names cut into 2ᵈ; the corners of the coarse grid that
/// lie inside are displaced at random, the others where the coarse cells put them.
fn refined(dimension: usize, cells: i32, fine: impl Fn([i32; 3]) -> bool) -> Mesh {
    let element = by_id(if dimension == 2 { "quad4" } else { "hex8" }).unwrap();
    let thick = |axis: usize| axis < dimension;
    // A reproducible displacement of a corner of the coarse grid, zero on the rim.
    let corner = |at: [i32; 3]| -> [f64; 3] {
        let inside = (0..dimension).all(|a| at[a] > 0 && at[a] < cells);
        let mut hash =
            at.iter().fold(17u32, |h, &x| h.wrapping_mul(31).wrapping_add(x as u32).wrapping_mul(2_654_435_761));
        std::array::from_fn(|a| {
            hash = hash.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let shift =
                if inside && thick(a) { 0.3 * (f64::from(hash >> 8) / f64::from(1u32 << 24) - 0.5) } else { 0.0 };
            2.0 / f64::from(cells) * (f64::from(at[a]) + shift)
        })
    };
    // Points on the grid of half cells lie in the middle of coarse corners.
    let position = |p: [i32; 3]| -> [f64; 3] {
        let ends = |a: usize| [p[a].div_euclid(2), (p[a] + 1).div_euclid(2)];
        let mut sum = [0.0; 3];
        for choice in 0..8 {
            let c = corner(std::array::from_fn(|a| ends(a)[choice >> a & 1]));
            (0..3).for_each(|a| sum[a] += c[a] / 8.0);
        }
        sum
    };
    let mut mesh = Mesh::default();
    let mut known: std::collections::BTreeMap<[i32; 3], u32> = std::collections::BTreeMap::new();
    let range = |axis: usize| if thick(axis) { 0..cells } else { 0..1 };
    for (k, j, i) in range(2).flat_map(|k| range(1).flat_map(move |j| range(0).map(move |i| (k, j, i)))) {
        let (size, count) = if fine([i, j, k]) { (1, 1 << dimension) } else { (2, 1) };
        for part in 0..count {
            let low: [i32; 3] = std::array::from_fn(|a| 2 * [i, j, k][a] + (part >> a & 1));
            for node in element.nodes {
                let p =
                    std::array::from_fn(|a| if thick(a) { low[a] + if node[a] > 0.0 { size } else { 0 } } else { 0 });
                let number = *known.entry(p).or_insert_with(|| {
                    mesh.nodes.push(position(p));
                    mesh.nodes.len() as u32 - 1
                });
                mesh.block_mut(element).connectivity.push(number);
            }
        }
    }
    mesh
}

/// A checkerboard of whole and cut cells in two and in three dimensions, with displaced corners: nodes hang on edges of
/// several coarse cells and on warped faces, all are found, and uniform stress stays uniform.
#[test]
fn distorted_meshes_with_hanging_nodes_pass_the_patch_test() {
    // Edges between coarse cells that a fine cell touches, and faces between a coarse and a fine one.
    for (dimension, cells) in [(2, 4), (3, 3)] {
        let mesh = refined(dimension, cells, |[i, j, k]| (i + 2 * j + k) % 3 == 0);
        let found = conformity(&mesh, &Topology::new(&mesh).unwrap()).unwrap();
        assert_eq!((found.count(Cause::Interpolation), found.rough), (0, 0));
        let two = found.constraints.iter().filter(|c| c.masters.len() == 2).count();
        let four = found.constraints.iter().filter(|c| c.masters.len() == 4).count();
        assert_eq!(two + four, found.constraints.len());
        assert!(two > 4 && (four > 0) == (dimension == 3), "{two} on edges, {four} on faces");
        for constraint in &found.constraints {
            assert!(constraint.gap(&mesh.nodes) < 1e-14, "{constraint:?}");
            let sum: f64 = constraint.masters.iter().map(|m| m.1).sum();
            assert!((sum - 1.0).abs() < 1e-14, "{constraint:?}");
        }
        let error = error_of_uniform_stress(&mesh);
        assert!(error < 1e-10, "{dimension} dimensions: {error:e}");
    }
}

/// The skin of a mesh with hanging nodes is that of the body: faces inside do not count.
#[test]
fn hanging_faces_are_no_skin() {
    let mesh = refined(3, 3, |[i, j, k]| (i + 2 * j + k) % 3 == 0);
    let topology = Topology::new(&mesh).unwrap();
    let skin = conformity(&mesh, &topology).unwrap().skin(&topology);
    let outside = |n: u32| mesh.nodes[n as usize].iter().any(|x| x.abs() < 1e-12 || (x - 2.0).abs() < 1e-12);
    assert!(skin.len() < topology.boundary().len());
    assert!(skin.iter().all(|&f| topology.face_material(f).all(outside)));
}

/// A quadratic bar beside a linear one of half the cells, hanging under its weight.
fn two_degrees() -> Mesh {
    joined(piece(by_id("hex20").unwrap(), 0.0, 1), &piece(by_id("hex8").unwrap(), 1.0, 2))
}

/// A scene of one body from x = 0 to 2 that is held at x = 0, if at all, under gravity.
fn hung(held: bool) -> String {
    let fix = if held { "[[body.fix]]\nregion = { plane = { point = [0, 0, 0], normal = [-1, 0, 0] } }\n" } else { "" };
    let gravity = if held { "gravity = [0.0, -9.81, 0.0]" } else { "" };
    format!(
        r#"
{gravity}
[time]
step = 0.01
end = 0.1
[integrator]
method = "implicit-euler"
newton_iterations = 5
[linear_solver]
tolerance = 1e-13
[[body]]
name = "bar"
density = 1000.0
initial_velocity = [1.0, 0.5, 0.0]
mesh = {{ file = "bar.msh" }}
[[body.material]]
law = "stvk"
young = 1e6
poisson = 0.3
{fix}
[[probe]]
name = "tip"
region = {{ plane = {{ point = [2, 0, 0], normal = [1, 0, 0] }} }}
quantity = "mean displacement"
[[probe]]
name = "root"
region = {{ plane = {{ point = [0, 0, 0], normal = [-1, 0, 0] }} }}
quantity = "reaction"
[[probe]]
name = "all"
region = "all"
quantity = ["kinetic energy", "strain energy", "mean displacement"]
"#
    )
}

fn vector(simulation: &mut Simulation, probe: &str, quantity: &str) -> [f64; 3] {
    match simulation.probes()[probe][quantity] {
        ProbeValue::Vector(v) => v,
        _ => panic!("{quantity} is a vector"),
    }
}

/// How far the constraints are from being met by a state, [node, axis].
fn violation(mesh: &Mesh, u: &[f64]) -> f64 {
    let d = mesh.dimension();
    let constraints = conformity(mesh, &Topology::new(mesh).unwrap()).unwrap().constraints;
    assert!(!constraints.is_empty());
    let of = |node: u32, axis: usize| u[node as usize * d + axis];
    let apart = |axis: usize, c: &souple_simulation::mesh::constraint::Constraint| {
        (of(c.node, axis) - c.masters.iter().map(|m| m.1 * of(m.0, axis)).sum::<f64>()).abs()
    };
    constraints.iter().flat_map(|c| (0..d).map(move |axis| apart(axis, c))).fold(0.0, f64::max)
}

/// Assembled and matrix-free products, every preconditioner and the factorisation, explicit and implicit steps: the same
/// trajectory for any number of threads, and constraints met to rounding at its end.
#[test]
fn every_solver_keeps_the_constraints() {
    let mesh = two_degrees();
    let scene = hung(true);
    let state = |overrides: &[&str], threads: usize| {
        let (mut simulation, _) = load(&mesh, &scene, overrides, threads).unwrap();
        while simulation.advance().unwrap().finished.is_none() {}
        simulation.displacement().to_vec()
    };
    let direct = state(&["linear_solver.method='direct'"], 1);
    let size = direct.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    assert!(size > 1e-3, "it moves");
    assert!(violation(&mesh, &direct) <= 1e-15 * size);
    for choice in [
        "preconditioner='none'",
        "preconditioner='jacobi'",
        "preconditioner='block-jacobi'",
        "preconditioner='incomplete-cholesky'",
        "operator='matrix-free'",
    ] {
        let choice = format!("linear_solver.{choice}");
        let states = [1, 3].map(|threads| state(&[&choice], threads));
        assert!(states[0].iter().zip(&states[1]).all(|(a, b)| a.to_bits() == b.to_bits()), "{choice}");
        let gap = states[0].iter().zip(&direct).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
        assert!(gap <= 1e-9 * size, "{choice}: {gap:e} of {size:e}");
        assert!(violation(&mesh, &states[0]) <= 1e-15 * size, "{choice}");
    }
    for method in ["symplectic-euler", "rk4"] {
        let u = state(&[&format!("integrator.method='{method}'"), "time.step=1e-4", "time.end=0.005"], 1);
        assert!(u.iter().any(|x| x.abs() > 1e-4));
        assert!(violation(&mesh, &u) <= 1e-15, "{method}");
    }
}

/// Turning and shifting a body without strain makes no force and no energy: a free body with uniform velocity keeps it,
/// and with it its momentum.
#[test]
fn a_free_body_keeps_its_momentum() {
    let mesh = two_degrees();
    for method in ["implicit-euler", "symplectic-euler"] {
        let step = if method == "implicit-euler" { "time.step=0.01" } else { "time.step=0.001" };
        let mut simulation = run(&mesh, &hung(false), &[&format!("integrator.method='{method}'"), step]);
        let mean = vector(&mut simulation, "all", "mean displacement");
        for (got, wanted) in mean.iter().zip([0.1, 0.05, 0.0]) {
            assert!((got - wanted).abs() < 1e-12, "{method}: {mean:?}");
        }
        // 2 m³ of 1000 kg/m³ at a speed of √1.25 m/s.
        let ProbeValue::Scalar(kinetic) = simulation.probes()["all"]["kinetic energy"] else { panic!("a number") };
        assert!((kinetic - 1250.0).abs() < 1e-9 * 1250.0, "{method}: {kinetic}");
        let ProbeValue::Scalar(strain) = simulation.probes()["all"]["strain energy"] else { panic!("a number") };
        assert!(strain.abs() < 1e-18 * 1e6, "{method}: {strain:e}");
    }
}

/// In balance the reaction carries the whole weight, also that of nodes that follow others.
#[test]
fn reactions_carry_the_weight() {
    let set = ["integrator.method='quasi-static'", "time.step=1.0", "time.end=1.0", "linear_solver.method='direct'"];
    let mut simulation = run(&two_degrees(), &hung(true), &set);
    let reaction = vector(&mut simulation, "root", "reaction");
    assert!((reaction[1] - 2.0 * 1000.0 * 9.81).abs() < 1e-3, "{reaction:?}");
    assert!(violation(&two_degrees(), simulation.displacement()) < 1e-15);
}

/// A cantilever that is half quadratic and half linear bends more than a linear one and less than a quadratic one.
#[test]
fn a_cantilever_of_two_degrees_lies_between() {
    let tip = |first: &str, second: &str| {
        let [first, second] = [first, second].map(|id| by_id(id).unwrap());
        let set = [
            "integrator.method='quasi-static'",
            "time.step=1.0",
            "time.end=1.0",
            "linear_solver.method='direct'",
            "body.0.material.0.law='hooke'",
        ];
        let mesh = joined(piece(first, 0.0, 2), &piece(second, 1.0, 2));
        vector(&mut run(&mesh, &hung(true), &set), "tip", "mean displacement")[1]
    };
    let (linear, mixed, quadratic) = (tip("hex8", "hex8"), tip("hex20", "hex8"), tip("hex20", "hex20"));
    assert!(quadratic < mixed && mixed < linear && linear < 0.0, "{linear} {mixed} {quadratic}");
}

/// Without constraints the two sides part, which is what the switch is for.
#[test]
fn constraints_can_be_switched_off() {
    let mesh = two_degrees();
    let (on, off) = (run(&mesh, &hung(true), &[]), run(&mesh, &hung(true), &["body.0.conforming='off'"]));
    assert!(violation(&mesh, on.displacement()) < 1e-15);
    assert!(violation(&mesh, off.displacement()) > 1e-6);
}

/// A held node that follows free ones is refused, with its name and theirs, at the region that holds it.
#[test]
fn a_held_node_cannot_follow_free_ones() {
    // The plane x = 1 of the fine side, its edge at y = 0 left out: nodes that hang on that edge's coarse face stay.
    let region = "[[body.fix]]\nregion = { box = { min = [0.9, 0.4, -1], max = [1.1, 0.6, 2] } }\n";
    let scene = hung(true).replace("[[probe]]\nname = \"tip\"", &format!("{region}[[probe]]\nname = \"tip\""));
    let refused = load(&two_degrees(), &scene, &[], 1).map(|_| ()).unwrap_err();
    for part in ["scene.toml:", "not prescribed in the same way", "of body \"bar\"", "follows", "conforming = \"off\""]
    {
        assert!(refused.contains(part), "{part}: {refused}");
    }
}

/// A tie holds the nodes of one body on the faces of another: two bars glued end to end bend like one with hanging
/// nodes, and the constraint is exact.
#[test]
fn tied_bodies_are_one() {
    let scene = |to: &str| {
        format!(
            r#"
gravity = [0.0, -9.81, 0.0]
[time]
step = 1.0
end = 1.0
[integrator]
method = "quasi-static"
[linear_solver]
method = "direct"
[[body]]
name = "coarse"
density = 1000.0
mesh = {{ generator = "bar", size = [1, 1, 1], cells = [1, 1, 1], element = "hex8" }}
material = [{{ law = "hooke", young = 1e6, poisson = 0.3 }}]
fix = [{{ region = "x_min" }}]
[[body]]
name = "fine"
density = 1000.0
mesh = {{ generator = "bar", size = [1, 1, 1], cells = [2, 2, 2], origin = [1, 0, 0], element = "hex8" }}
material = [{{ law = "hooke", young = 1e6, poisson = 0.3 }}]
[[tie]]
body = "fine"
region = "x_min"
to_body = "coarse"
to_region = "x_max"
within = 0.01
{to}
[[probe]]
name = "tip"
body = "fine"
region = "x_max"
quantity = "mean displacement"
[[probe]]
name = "root"
body = "coarse"
region = "x_min"
quantity = "reaction"
"#
        )
    };
    let hex8 = by_id("hex8").unwrap();
    let one = joined(piece(hex8, 0.0, 1), &piece(hex8, 1.0, 2));
    let set = [
        "integrator.method='quasi-static'",
        "time.step=1.0",
        "time.end=1.0",
        "linear_solver.method='direct'",
        "body.0.material.0.law='hooke'",
    ];
    let wanted = vector(&mut run(&one, &hung(true), &set), "tip", "mean displacement");
    let mut glued = run(&one, &scene(""), &[]);
    let got = vector(&mut glued, "tip", "mean displacement");
    assert!(got.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-9 * wanted[1].abs()), "{got:?} {wanted:?}");
    let reaction = vector(&mut glued, "root", "reaction");
    assert!((reaction[1] - 2.0 * 9810.0).abs() < 1e-4, "{reaction:?}");

    let refused = |to: &str, part: &str| {
        let message = load(&one, &scene(to), &[], 1).map(|_| ()).unwrap_err();
        assert!(message.contains("scene.toml:") && message.contains(part), "{part}: {message}");
    };
    let tie = |body: &str, region: &str, to: &str, to_region: &str| {
        format!(
            "[[tie]]\nbody = \"{body}\"\nregion = \"{region}\"\nto_body = \"{to}\"\nto_region = \"{to_region}\"\nwithin = 0.01\n"
        )
    };
    refused(&tie("coarse", "x_max", "fine", "x_min"), "in a circle");
    refused(&tie("fine", "x_min", "coarse", "x_max"), "tied already by an earlier [[tie]]");
    refused(&tie("fine", "x_max", "coarse", "x_max"), "holds nothing");
}
