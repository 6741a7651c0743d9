//! One WebSocket: frames when the client has room for them, answers to its mistakes, its commands.
//!
//! A client may have [`FRAMES`] frames under way and says `more` for each that it has drawn; then it gets the newest one
//! that it has not seen. So a slow client skips frames, and nothing grows for its sake.

use crate::command::{self, Command};
use crate::hub::{Event, Frames};
use crate::server::{Shared, ended};
use axum::body::Bytes;
use axum::extract::ws::{CloseFrame, Message, WebSocket, close_code};
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt as _, StreamExt as _};
use serde_json::json;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{Semaphore, mpsc, watch};
use tokio::time::{Instant, interval_at, timeout};

/// Frames that may be under way.
const FRAMES: usize = 2;
/// Answers that may wait; who makes mistakes faster than they can be told is not told of all.
const ANSWERS: usize = 16;
/// Commands per second.
const COMMANDS: u32 = 500;
/// The other side is asked this often whether it is there.
const PULSE: Duration = Duration::from_secs(15);
/// Without a sign of life for this long, it is not.
const SILENCE: Duration = Duration::from_secs(45);

/// Talks to a client until it goes away or the server ends.
pub(crate) async fn talk(socket: WebSocket, number: u32, shared: Arc<Shared>) {
    let mut frames = shared.frames.subscribe();
    // Only what comes from now on is news; the hub makes a frame for whoever joins.
    frames.mark_unchanged();
    let (sink, stream) = socket.split();
    let room = Semaphore::new(FRAMES);
    let (answer, answers) = mpsc::channel(ANSWERS);
    if shared.hub.send(Event::Joined(number)).is_ok() {
        tokio::select! {
            () = write(sink, number, frames, &room, answers, &shared) => {}
            () = read(stream, number, &room, answer, &shared) => {}
        }
        // The hub is gone when the server ends.
        let _ = shared.hub.send(Event::Left(number));
    }
}

async fn write(
    mut sink: SplitSink<WebSocket, Message>,
    number: u32,
    mut frames: watch::Receiver<Frames>,
    room: &Semaphore,
    mut answers: mpsc::Receiver<String>,
    shared: &Shared,
) {
    let welcome = json!({ "kind": "welcome", "you": number }).to_string();
    for message in [Message::Text(welcome.into()), Message::Binary(shared.scene.clone())] {
        if sink.send(message).await.is_err() {
            return;
        }
    }
    let mut pulse = interval_at(Instant::now() + PULSE, PULSE);
    let mut stop = shared.stop.subscribe();
    loop {
        let message = tokio::select! {
            biased;
            () = ended(&mut stop) => {
                let reason = "the server ends".into();
                // Whoever does not listen any more needs no goodbye.
                let _ = sink.send(Message::Close(Some(CloseFrame { code: close_code::AWAY, reason }))).await;
                return;
            }
            Some(answer) = answers.recv() => Message::Text(answer.into()),
            _ = pulse.tick() => Message::Ping(Bytes::new()),
            frame = newest(&mut frames, number, room) => match frame {
                Some(frame) => Message::Binary(frame),
                None => return,
            },
        };
        if sink.send(message).await.is_err() {
            return;
        }
    }
}

/// The newest frame that the client has not seen, once it has room; `None` when there will be no more.
async fn newest(frames: &mut watch::Receiver<Frames>, number: u32, room: &Semaphore) -> Option<Bytes> {
    // The place is given back when this wait is broken off, and taken for good when a frame goes out.
    let place = room.acquire().await.ok()?;
    loop {
        frames.changed().await.ok()?;
        // Those that were made before the hub knew of this client have none for it.
        let frame = frames.borrow_and_update().get(&number).cloned();
        if frame.is_some() {
            place.forget();
            return frame;
        }
    }
}

async fn read(
    mut stream: SplitStream<WebSocket>,
    number: u32,
    room: &Semaphore,
    answer: mpsc::Sender<String>,
    shared: &Shared,
) {
    let refuse = |why: String| {
        // See ANSWERS.
        let _ = answer.try_send(json!({ "kind": "error", "message": why }).to_string());
    };
    let mut second = (Instant::now(), 0);
    // An error is a broken connection or a message that breaks the protocol (too long, say); both end it.
    while let Ok(Some(Ok(message))) = timeout(SILENCE, stream.next()).await {
        let text = match message {
            Message::Text(text) => text,
            Message::Binary(_) => {
                refuse("commands are JSON in text messages, found a binary one".into());
                continue;
            }
            Message::Close(_) => return,
            Message::Ping(_) | Message::Pong(_) => continue,
        };
        if second.0.elapsed() > Duration::from_secs(1) {
            second = (Instant::now(), 0);
        }
        second.1 += 1;
        if second.1 > COMMANDS {
            refuse(format!("more than {COMMANDS} commands per second; this one was left out"));
            continue;
        }
        match command::parse(&text, shared.surface.nodes.len()) {
            Ok(Command::More {}) => {
                if room.available_permits() < FRAMES {
                    room.add_permits(1);
                }
            }
            Ok(command) => {
                if shared.hub.send(Event::Asked(number, command)).is_err() {
                    return;
                }
            }
            Err(error) => refuse(error.to_string()),
        }
    }
}
