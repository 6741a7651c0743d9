//! `souple bench`: what things cost, here and now. Progress goes to standard error, figures to standard output.

mod kernels;
mod operators;
mod setup;
mod step;

use crate::failure::{Failure, input};
use clap::{Args, Subcommand};
use souple_bench::machine::Machine;
use souple_bench::stopwatch::{Effort, Spread};
use souple_bench::{Element, Law, all_elements, all_laws};
use souple_simulation::lists::{find_element, find_law};

#[derive(Debug, Args)]
#[command(after_help = "Example: souple bench kernels --element tet4 --against\n\n\
    Figures are medians over rounds with quartiles; what is compared takes turns in every round.\n\
    docs/benchmarks.md says what each figure means.")]
pub(crate) struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Kernels of an element with a law: time per element, share of the processor's peak, against other code
    Kernels(kernels::Arguments),
    /// Forces, products and assembly of models of one kind of elements: time per element
    Operators(operators::Arguments),
    /// Implicit steps with a fixed number of iterations: time per step, and where it goes
    Step(step::Arguments),
    /// Loading a scene: seconds by phase, highest memory
    Setup(setup::Arguments),
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.what {
        What::Kernels(arguments) => kernels::run(arguments),
        What::Operators(arguments) => operators::run(arguments),
        What::Step(arguments) => step::run(arguments),
        What::Setup(arguments) => setup::run(arguments),
    }
}

/// How long to measure.
#[derive(Debug, Args)]
struct Rounds {
    /// Number of rounds that medians are taken over
    #[arg(long, default_value_t = Effort::default().rounds, value_parser = at_least_one)]
    rounds: usize,
}

impl Rounds {
    fn effort(&self) -> Effort {
        Effort { rounds: self.rounds, ..Effort::default() }
    }
}

fn at_least_one(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(0) | Err(_) => Err("expected a whole number, at least 1".to_owned()),
        Ok(n) => Ok(n),
    }
}

/// Elements by id, separated by commas, or all.
fn elements(names: &str) -> Result<Vec<&'static Element>, Failure> {
    match names {
        "all" => Ok(all_elements().to_vec()),
        names => names.split(',').map(find_element).collect::<Result<_, _>>().map_err(input),
    }
}

/// Laws by id, separated by commas, or all.
fn laws(names: &str) -> Result<Vec<&'static Law>, Failure> {
    match names {
        "all" => Ok(all_laws().to_vec()),
        names => names.split(',').map(find_law).collect::<Result<_, _>>().map_err(input),
    }
}

/// A number of threads; 0 stands for as many as the machine has.
fn threads(wanted: usize) -> usize {
    match wanted {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        n => n,
    }
}

/// What figures were measured on.
fn machine_line(machine: &Machine, device: &str, threads: usize) -> String {
    let load = machine.load.map(|load| format!(", load {load:.1}")).unwrap_or_default();
    format!("{}, {} processors{load}; {device}; threads: {threads}", machine.processor, machine.processors)
}

/// A median with its quartiles: `12.3 (12.1–12.9)`.
fn spread(s: &Spread) -> String {
    format!("{} ({}–{})", digits(s.median), digits(s.lower_quartile), digits(s.upper_quartile))
}

/// Three digits that count.
fn digits(value: f64) -> String {
    let places = (2 - value.abs().max(1e-3).log10().floor() as i32).clamp(0, 4);
    format!("{value:.*}", places as usize)
}

#[cfg(test)]
mod tests {
    use super::digits;

    /// Figures show three digits that count, and no more behind the point than there are.
    #[test]
    fn figures_have_three_digits() {
        assert_eq!([1234.5, 123.45, 12.345, 1.2345, 0.12345].map(digits), ["1234", "123", "12.3", "1.23", "0.123"]);
        assert_eq!(digits(0.0), "0.0000");
    }
}
