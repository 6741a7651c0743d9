//! How schedulers are told to run the tasks of a spool: HyperQueue by a command, Slurm by a script.
//!
//! What it is not: a scheduler, or a judge of what became of tasks. [`crate::spool`] sees that from the files they leave.

use std::path::Path;

/// Environment variables in which schedulers tell a task its number.
pub const TASK_VARIABLES: &[&str] = &["HQ_TASK_ID", "SLURM_ARRAY_TASK_ID"];

/// What a scheduler has to know of a submission.
#[derive(Clone, Copy, Debug)]
pub struct Submission<'a> {
    /// Name of the group.
    pub name: &'a str,
    /// Its folder.
    pub folder: &'a Path,
    /// The `souple-campaign` program.
    pub program: &'a Path,
    /// Number of tasks; at least one.
    pub tasks: usize,
    /// Threads of each.
    pub threads: usize,
    /// Tasks at the same time, where that is limited.
    pub at_most: Option<usize>,
}

/// The arguments of `hq` that submit the tasks and wait for them.
pub fn hyperqueue(submission: &Submission<'_>) -> Vec<String> {
    let Submission { folder, program, tasks, threads, .. } = *submission;
    let mut words = vec!["submit".to_owned(), "--wait".to_owned()];
    for (option, value) in [
        ("--name", name(submission.name)),
        ("--array", format!("0-{}", tasks - 1)),
        ("--cpus", threads.to_string()),
        // What tasks say goes into the folders of their simulations.
        ("--stdout", "none".to_owned()),
        ("--stderr", "none".to_owned()),
    ] {
        words.extend([option.to_owned(), value]);
    }
    words.push("--".to_owned());
    words.extend([program.display().to_string(), "task".to_owned(), folder.display().to_string()]);
    words
}

/// The script for `sbatch`.
pub fn slurm(submission: &Submission<'_>) -> String {
    let Submission { folder, program, tasks, threads, at_most, .. } = *submission;
    let limit = at_most.map_or(String::new(), |n| format!("%{n}"));
    let quoted = |path: &Path| format!("'{}'", path.display().to_string().replace('\'', "'\\''"));
    format!(
        "#!/bin/sh\n\
         #SBATCH --job-name={}\n\
         #SBATCH --array=0-{}{limit}\n\
         #SBATCH --cpus-per-task={threads}\n\
         #SBATCH --output=/dev/null\n\
         # Account, partition and time limit are your cluster's: add them here or give them to sbatch.\n\
         exec {} task {}\n",
        name(submission.name),
        tasks - 1,
        quoted(program),
        quoted(folder),
    )
}

/// A name without what schedulers take for something else.
fn name(group: &str) -> String {
    group.chars().map(|c| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' }).collect()
}
