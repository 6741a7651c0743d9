//! A few laws of every kind of parameter, and short scenes to change.

use souple_scene::catalogue::LawCheck;
use souple_scene::{
    Bound, Catalogue, LawEntry, LawRefusal, ParameterEntry, ParameterShape, ParameterValue, Scene, SceneErrors,
    Warning, parse,
};

pub(crate) const EXAMPLE: &str = souple_scene::reference::EXAMPLE;

/// The shortest valid scene; `law` stands on line 10.
pub(crate) const SHORT: &str = r#"[time]
step = 0.01
end = 1.0
[[body]]
name = "bar"
density = 1000.0
mesh = { generator = "bar", size = [1, 1, 1], cells = [2, 2, 2], element = "hex8" }
[[body.material]]
region = "all"
law = "stvk"
young = 1e5
poisson = 0.3
"#;

fn parameter(name: &str, unit: &str, minimum: Option<Bound>, maximum: Option<Bound>) -> ParameterEntry {
    ParameterEntry {
        name: name.to_owned(),
        unit: unit.to_owned(),
        shape: ParameterShape::Number,
        minimum,
        maximum,
        default: None,
        about: format!("the {name} of the test"),
    }
}

fn isotropic() -> Vec<ParameterEntry> {
    vec![
        parameter("young", "Pa", Some(Bound::Open(0.0)), None),
        parameter("poisson", "", Some(Bound::Open(-1.0)), Some(Bound::Open(0.5))),
    ]
}

fn same_length(parameters: &[(&str, &ParameterValue)]) -> Result<(), LawRefusal> {
    let length = |name: &str| {
        parameters.iter().find(|p| p.0 == name).map(|p| match p.1 {
            ParameterValue::List(values) => values.len(),
            ParameterValue::Number(_) => 1,
        })
    };
    if length("mu") == length("alpha") {
        return Ok(());
    }
    let message = "must have as many values as `mu`".to_owned();
    Err(LawRefusal { parameter: Some("alpha".to_owned()), message })
}

fn user_law(energy: &str, parameters: &[(&str, &ParameterValue)]) -> Result<(), LawRefusal> {
    if energy.contains("ln(0)") {
        return Err(LawRefusal { parameter: None, message: "the energy is not finite at rest".to_owned() });
    }
    match parameters.iter().find(|p| p.0 == "bad") {
        Some(_) => Err(LawRefusal { parameter: Some("bad".to_owned()), message: "is bad".to_owned() }),
        None => Ok(()),
    }
}

pub(crate) fn catalogue() -> Catalogue {
    let law = |id: &str, parameters, check: Option<LawCheck>| LawEntry { id: id.to_owned(), parameters, check };
    let positive = Some(Bound::Open(0.0));
    let list = |length| ParameterShape::List { length };
    let mut fibre = isotropic();
    fibre.push(ParameterEntry {
        default: Some(ParameterValue::Number(0.0)),
        ..parameter("young_fibre", "Pa", None, None)
    });
    fibre.push(ParameterEntry { shape: ParameterShape::Direction, ..parameter("direction", "", None, None) });
    let mooney = ["c10", "c01", "bulk"].map(|name| parameter(name, "Pa", positive, None)).to_vec();
    let ogden = vec![
        ParameterEntry { shape: list(None), ..parameter("mu", "Pa", None, None) },
        ParameterEntry { shape: list(None), ..parameter("alpha", "1", None, None) },
        parameter("bulk", "Pa", positive, None),
    ];
    let fung = vec![
        parameter("c", "Pa", positive, None),
        ParameterEntry { shape: list(Some(3)), ..parameter("coefficients", "", None, None) },
    ];
    Catalogue {
        laws: vec![
            law("hooke", isotropic(), None),
            law("stvk", isotropic(), None),
            law("transverse-stvk", fibre, None),
            law("mooney-rivlin", mooney, None),
            law("ogden", ogden, Some(same_length)),
            law("fung", fung, None),
        ],
        user_law: Some(user_law),
    }
}

pub(crate) fn read(text: &str) -> Result<(Scene, Vec<Warning>), SceneErrors> {
    parse(text, "scene.toml", &catalogue())
}

/// The scene of a text that must be valid.
pub(crate) fn scene(text: &str) -> Scene {
    read(text).unwrap_or_else(|errors| panic!("{errors}\n---\n{text}")).0
}

/// The messages of a text that must not be valid, one a line.
pub(crate) fn messages(text: &str) -> Vec<String> {
    match read(text) {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(errors) => errors.to_string().lines().map(str::to_owned).collect(),
    }
}
