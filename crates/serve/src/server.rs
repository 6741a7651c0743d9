//! Starting and ending a server.
//!
//! | path | gives |
//! |---|---|
//! | `/` and its files | the page |
//! | `/socket` | the WebSocket |
//! | `/status` | how many look, as JSON |

use crate::client::talk;
use crate::command::LONGEST;
use crate::gate::judge;
use crate::hub::{Event, Frames, Hub};
use crate::page::{FILES, HEADERS};
use crate::scene_message::scene_message;
use crate::surface::Surface;
use axum::Router;
use axum::body::Bytes;
use axum::extract::ws::WebSocketUpgrade;
use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse as _, Response};
use axum::routing::{any, get};
use souple_simulation::Simulation;
use souple_simulation::session::{Session, SessionOptions};
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;
use tokio::sync::{Semaphore, watch};

/// How long clients have to hear that the server ends.
const GOODBYE: Duration = Duration::from_secs(2);

/// How a server begins.
#[derive(Clone, Debug, PartialEq)]
pub struct ServerOptions {
    /// Address to listen on.
    pub bind: IpAddr,
    /// Port; 0 takes one that is free.
    pub port: u16,
    /// Most clients at a time.
    pub clients: usize,
    /// Names under which the server may be asked for, beside `localhost` and addresses in digits.
    pub hosts: Vec<String>,
    /// How the simulation begins.
    pub session: SessionOptions,
}

impl Default for ServerOptions {
    fn default() -> Self {
        ServerOptions {
            bind: IpAddr::V4(Ipv4Addr::LOCALHOST),
            port: 8017,
            clients: 8,
            hosts: Vec::new(),
            session: SessionOptions::default(),
        }
    }
}

/// Why a server cannot start.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// Somebody else listens there.
    #[error("port {} of {} is in use; choose another with --port, or let --port 0 find one", .0.port(), .0.ip())]
    PortInUse(SocketAddr),
    /// The address cannot be listened on.
    #[error("cannot listen on {address}: {source}")]
    Bind {
        /// The address.
        address: SocketAddr,
        /// Why.
        source: std::io::Error,
    },
    /// The machine gives no thread, or no events.
    #[error("cannot start the server: {0}")]
    Start(String),
}

/// What all connections share.
pub(crate) struct Shared {
    pub(crate) hub: Sender<Event>,
    pub(crate) frames: watch::Sender<Frames>,
    pub(crate) stop: watch::Sender<bool>,
    pub(crate) scene: Bytes,
    pub(crate) surface: Arc<Surface>,
    places: Arc<Semaphore>,
    clients: usize,
    hosts: Vec<String>,
    next: AtomicU32,
}

/// A simulation that is served; dropping this ends it.
pub struct Server {
    address: SocketAddr,
    shared: Arc<Shared>,
    threads: Mutex<Vec<JoinHandle<()>>>,
}

