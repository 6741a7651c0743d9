//! `campaign.toml`: a base scene, what varies, bars, devices.
//!
//! ```toml
//! name = "softness"
//! scene = "bar.toml"                # relative to this file
//! devices = ["cpu"]
//!
//! [[vary]]                          # the first one varies most quickly
//! key = "body.0.density"            # as in `souple run --set`
//! values = [900, "1 g/cm^3"]
//! [[vary]]
//! key = "material.*.young"          # `*`: every material of the body
//! from = 1e6
//! to = 8e6
//! factor = 2                        # or: step = 1e6
//! [[vary]]
//! key = "time.step"
//! low = 0.001                       # drawn, together with all others that have bounds
//! high = 0.01
//! [hypercube]
//! samples = 8
//! seed = 1
//!
//! [[case]]                          # changes that belong together; their names vary most quickly, as `case`
//! name = "fine"
//! set = { "body.0.mesh.cells" = [80, 8, 8], "expect.0.tolerance" = 1e-4 }
//! ends = "finished"                 # or: "failed", "invalid"
//!
//! [[bar]]                           # crossed with all the above
//! name = "mixed"
//! sections = [
//!   { until = 0.5, law = "hooke", element = "hex8", quadrature = 8 },
//!   { until = 1.0, law = "stvk", element = "tet4" },
//! ]
//! ```

use crate::group::{Bar, BaseScene, CASE, Case, Ending, Group, Parameter, Section, Source, Value, Variation};
use crate::problem::Problems;
use crate::toml_table::{Table, line};
use crate::values::{End, VALUES_AT_MOST, latin_hypercube, range};
use souple_simulation::lists::{find_element, find_law};
use std::path::{Path, PathBuf};
use toml::de::DeTable;

const KEYS: &[&str] = &["name", "scene", "devices", "case", "vary", "hypercube", "bar"];
const VARY: &[&str] = &["key", "values", "from", "to", "step", "factor", "low", "high"];
const SECTION: &[&str] = &["until", "law", "element", "quadrature"];

/// Reads a description; `file` is its name in messages, `read` gives the text of the base scene, `folder` holds it.
///
/// # Errors
///
/// Everything that is wrong, with its lines.
pub fn parse(
    text: &str,
    file: &str,
    folder: &Path,
    read: &mut dyn FnMut(&Path) -> Result<String, String>,
) -> Result<Group, Problems> {
    let mut problems = Problems::default();
    let (parsed, errors) = DeTable::parse_recoverable(text);
    if !errors.is_empty() {
        for error in errors.iter().take(3) {
            let at = error.span().map_or(1, |span| line(text, span.start));
            problems.add(file, at, format!("not valid TOML: {}", error.message()));
        }
        return Err(problems);
    }
    let root = Table { table: parsed.get_ref(), header: "the campaign", span: 0..0, text, file };
    root.only(KEYS, &mut problems);
    let name = root.text_of("name", &mut problems).or_else(|| {
        folder.file_name().filter(|_| root.get("name").is_none()).map(|n| n.to_string_lossy().into_owned())
    });
    let scene = base_scene(&root, folder, read, &mut problems);
    let cases = cases(&root, &mut problems);
    let (mut parameters, samples) = parameters(&root, &mut problems);
    if !cases.is_empty() {
        let values = cases.iter().map(|case| Value::Toml(format!("{:?}", case.name))).collect();
        parameters.insert(0, Parameter { name: CASE.to_owned(), variation: Variation::List, values });
    }
    let bars = bars(&root, &mut problems);
    let devices = match root.get("devices") {
        None => Some(vec!["cpu".to_owned()]),
        Some(_) => root.texts("devices", &mut problems),
    };
    let group = match (name, scene, devices) {
        (Some(name), Some(scene), Some(devices)) => {
            Some(Group { name, source: Source::Toml, scene, parameters, samples, cases, bars, devices })
        }
        (None, ..) if problems.0.is_empty() => {
            problems.add(file, 1, "the campaign needs `name`: what the database calls it");
            None
        }
        _ => None,
    };
    problems.none_or(group)
}

fn base_scene(
    root: &Table<'_>,
    folder: &Path,
    read: &mut dyn FnMut(&Path) -> Result<String, String>,
    problems: &mut Problems,
) -> Option<BaseScene> {
    let Some(value) = root.get("scene") else {
        problems.add(root.file, 1, "the campaign needs `scene`: the base scene's file, relative to this one");
        return None;
    };
    let path: PathBuf = folder.join(root.text_of("scene", problems)?);
    match read(&path) {
        Ok(text) => Some(BaseScene { path: Some(path), text }),
        Err(why) => {
            root.wrong(&value.span(), problems, format!("{why}; `scene` is relative to {}", root.file));
            None
        }
    }
}

