//! The program as a person starts it: it says where it listens, refuses a port in use, and ends with Ctrl-C.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says with its line number what it expected")]
#![cfg(unix)]

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};

fn start(more: &[&str]) -> Child {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/validation/cube_top.toml");
    Command::new(env!("CARGO_BIN_EXE_souple-serve"))
        .args([scene, "--threads", "1", "--paused"])
        .args(more)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// With `--port 0` the program prints an address at which the page is; a second program on that port is refused with what
/// to do; Ctrl-C ends the first one without an error.
#[test]
fn the_program_serves_until_it_is_ended() {
    let mut first = start(&["--port", "0"]);
    let mut line = String::new();
    BufReader::new(first.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let address = line.split("http://").nth(1).and_then(|rest| rest.split('/').next()).unwrap().to_owned();
    let mut stream = TcpStream::connect(&address).unwrap();
    write!(stream, "GET / HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n").unwrap();
    let mut page = String::new();
    stream.read_to_string(&mut page).unwrap();
    assert!(page.starts_with("HTTP/1.1 200") && page.contains("<canvas"), "{page}");

    let port = address.rsplit(':').next().unwrap();
    let second = start(&["--port", port]).wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&second.stderr).into_owned();
    assert_eq!(second.status.code(), Some(2), "{said}");
    assert!(said.contains(port) && said.contains("--port"), "{said}");

    let asked = Command::new("kill").args(["-INT", &first.id().to_string()]).status().unwrap();
    assert!(asked.success());
    assert_eq!(first.wait().unwrap().code(), Some(0));
}

/// What is wrong with the arguments or the scene is said, and ends the program with 2.
#[test]
fn wrong_input_is_refused() {
    for (more, says) in [
        (&["--speed", "0"][..], "max"),
        (&["--clients", "0"], "clients"),
        (&["--set", "time.step=-1"], "step"),
        (&["--device", "abacus"], "abacus"),
    ] {
        let ended = start(more).wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert_eq!(ended.status.code(), Some(2), "{more:?}: {said}");
        assert!(said.contains(says), "{more:?}: {said}");
    }
}
