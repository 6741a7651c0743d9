//! The short table at the end of a run.

use super::End;
use crate::terminal::table;
use souple_simulation::{Ending, ExpectationResult, ProbeValue, Summary};
use std::path::Path;

/// Numbers of a list that are shown; `summary.json` has all.
const SHOWN: usize = 4;

pub(super) fn text(summary: &Summary, expectations: &[ExpectationResult], end: &End, folder: &Path) -> String {
    let status = match (end, summary.status) {
        (End::Interrupted, _) => "interrupted",
        (_, Ending::Finished) => "finished",
        (_, Ending::AtRest) => "at rest",
        (_, Ending::Failed) => "failed",
    };
    let elements: Vec<String> = summary.elements.iter().map(|(id, count)| format!("{count} {id}")).collect();
    let ratio = summary.simulated_s / summary.wall_s.max(1e-9);
    let ms = summary.step_ms;
    let mut rows = vec![
        ("status", status.to_owned()),
        ("mesh", format!("{} nodes, {}", summary.nodes, elements.join(", "))),
        ("device", summary.device.clone()),
        ("steps", summary.steps.to_string()),
        ("time", format!("{} s simulated in {:.3} s: {ratio:.3} × real time", summary.simulated_s, summary.wall_s)),
        ("ms per step", format!("mean {:.3}, median {:.3}, 99 % below {:.3}", ms.mean, ms.p50, ms.p99)),
        ("CG iterations", format!("mean {:.1}, most {}", summary.cg_iterations.mean, summary.cg_iterations.max)),
    ];
    if let Some(moved) = &summary.transfers {
        let per_step = |bytes: u64| bytes / summary.steps.max(1);
        rows.push((
            "moved",
            format!(
                "per step {} bytes to the device and {} back; {} bytes of nodes and {} of whole states in all",
                per_step(moved.steps.uploaded),
                per_step(moved.steps.downloaded),
                moved.nodes.uploaded + moved.nodes.downloaded,
                moved.states.uploaded + moved.states.downloaded
            ),
        ));
    }
    rows.push(("results", folder.display().to_string()));
    let mut out = String::new();
    for (name, value) in rows {
        out.push_str(&format!("{name:14}{value}\n"));
    }
    let rows: Vec<Vec<String>> = summary
        .probes
        .iter()
        .flat_map(|(probe, values)| {
            values.iter().map(move |(quantity, v)| vec![probe.clone(), quantity.clone(), value(v)])
        })
        .collect();
    if !rows.is_empty() {
        out.push('\n');
        out.push_str(&table(&["probe", "quantity", "value"], &rows));
    }
    if !expectations.is_empty() {
        out.push('\n');
        for result in expectations {
            out.push_str(&format!("{} {}\n", if result.passed { "met    " } else { "NOT MET" }, comparison(result)));
        }
    }
    out
}

fn value(v: &ProbeValue) -> String {
    match v {
        ProbeValue::Scalar(x) => number(*x),
        ProbeValue::Vector(x) => list(x),
        ProbeValue::Tensor(x) => list(x),
        ProbeValue::Vectors(all) => {
            let mut shown: Vec<String> = all.iter().take(SHOWN).map(|x| list(x)).collect();
            if all.len() > SHOWN {
                shown.push(format!("… ({} in all)", all.len()));
            }
            shown.join(" ")
        }
    }
}

fn list(values: &[f64]) -> String {
    format!("[{}]", values.iter().map(|&x| number(x)).collect::<Vec<_>>().join(", "))
}

fn number(x: f64) -> String {
    let size = x.abs();
    if x == 0.0 || (1e-3..1e6).contains(&size) { format!("{x:.6}") } else { format!("{x:.6e}") }
}

/// One expectation in words.
pub(super) fn comparison(r: &ExpectationResult) -> String {
    format!(
        "{}: expected {} within {:e}, got {} ({:e} apart)",
        r.name,
        list(&r.expected),
        r.tolerance,
        list(&r.got),
        r.difference
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers are short in the usual range and scientific outside; long lists are cut and say so.
    #[test]
    fn values_are_short() {
        assert_eq!(value(&ProbeValue::Vector([0.0, -0.25, 1e-9])), "[0.000000, -0.250000, 1.000000e-9]");
        let long = value(&ProbeValue::Vectors(vec![[1.0; 3]; 9]));
        assert!(long.ends_with("… (9 in all)"), "{long}");
    }
}