/// The parameters and the number of samples.
fn parameters(root: &Table<'_>, problems: &mut Problems) -> (Vec<Parameter>, usize) {
    let (samples, seed) = hypercube(root, problems);
    let mut parameters: Vec<Parameter> = Vec::new();
    let mut drawn = 0;
    for table in root.tables("vary", "[[vary]]", problems) {
        table.only(VARY, problems);
        let key = table.text_of("key", problems);
        if table.get("key").is_none() {
            table.wrong(&table.span, problems, "[[vary]] needs `key`: a key of the scene as in `souple run --set`");
        }
        if key.as_deref() == Some(CASE) {
            table.wrong(&table.span, problems, "`case` is no key of a scene; write [[case]] with `name` and `set`");
        }
        if let Some(key) = &key
            && parameters.iter().any(|p| p.name == *key)
        {
            table.wrong(&table.span, problems, format!("`{key}` varies already; write all its values in one [[vary]]"));
        }
        let values = variation(&table, samples, seed, drawn, problems);
        if let (Some(key), Some((variation, values))) = (key, values) {
            drawn += usize::from(matches!(variation, Variation::LatinHypercube { .. }));
            parameters.push(Parameter { name: key, variation, values });
        }
    }
    if drawn == 0 && samples.is_some() && problems.0.is_empty() {
        let span = root.get("hypercube").map_or(0..0, toml::Spanned::span);
        root.wrong(&span, problems, "no [[vary]] has `low` and `high`: give one, or remove [hypercube]");
    }
    (parameters, if drawn > 0 { samples.unwrap_or(1) } else { 1 })
}

fn hypercube(root: &Table<'_>, problems: &mut Problems) -> (Option<usize>, u64) {
    let Some(table) = root.table("hypercube", "[hypercube]", problems) else { return (None, 0) };
    table.only(&["samples", "seed"], problems);
    let seed = table.count("seed", problems).unwrap_or(0);
    match table.count("samples", problems) {
        Some(n) if (1..=VALUES_AT_MOST as u64).contains(&n) => (Some(n as usize), seed),
        Some(n) => {
            table.wrong(&table.span, problems, format!("`samples` must be from 1 to {VALUES_AT_MOST}, found {n}"));
            (None, seed)
        }
        None => {
            if table.get("samples").is_none() {
                table.wrong(&table.span, problems, "[hypercube] needs `samples`: how many values each parameter gets");
            }
            (None, seed)
        }
    }
}

fn variation(
    table: &Table<'_>,
    samples: Option<usize>,
    seed: u64,
    drawn: usize,
    problems: &mut Problems,
) -> Option<(Variation, Vec<Value>)> {
    let given = |keys: &[&str]| keys.iter().filter(|k| table.get(k).is_some()).count();
    let (list, bounds, drawing) = (given(&["values"]), given(&["from", "to"]), given(&["low", "high"]));
    let steps = given(&["step", "factor"]);
    match (list, bounds, steps, drawing) {
        (1, 0, 0, 0) => Some((Variation::List, table.values("values", problems)?)),
        (0, 2, 1, 0) => {
            let from = table.number("from", problems)?;
            let to = table.number("to", problems)?;
            let variation = match table.get("step") {
                Some(_) => Variation::Adding { from, to, step: table.number("step", problems)? },
                None => Variation::Multiplying { from, to, factor: table.number("factor", problems)? },
            };
            let whole = table.is_whole("from") && (table.is_whole("step") || table.is_whole("factor"));
            match range(variation, End::Within) {
                Ok(values) => {
                    let value = |x: f64| if whole { Value::Whole(x.round() as i64) } else { Value::Number(x) };
                    Some((variation, values.into_iter().map(value).collect()))
                }
                Err(why) => {
                    table.wrong(&table.span, problems, why);
                    None
                }
            }
        }
        (0, 0, 0, 2) => {
            let (low, high) = (table.number("low", problems)?, table.number("high", problems)?);
            let Some(samples) = samples else {
                table.wrong(&table.span, problems, "`low` and `high` need [hypercube] with `samples`");
                return None;
            };
            if low >= high {
                table.wrong(&table.span, problems, format!("`low` must be below `high`, found {low} and {high}"));
                return None;
            }
            let values = latin_hypercube(low, high, samples, seed, drawn);
            Some((Variation::LatinHypercube { low, high }, values.into_iter().map(Value::Number).collect()))
        }
        _ => {
            table.wrong(
                &table.span,
                problems,
                "[[vary]] needs either `values`, or `from`, `to` and one of `step` and `factor`, or `low` and `high`",
            );
            None
        }
    }
}