impl Server {
    /// Starts to simulate and to listen; `warnings` are those of loading.
    ///
    /// # Errors
    /// When the address is taken or cannot be listened on, or the machine gives no thread.
    pub fn start(simulation: Simulation, warnings: Vec<String>, options: ServerOptions) -> Result<Server, ServeError> {
        let wanted = SocketAddr::new(options.bind, options.port);
        let listener = TcpListener::bind(wanted).map_err(|source| match source.kind() {
            std::io::ErrorKind::AddrInUse => ServeError::PortInUse(wanted),
            _ => ServeError::Bind { address: wanted, source },
        })?;
        let listening = listener.set_nonblocking(true).and_then(|()| listener.local_addr());
        let address = listening.map_err(|source| ServeError::Bind { address: wanted, source })?;

        let surface = Arc::new(Surface::of(&simulation));
        let scene = Bytes::from(scene_message(&simulation, &surface));
        let (hub, events) = channel();
        let (frames, _) = watch::channel(Frames::new());
        let wake = hub.clone();
        // The hub ends after its session, so nobody is woken in vain but at the very end.
        let wake = Box::new(move || drop(wake.send(Event::Woken)));
        let speed = options.session.speed;
        let session = Session::start(simulation, warnings, options.session, wake).map_err(ServeError::Start)?;
        let worker = Hub { session, surface: surface.clone(), events, frames: frames.clone(), speed };
        let shared = Arc::new(Shared {
            hub,
            frames,
            stop: watch::channel(false).0,
            scene,
            surface,
            places: Arc::new(Semaphore::new(options.clients)),
            clients: options.clients,
            hosts: options.hosts,
            next: AtomicU32::new(1),
        });
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
        let runtime = runtime.map_err(|e| ServeError::Start(e.to_string()))?;
        let listener = {
            let _inside = runtime.enter();
            tokio::net::TcpListener::from_std(listener).map_err(|e| ServeError::Start(e.to_string()))?
        };
        let start = |name: &str, work: Box<dyn FnOnce() + Send>| {
            std::thread::Builder::new().name(name.into()).spawn(work).map_err(|e| ServeError::Start(e.to_string()))
        };
        let server = Server { address, shared, threads: Mutex::new(Vec::new()) };
        let shared = server.shared.clone();
        let network = Box::new(move || runtime.block_on(listen(listener, shared)));
        let threads = [start("hub", Box::new(move || worker.run()))?, start("network", network)?];
        server.threads.lock().unwrap_or_else(std::sync::PoisonError::into_inner).extend(threads);
        Ok(server)
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Ends it: clients are told, the simulation finishes its step. Doing so twice is no mistake.
    pub fn stop(&self) {
        self.shared.stop.send_replace(true);
        // Nobody is there when it has ended before.
        let _ = self.shared.hub.send(Event::Stop);
        let threads = std::mem::take(&mut *self.threads.lock().unwrap_or_else(std::sync::PoisonError::into_inner));
        for thread in threads {
            // A panic has been reported by the thread itself.
            let _ = thread.join();
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.stop();
    }
}

/// Waits for the end of the server.
pub(crate) async fn ended(stop: &mut watch::Receiver<bool>) {
    // An error means that the server itself is gone.
    let _ = stop.wait_for(|stop| *stop).await;
}

async fn listen(listener: tokio::net::TcpListener, shared: Arc<Shared>) {
    let mut router = Router::new().route("/socket", any(socket)).route("/status", get(status));
    for file in FILES {
        router = router.route(file.path, get(([(header::CONTENT_TYPE, file.kind)], file.text)));
    }
    let router = router.layer(from_fn_with_state(shared.clone(), guard)).with_state(shared.clone());
    let mut stop = shared.stop.subscribe();
    let until = async move { ended(&mut stop).await };
    let served = axum::serve(listener, router).with_graceful_shutdown(until).into_future();
    tokio::select! {
        // With an error of the listener nobody new comes in; whoever is connected stays until the end.
        _ = served => farewell(&shared).await,
        () = farewell(&shared) => {}
    }
}

/// Waits for the end, then until every client has gone or has had its time.
async fn farewell(shared: &Shared) {
    ended(&mut shared.stop.subscribe()).await;
    // All places are free when everybody has gone.
    let everybody = shared.places.acquire_many(shared.clients as u32);
    let _ = tokio::time::timeout(GOODBYE, everybody).await;
}

/// Refuses strangers before anything else looks at the request, and puts the common headers on every answer.
async fn guard(State(shared): State<Arc<Shared>>, request: Request, next: Next) -> Response {
    let verdict = {
        let text = |name| request.headers().get(name).map(|v: &HeaderValue| v.to_str().unwrap_or("?"));
        judge(text(header::HOST), text(header::ORIGIN), &shared.hosts)
    };
    let mut answer = match verdict {
        Ok(()) => next.run(request).await,
        Err(refusal) => (StatusCode::FORBIDDEN, format!("{refusal}\n")).into_response(),
    };
    for (name, value) in HEADERS {
        answer.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    answer
}

async fn status(State(shared): State<Arc<Shared>>) -> Response {
    let looking = shared.clients - shared.places.available_permits();
    let text = format!("{{\"clients\":{looking},\"limit\":{}}}", shared.clients);
    ([(header::CONTENT_TYPE, "application/json")], text).into_response()
}

async fn socket(
    State(shared): State<Arc<Shared>>,
    method: Method,
    headers: HeaderMap,
    upgrade: Result<WebSocketUpgrade, axum::extract::ws::rejection::WebSocketUpgradeRejection>,
) -> Response {
    let upgrade = match upgrade {
        Ok(upgrade) => upgrade,
        Err(_) => {
            let asked = headers.get(header::UPGRADE).is_some();
            let why = format!(
                "a WebSocket is opened here, found {method} {}",
                if asked { "broken" } else { "without upgrade" }
            );
            return (StatusCode::BAD_REQUEST, why).into_response();
        }
    };
    let Ok(place) = shared.places.clone().try_acquire_owned() else {
        let why = format!("{} clients look already, which is the limit (--clients)\n", shared.clients);
        return (StatusCode::SERVICE_UNAVAILABLE, why).into_response();
    };
    let number = shared.next.fetch_add(1, Ordering::Relaxed);
    upgrade.max_message_size(LONGEST).max_frame_size(LONGEST).on_upgrade(async move |socket| {
        talk(socket, number, shared).await;
        drop(place);
    })
}
