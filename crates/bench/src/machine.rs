//! What figures were measured on, and the day.

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

/// The day by the system's clock, UTC: `2026-11-22`.
pub fn today() -> String {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    let [year, month, day] = date(since.map_or(0, |d| d.as_secs() / 86_400));
    format!("{year:04}-{month:02}-{day:02}")
}

/// Year, month and day so many days after the first of January 1970, in the Gregorian calendar.
fn date(mut days: u64) -> [u64; 3] {
    let leap = |year: u64| year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    let mut year = 1970;
    while days >= 365 + u64::from(leap(year)) {
        days -= 365 + u64::from(leap(year));
        year += 1;
    }
    let mut month = 1;
    for length in [31, 28 + u64::from(leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30] {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    [year, month, days + 1]
}

/// The first model that the table of processors names.
fn model(information: &str) -> Option<String> {
    let line = information.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::{date, model};

    /// Days are counted through leap years, those of centuries too.
    #[test]
    fn days_have_dates() {
        assert_eq!(date(0), [1970, 1, 1]);
        assert_eq!(date(59), [1970, 3, 1]);
        assert_eq!(date(11_016), [2000, 2, 29]);
        assert_eq!(date(11_322), [2000, 12, 31]);
        assert_eq!(date(20_779), [2026, 11, 22]);
    }

    /// The model is read from the first processor's entry.
    #[test]
    fn model_is_found() {
        let text = "processor\t: 0\nmodel name\t: Some Processor 9\nmodel name\t: Another\n";
        assert_eq!(model(text).as_deref(), Some("Some Processor 9"));
        assert_eq!(model("Hardware : x\n"), None);
    }
}
