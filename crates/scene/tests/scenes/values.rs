//! Every part of a scene arrives with its value.

use souple_scene::expect::{Component, Expectation};
use souple_scene::integrator::Method;
use souple_scene::load::ForceAmount;
use souple_scene::mesh::Mesh;
use souple_scene::probe::Quantity;
use souple_scene::{Selection, canonical_json};

use crate::catalogue::{SHORT, read, scene};

#[test]
fn conditions_and_loads_arrive_with_units_converted() {
    let text = format!(
        r#"{SHORT}
[body.material.viscosity]
shear = "2 Pa s"
prony = [{{ fraction = 0.25, time = "100 ms" }}]
[[body.region]]
name = "corner"
region = {{ and = ["x_max", {{ not = {{ plane = {{ point = [0, "5 mm", 0], normal = [0, 1, 0] }} }} }}] }}
[[body.fix]]
region = {{ box = {{ min = [0, 0, 0], max = ["1 mm", 1, 1] }} }}
axes = ["y", "z"]
[[body.move]]
region = "corner"
axes = ["x"]
translation = {{ keys = [[0, [0, 0, 0]], ["20 ms", ["1 cm", 0, 0]]] }}
[[body.move]]
region = {{ sphere = {{ centre = [0, 0, 0], radius = "1 cm" }} }}
rotation = {{ axis = [0, 0, 2], keys = [[0, "0 rad"], [1, "90 deg"]] }}
[[body.force]]
region = "x_max"
total = [0, 0, "3 mN"]
factor = [[0, 0], [1, 1]]
[[body.force]]
region = {{ near_surface = 0.1 }}
per_node = [1, 2, 3]
[[body.traction]]
region = "y_max"
traction = [0, "-1 kPa", 0]
[[body.pressure]]
region = {{ or = ["z_min", "z_max"] }}
pressure = "120 mmHg"
"#
    );
    let (scene, warnings) = read(&text).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(warnings, []);
    let body = &scene.bodies[0];
    let viscosity = body.materials[0].viscosity.as_ref().unwrap();
    assert_eq!((viscosity.shear, viscosity.bulk), (2.0, 0.0));
    assert_eq!((viscosity.prony[0].fraction, viscosity.prony[0].time), (0.25, 0.1));
    let Selection::And(parts) = &*body.regions[0].region else { panic!("{:?}", body.regions) };
    let Selection::Not(plane) = &*parts[1] else { panic!("{parts:?}") };
    assert_eq!(plane.value, Selection::Plane { point: [0.0, 0.005, 0.0], normal: [0.0, 1.0, 0.0] });
    assert_eq!(*body.fixes[0].region, Selection::Box { min: [0.0; 3], max: [0.001, 1.0, 1.0] });
    assert_eq!(body.fixes[0].axes, [false, true, true]);
    assert_eq!(body.moves[0].axes, [true, false, false]);
    let keys = body.moves[0].translation.as_ref().unwrap();
    assert_eq!((keys[1].time, keys[1].value), (0.02, [0.01, 0.0, 0.0]));
    assert_eq!(*body.moves[1].region, Selection::Sphere { centre: [0.0; 3], radius: 0.01 });
    assert_eq!(body.moves[1].rotation.as_ref().unwrap().keys[1].value, 90.0);
    assert_eq!(body.forces[0].amount, ForceAmount::Total([0.0, 0.0, 0.003]));
    assert_eq!(body.forces[0].factor[1].value, 1.0);
    assert_eq!(body.forces[1].amount, ForceAmount::PerNode([1.0, 2.0, 3.0]));
    assert_eq!(*body.forces[1].region, Selection::NearSurface(0.1));
    assert_eq!(body.tractions[0].traction, [0.0, -1000.0, 0.0]);
    assert!((body.pressures[0].pressure - 15998.686).abs() < 0.01);
}

#[test]
fn several_bodies_ties_probes_and_expectations_refer_to_each_other() {
    let other = SHORT.split_once("[[body]]").unwrap().1.replace("\"bar\"\ndensity", "\"other bar\"\ndensity");
    let text = format!(
        r#"{SHORT}
[[body]]{other}
[[tie]]
body = "other bar"
region = "x_min"
to_body = "bar"
to_region = "x_max"
within = "1 mm"
[[probe]]
name = "tip"
body = "other bar"
region = "x_max"
quantity = ["mean displacement", "stress"]
[[probe]]
name = "line"
quantity = "deflection curve"
axis = "y"
[[expect]]
probe = "tip"
quantity = "mean displacement"
component = "z"
value = "-2 mm"
tolerance = "10 um"
[[expect]]
probe = "tip"
quantity = "stress"
value = [1, 2, 3, 4, 5, "6 kPa"]
relative_tolerance = 1e-3
[[expect]]
probe = "line"
index = 3
component = "magnitude"
value = 1
tolerance = 0.1
[[expect]]
max_cg_iterations = 40
"#
    );
    let scene = scene(&text);
    assert_eq!((*scene.ties[0].body, *scene.ties[0].to_body, scene.ties[0].within), (1, 0, 0.001));
    assert_eq!(scene.probes[0].body.as_ref().map(|body| body.value), Some(1));
    assert_eq!((&*scene.probes[1].region, scene.probes[1].body.as_ref()), (&Selection::All, None));
    let Expectation::Value(first) = &*scene.expectations[0] else { panic!() };
    assert_eq!((*first.probe, first.quantity, first.component), (0, Quantity::MeanDisplacement, Some(Component::Z)));
    assert_eq!((first.value.as_slice(), first.tolerance, first.relative_tolerance), (&[-0.002][..], 1e-5, 0.0));
    let Expectation::Value(second) = &*scene.expectations[1] else { panic!() };
    assert_eq!((second.value.as_slice(), second.relative_tolerance), (&[1.0, 2.0, 3.0, 4.0, 5.0, 6000.0][..], 1e-3));
    let Expectation::Value(third) = &*scene.expectations[2] else { panic!() };
    assert_eq!((*third.probe, third.index, third.component), (1, Some(3), Some(Component::Magnitude)));
    assert_eq!(*scene.expectations[3], Expectation::MaxCgIterations(40));
}

