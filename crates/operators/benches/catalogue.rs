//! How long it takes to derive the whole catalogue: every element with every law, default rules, on one core.
//!
//! `cargo bench -p souple-operators --bench catalogue` prints the time of each element (rows) with each law (columns) in
//! milliseconds, and the sums. What is timed is energy, force, tangent product and tangent blocks with all that they
//! carry: [`derive`] from the definition to verified programs, on the thread that calls it.

#![allow(
    clippy::disallowed_methods,
    clippy::disallowed_macros,
    reason = "a measurement reads the clock and prints what it found"
)]

use souple_forms::{Loops, define};
use souple_operators::{Association, derive};
use souple_program::Costs;
use std::time::{Duration, Instant};

fn main() {
    let laws = souple_laws::all();
    println!("{:<10}{}", "ms", laws.iter().map(|law| format!("{:>8.7}", law.id)).collect::<String>());
    let (mut defining, mut total, mut longest) = (Duration::ZERO, Duration::ZERO, (Duration::ZERO, String::new()));
    for &element in souple_elements::all() {
        let mut row = String::new();
        for &law in laws {
            let rule = element.default_rule();
            let start = Instant::now();
            let definition = define(element, law, rule, Loops::Rolled, element.dimension());
            defining += start.elapsed();
            drop(definition);
            let start = Instant::now();
            let derived = derive(Association { rule, ..Association::new(element, law) }, Costs::default());
            let time = start.elapsed();
            drop(derived);
            row += &format!("{:>8.1}", 1e3 * time.as_secs_f64());
            total += time;
            if time > longest.0 {
                longest = (time, format!("{} with {}", element.id, law.id));
            }
        }
        println!("{:<10}{row}", element.id);
    }
    let count = souple_elements::all().len() * laws.len();
    println!("{count} associations in {:.2} s", total.as_secs_f64());
    println!("of which definitions {:.2} s", defining.as_secs_f64());
    println!("longest: {}, {:.2} s", longest.1, longest.0.as_secs_f64());
}
