//! What a page may ask for: one JSON object per text message, `{"do": "pull-move", "target": [0.1, 0.2, 0.0]}`.
//!
//! Everything is checked here against what it means, so that a mistake is answered to whoever made it, with what was
//! expected; the simulation checks once more what only it can know.

use crate::colours::{Choice, choices};
use serde::Deserialize;

/// Longest message of a client in bytes.
pub const LONGEST: usize = 16 << 10;
/// Most steps that one command may ask for.
const MOST_STEPS: u64 = 1_000_000;

/// What a client asks for.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Command {
    /// Steps follow each other from now on.
    Play {},
    /// They stop.
    Pause {},
    /// This many steps, then a pause.
    Step {
        /// How many.
        #[serde(default = "one")]
        count: u64,
    },
    /// Back to the beginning.
    Reset {},
    /// Simulated seconds per second; `null` is as fast as it goes.
    Speed {
        /// The factor.
        factor: Option<f64>,
    },
    /// Takes a point of the surface with a spring.
    PullBegin {
        /// Surface nodes around the point.
        nodes: Vec<u32>,
        /// Their weights, which add up to 1.
        weights: Vec<f64>,
        /// The other end of the spring in m.
        target: [f64; 3],
        /// Stiffness in N/m.
        stiffness: f64,
    },
    /// Moves the other end of the spring.
    PullMove {
        /// Where to, in m.
        target: [f64; 3],
    },
    /// Lets go.
    PullEnd {},
    /// Gravity in m/s².
    Gravity {
        /// Its components.
        value: [f64; 3],
    },
    /// Velocity damping in 1/s.
    Damping {
        /// The damping.
        value: f64,
    },
    /// Time step in s.
    TimeStep {
        /// The step.
        value: f64,
    },
    /// What this client's colours show.
    Colour {
        /// A key of [`crate::colours::choices`].
        by: String,
    },
    /// One frame more: sent when one has been drawn.
    More {},
}

fn one() -> u64 {
    1
}

/// Why a command is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CommandError {
    /// It could not be read.
    #[error("cannot read the command: {0}")]
    Unreadable(String),
    /// A value that cannot be.
    #[error("{0}")]
    Value(String),
}

/// Reads a command; the surface has `node_count` nodes.
///
/// # Errors
/// What is wrong, and what was expected.
pub fn parse(text: &str, node_count: usize) -> Result<Command, CommandError> {
    let command: Command = serde_json::from_str(text).map_err(|e| CommandError::Unreadable(e.to_string()))?;
    check(&command, node_count).map_err(CommandError::Value)?;
    Ok(command)
}

/// The choice of colours of this key.
pub(crate) fn choice(key: &str) -> Option<Choice> {
    choices().into_iter().find(|c| c.key == key)
}

fn check(command: &Command, node_count: usize) -> Result<(), String> {
    let within = |name: &str, value: f64, low: f64, high: f64, unit: &str| match value >= low && value <= high {
        true => Ok(()),
        false => Err(format!("{name} must lie between {low:e} and {high:e} {unit}, found {value}")),
    };
    let point = |name: &str, value: &[f64; 3]| match value.iter().all(|x| x.abs() <= 1e9) {
        true => Ok(()),
        false => Err(format!("{name} must lie within 1e9 m of the origin, found {value:?}")),
    };
    match command {
        Command::Step { count } if !(1..=MOST_STEPS).contains(count) => {
            Err(format!("`count` must lie between 1 and {MOST_STEPS} steps, found {count}"))
        }
        Command::Speed { factor: Some(factor) } => within("`factor`", *factor, 1e-6, 1e6, ""),
        Command::PullBegin { nodes, weights, target, stiffness } => {
            if nodes.is_empty() || nodes.len() > 16 || nodes.len() != weights.len() {
                let found = (nodes.len(), weights.len());
                return Err(format!("`nodes` and `weights` must be 1 to 16 each and as many, found {found:?}"));
            }
            if let Some(node) = nodes.iter().find(|n| **n as usize >= node_count) {
                return Err(format!("there is no surface node {node}; there are {node_count}"));
            }
            let sum: f64 = weights.iter().sum();
            if weights.iter().any(|w| *w < 0.0) || (sum - 1.0).abs() > 1e-6 {
                return Err(format!("`weights` must not be negative and add up to 1, found {weights:?}"));
            }
            point("`target`", target)?;
            within("`stiffness`", *stiffness, 1e-9, 1e12, "N/m")
        }
        Command::PullMove { target } => point("`target`", target),
        Command::Gravity { value } => value.iter().try_for_each(|g| within("gravity", *g, -1e6, 1e6, "m/s²")),
        Command::Damping { value } => within("damping", *value, 0.0, 1e9, "1/s"),
        Command::TimeStep { value } => within("the time step", *value, 1e-12, 1e3, "s"),
        Command::Colour { by } if choice(by).is_none() => {
            let known: Vec<&str> = choices().iter().map(|c| c.key).collect();
            Err(format!("`by` must be one of {}, found `{by}`", known.join(", ")))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every command is read; what is misspelt, missing, too much or out of range is refused with its name.
    #[test]
    fn commands_are_read_or_refused() {
        for good in [
            r#"{"do":"play"}"#,
            r#"{"do":"step"}"#,
            r#"{"do":"step","count":5}"#,
            r#"{"do":"speed","factor":null}"#,
            r#"{"do":"pull-begin","nodes":[0,1,2],"weights":[0.5,0.25,0.25],"target":[0,0,1],"stiffness":10}"#,
            r#"{"do":"gravity","value":[0,0,-9.81]}"#,
            r#"{"do":"colour","by":"von-mises"}"#,
        ] {
            assert!(parse(good, 3).is_ok(), "{good}");
        }
        for (bad, says) in [
            ("", "EOF"),
            ("[1]", "cannot read"),
            (r#"{"do":"dance"}"#, "dance"),
            (r#"{"play":1}"#, "do"),
            (r#"{"do":"play","twice":true}"#, "twice"),
            (r#"{"do":"step","count":0}"#, "count"),
            (r#"{"do":"step","count":-1}"#, "-1"),
            (r#"{"do":"speed","factor":0}"#, "factor"),
            (r#"{"do":"pull-move","target":[0,0]}"#, "3"),
            (r#"{"do":"pull-move","target":[0,0,1e300]}"#, "target"),
            (r#"{"do":"pull-begin","nodes":[3],"weights":[1],"target":[0,0,1],"stiffness":1}"#, "no surface node 3"),
            (r#"{"do":"pull-begin","nodes":[0],"weights":[2],"target":[0,0,1],"stiffness":1}"#, "weights"),
            (r#"{"do":"pull-begin","nodes":[0],"weights":[1],"target":[0,0,1],"stiffness":-1}"#, "stiffness"),
            (r#"{"do":"damping","value":-1}"#, "damping"),
            (r#"{"do":"time-step","value":0}"#, "time step"),
            (r#"{"do":"colour","by":"mood"}"#, "von-mises"),
        ] {
            let message = parse(bad, 3).unwrap_err().to_string();
            assert!(message.contains(says), "{bad}: {message}");
        }
    }
}
