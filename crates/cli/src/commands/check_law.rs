//! `souple check-law`: judges a constitutive law with its parameters, and draws its curves.

use crate::failure::{Failure, input};
use crate::files;
use crate::terminal::{say, say_json, table};
use clap::Args;
use souple_simulation::law_report::{LawReport, report};
use souple_simulation::prepare::judge::{laws, permissive_catalogue};
use souple_simulation::scene::parse_with_overrides;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  souple check-law neo-hookean --set young=4e3 --set poisson=0.3\n  souple check-law --energy \"mu/2*(I1 - 3) - mu*ln(J)\" --set mu=1e3\n  souple check-law scenes/organ.toml --plot curves"
)]
pub(crate) struct Arguments {
    /// Id of a law, or a scene file: then every law in it
    #[arg(required_unless_present = "energy", conflicts_with = "energy")]
    law: Option<String>,
    /// An energy density written out, as scenes take it
    #[arg(long, value_name = "TEXT", allow_hyphen_values = true)]
    energy: Option<String>,
    /// Give a parameter (of a scene: change a value); repeat it
    #[arg(long = "set", value_name = "NAME=VALUE")]
    values: Vec<String>,
    /// Write the curves as SVG files into this folder
    #[arg(long, value_name = "DIR")]
    plot: Option<PathBuf>,
    /// Print the curves as tables
    #[arg(long)]
    tables: bool,
    /// One line of JSON instead of text
    #[arg(long)]
    json: bool,
}

/// A scene that is only there to hold one material.
const STAND: &str = "[integrator]\nmethod = \"quasi-static\"\n[[body]]\nname = \"law\"\ndensity = 1.0\n\
    mesh = { generator = \"bar\", size = [1, 1, 1], cells = [1, 1, 1], element = \"hex8\" }\n[[body.material]]\n";

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let reports = judged(arguments)?;
    if let Some(folder) = &arguments.plot {
        for (number, law) in reports.iter().enumerate() {
            for curve in &law.curves {
                let word = |c: char| if c.is_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
                let name = format!("law{number}_{}.svg", curve.title.chars().map(word).collect::<String>());
                files::write(&folder.join(name), curve.svg.as_bytes())?;
            }
        }
    }
    if arguments.json {
        say_json(&reports)?;
    } else {
        for law in &reports {
            say(&text_of(law, arguments.tables))?;
        }
    }
    match reports.iter().find(|r| !r.passed) {
        None => Ok(()),
        Some(bad) => Err(input(format!("the law \"{}\" cannot be used; see the failed checks", bad.law))),
    }
}

fn judged(arguments: &Arguments) -> Result<Vec<LawReport>, Failure> {
    let (file, text, overrides) = match (&arguments.law, &arguments.energy) {
        (Some(law), _) if law.ends_with(".toml") => {
            (law.clone(), files::read_text(law.as_ref())?, arguments.values.clone())
        }
        (law, energy) => {
            let line = match (law, energy) {
                (Some(law), _) => format!("law = {law:?}\n"),
                (None, Some(energy)) => format!("energy = {energy:?}\n"),
                (None, None) => return Err(input("give a law, a scene file or --energy")),
            };
            // Parameters stand in the material itself, where a law's names are looked for.
            let mut text = format!("{STAND}{line}");
            for value in &arguments.values {
                let (name, value) = value
                    .split_once('=')
                    .ok_or_else(|| input(format!("--set {value}: expected NAME=VALUE, such as young=4e3")))?;
                let plain = value.parse::<f64>().is_ok() || value.trim_start().starts_with('[');
                let value = if plain { value.to_owned() } else { format!("{value:?}") };
                text.push_str(&format!("{} = {value}\n", name.trim()));
            }
            let name = law.clone().unwrap_or_else(|| "--energy".to_owned());
            (name, text, Vec::new())
        }
    };
    let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
    // Places in a scene that nobody wrote would mislead.
    let written = file.ends_with(".toml");
    let refuse = |message: String| input(if written { message } else { without_places(&message, &file) });
    let (scene, _) =
        parse_with_overrides(&text, &file, &overrides, &permissive_catalogue()).map_err(|e| refuse(e.to_string()))?;
    let found = laws(&scene, &file).map_err(|e| refuse(e.to_string()))?;
    Ok(found.into_iter().map(|(name, response)| report(name, &response)).collect())
}

/// Lines without their `file:line:column: `.
fn without_places(message: &str, file: &str) -> String {
    let line = |line: &str| -> String {
        let place =
            line.strip_prefix(file).and_then(|rest| rest.strip_prefix(':')).and_then(|rest| rest.split_once(": "));
        place.map_or(line, |(_, rest)| rest).to_owned()
    };
    message.lines().map(line).collect::<Vec<_>>().join("\n")
}

fn text_of(law: &LawReport, tables: bool) -> String {
    let rows: Vec<Vec<String>> =
        law.checks.iter().map(|c| vec![c.check.to_owned(), c.outcome.to_owned(), c.sentence.clone()]).collect();
    let mut text = format!("{}\n\n{}", law.law, table(&["check", "outcome", "what was found"], &rows));
    if tables {
        for curve in &law.curves {
            text.push_str(&format!("\n{}\n{}", curve.title, curve.table));
        }
    }
    text
}