#[test]
fn a_mesh_file_has_a_path_and_a_scale() {
    let text = SHORT.replace(
        "{ generator = \"bar\", size = [1, 1, 1], cells = [2, 2, 2], element = \"hex8\" }",
        "{ file = \"liver.vtu\", scale = \"1 mm\" }",
    );
    let scene = scene(&text);
    let Mesh::File(file) = &scene.bodies[0].mesh.value else { panic!() };
    assert_eq!((file.path.as_str(), file.scale, file.path.at.line()), ("liver.vtu", 0.001, Some(7)));
}

#[test]
fn a_quadrature_is_named_by_its_points_or_its_id() {
    for value in ["8", "\"8\"", "\"hexahedron-8\""] {
        let scene = scene(&format!("{SHORT}[body.quadrature]\ntet4 = 1\nhex8 = {value}\n"));
        let chosen: Vec<(&str, &str)> =
            scene.bodies[0].quadrature.iter().map(|q| (q.element.as_str(), q.rule.as_str())).collect();
        assert_eq!(chosen, [("hex8", "hexahedron-8"), ("tet4", "tetrahedron-1")], "{value}");
    }
}

#[test]
fn quasi_static_scenes_may_leave_out_the_time_and_iterate_by_default() {
    let text = SHORT.split_once("[[body]]").map(|(_, rest)| format!("[[body]]{rest}")).unwrap();
    let scene = scene(&format!("{text}[integrator]\nmethod = \"quasi-static\"\nload_steps = 4\n"));
    assert_eq!((*scene.time.step, *scene.time.end, scene.time.step_count()), (1.0, 1.0, 1));
    assert_eq!(*scene.integrator.method, Method::QuasiStatic);
    assert_eq!((scene.integrator.newton_iterations, scene.integrator.load_steps), (50, 4));
}

#[test]
fn the_canonical_text_depends_on_what_is_described_and_not_on_how_it_is_written() {
    let first = scene(SHORT);
    let moved = SHORT.replace("step = 0.01\nend = 1.0", "# a comment\nend = \"1 s\"\nstep = \"10 ms\"");
    let moved = scene(&moved.replace("young = 1e5\npoisson = 0.3", "poisson = 0.3\nyoung = \"100 kPa\""));
    assert_eq!(first, moved);
    assert_eq!(canonical_json(&first), canonical_json(&moved));
    for (from, to) in [
        ("0.01", "0.02"),
        ("\"bar\"\n", "\"baz\"\n"),
        ("hex8", "tet4"),
        ("stvk", "hooke"),
        ("1e5", "100000.00000000001"),
    ] {
        let other = scene(&SHORT.replace(from, to));
        assert_ne!(first, other, "{from} → {to}");
        assert_ne!(canonical_json(&first), canonical_json(&other), "{from} → {to}");
    }
}

#[test]
fn suspicious_but_valid_values_are_warned_of() {
    let cases = [
        (
            "[integrator]\nmethod = \"rk4\"\nnewton_iterations = 3\n",
            "`newton_iterations` has no effect with method \"rk4\"",
        ),
        ("[integrator]\nload_steps = 3\n", "`load_steps` has no effect with method \"implicit-euler\""),
        ("[linear_solver]\nmethod = \"direct\"\ntolerance = 0.1\n", "`tolerance` has no effect with method \"direct\""),
        ("[[body.region]]\nname = \"a\"\nregion = \"x_min\"\n", "region \"a\" is not used"),
        ("[[probe]]\nname = \"p\"\nquantity = \"energy\"\naxis = \"y\"\n", "`axis` has no effect without"),
    ];
    for (addition, part) in cases {
        let (_, warnings) = read(&format!("{SHORT}{addition}")).unwrap_or_else(|errors| panic!("{errors}"));
        assert_eq!(warnings.len(), 1, "{addition}: {warnings:?}");
        let text = warnings[0].in_file("scene.toml");
        assert!(text.starts_with("scene.toml:1") && text.contains("warning") && text.contains(part), "{text}");
    }
    let (_, warnings) = read(&SHORT.replace("end = 1.0", "end = 1.004")).unwrap();
    assert!(
        warnings[0].in_file("s").contains("s:3:7: warning: `end` is not a whole number of steps; 100 steps"),
        "{warnings:?}"
    );
}
