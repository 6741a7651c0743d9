//! Folders with `params.csv`, `barres.csv` and `Barre/NAME.csv`: groups as a thesis of 2014 describes them.
//!
//! ```text
//! params.csv      name type first last step order operation      one parameter per line
//! barres.csv      NAME                                           one bar per line
//! Barre/NAME.csv  typePU CPU | component … | category … | fraction law element cut
//! ```
//!
//! Fields are separated by white space, commas or semicolons; `#` starts a comment.
//! `type` 0 is a whole number, 1 a real one; `operation` 0 multiplies and 1 adds; the last value is the first that
//! reaches or passes `last`, so that a `last` below `first` means one value.
//! The parameter with the smallest `order` varies most quickly.

use crate::group::{Bar, BaseScene, Group, Parameter, Section, Source, Value, Variation};
use crate::problem::Problems;
use crate::values::{End, range};

/// The parameters, all of which a `params.csv` gives.
pub const PARAMETERS: &[&str] = &[
    "nbCube",
    "longueur",
    "largeurSection",
    "densite",
    "moduleYoung",
    "poissonRatio",
    "typeIntegration",
    "epsilonStable",
    "pas",
    "typeSimulation",
    "pourcentage",
    "tempsEtirement",
];

/// Names of elements in such files, and ours.
const ELEMENTS: &[(&str, &str)] = &[
    ("Triangle", "tri3"),
    ("Quad", "quad4"),
    ("Quadrangle", "quad4"),
    ("Tetra", "tet4"),
    ("Tetraedre", "tet4"),
    ("Prisme", "prism6"),
    ("Pyramide", "pyramid5"),
    ("Cube", "hex8"),
    ("Hexa", "hex8"),
    ("Hexaedre", "hex8"),
];

/// Names of laws in such files, and ours.
const LAWS: &[(&str, &str)] = &[("Hooke", "hooke"), ("SaintVenant", "stvk")];

/// Reads a folder of this kind; `read` gives the text of a file in it, `folder` is its name in messages.
///
/// # Errors
///
/// Everything that is wrong, with its files and lines.
pub fn parse(
    name: &str,
    folder: &str,
    read: &mut dyn FnMut(&str) -> Result<String, String>,
) -> Result<Group, Problems> {
    let mut problems = Problems::default();
    let file = |local: &str| if folder.is_empty() { local.to_owned() } else { format!("{folder}/{local}") };
    let mut text = |local: &str, problems: &mut Problems| match read(local) {
        Ok(text) => Some(text),
        Err(why) => {
            problems.add(
                &file(local),
                0,
                format!("{why}; such a folder holds params.csv, barres.csv and Barre/NAME.csv"),
            );
            None
        }
    };
    let parameters = text("params.csv", &mut problems).map(|t| parameters(&t, &file("params.csv"), &mut problems));
    let mut bars: Vec<Bar> = Vec::new();
    if let Some(list) = text("barres.csv", &mut problems) {
        let names = lines(&list);
        if names.is_empty() {
            problems.add(&file("barres.csv"), 0, "no bar is listed; write the name of one per line");
        }
        for (line, fields) in names {
            let [bar] = fields[..] else {
                let message = format!("expected the name of one bar, found {} fields", fields.len());
                problems.add(&file("barres.csv"), line, message);
                continue;
            };
            if bars.iter().any(|b| b.name == bar) {
                problems.add(&file("barres.csv"), line, format!("{bar} is listed twice; remove one"));
                continue;
            }
            let local = format!("Barre/{bar}.csv");
            if let Some(text) = text(&local, &mut problems) {
                bars.push(read_bar(bar, &text, &file(&local), &mut problems));
            }
        }
    }
    let group = parameters.map(|parameters| Group {
        name: name.to_owned(),
        source: Source::Folder,
        scene: BaseScene { path: None, text: crate::folder_scene::SCENE.to_owned() },
        parameters,
        samples: 1,
        cases: Vec::new(),
        bars,
        devices: vec!["cpu".to_owned()],
    });
    problems.none_or(group)
}

/// The lines that hold something, with their numbers and fields.
fn lines(text: &str) -> Vec<(usize, Vec<&str>)> {
    let between = |c: char| c.is_whitespace() || matches!(c, ',' | ';' | '\u{feff}');
    text.lines()
        .enumerate()
        .map(|(n, line)| {
            let content = line.split('#').next().unwrap_or("");
            (n + 1, content.split(between).filter(|field| !field.is_empty()).collect::<Vec<_>>())
        })
        .filter(|(_, fields)| !fields.is_empty())
        .collect()
}

