//! The example of the documentation says what it seems to say.

use souple_scene::choice::Axis;
use souple_scene::integrator::Method;
use souple_scene::linear_solver::{LinearMethod, Operator, Preconditioner};
use souple_scene::mesh::{Mesh, Transition};
use souple_scene::output::{Field, Format};
use souple_scene::probe::Quantity;
use souple_scene::{ParameterValue, Selection};

use crate::catalogue::{EXAMPLE, read, scene};

#[test]
fn the_example_has_every_value_that_it_shows() {
    let (scene, warnings) = read(EXAMPLE).unwrap();
    assert_eq!(warnings, []);
    assert_eq!(scene.title, "Mixed bar under gravity");
    assert_eq!(scene.gravity, [0.0, -9.81, 0.0]);
    assert_eq!((*scene.time.step, *scene.time.end), (0.01, 10.0));
    let stop = scene.time.stop.as_ref().unwrap();
    assert_eq!((stop.mean_kinetic_energy, stop.check_every), (5e-9, Some(0.05)));
    assert_eq!(*scene.integrator.method, Method::ImplicitEuler);
    assert_eq!((scene.integrator.newton_iterations, scene.integrator.velocity_damping), (1, 3.0));
    let solver = &scene.linear_solver;
    assert_eq!((*solver.method, *solver.preconditioner), (LinearMethod::Cg, Preconditioner::BlockJacobi));
    assert_eq!((solver.tolerance, solver.max_iterations, *solver.operator), (1e-6, 200, Operator::Auto));
    assert_eq!(scene.bodies.len(), 1);
    let body = &scene.bodies[0];
    assert_eq!((body.name.as_str(), *body.density), ("bar", 1000.0));
    let Mesh::Bar(bar) = &body.mesh.value else { panic!("{:?}", body.mesh) };
    assert_eq!((*bar.size, *bar.cells, bar.origin), ([8.0, 1.0, 1.0], [24, 4, 4], [0.0; 3]));
    assert_eq!((bar.transition, bar.tetrahedra, bar.prism_axis), (Transition::Keep, 6, Axis::X));
    let sections: Vec<(f64, &str)> = bar.sections.iter().map(|s| (s.until, s.element.as_str())).collect();
    assert_eq!(sections, [(0.25, "prism6"), (0.5, "pyramid5"), (0.75, "hex8"), (1.0, "tet4")]);
    let laws: Vec<&str> = body.materials.iter().map(|m| m.law.as_str()).collect();
    assert_eq!(laws, ["stvk", "hooke"]);
    assert_eq!(*body.materials[0].region, Selection::All);
    assert_eq!(*body.materials[1].region, Selection::Element("prism6".to_owned()));
    for material in &body.materials {
        assert_eq!(material.parameter("young").unwrap().value, ParameterValue::Number(1e8));
        assert_eq!(material.parameter("poisson").unwrap().value, ParameterValue::Number(0.0));
        assert_eq!(material.parameters.len(), 2);
    }
    assert_eq!(body.fixes.len(), 1);
    assert_eq!((&*body.fixes[0].region, body.fixes[0].axes), (&Selection::Name("x_min".to_owned()), [true; 3]));
    let rotation = body.moves[0].rotation.as_ref().unwrap();
    assert_eq!((rotation.axis, rotation.through), ([1.0, 0.0, 0.0], [8.0, 0.5, 0.5]));
    let keys: Vec<(f64, f64)> = rotation.keys.iter().map(|key| (key.time, key.value)).collect();
    assert_eq!(keys, [(0.0, 0.0), (5.0, 180.0)]);
    assert_eq!(body.moves[0].translation, None);
    let probe = &scene.probes[0];
    assert_eq!((probe.name.as_str(), &*probe.region), ("tip", &Selection::Name("x_max".to_owned())));
    assert_eq!((probe.quantities.len(), *probe.quantities[0]), (1, Quantity::MeanDisplacement));
    assert_eq!((scene.output.every.as_ref().map(|e| e.value), scene.output.format), (Some(0.1), Format::Vtu));
    assert_eq!(scene.output.fields, [Field::Displacement, Field::Velocity]);
}

#[test]
fn values_remember_where_they_stand() {
    let scene = scene(EXAMPLE);
    let line_of = |part: &str| EXAMPLE.lines().position(|line| line.starts_with(part)).map(|line| line as u32 + 1);
    assert_eq!(scene.time.step.at.line(), line_of("step ="));
    assert_eq!(scene.integrator.method.at.line(), line_of("method = \"implicit"));
    let body = &scene.bodies[0];
    assert_eq!(body.at.line(), line_of("[[body]]"));
    assert_eq!(body.mesh.at.line(), line_of("[body.mesh]"));
    assert_eq!(
        body.fixes[0].region.at.in_file("a.toml"),
        format!("a.toml:{}:10", line_of("region = \"x_min\"").unwrap())
    );
    assert_eq!(body.materials[0].parameter("young").unwrap().at.line(), line_of("young"));
    assert_eq!(scene.probes[0].region.at.line().unwrap() - 1, line_of("name = \"tip\"").unwrap());
}
