//! The reference of scenes as Markdown, printed from the schema.
//!
//! `docs/scene.md` is this text; a test compares them, and rewrites the file when `SOUPLE_BLESS=1` is set.

use std::fmt::Write;

use crate::choice::{Choice, Named};
use crate::dimension::Dimension;
use crate::expect::Component;
use crate::probe::{Quantity, QuantityShape};
use crate::region::REGION;
use crate::schema::{self, Key, Kind, Presence, Section, schema};
use crate::units;

/// A complete scene, as the reference shows it.
pub const EXAMPLE: &str = include_str!("example.toml");

const INTRODUCTION: &str = "\
<!-- Printed from the schema in crates/scene; do not edit. SOUPLE_BLESS=1 cargo test -p souple-scene rewrites it. -->

# Scenes

A scene is a TOML file that says what is simulated and how.
Errors name the line and the column, what was expected and the nearest name that exists; all of them are reported at once.

```toml
";

const VALUES: &str = "\
## Values

**Numbers** are in SI units: metres, kilograms, seconds, newtons, pascals, joules. Angles are in degrees.
A whole number is accepted for any number; `inf` and `nan` never are.

**Numbers with units** are texts: `\"4 kPa\"`, `\"1 g/cm^3\"`, `\"9.81 m/s^2\"`, `\"30 deg\"`.
The unit must have the dimension of the key: `step = \"5 mm\"` is an error.
Factors are separated by a space, `*` or `·`; each `/` divides by the one factor after it; powers are written `m^2`, `m**2`,
`m²`, `s^-1`; parentheses group.
";

const REGIONS: &str = "\
## Regions

Wherever a key takes a region, write `\"all\"`, a name, or a table with exactly one key.

```toml
region = \"all\"
region = \"x_max\"
region = { element = \"prism6\" }
region = { box = { min = [0, 0, 0], max = [0.5, 1, 1] } }
region = { and = [\"x_max\", { not = { plane = { point = [0, 0.5, 0], normal = [0, 1, 0] } } }] }
```

A name is looked up first among the regions of the body (`[[body.region]]`), then among those of the mesh: the faces of a
generator (`x_min`, `x_max`, `y_min`, …) or the groups of a mesh file.
All positions are those of the rest shape.
A region that selects nothing is an error.
";

const OVERRIDES: &str = "\
## Overrides

`--set key=value` changes one value before the scene is read; it can be given several times.

* `--set time.end=0.5`: tables and keys are separated by dots.
* `--set body.0.density=900`, `--set body.bar.density=900`: an entry of a list by its position, from 0, or by its name.
* `--set material.0.young=2e8`: what is not a key of the scene is looked up in the first body.
* `--set 'probe.\"left tip\".region=x_max'`: a part with dots or spaces stands in quotes.
* `--set 'body.0.mesh.size=[4, 1, 1]'`, `--set body.0.mesh.size.0=4`: a whole list, or one of its values.

The value is TOML; texts need no quotes: `--set integrator.method=rk4`, `--set 'material.0.young=4 kPa'`.
An error about such a value names the override instead of a line.
";

/// The text of `docs/scene.md`.
pub fn markdown() -> String {
    let mut text = format!("{INTRODUCTION}{EXAMPLE}```\n\n{VALUES}\n");
    write_units(&mut text);
    for section in schema() {
        write_section(&mut text, section);
    }
    text.push_str(REGIONS);
    text.push('\n');
    write_table(&mut text, &REGION);
    for key in REGION.keys {
        if let Kind::Table(inner) = key.kind {
            push(&mut text, format_args!("### `{}`\n\n{}.\n\n", inner.header, sentence(inner.about)));
            write_table(&mut text, inner);
        }
    }
    text.push_str("## Quantities of probes\n\n| quantity | value | unit | meaning |\n|---|---|---|---|\n");
    for &quantity in Quantity::ALL {
        let shape = match quantity.shape() {
            QuantityShape::Scalar => "number",
            QuantityShape::Vector => "vector [x, y, z]",
            QuantityShape::Tensor => "tensor [xx, yy, zz, xy, yz, zx]",
            QuantityShape::Vectors => "list of vectors",
        };
        let about = Quantity::CHOICES[quantity as usize].about.split(" (").next().unwrap_or_default();
        let about = about.split(';').next().unwrap_or_default().trim();
        push(&mut text, format_args!("| `\"{quantity}\"` | {shape} | {} | {about} |\n", quantity.dimension().unit));
    }
    let (of_vectors, of_tensors): (Vec<Component>, Vec<Component>) =
        Component::ALL.iter().partition(|c| c.is_of_vector());
    let list =
        |components: &[Component]| components.iter().map(|c| format!("`\"{c}\"`")).collect::<Vec<_>>().join(", ");
    push(
        &mut text,
        format_args!("\nComponents of vectors: {}; of tensors: {}.\n\n", list(&of_vectors), list(&of_tensors)),
    );
    text.push_str(OVERRIDES);
    text
}

/// Writing to a `String` cannot fail; this keeps the one place that says so.
fn push(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    text.write_fmt(arguments).expect("writing to a String does not fail");
}

