//! `souple campaign serve`: reports of a database that is being filled, in a browser.

use super::open;
use crate::output::{note, say};
use souple_campaign::database::Location;
use souple_campaign::serve::{Answer, Body, Question, Site, answer, said};
use std::fs::File;
use std::io::{Cursor, Read};
use std::net::{IpAddr, SocketAddr};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use tiny_http::{Header, Request, Response, Server};

/// Questions that are answered at the same time: one that is slow to take its answer holds up nobody.
const WORKERS: usize = 4;

#[derive(Debug, clap::Args)]
#[command(after_help = "Example: souple campaign serve --port 8000")]
pub(crate) struct Arguments {
    /// The database
    #[arg(long, value_name = "FILE|URL", default_value = "campaign.db")]
    db: String,
    /// Folder of the results of simulations; without it, beside the database's file or named after the server's database
    #[arg(long, value_name = "DIR")]
    results: Option<PathBuf>,
    /// The port; 0 takes a free one
    #[arg(long, default_value_t = 8321)]
    port: u16,
    /// The address to listen on; any other than one of this machine shows the results to the network
    #[arg(long, default_value = "127.0.0.1")]
    bind: IpAddr,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, String> {
    let asked = SocketAddr::new(arguments.bind, arguments.port);
    let results = arguments.results.clone().unwrap_or_else(|| Location::parse(&arguments.db).results());
    let site = |_| open(&arguments.db).map(|database| Site::new(database, results.clone()));
    let sites: Vec<Site> = (0..WORKERS).map(site).collect::<Result<_, _>>()?;
    let server = Server::http(asked)
        .map_err(|e| format!("cannot listen on {asked}: {e}; choose another one with --port, or 0 for any"))?;
    let address = server.server_addr().to_ip().ok_or("the system does not say where we listen")?;
    say(&format!("http://{address}/"))?;
    let (server, stop) = (Arc::new(server), Arc::new(AtomicBool::new(false)));
    let (asked, waiting) = (stop.clone(), server.clone());
    ctrlc::set_handler(move || {
        asked.store(true, Ordering::Relaxed);
        (0..WORKERS).for_each(|_| waiting.unblock());
    })
    .map_err(|e| format!("cannot listen for Ctrl-C: {e}"))?;
    let workers = sites.into_iter().map(|mut site| {
        let (server, stop) = (server.clone(), stop.clone());
        std::thread::spawn(move || {
            while !stop.load(Ordering::Relaxed) {
                // An error here is one connection's, or the call to stop.
                if let Ok(request) = server.recv() {
                    respond(&mut site, request, address);
                }
            }
        })
    });
    for worker in workers.collect::<Vec<_>>() {
        worker.join().map_err(|_| "a worker panicked; this is a mistake in the program".to_owned())?;
    }
    Ok(ExitCode::SUCCESS)
}

fn respond(site: &mut Site, request: Request, address: SocketAddr) {
    let method = request.method().to_string();
    let header = |name: &'static str| {
        request.headers().iter().find(|h| h.field.equiv(name)).map(|h| h.value.as_str().to_owned())
    };
    let (host, known) = (header("Host"), header("If-None-Match"));
    let path = request.url().split('?').next().unwrap_or("").to_owned();
    let question = Question { method: &method, path: &path, host: host.as_deref(), known: known.as_deref() };
    let Answer { status, headers, body } = answer(site, &question, address).unwrap_or_else(|e| {
        note(&format!("error: {e}"));
        said(500, "the database cannot be read; the terminal of the server says why")
    });
    let (status, body, length): (u16, Box<dyn Read>, u64) = match body {
        Body::Bytes(bytes) => {
            let length = bytes.len() as u64;
            (status, Box::new(Cursor::new(bytes)), length)
        }
        Body::File(path) => match File::open(&path).and_then(|file| Ok((file.metadata()?.len(), file))) {
            Ok((length, file)) => (status, Box::new(file), length),
            // It was there a moment ago.
            Err(_) => (404, Box::new(std::io::empty()), 0),
        },
    };
    let length = usize::try_from(length).ok();
    let headers = headers.into_iter().filter_map(|(name, value)| Header::from_bytes(name, value.as_bytes()).ok());
    // Whoever asked may be gone.
    let _ = request.respond(Response::new(status.into(), headers.collect(), body, length, None));
}