fn cases(root: &Table<'_>, problems: &mut Problems) -> Vec<Case> {
    let mut cases: Vec<Case> = Vec::new();
    for table in root.tables("case", "[[case]]", problems) {
        table.only(&["name", "set", "ends"], problems);
        for (key, about) in [("name", "what the database calls it"), ("set", "keys of the scene and their values")] {
            if table.get(key).is_none() {
                table.wrong(&table.span, problems, format!("[[case]] needs `{key}`: {about}"));
            }
        }
        let set = table.table("set", "{ \"key of the scene\" = value }", problems).map_or(Vec::new(), |set| {
            set.table.iter().map(|(key, v)| (key.get_ref().to_string(), table.text[v.span()].to_owned())).collect()
        });
        let ends = match table.text_of("ends", problems).as_deref() {
            None | Some("finished") => Ending::Finished,
            Some("failed") => Ending::Failed,
            Some("invalid") => Ending::Invalid,
            Some(other) => {
                let message = format!("`ends` must be \"finished\", \"failed\" or \"invalid\", found \"{other}\"");
                table.wrong(&table.span, problems, message);
                Ending::Finished
            }
        };
        let Some(name) = table.text_of("name", problems) else { continue };
        if cases.iter().any(|c| c.name == name) {
            table.wrong(&table.span, problems, format!("there is already a case named \"{name}\"; rename this one"));
        }
        cases.push(Case { name, set, ends });
    }
    cases
}

fn bars(root: &Table<'_>, problems: &mut Problems) -> Vec<Bar> {
    let mut bars: Vec<Bar> = Vec::new();
    for table in root.tables("bar", "[[bar]]", problems) {
        table.only(&["name", "sections"], problems);
        for (key, about) in [("name", "what the database calls it"), ("sections", "its parts along x")] {
            if table.get(key).is_none() {
                table.wrong(&table.span, problems, format!("[[bar]] needs `{key}`: {about}"));
            }
        }
        let sections = sections(&table, problems);
        let Some(name) = table.text_of("name", problems) else { continue };
        if bars.iter().any(|b| b.name == name) {
            table.wrong(&table.span, problems, format!("there is already a bar named \"{name}\"; rename this one"));
        }
        bars.push(Bar { name, device: None, sections });
    }
    bars
}

fn sections(bar: &Table<'_>, problems: &mut Problems) -> Vec<Section> {
    let mut sections: Vec<Section> = Vec::new();
    let tables = bar.tables("sections", "a list of sections { until, law, element }", problems);
    if tables.is_empty() && bar.get("sections").is_some() {
        bar.wrong(&bar.span, problems, "`sections` must have at least one section { until = 1.0, law, element }");
    }
    let count = tables.len();
    for (index, table) in tables.iter().enumerate() {
        for key in ["until", "law", "element"].iter().filter(|k| table.get(k).is_none()) {
            table.wrong(&table.span, problems, format!("a section needs `{key}`"));
        }
        let until = table.number("until", problems);
        let before = sections.last().map_or(0.0, |s: &Section| s.until);
        if let Some(until) = until
            && (until <= before || until > 1.0 || (index + 1 == count && until != 1.0))
        {
            let message = format!("`until` must increase up to 1.0 for the last section, found {until} after {before}");
            table.wrong(&table.span, problems, message);
        }
        let law = table.text_of("law", problems);
        let element = table.text_of("element", problems);
        if let Some(why) = law.as_deref().and_then(|id| find_law(id).err()) {
            table.wrong(&table.span, problems, why);
        }
        if let Some(why) = element.as_deref().and_then(|id| find_element(id).err()) {
            table.wrong(&table.span, problems, why);
        }
        let quadrature = table.get("quadrature").map(|v| table.text[v.span()].to_owned());
        if let Some(other) = sections.iter().find(|s| Some(&s.element) == element.as_ref())
            && other.quadrature != quadrature
        {
            let message = format!("all sections of {} must have the same `quadrature`", other.element);
            table.wrong(&table.span, problems, message);
        }
        let parameters = table.table.iter().filter(|(key, _)| !SECTION.contains(&key.get_ref().as_ref()));
        let parameters =
            parameters.map(|(key, v)| (key.get_ref().to_string(), table.text[v.span()].to_owned())).collect();
        if let (Some(until), Some(law), Some(element)) = (until, law, element) {
            sections.push(Section { until, law, element, quadrature, parameters });
        }
    }
    sections
}
