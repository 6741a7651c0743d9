//! Reports of a database that is still being filled, over HTTP.
//!
//! | address | answer |
//! |---|---|
//! | `/` | the groups, or the page of the only one |
//! | `/group/N` | the page of the group with id N, which asks for new data by itself |
//! | `/group/N/data.json` | its data, with an `ETag`; 304 to whoever has them already |
//!
//! What it is not: a way to change anything, or to read files. It answers GET and HEAD, reads the database, and, where it
//! listens on this machine alone, answers only to names of this machine, so that no page of the network can read it
//! through the browser of someone here.

use crate::database::{Database, DatabaseError, GroupRow, groups};
use crate::identity::sha256;
use crate::report::page::{Surroundings, data, escaped, html};
use crate::report::read;
use std::net::SocketAddr;

/// What is asked for.
#[derive(Clone, Copy, Debug)]
pub struct Question<'q> {
    /// `GET`, `HEAD`, ….
    pub method: &'q str,
    /// Path, without the query.
    pub path: &'q str,
    /// The `Host` that was asked.
    pub host: Option<&'q str>,
    /// The `If-None-Match`.
    pub known: Option<&'q str>,
}

/// What is answered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// Status.
    pub status: u16,
    /// Names and values.
    pub headers: Vec<(&'static str, String)>,
    /// Content.
    pub body: Vec<u8>,
}

const HTML: &str = "text/html; charset=utf-8";
const JSON: &str = "application/json";
/// The page contains its scripts and style; nothing else may be loaded, and nothing but its own data asked for.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; \
    connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// Answers a question from the database; `address` is where we listen.
///
/// # Errors
///
/// When the database cannot be read.
pub fn answer(database: &Database, question: &Question<'_>, address: SocketAddr) -> Result<Answer, DatabaseError> {
    if !["GET", "HEAD"].contains(&question.method) {
        let mut refused = said(405, "this server only shows: use GET");
        refused.headers.push(("Allow", "GET, HEAD".to_owned()));
        return Ok(refused);
    }
    if address.ip().is_loopback() && !question.host.is_some_and(names_this_machine) {
        return Ok(said(403, "this server answers to names of its own machine only: use localhost"));
    }
    let all = groups(database)?;
    let parts: Vec<&str> = question.path.trim_matches('/').split('/').collect();
    let of = |id: &str| id.parse::<i64>().ok().and_then(|id| all.iter().find(|g| g.id == id));
    let found = match parts.as_slice() {
        [""] if all.len() != 1 => return Ok(ok(HTML, index(&all).into_bytes())),
        [""] => all.first().map(|g| (g, false)),
        ["group", id] => of(id).map(|g| (g, false)),
        ["group", id, "data.json"] => of(id).map(|g| (g, true)),
        _ => None,
    };
    let Some((row, only_data)) = found else {
        return Ok(said(404, "there is no such page; / has the groups"));
    };
    let group = read::group(database, row.id)?;
    let surroundings = Surroundings { results: None, live: Some(format!("/group/{}/data.json", row.id)) };
    if !only_data {
        return Ok(ok(HTML, html(&group, &surroundings).into_bytes()));
    }
    let body = data(&group, &surroundings).to_string().into_bytes();
    let tag = format!("\"{}\"", sha256(&body));
    let mut answer = ok(JSON, body);
    if question.known == Some(tag.as_str()) {
        answer.status = 304;
        answer.body.clear();
    }
    answer.headers.push(("ETag", tag));
    Ok(answer)
}

fn ok(kind: &str, body: Vec<u8>) -> Answer {
    let headers = vec![
        ("Content-Type", kind.to_owned()),
        ("Content-Security-Policy", POLICY.to_owned()),
        ("X-Content-Type-Options", "nosniff".to_owned()),
        ("Cache-Control", "no-cache".to_owned()),
    ];
    Answer { status: 200, headers, body }
}

/// A status with a sentence.
pub fn said(status: u16, text: &str) -> Answer {
    Answer { status, ..ok("text/plain; charset=utf-8", format!("{text}\n").into_bytes()) }
}

/// Whether a `Host` is a name of the machine that one sits at.
fn names_this_machine(host: &str) -> bool {
    let name = match host.rsplit_once(':') {
        Some((name, port)) if port.bytes().all(|b| b.is_ascii_digit()) => name,
        _ => host,
    };
    let bare = name.trim_start_matches('[').trim_end_matches(']');
    name.eq_ignore_ascii_case("localhost") || bare.parse::<std::net::IpAddr>().is_ok_and(|ip| ip.is_loopback())
}

/// The list of groups.
fn index(all: &[GroupRow]) -> String {
    let row = |g: &GroupRow| {
        let name = escaped(&g.name);
        format!("<li><a href=\"/group/{}\">{name}</a>: {} of {} done</li>", g.id, g.done, g.members)
    };
    let rows: String = all.iter().rev().map(row).collect();
    let list = if all.is_empty() { "<p>No group yet.</p>".to_owned() } else { format!("<ul>{rows}</ul>") };
    format!(
        "<!DOCTYPE html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">\
         <meta name=\"color-scheme\" content=\"light dark\"><link rel=\"icon\" href=\"data:,\"><title>Campaigns</title>\
         <style>body {{ font: 16px/1.6 system-ui, sans-serif; max-width: 40em; margin: 3em auto; padding: 0 1em }}</style>\
         <h1>Campaigns</h1>{list}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Only names of the own machine are taken for it, with and without a port.
    #[test]
    fn names_of_the_machine_are_known() {
        for host in ["localhost", "localhost:8000", "LOCALHOST:1", "127.0.0.1:80", "[::1]:80", "127.1.2.3"] {
            assert!(names_this_machine(host), "{host}");
        }
        for host in ["example.org", "localhost.example.org:80", "10.0.0.1", "", "127.0.0.1.example.org"] {
            assert!(!names_this_machine(host), "{host}");
        }
    }
}
