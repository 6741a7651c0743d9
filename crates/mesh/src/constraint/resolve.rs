//! Chains of constraints put into each other, until nobody follows a follower.
//!
//! ```text
//! u_m = Σ_a w_a u_a,   u_a = Σ_b v_b u_b    ⇒    u_m = Σ_b (w_a v_b) u_b
//! ```

use super::Constraint;

/// Constraints that contradict each other.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ConstraintError {
    /// Nodes that follow each other in a circle.
    #[error(
        "nodes {} follow each other in a circle; let one of the two sides be the master of the other",
        list(.nodes)
    )]
    Cycle {
        /// The nodes, ascending.
        nodes: Vec<u32>,
    },
    /// A node with two constraints.
    #[error("node {node} is tied twice, to nodes {} and to nodes {}; take it out of one of the ties", list(.first), list(.second))]
    Twice {
        /// The node.
        node: u32,
        /// Masters of one.
        first: Vec<u32>,
        /// Masters of the other.
        second: Vec<u32>,
    },
}

/// Nodes in a message before the rest is left out.
const SHOWN: usize = 8;

fn list(nodes: &[u32]) -> String {
    let mut shown: Vec<String> = nodes.iter().take(SHOWN).map(u32::to_string).collect();
    if nodes.len() > SHOWN {
        shown.push(format!("and {} more", nodes.len() - SHOWN));
    }
    shown.join(", ")
}

/// The constraints in order of their nodes, with masters that are free.
///
/// # Errors
/// [`ConstraintError`] when a node has two constraints, or nodes follow each other in a circle.
pub fn resolve(mut constraints: Vec<Constraint>) -> Result<Vec<Constraint>, ConstraintError> {
    constraints.sort_by_key(|c| c.node);
    if let Some(pair) = constraints.windows(2).find(|pair| pair[0].node == pair[1].node) {
        let nodes = |c: &Constraint| c.masters.iter().map(|m| m.0).collect();
        return Err(ConstraintError::Twice { node: pair[0].node, first: nodes(&pair[0]), second: nodes(&pair[1]) });
    }
    let place = |constraints: &[Constraint], node: u32| constraints.binary_search_by_key(&node, |c| c.node).ok();
    // Who waits for whom, and for how many each waits.
    let mut waiting: Vec<usize> = vec![0; constraints.len()];
    let mut waited_for: Vec<Vec<usize>> = vec![Vec::new(); constraints.len()];
    for (at, constraint) in constraints.iter().enumerate() {
        for &(master, _) in &constraint.masters {
            if let Some(other) = place(&constraints, master) {
                waiting[at] += 1;
                waited_for[other].push(at);
            }
        }
    }
    let mut ready: Vec<usize> = (0..constraints.len()).filter(|&at| waiting[at] == 0).collect();
    let mut done = 0;
    while done < ready.len() {
        let at = ready[done];
        done += 1;
        let mut masters: Vec<(u32, f64)> = Vec::new();
        for &(master, weight) in &constraints[at].masters {
            match place(&constraints, master) {
                None => masters.push((master, weight)),
                Some(other) => {
                    masters.extend(constraints[other].masters.iter().map(|&(node, inner)| (node, weight * inner)));
                }
            }
        }
        masters.sort_by_key(|m| m.0);
        masters.dedup_by(|next, kept| {
            let same = next.0 == kept.0;
            if same {
                kept.1 += next.1;
            }
            same
        });
        constraints[at].masters = masters;
        for &next in &waited_for[at] {
            waiting[next] -= 1;
            if waiting[next] == 0 {
                ready.push(next);
            }
        }
    }
    if done < constraints.len() {
        let stuck = (0..constraints.len()).filter(|&at| waiting[at] > 0).map(|at| constraints[at].node);
        return Err(ConstraintError::Cycle { nodes: stuck.collect() });
    }
    Ok(constraints)
}
