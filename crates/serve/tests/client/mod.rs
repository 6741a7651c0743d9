//! A client of the protocol, for tests: it waits for what it wants to see, never for time to pass.

#![allow(dead_code, reason = "each test file uses its part")]

use serde_json::Value;
use souple_serve::message::{Decoded, decode};
use souple_serve::server::{Server, ServerOptions};
use souple_simulation::session::SessionOptions;
use souple_simulation::{RunOptions, Simulation};
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::time::{Duration, Instant};
use tungstenite::client::IntoClientRequest as _;
use tungstenite::http::HeaderValue;
use tungstenite::{HandshakeError, Message, WebSocket};

/// Nothing here takes as long; a test that waits so long fails.
const DEADLINE: Duration = Duration::from_secs(60);

/// A bar of hexahedra, held at one end, that bends under its own weight.
pub(crate) fn simulation() -> Simulation {
    let text = r#"
        title = "Bar"
        gravity = [0.0, -9.81, 0.0]
        [time]
        step = 0.01
        end = 100.0
        [integrator]
        method = "implicit-euler"
        velocity_damping = 5.0
        [[body]]
        name = "bar"
        density = 1000.0
        mesh = { generator = "bar", size = [0.4, 0.1, 0.1], cells = [4, 2, 2], element = "hex8" }
        material = [{ law = "stvk", young = "50 kPa", poisson = 0.3 }]
        fix = [{ region = "x_min" }]
    "#;
    let mut read = |file: &str| Err(format!("no file {file}"));
    Simulation::load(text, "bar.toml", &[], &mut read, &options()).unwrap().0
}

fn options() -> RunOptions {
    RunOptions { threads: 1, ..RunOptions::default() }
}

/// Paused, and as fast as it goes.
fn session() -> SessionOptions {
    SessionOptions { playing: false, speed: None, ..SessionOptions::default() }
}

/// Serves the bar on a free port.
pub(crate) fn serve(options: ServerOptions) -> Server {
    let options = ServerOptions { port: 0, session: session(), ..options };
    Server::start(simulation(), Vec::new(), options).unwrap()
}

/// Serves a scene of the repository.
pub(crate) fn scene(path: &str) -> Server {
    scene_at(path, 0)
}

/// Serves a scene of the repository on this port.
pub(crate) fn scene_at(path: &str, port: u16) -> Server {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let text = std::fs::read_to_string(&path).unwrap();
    let folder = path.parent().unwrap();
    let mut read = |file: &str| std::fs::read(folder.join(file)).map_err(|e| e.to_string());
    let (simulation, warnings) = Simulation::load(&text, "scene.toml", &[], &mut read, &options()).unwrap();
    let options = ServerOptions { port, session: session(), ..ServerOptions::default() };
    Server::start(simulation, warnings, options).unwrap()
}

/// Asks again until there is an answer.
pub(crate) fn until<T>(mut ask: impl FnMut() -> Option<T>) -> T {
    let begin = Instant::now();
    loop {
        if let Some(answer) = ask() {
            return answer;
        }
        assert!(begin.elapsed() < DEADLINE, "waited in vain");
        std::thread::yield_now();
    }
}

/// The whole answer to a plain request.
pub(crate) fn get(server: &Server, path: &str) -> String {
    let mut stream = TcpStream::connect(server.address()).unwrap();
    stream.set_read_timeout(Some(DEADLINE)).unwrap();
    let host = server.address();
    write!(stream, "GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n").unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
}

/// Why there is no client.
#[derive(Debug)]
pub(crate) enum Refused {
    /// The server answered something else, with this text.
    Status(u16, String),
    /// It answered nothing that could be understood.
    Other(String),
}

/// A client.
pub(crate) struct Client {
    socket: WebSocket<TcpStream>,
    /// Its number, which is that of its hand.
    pub(crate) number: u64,
    /// What came first.
    pub(crate) scene: Decoded,
    /// Whether it asks for another frame for each that it got.
    pub(crate) hungry: bool,
}

/// Connects as a program does, without an origin.
pub(crate) fn connect(server: &Server) -> Result<Client, Refused> {
    Client::open(server, None, None)
}

