//! `souple campaign compare`: two groups side by side.

use super::{open, whole_group};
use crate::output::{say, text_table};
use souple_campaign::compare::{Comparison, Side, compare};
use souple_campaign::database::Table;
use souple_campaign::report::quantities::Kind;
use std::fmt::Write as _;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Example: souple campaign compare softness softness --db mine.db --with theirs.db")]
pub(crate) struct Arguments {
    /// A group
    a: String,
    /// Another one, or the same one in another database
    b: String,
    /// The database of A
    #[arg(long, value_name = "FILE|URL", default_value = "campaign.db")]
    db: String,
    /// The database of B; absent: that of A
    #[arg(long, value_name = "FILE|URL")]
    with: Option<String>,
    /// Print everything as JSON, pair by pair
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, String> {
    let other = arguments.with.as_deref().unwrap_or(&arguments.db);
    if arguments.a == arguments.b && other == arguments.db {
        return Err(format!(
            "both sides are {} of {other}: name another group, or another database with --with",
            arguments.a
        ));
    }
    let a = whole_group(&open(&arguments.db)?, Some(&arguments.a))?;
    let b = whole_group(&open(other)?, Some(&arguments.b))?;
    let comparison = compare(&a, &b);
    if arguments.json {
        let json = serde_json::to_string_pretty(&comparison).map_err(|e| format!("cannot write JSON: {e}"))?;
        say(&json)?;
    } else {
        say(&text(&comparison))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// For people.
fn text(c: &Comparison) -> String {
    let mut out = String::new();
    for (name, side) in ["A", "B"].iter().zip(&c.sides) {
        describe(&mut out, name, side);
    }
    // Writing to a text does not fail.
    let _ = writeln!(
        out,
        "{} pairs with the same {}",
        c.pairs.len(),
        if c.matched_by.is_empty() { "base scene".to_owned() } else { c.matched_by.join(", ") }
    );
    for e in &c.ended_differently {
        let _ = writeln!(out, "#{} of A is {}, #{} of B is {}: not compared", e.pair.a, e.a, e.pair.b, e.b);
    }
    let heads = ["quantity", "figure", "least", "median", "largest", "pairs"].map(str::to_owned).to_vec();
    let rows = c.quantities.iter().filter_map(|q| {
        let [low, middle, high] = q.range?.map(|x| format!("{x:.3e}"));
        let ratio = |x: f64| format!("{x:.3}");
        let times = q.kind == Kind::Time;
        let [low, middle, high] = if times { q.range?.map(ratio) } else { [low, middle, high] };
        let figure = if times { "B / A" } else { "|B − A| / max" };
        let count = q.values.iter().filter(|v| v.2.is_some()).count().to_string();
        Some(vec![q.name.clone(), figure.to_owned(), low, middle, high, count])
    });
    let rows: Vec<Vec<String>> = rows.collect();
    if !rows.is_empty() {
        out.push('\n');
        out.push_str(&text_table(&Table { heads, rows }));
    }
    out
}

fn describe(out: &mut String, name: &str, side: &Side) {
    let short: Vec<&str> = side.programs.iter().map(|p| p.get(..12).unwrap_or(p)).collect();
    let _ = writeln!(
        out,
        "{name}: {}, {} simulations, {}, program {}",
        side.group,
        side.simulations,
        side.machines.join("; "),
        short.join(", ")
    );
    let numbers = |list: &[usize]| list.iter().map(|n| format!("#{n}")).collect::<Vec<_>>().join(", ");
    for (list, why) in
        [(&side.unmatched, "have no counterpart"), (&side.ambiguous, "are not told apart by what matches")]
    {
        if !list.is_empty() {
            let _ = writeln!(out, "   {} {why}: {}", list.len(), numbers(list));
        }
    }
    for (list, what) in [(&side.only_parameters, "parameters"), (&side.only_quantities, "quantities")] {
        if !list.is_empty() {
            let _ = writeln!(out, "   {what} of this side only: {}", list.join(", "));
        }
    }
}
