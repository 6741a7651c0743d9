//! Promise: on the same mesh, with the same law and quadrature, every nodal displacement of the static cantilevers
//! agrees with an independent solver (CalculiX 2.20) to the digits that it prints.
//!
//! Out of scope: how good the elements are; the meshes are coarse on purpose.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on says where")]

use souple_simulation::{RunOptions, Simulation};
use std::path::Path;

/// Largest relative difference |u − r| / |r| over all nodes of a validation scene, and the number of nodes compared.
fn difference(case: &str) -> (f64, usize) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/validation");
    let file = folder.join(format!("cantilever_{case}.toml"));
    let text = std::fs::read_to_string(&file).unwrap();
    let mut read = |name: &str| std::fs::read(folder.join(name)).map_err(|e| e.to_string());
    let (mut simulation, _) =
        Simulation::load(&text, &file.to_string_lossy(), &[], &mut read, &RunOptions::default()).unwrap();
    while simulation.advance().unwrap().finished.is_none() {}
    let reference = std::fs::read_to_string(folder.join(format!("reference/cantilever_{case}.csv"))).unwrap();
    let u = simulation.displacement();
    let mut worst: f64 = 0.0;
    let mut count = 0;
    for line in reference.lines().filter(|l| l.starts_with(|c: char| c.is_ascii_digit())) {
        let mut words = line.split(',');
        let node: usize = words.next().unwrap().trim().parse().unwrap();
        let expected: Vec<f64> = words.map(|w| w.trim().parse().unwrap()).collect();
        let size = expected.iter().map(|x| x * x).sum::<f64>().sqrt();
        let got = &u[3 * (node - 1)..3 * node];
        let gap = got.iter().zip(&expected).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        if size > 0.0 {
            worst = worst.max(gap / size);
        } else {
            assert_eq!(gap, 0.0, "node {node} is clamped");
        }
        count += 1;
    }
    (worst, count)
}

macro_rules! agrees {
    ($($name:ident: $case:literal,)*) => {$(
        /// Every nodal displacement agrees to 1e-6 of its length.
        #[test]
        fn $name() {
            let (worst, count) = difference($case);
            assert!(count > 800, "only {count} nodes were compared");
            assert!(worst <= 1e-6, "the largest relative difference is {worst:e}");
        }
    )*};
}

agrees! {
    hex8_hooke: "hex8_hooke",
    hex8_stvk: "hex8_stvk",
    tet4_hooke: "tet4_hooke",
    tet4_stvk: "tet4_stvk",
    prism6_hooke: "prism6_hooke",
    prism6_stvk: "prism6_stvk",
}
