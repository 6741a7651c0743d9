//! What figures were measured on, without a date.

use crate::vectors::Vectors;
use serde::Serialize;

/// The machine, as far as the system tells.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Machine {
    /// Model of the processor, from the system.
    pub processor: String,
    /// Processors that the system offers to this process.
    pub processors: usize,
    /// Widest instruction set with vectors.
    pub instruction_set: &'static str,
    /// Mean number of processes that wanted to run in the last minute, where the system tells: above the number of
    /// processors, times are longer than the work.
    pub load: Option<f64>,
}

/// Asks the system.
pub fn machine() -> Machine {
    let information = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let load = std::fs::read_to_string("/proc/loadavg").ok();
    Machine {
        processor: model(&information).unwrap_or_else(|| format!("unknown {}", std::env::consts::ARCH)),
        processors: std::thread::available_parallelism().map_or(1, usize::from),
        instruction_set: Vectors::widest().map_or("none", Vectors::name),
        load: load.and_then(|text| text.split_whitespace().next()?.parse().ok()),
    }
}

/// The first model that the table of processors names.
fn model(information: &str) -> Option<String> {
    let line = information.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::model;

    /// The model is read from the first processor's entry.
    #[test]
    fn model_is_found() {
        let text = "processor\t: 0\nmodel name\t: Some Processor 9\nmodel name\t: Another\n";
        assert_eq!(model(text).as_deref(), Some("Some Processor 9"));
        assert_eq!(model("Hardware : x\n"), None);
    }
}
