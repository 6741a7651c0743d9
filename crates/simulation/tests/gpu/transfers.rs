//! What moves between host and device: steps cost the same for every model, readings what was asked for.

use super::gpu;
use super::runs::{BAR, load, tip};
use souple_simulation::gpu::{Moved, Transfers};
use souple_simulation::surface;

fn since(now: Moved, before: Moved) -> Moved {
    Moved { uploaded: now.uploaded - before.uploaded, downloaded: now.downloaded - before.downloaded }
}

/// What three steps with a probe of the tip move, by purpose, and the number of unknowns.
fn three_steps(cells: &str) -> (Transfers, usize) {
    let mut simulation = load(BAR, &[cells, "time.end=1.0"], "gpu").unwrap().0;
    let before = simulation.transfers().unwrap();
    for _ in 0..3 {
        simulation.advance().unwrap();
        let _ = tip(&mut simulation);
        let read = simulation.transfers().unwrap();
        let _ = tip(&mut simulation);
        assert_eq!(simulation.transfers().unwrap(), read, "one reading per step is enough");
        // 9 nodes: displacements in two singles per axis, velocities in one; and the record of the solve.
        assert!(read.last_step.downloaded >= 9 * 36 + 64, "{read:?}");
    }
    let after = simulation.transfers().unwrap();
    let moved = Transfers {
        uploaded: after.uploaded - before.uploaded,
        downloaded: after.downloaded - before.downloaded,
        steps: since(after.steps, before.steps),
        nodes: since(after.nodes, before.nodes),
        states: since(after.states, before.states),
        last_step: after.last_step,
    };
    (moved, simulation.unknowns())
}

/// With a probe of the tip, steps of a model with many elements move as many bytes as those of one with few, if its tip
/// has as many nodes: the numbers of the steps, 64 bytes per wait, and the nodes of the tip.
#[test]
fn steps_move_as_much_for_large_models() {
    if gpu().is_none() {
        return;
    }
    let (small, few) = three_steps("body.0.mesh.cells=[4, 2, 2]");
    let (large, many) = three_steps("body.0.mesh.cells=[20, 2, 2]");
    assert!(many > 4 * few, "{many} and {few} unknowns");
    for (moved, what) in [(small, "small"), (large, "large")] {
        assert_eq!(moved.states, Moved::default(), "{what}: no whole state was needed");
        // Which nodes: their numbers, and three descriptions of two words; then 3 × 9 nodes × 36 bytes.
        assert_eq!(moved.nodes, Moved { uploaded: 4 * 9 + 24, downloaded: 3 * 9 * 36 }, "{what}");
        // A solve that takes longer than the last waits more often, for 64 bytes each time.
        assert!(moved.steps.downloaded % 64 == 0 && moved.steps.downloaded <= 3 * 6 * 64, "{what}: {moved:?}");
        let sum = |of: fn(Moved) -> u64| of(moved.steps) + of(moved.nodes) + of(moved.states);
        assert_eq!((moved.uploaded, moved.downloaded), (sum(|m| m.uploaded), sum(|m| m.downloaded)), "{what}");
    }
    assert_eq!(small.steps.uploaded, large.steps.uploaded);
    assert!(small.steps.uploaded < 3 * 256, "{small:?}");
}

/// The places of the surface's nodes come back in 12 bytes per node, right to single precision, and nothing is sent for
/// them after the first time; the processor gives the same without moving anything.
#[test]
fn the_surface_alone_comes_back() {
    if gpu().is_none() {
        return;
    }
    let cells = "body.0.mesh.cells=[8, 4, 4]";
    let mut device = load(BAR, &[cells], "gpu").unwrap().0;
    let mut processor = load(BAR, &[cells], "cpu").unwrap().0;
    let numbers = surface::nodes(device.prepared());
    assert!(numbers.len() > 50 && numbers.len() < device.prepared().nodes.len() - 20, "{}", numbers.len());
    let (nodes, same) = (device.nodes(&numbers).unwrap(), processor.nodes(&numbers).unwrap());
    for _ in 0..2 {
        device.advance().unwrap();
        processor.advance().unwrap();
        let before = device.transfers().unwrap();
        let places = device.positions_of(&nodes).unwrap();
        let moved = since(device.transfers().unwrap().nodes, before.nodes);
        assert_eq!(moved, Moved { uploaded: 0, downloaded: 12 * numbers.len() as u64 });
        assert_eq!(device.transfers().unwrap().states, before.states);
        for (place, other) in places.iter().zip(processor.positions_of(&same).unwrap()) {
            assert!((0..3).all(|k| (place[k] - other[k]).abs() < 1e-5), "{place:?} {other:?}");
        }
        let whole = device.positions();
        for (&n, place) in numbers.iter().zip(&places) {
            assert!((0..3).all(|k| (f64::from(place[k]) - whole[n as usize][k]).abs() < 1e-6), "node {n}");
        }
        // Now that the host knows the state, nothing is moved for its nodes.
        let before = device.transfers().unwrap();
        device.positions_of(&nodes).unwrap();
        assert_eq!(device.transfers().unwrap(), before);
    }
    let error = device.nodes(&[0, 1_000_000]).err().unwrap().to_string();
    assert!(error.contains("1000000") && error.contains("numbered from 0"), "{error}");
}

/// A probe of a quantity that elements make has the whole state come back, once per step, and measures what it measures
/// on the processor; so do probes of nodes beside it.
#[test]
fn quantities_of_elements_bring_the_state_back() {
    if gpu().is_none() {
        return;
    }
    let both = "probe.0.quantity=['mean displacement', 'strain energy']";
    let mut device = load(BAR, &["probe.0.region='all'", both], "gpu").unwrap().0;
    device.advance().unwrap();
    let before = device.transfers().unwrap();
    let _ = tip(&mut device);
    let moved = since(device.transfers().unwrap().states, before.states);
    // u in two numbers, v and the last acceleration.
    assert_eq!(moved, Moved { uploaded: 0, downloaded: 16 * device.unknowns() as u64 });
    assert_eq!(device.transfers().unwrap().nodes, before.nodes);
}
