//! `--set key=value` changes one value, and its messages name it.

use souple_scene::integrator::Method;
use souple_scene::mesh::Mesh;
use souple_scene::{ParameterValue, Scene, SceneErrors, parse_with_overrides};

use crate::catalogue::{EXAMPLE, SHORT, catalogue};

fn with(text: &str, overrides: &[&str]) -> Result<Scene, SceneErrors> {
    parse_with_overrides(text, "scene.toml", overrides, &catalogue()).map(|(scene, _)| scene)
}

fn scene(overrides: &[&str]) -> Scene {
    with(EXAMPLE, overrides).unwrap_or_else(|errors| panic!("{errors}"))
}

#[test]
fn values_are_found_by_path_position_name_and_short_form() {
    let young =
        |scene: &Scene, material: usize| scene.bodies[0].materials[material].parameter("young").unwrap().value.clone();
    assert_eq!(*scene(&["time.end=0.5"]).time.end, 0.5);
    assert_eq!(*scene(&[" time.end = \"500 ms\" "]).time.end, 0.5);
    assert_eq!(*scene(&["body.0.density=900"]).bodies[0].density, 900.0);
    assert_eq!(*scene(&["body.bar.density=900"]).bodies[0].density, 900.0);
    assert_eq!(*scene(&["body.\"bar\".density=1 g/cm^3"]).bodies[0].density, 1000.0);
    assert_eq!(young(&scene(&["material.1.young=4 kPa"]), 1), ParameterValue::Number(4000.0));
    assert_eq!(young(&scene(&["body.bar.material.0.young=5"]), 0), ParameterValue::Number(5.0));
    assert_eq!(*scene(&["integrator.method=rk4"]).integrator.method, Method::Rk4);
    assert_eq!(
        *scene(&["linear_solver.operator=assembled", "title=a=b"]).linear_solver.operator.name_of(),
        *"assembled"
    );
    assert_eq!(scene(&["title=a=b"]).title, "a=b");
    assert_eq!(scene(&["output.fields=[\"stress\"]"]).output.fields.len(), 1);
    assert_eq!(scene(&["integrator.rayleigh.mass=0.5"]).integrator.rayleigh.mass, 0.5);
    assert_eq!(scene(&["time.end=1", "time.end=2"]).time.end.value, 2.0);
    let Mesh::Bar(bar) = scene(&["mesh.size.0=4", "mesh.cells=[1, 2, 3]"]).bodies[0].mesh.value.clone() else {
        panic!()
    };
    assert_eq!((bar.size.value, bar.cells.value), ([4.0, 1.0, 1.0], [1, 2, 3]));
    let probe = &scene(&["probe.tip.region={ element = \"tet4\" }"]).probes[0].clone();
    assert_eq!(*probe.region, souple_scene::Selection::Element("tet4".to_owned()));
}

trait NameOf {
    fn name_of(&self) -> &'static str;
}

impl NameOf for souple_scene::Spanned<souple_scene::linear_solver::Operator> {
    fn name_of(&self) -> &'static str {
        souple_scene::Named::name(self.value)
    }
}

#[test]
fn an_override_equals_the_same_value_in_the_text() {
    let written = with(&SHORT.replace("1e5", "2e5"), &[]).unwrap();
    assert_eq!(with(SHORT, &["material.0.young=2e5"]).unwrap(), written);
    assert_ne!(with(SHORT, &[]).unwrap(), written);
}

#[test]
fn mistakes_name_the_override_instead_of_a_line() {
    for (text, message) in [
        ("time.end", "there is no `=`; write `key=value` as in `time.end=0.5`"),
        ("time.end=", "there is no value after `=`"),
        ("=3", "a part of the key is empty"),
        ("time..end=3", "a part of the key is empty"),
        ("time.end=-1", "`end` must be greater than 0 s, found -1"),
        ("time.end=5 mm", "`end`: expected a time"),
        ("time.ende=1", "unknown key `ende` in [time]; did you mean `end`?"),
        ("tme.end=1", "unknown key `tme` in the scene; did you mean `time`?"),
        ("time.end.x=1", "`time.end` is the number 10; it has no `x`"),
        ("time.end.x.y=1", "`time.end` is the number 10; it has no `x`"),
        ("body.1.density=1", "`body` has only one entry, 0"),
        ("material.2.young=1", "`body.0.material` has the entries 0 to 1, not 2"),
        ("body.baar.density=1", "`body` has no entry named `baar`; did you mean `bar`?; its entries: bar"),
        ("material.young=1", "`body.0.material` is a list without names: write the number of the entry"),
        ("expect.0.value=1", "the scene has no list `expect`"),
        ("output.fields=[stress]", "the value `[stress]` is not valid TOML"),
        ("mesh.cells.1=0", "`cells` must be at least 1, found 0"),
        ("integrator.method=rk5", "unknown method `rk5`; did you mean `rk2`?"),
        ("a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a=1", "the key has 19 parts"),
        ("material.0.law=nope", "unknown law `nope`"),
        ("probe={}", "`probe` must be a list of tables"),
    ] {
        let errors = with(EXAMPLE, &[text]).expect_err(text);
        let first = &errors.to_string();
        assert!(first.starts_with(&format!("--set {text}: {message}")), "{first}\n{message}");
    }
}

#[test]
fn errors_of_the_text_and_of_overrides_come_together() {
    let text = SHORT.replace("step = 0.01", "step = 0");
    let errors = with(&text, &["body.0.density=0", "nothing"]).unwrap_err();
    let lines: Vec<String> = errors.to_string().lines().map(str::to_owned).collect();
    assert_eq!(lines.len(), 3, "{lines:#?}");
    assert!(lines[0].starts_with("scene.toml:2:8:") && lines[1].starts_with("--set body.0.density=0: `density`"));
    assert!(lines[2].starts_with("--set nothing: there is no `=`"));
}
