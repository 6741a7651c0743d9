//! `souple campaign report`: a group as one page.

use super::{open, whole_group};
use crate::output::note;
use souple_campaign::database::Location;
use souple_campaign::report::page::{Surroundings, html};
use souple_campaign::serve::percent_encoded;
use std::path::{Component, Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Example: souple campaign report softness -o softness.html")]
pub(crate) struct Arguments {
    /// Its name; without it, the last group
    group: Option<String>,
    /// The database: a file, or postgres://USER@HOST/DATABASE
    #[arg(long, value_name = "FILE|URL", default_value = "campaign.db")]
    db: String,
    /// The page
    #[arg(short, long, value_name = "FILE", default_value = "report.html")]
    output: PathBuf,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, String> {
    let database = open(&arguments.db)?;
    let group = whole_group(&database, arguments.group.as_deref())?;
    let results = Location::parse(&arguments.db).results();
    let surroundings = Surroundings { results: address(&results, &arguments.output), live: None };
    let page = html(&group, &surroundings);
    std::fs::write(&arguments.output, page).map_err(|e| format!("cannot write {}: {e}", arguments.output.display()))?;
    note(&format!("{}: {} simulations of {}", arguments.output.display(), group.simulations.len(), group.name));
    Ok(ExitCode::SUCCESS)
}

/// The address of a folder as seen from a page; none where there is no such folder.
fn address(folder: &Path, page: &Path) -> Option<String> {
    let folder = std::fs::canonicalize(folder).ok().filter(|f| f.is_dir())?;
    let beside = page.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let page = std::fs::canonicalize(beside).ok()?;
    let (to, from): (Vec<Component<'_>>, Vec<Component<'_>>) =
        (folder.components().collect(), page.components().collect());
    let shared = to.iter().zip(&from).take_while(|(a, b)| a == b).count();
    let up = std::iter::repeat_n("..".to_owned(), from.len() - shared);
    let down = to[shared..].iter().map(|c| percent_encoded(&c.as_os_str().to_string_lossy()));
    Some(up.chain(down).collect::<Vec<_>>().join("/"))
}