fn parameters(text: &str, file: &str, problems: &mut Problems) -> Vec<Parameter> {
    let mut found: Vec<(f64, Parameter)> = Vec::new();
    for (line, fields) in lines(text) {
        let [name, rest @ ..] = &fields[..] else { continue };
        if rest.len() != 6 {
            let message =
                format!("expected 7 fields (name, type, first, last, step, order, operation), found {}", fields.len());
            problems.add(file, line, message);
            continue;
        }
        let mut wrong = false;
        if !PARAMETERS.contains(name) {
            problems.add(file, line, format!("unknown parameter `{name}`; known: {}", PARAMETERS.join(", ")));
            wrong = true;
        }
        if found.iter().any(|(_, p)| p.name == *name) {
            problems.add(file, line, format!("`{name}` is given twice; remove one"));
            wrong = true;
        }
        let mut number = |index: usize, what: &str| -> f64 {
            match rest[index].parse::<f64>() {
                Ok(x) if x.is_finite() => x,
                _ => {
                    let message = format!("the {what} of `{name}` must be a number, found `{}`", rest[index]);
                    problems.add(file, line, message);
                    wrong = true;
                    0.0
                }
            }
        };
        let [kind, from, to] = [number(0, "type"), number(1, "first value"), number(2, "last value")];
        let [step, order, operation] = [number(3, "step"), number(4, "order"), number(5, "operation")];
        for (what, value, meaning) in
            [("type", kind, "0 (whole) or 1 (real)"), ("operation", operation, "0 (multiply) or 1 (add)")]
        {
            if value != 0.0 && value != 1.0 {
                problems.add(file, line, format!("the {what} of `{name}` must be {meaning}, found {value}"));
                wrong = true;
            }
        }
        if wrong {
            continue;
        }
        let variation = if operation == 0.0 {
            Variation::Multiplying { from, to, factor: step }
        } else {
            Variation::Adding { from, to, step }
        };
        match range(variation, End::Reaching) {
            Ok(values) if kind == 0.0 && values.iter().any(|x| x.fract() != 0.0) => {
                let message = format!("`{name}` has type 0 (whole) and values that are not; write type 1");
                problems.add(file, line, message);
            }
            Ok(values) => {
                let value = |x: f64| if kind == 0.0 { Value::Whole(x as i64) } else { Value::Number(x) };
                let values = values.into_iter().map(value).collect();
                found.push((order, Parameter { name: (*name).to_owned(), variation, values }));
            }
            Err(why) => problems.add(file, line, format!("`{name}`: {why}")),
        }
    }
    let given: Vec<&str> = lines(text).iter().map(|(_, fields)| fields[0]).collect();
    for name in PARAMETERS.iter().filter(|name| !given.contains(name)) {
        problems.add(
            file,
            0,
            format!("`{name}` is missing; write a line `{name} type first last step order operation`"),
        );
    }
    // Equal orders keep the order of the lines.
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.into_iter().map(|(_, parameter)| parameter).collect()
}

fn read_bar(name: &str, text: &str, file: &str, problems: &mut Problems) -> Bar {
    let mut bar = Bar { name: name.to_owned(), device: None, sections: Vec::new() };
    let mut end = 0.0;
    for (line, fields) in lines(text) {
        match fields[..] {
            ["typePU", unit] => match unit {
                "CPU" => bar.device = Some("cpu".to_owned()),
                "GPU" => bar.device = Some("gpu".to_owned()),
                _ => problems.add(file, line, format!("typePU must be CPU or GPU, found `{unit}`")),
            },
            // Classes of the program that these files were written for.
            ["component" | "category", _] => {}
            [fraction, law, element, _cut] => {
                let until = fraction.parse::<f64>().ok().filter(|x| *x > end && *x <= 1.0);
                if until.is_none() {
                    let message =
                        format!("a section must end after {end} and at most at 1.0 of the length, found `{fraction}`");
                    problems.add(file, line, message);
                }
                end = until.unwrap_or(end);
                let law = word(law, LAWS, "law", file, line, problems);
                let element = word(element, ELEMENTS, "element", file, line, problems);
                if let (Some(law), Some(element), Some(until)) = (law, element, until) {
                    bar.sections.push(Section { until, law, element, quadrature: None, parameters: Vec::new() });
                }
            }
            _ => problems.add(
                file,
                line,
                "expected `typePU CPU`, `component NAME`, `category NAME`, or a section `fraction law element cut`",
            ),
        }
    }
    if end != 1.0 {
        problems.add(file, 0, format!("the sections end at {end} of the length; the last one must end at 1.0"));
    }
    bar
}

/// Our name for one of theirs.
fn word(
    found: &str,
    known: &[(&str, &str)],
    what: &str,
    file: &str,
    line: usize,
    problems: &mut Problems,
) -> Option<String> {
    let ours = known.iter().find(|(theirs, _)| *theirs == found).map(|(_, ours)| (*ours).to_owned());
    if ours.is_none() {
        let names: Vec<&str> = known.iter().map(|(theirs, _)| *theirs).collect();
        problems.add(file, line, format!("unknown {what} `{found}`; known: {}", names.join(", ")));
    }
    ours
}
