//! The `souple-serve` program: what `souple serve` starts.
//!
//! | exit code | meaning |
//! |---|---|
//! | 0 | it was ended by Ctrl-C |
//! | 2 | bad input, or the address cannot be listened on |

use clap::Parser;
use souple_serve::server::{Server, ServerOptions};
use souple_simulation::session::SessionOptions;
use souple_simulation::{RunOptions, Simulation};
use std::net::{IpAddr, Ipv4Addr};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::mpsc::channel;

/// Simulate here, see and touch it in browsers.
#[derive(Debug, Parser)]
#[command(
    name = "souple serve",
    version,
    after_help = "Examples:\n  souple serve scenes/organ.toml --open\n  \
        souple serve scenes/organ.toml --port 0 --paused\n  \
        ssh -L 8017:localhost:8017 HOST souple serve scenes/organ.toml    see what runs elsewhere"
)]
struct Arguments {
    /// The scene file
    scene: PathBuf,
    /// The port; 0 takes one that is free
    #[arg(long, default_value_t = 8017)]
    port: u16,
    /// The address to listen on; 0.0.0.0 lets every machine of the network in
    #[arg(long, value_name = "ADDRESS", default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST))]
    bind: IpAddr,
    /// Open a browser
    #[arg(long)]
    open: bool,
    /// Wait for somebody to press play
    #[arg(long)]
    paused: bool,
    /// Simulated seconds per second, or `max`
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = speed)]
    speed: Speed,
    /// Most browsers at a time
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u16).range(1..=1000))]
    clients: u16,
    /// A name under which browsers may ask for this machine; repeat it
    #[arg(long = "allow-host", value_name = "NAME")]
    hosts: Vec<String>,
    /// Change a value of the scene; repeat it
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// What to compute on (see: souple list devices)
    #[arg(long, default_value = "cpu")]
    device: String,
    /// Number of threads; 0 takes as many as the machine has
    #[arg(long, default_value_t = 0)]
    threads: usize,
}

/// Simulated seconds per second; as fast as it goes without.
#[derive(Clone, Copy, Debug)]
struct Speed(Option<f64>);

fn speed(text: &str) -> Result<Speed, String> {
    if text == "max" {
        return Ok(Speed(None));
    }
    let factor = text.parse().ok().filter(|f| (1e-6..=1e6).contains(f));
    factor.map(|f| Speed(Some(f))).ok_or_else(|| "expected a positive number, like 0.5, or `max`".into())
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let (asked, stop) = channel();
    let end = move || {
        // Nobody listens any more when it ends already.
        let _ = asked.send(());
    };
    ctrlc::set_handler(end).map_err(|e| format!("cannot listen for Ctrl-C: {e}"))?;
    let (simulation, warnings) = load(arguments)?;
    warnings.iter().for_each(|w| eprintln!("{w}"));
    let title = simulation.scene().title.clone();
    let options = ServerOptions {
        bind: arguments.bind,
        port: arguments.port,
        clients: usize::from(arguments.clients),
        hosts: arguments.hosts.clone(),
        session: SessionOptions { playing: !arguments.paused, speed: arguments.speed.0, ..SessionOptions::default() },
    };
    let server = Server::start(simulation, warnings, options).map_err(|e| e.to_string())?;
    let mut address = server.address();
    if !address.ip().is_loopback() {
        eprintln!("warning: whoever reaches {address} sees this simulation and may touch it");
    }
    if address.ip().is_unspecified() {
        address.set_ip(IpAddr::V4(Ipv4Addr::LOCALHOST));
    }
    let address = format!("http://{address}/");
    println!("{title}: {address} (Ctrl-C ends it)");
    if arguments.open
        && let Err(error) = open(&address)
    {
        eprintln!("cannot open a browser: {error}");
    }
    // The handler lives as long as the program, so that this ends with Ctrl-C only.
    let _ = stop.recv();
    server.stop();
    Ok(())
}

/// Reads the scene, with mesh files beside it.
fn load(arguments: &Arguments) -> Result<(Simulation, Vec<String>), String> {
    let path = &arguments.scene;
    let text = std::fs::read_to_string(path).map_err(|e| format!("cannot read {}: {e}", path.display()))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut read = |file: &str| {
        let path = folder.join(file);
        std::fs::read(&path).map_err(|e| format!("cannot read {}: {e}", path.display()))
    };
    let options = RunOptions { device: arguments.device.clone(), threads: arguments.threads };
    let name = path.display().to_string();
    Simulation::load(&text, &name, &arguments.overrides, &mut read, &options).map_err(|e| e.to_string())
}

/// Opens the person's browser.
fn open(address: &str) -> std::io::Result<()> {
    let program = match std::env::consts::OS {
        "macos" => "open",
        "windows" => "explorer",
        _ => "xdg-open",
    };
    std::process::Command::new(program).arg(address).spawn().map(drop)
}
