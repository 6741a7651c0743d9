//! Promises of steps on a graphics device: they agree with those on the processor, move few bytes, refuse what they
//! cannot do, and fail without taking the last state with them. On Mesa's driver on the processor where there is no other.
#![cfg(feature = "gpu")]
#![expect(clippy::unwrap_used, reason = "a test that cannot go on says where")]

#[path = "gpu/conformance.rs"]
mod conformance;
#[path = "gpu/runs.rs"]
mod runs;
#[path = "gpu/trajectory.rs"]
mod trajectory;
#[path = "gpu/transfers.rs"]
mod transfers;

use souple_kernels_gpu::Gpu;
use std::sync::OnceLock;

/// The first device; where there is none, says that tests are skipped.
fn gpu() -> Option<Gpu> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    let gpu = GPU.get_or_init(|| match Gpu::open("", None) {
        Ok(gpu) => Some(gpu),
        Err(souple_kernels_gpu::OpenError::None) => {
            println!("skipped: no adapter");
            if let Some(folder) = std::env::var_os("SOUPLE_SKIPPED") {
                std::fs::write(
                    std::path::Path::new(&folder).join("simulation, every test on a device.txt"),
                    "no adapter",
                )
                .unwrap();
            }
            None
        }
        Err(error) => panic!("{error}"),
    });
    gpu.clone()
}