impl Client {
    /// Connects with these headers.
    pub(crate) fn open(server: &Server, host: Option<&str>, origin: Option<&str>) -> Result<Client, Refused> {
        let stream = TcpStream::connect(server.address()).unwrap();
        stream.set_read_timeout(Some(DEADLINE)).unwrap();
        let mut request = format!("ws://{}/socket", server.address()).into_client_request().unwrap();
        for (name, value) in [("host", host), ("origin", origin)] {
            if let Some(value) = value {
                request.headers_mut().insert(name, HeaderValue::from_str(value).unwrap());
            }
        }
        let socket = match tungstenite::client(request, stream) {
            Ok((socket, _)) => socket,
            Err(HandshakeError::Failure(tungstenite::Error::Http(answer))) => {
                let text = answer.body().as_deref().map(String::from_utf8_lossy).unwrap_or_default().into_owned();
                return Err(Refused::Status(answer.status().as_u16(), text));
            }
            Err(other) => return Err(Refused::Other(other.to_string())),
        };
        let mut client = Client { socket, number: 0, scene: empty(), hungry: true };
        match client.read() {
            Message::Text(text) => {
                let welcome: Value = serde_json::from_str(&text).unwrap();
                assert_eq!(welcome["kind"], "welcome");
                client.number = welcome["you"].as_u64().unwrap();
            }
            other => panic!("{other:?}"),
        }
        match client.read() {
            Message::Binary(bytes) => client.scene = decode(&bytes).unwrap(),
            other => panic!("{other:?}"),
        }
        assert_eq!(client.scene.header["kind"], "scene");
        Ok(client)
    }

    fn read(&mut self) -> Message {
        loop {
            match self.socket.read().unwrap() {
                Message::Ping(_) | Message::Pong(_) => {}
                message => return message,
            }
        }
    }

    /// Sends a command.
    pub(crate) fn send(&mut self, command: Value) {
        self.send_text(&command.to_string());
    }

    /// Sends a text.
    pub(crate) fn send_text(&mut self, text: &str) {
        self.socket.send(Message::Text(text.into())).unwrap();
    }

    /// Sends bytes.
    pub(crate) fn send_binary(&mut self, bytes: &[u8]) {
        self.socket.send(Message::Binary(bytes.to_vec().into())).unwrap();
    }

    /// The next frame; answers to mistakes are none.
    pub(crate) fn frame(&mut self) -> Decoded {
        match self.read() {
            Message::Binary(bytes) => {
                if self.hungry {
                    self.send(serde_json::json!({ "do": "more" }));
                }
                decode(&bytes).unwrap()
            }
            other => panic!("expected a frame, found {other:?}"),
        }
    }

    /// The first frame from now on whose header is wanted.
    pub(crate) fn frame_where(&mut self, wanted: impl Fn(&Value) -> bool) -> Decoded {
        let begin = Instant::now();
        loop {
            let frame = self.frame();
            if wanted(&frame.header) {
                return frame;
            }
            assert!(begin.elapsed() < DEADLINE, "waited in vain; the last frame: {}", frame.header);
        }
    }

    /// Frames up to the next answer to a mistake.
    pub(crate) fn frames_before_error(&mut self) -> Vec<Decoded> {
        let mut frames = Vec::new();
        loop {
            match self.read() {
                Message::Binary(bytes) => frames.push(decode(&bytes).unwrap()),
                Message::Text(text) => {
                    assert!(text.contains("error"), "{text}");
                    return frames;
                }
                other => panic!("{other:?}"),
            }
        }
    }

    /// The next answer to a mistake; frames before it are passed over.
    pub(crate) fn error(&mut self) -> String {
        loop {
            match self.read() {
                Message::Binary(_) => {
                    if self.hungry {
                        self.send(serde_json::json!({ "do": "more" }));
                    }
                }
                Message::Text(text) => {
                    let answer: Value = serde_json::from_str(&text).unwrap();
                    assert_eq!(answer["kind"], "error");
                    return answer["message"].as_str().unwrap().to_owned();
                }
                other => panic!("{other:?}"),
            }
        }
    }

    /// Whether the connection ends; what comes before is passed over.
    pub(crate) fn ends(&mut self) -> bool {
        loop {
            match self.socket.read() {
                Ok(Message::Close(_)) => return true,
                Ok(_) => {}
                Err(tungstenite::Error::Io(e)) => {
                    return !matches!(e.kind(), std::io::ErrorKind::WouldBlock | std::io::ErrorKind::TimedOut);
                }
                Err(_) => return true,
            }
        }
    }
}

fn empty() -> Decoded {
    decode(&souple_serve::message::encode(serde_json::Map::new(), &[])).unwrap()
}
