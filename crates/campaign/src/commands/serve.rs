//! `souple campaign serve`: reports of a database that is being filled, in a browser.

use super::open;
use crate::output::{note, say};
use souple_campaign::database::Database;
use souple_campaign::serve::{Answer, Question, answer, said};
use std::net::{IpAddr, SocketAddr};
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
    /// The port; 0 takes a free one
    #[arg(long, default_value_t = 8321)]
    port: u16,
    /// The address to listen on; any other than one of this machine shows the results to the network
    #[arg(long, default_value = "127.0.0.1")]
    bind: IpAddr,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, String> {
    let asked = SocketAddr::new(arguments.bind, arguments.port);
    let databases: Vec<Database> = (0..WORKERS).map(|_| open(&arguments.db)).collect::<Result<_, _>>()?;
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
    let workers = databases.into_iter().map(|database| {
        let (server, stop) = (server.clone(), stop.clone());
        std::thread::spawn(move || {
            while !stop.load(Ordering::Relaxed) {
                // An error here is one connection's, or the call to stop.
                if let Ok(request) = server.recv() {
                    respond(&database, request, address);
                }
            }
        })
    });
    for worker in workers.collect::<Vec<_>>() {
        worker.join().map_err(|_| "a worker panicked; this is a mistake in the program".to_owned())?;
    }
    Ok(ExitCode::SUCCESS)
}

fn respond(database: &Database, request: Request, address: SocketAddr) {
    let method = request.method().to_string();
    let header = |name: &'static str| {
        request.headers().iter().find(|h| h.field.equiv(name)).map(|h| h.value.as_str().to_owned())
    };
    let (host, known) = (header("Host"), header("If-None-Match"));
    let path = request.url().split('?').next().unwrap_or("").to_owned();
    let question = Question { method: &method, path: &path, host: host.as_deref(), known: known.as_deref() };
    let Answer { status, headers, body } = answer(database, &question, address).unwrap_or_else(|e| {
        note(&format!("error: {e}"));
        said(500, "the database cannot be read; the terminal of the server says why")
    });
    let mut response = Response::from_data(body).with_status_code(status);
    for (name, value) in headers {
        if let Ok(header) = Header::from_bytes(name, value.as_bytes()) {
            response.add_header(header);
        }
    }
    // Whoever asked may be gone.
    let _ = request.respond(response);
}