fn write_units(text: &mut String) {
    let (prefixed, plain, prefixes) = units::unit_names();
    let list = |names: &[&str]| names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    push(
        text,
        format_args!(
            "Units: {}, each also with a prefix {}; and {}.\n\n",
            list(&prefixed),
            list(&prefixes),
            list(&plain)
        ),
    );
    text.push_str("| quantity | unit of plain numbers | example |\n|---|---|---|\n");
    for dimension in Dimension::ALL {
        push(text, format_args!("| {} | {} | `\"{}\"` |\n", dimension.name, dimension.unit, dimension.example));
    }
    text.push('\n');
}

fn write_section(text: &mut String, section: &Section) {
    let header =
        if section.header.starts_with('[') { format!("`{}`", section.header) } else { sentence(section.header) };
    push(text, format_args!("## {header}\n\n{}.\n\n", sentence(section.about)));
    write_table(text, section);
    for key in section.keys {
        if let Kind::Choice(choices) | Kind::Choices(choices) = key.kind
            && !choices.iter().any(|choice| choice.name == "x")
            && key.name != "quantity"
        {
            write_choices(text, key, choices);
        }
    }
}

fn write_choices(text: &mut String, key: &Key, choices: &[Choice]) {
    push(text, format_args!("Words for `{}`:\n\n", key.name));
    for choice in choices {
        push(text, format_args!("* `\"{}\"`: {}\n", choice.name, lowercase(&one_line(choice.about))));
    }
    text.push('\n');
}

fn write_table(text: &mut String, section: &Section) {
    if !section.keys.is_empty() {
        text.push_str("| key | type | unit | default | range | meaning |\n|---|---|---|---|---|---|\n");
    }
    for key in section.keys {
        let default = match key.presence {
            Presence::Required => "**required**".to_owned(),
            Presence::Default(value) => format!("`{value}`"),
            Presence::Optional(absence) if absence.starts_with("required") => format!("**required**{}", &absence[8..]),
            Presence::Optional(absence) => format!("absent: {absence}"),
        };
        let (kind, range) = kind_and_range(&key.kind);
        let unit = schema::unit(&key.kind);
        push(text, format_args!("| `{}` | {kind} | {unit} | {default} | {range} | {} |\n", key.name, key.about));
    }
    if !section.keys.is_empty() {
        text.push('\n');
    }
    if let Some(others) = section.other_keys {
        push(text, format_args!("{others}\n\n"));
    }
}

fn kind_and_range(kind: &Kind) -> (String, String) {
    let plain = |name: &str| (name.to_owned(), String::new());
    match kind {
        Kind::Text => plain("text"),
        Kind::Boolean => plain("`true` or `false`"),
        Kind::Whole(0, u32::MAX) => plain("whole number"),
        Kind::Whole(least, u32::MAX) => ("whole number".to_owned(), format!("≥ {least}")),
        Kind::Whole(least, most) => ("whole number".to_owned(), format!("{least} to {most}")),
        Kind::WholeVector(least) => ("three whole numbers".to_owned(), format!("≥ {least}")),
        Kind::Number(_, range) => ("number".to_owned(), range.to_string()),
        Kind::Vector(_, range) => ("three numbers".to_owned(), range.to_string()),
        Kind::Direction => ("three numbers".to_owned(), "not all 0".to_owned()),
        Kind::Choice(choices) => ("word".to_owned(), words_if_few(choices)),
        Kind::Choices(choices) => ("list of words".to_owned(), words_if_few(choices)),
        Kind::OneOrMore(choices) => ("word or list of words".to_owned(), words_if_few(choices)),
        Kind::Region => plain("region"),
        Kind::Regions => plain("list of regions"),
        Kind::Element => plain("id of an element"),
        Kind::Curve(_) => ("`[[time, number], …]`".to_owned(), "times increase".to_owned()),
        Kind::VectorCurve(_) => ("`[[time, [x, y, z]], …]`".to_owned(), "times increase".to_owned()),
        Kind::Values(words) => plain(words),
        Kind::Table(section) => plain(&format!("table {}", link(section))),
        Kind::Tables(section) => plain(&format!("tables {}", link(section))),
    }
}

fn words_if_few(choices: &[Choice]) -> String {
    if choices.len() > 4 {
        return "see below".to_owned();
    }
    choices.iter().map(|choice| format!("`\"{}\"`", choice.name)).collect::<Vec<_>>().join(", ")
}

fn link(section: &Section) -> String {
    format!("`{}`", section.header)
}

/// A doc comment over several lines as one line.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ").trim_end_matches('.').to_owned()
}

fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

/// The first letter small, unless the word is an abbreviation or a name that stays as it is.
fn lowercase(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next();
    let names = ["Runge", "Newmark", "Von", "VTK", "Cauchy", "Green"];
    match first {
        Some(first) if !names.iter().any(|name| text.starts_with(name)) => {
            first.to_lowercase().chain(letters).collect()
        }
        _ => text.to_owned(),
    }
}
