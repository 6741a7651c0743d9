//! Why a command ends with an exit code other than 0.

use std::fmt;

/// Why, and with it which exit code.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Whoever reads the output has closed it (`souple list laws | head -1`): nothing to complain about.
    OutputClosed,
    /// The scene's expectations are not met: one line each.
    Unmet(Vec<String>),
    /// What was given cannot be used, or a file cannot be read or written.
    Input(anyhow::Error),
    /// The simulation failed.
    Simulation(String),
    /// What the command gives cannot be written: a full disk, a folder that may not be written.
    Output(anyhow::Error),
    /// Stopped by the person at the keyboard.
    Interrupted(String),
    /// A program that was started for it has said why, and ended with this exit code.
    Said(u8),
}

impl Failure {
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Failure::OutputClosed => 0,
            Failure::Unmet(_) => 1,
            Failure::Input(_) => 2,
            Failure::Simulation(_) => 3,
            Failure::Output(_) => 4,
            Failure::Interrupted(_) => 130,
            Failure::Said(code) => *code,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::OutputClosed | Failure::Said(_) => Ok(()),
            Failure::Unmet(lines) => write!(f, "expectations not met:\n  {}", lines.join("\n  ")),
            Failure::Input(error) | Failure::Output(error) => write!(f, "{error:#}"),
            Failure::Simulation(message) | Failure::Interrupted(message) => f.write_str(message),
        }
    }
}

impl From<anyhow::Error> for Failure {
    fn from(error: anyhow::Error) -> Self {
        Failure::Input(error)
    }
}

/// Bad input in words.
pub(crate) fn input(message: impl fmt::Display) -> Failure {
    Failure::Input(anyhow::anyhow!("{message}"))
}
