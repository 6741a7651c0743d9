//! Devices that allow less than they have: what fits in parts gives the same bits, what cannot be cut is refused.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on says where")]

use super::OnDevice;
use crate::run::{Remote, RunOptions, Simulation};
use souple_kernels_gpu::{DeviceError, Gpu, adapters};

/// Two batches of tetrahedra, with two laws.
const BAR: &str = r#"
gravity = [0.0, -9.81, 0.0]
[time]
step = 0.01
end = 0.05
[integrator]
method = "implicit-euler"
[linear_solver]
preconditioner = "block-jacobi"
[[body]]
name = "bar"
density = 1000.0
[body.mesh]
generator = "bar"
size = [4.0, 1.0, 1.0]
cells = [16, 4, 4]
sections = [{ until = 0.5, element = "tet4" }, { until = 1.0, element = "tet4" }]
[[body.material]]
region = "all"
law = "neo-hookean"
young = 1e6
poisson = 0.3
[[body.material]]
region = "section_1"
law = "hooke"
young = 1e6
poisson = 0.3
[[body.fix]]
region = "x_min"
[[body.move]]
region = "x_max"
axes = ["x"]
translation = { keys = [[0.0, [0, 0, 0]], [0.05, [0.1, 0, 0]]] }
"#;

/// The scene on the first adapter, with a mesh as fine as given, which allows as many bytes in a binding as given; `None` where there is no adapter.
fn limited(cells: &str, bytes: u64) -> Option<Result<Simulation, DeviceError>> {
    let mut adapter = adapters().into_iter().next()?;
    let limits = &mut adapter.description.limits;
    limits.binding_bytes = bytes;
    let own = limits.buffer_bytes;
    let gpu = Gpu::of(&adapter, None).unwrap();
    assert!(gpu.description().limits.buffer_bytes == own && gpu.description().limits.binding_bytes <= bytes);
    let mut read = |name: &str| Err(format!("{name}: there are no files here"));
    let options = RunOptions { device: "cpu".into(), threads: 1 };
    let (mut simulation, _) =
        Simulation::load(BAR, "scene.toml", &[format!("body.0.mesh.cells={cells}")], &mut read, &options).unwrap();
    let device = match OnDevice::on(&gpu, &simulation.scene, &simulation.system) {
        Ok(device) => device,
        Err(error) => return Some(Err(error)),
    };
    simulation.on_device = Some(Remote::new(device));
    simulation.send();
    Some(Ok(simulation))
}

fn run(mut simulation: Simulation) -> Vec<u64> {
    while simulation.advance().unwrap().finished.is_none() {}
    simulation.displacement().iter().map(|u| u.to_bits()).collect()
}

/// A model whose elements and contributions are cut into many parts by the size of a binding gives the same bits as the
/// uncut one.
#[test]
fn a_model_in_parts_gives_the_same_bits() {
    // Below 48 KiB the parts of the sums over vectors do not fit, whatever the model.
    let mesh = "[16, 4, 4]";
    let (Some(whole), Some(cut)) = (limited(mesh, u64::MAX), limited(mesh, 48 << 10)) else { return };
    let (whole, cut) = (whole.unwrap(), cut.unwrap());
    let parts = |s: &Simulation| s.on_device.as_ref().unwrap().device.parts();
    assert_eq!(parts(&whole), [2, 1], "one chunk per batch, one buffer of contributions");
    let [chunks, segments] = parts(&cut);
    assert!(chunks >= 6 && segments >= 2, "{chunks} chunks, {segments} buffers of contributions");
    let whole = run(whole);
    assert!(whole.iter().any(|bits| *bits != 0));
    assert!(whole == run(cut), "the bits differ");
}

/// A vector over all nodes is not cut: it is refused with what it is, its size, the limit and what to do.
#[test]
fn what_cannot_be_cut_is_refused_with_numbers() {
    let Some(refused) = limited("[40, 5, 5]", 48 << 10) else { return };
    let error = refused.err().unwrap();
    let DeviceError::TooLarge { bytes, limit, .. } = &error else { panic!("{error}") };
    // 41 × 6 × 6 nodes with a block of nine singles each.
    assert_eq!((*bytes, *limit), (1476 * 9 * 4, 48 << 10));
    let words = error.to_string();
    for part in ["the preconditioner", "51.9 KiB", "48.0 KiB", "coarser model", "`cpu`"] {
        assert!(words.contains(part), "{words}");
    }
}

/// The bytes that are counted by purpose are all that the device was given and gave since the model was put on it.
#[test]
fn every_byte_has_a_purpose() {
    let Some(simulation) = limited("[4, 1, 1]", u64::MAX) else { return };
    let mut simulation = simulation.unwrap();
    let all = |s: &Simulation| {
        let device = &s.on_device.as_ref().unwrap().device;
        let (own, counted) = (device.all_transfers(), device.transfers());
        (own.uploaded - counted.uploaded, own.downloaded - counted.downloaded)
    };
    let model = all(&simulation);
    simulation.advance().unwrap();
    let nodes = simulation.nodes(&[0, 3, 7]).unwrap();
    // What says which nodes are read is part of the purpose; results are made on the device.
    simulation.positions_of(&nodes).unwrap();
    simulation.advance().unwrap();
    simulation.frame().unwrap();
    assert_eq!(all(&simulation), model, "bytes without a purpose");
    assert_eq!(model.1, 0, "putting a model on a device reads nothing");
}
