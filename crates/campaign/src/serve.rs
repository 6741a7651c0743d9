//! Reports of a database that is still being filled, over HTTP.
//!
//! | address | answer |
//! |---|---|
//! | `/` | the groups, or the page of the only one |
//! | `/group/N` | the page of the group with id N, which asks for new data by itself |
//! | `/group/N/data.json` | its data, with an `ETag`; 304 to whoever has them already |
//! | `/results/HASH/` | the files of a simulation |
//! | `/results/HASH/FILE` | one of them |
//!
//! What was made of the database is kept until somebody changes that: asking again and again costs nothing.
//!
//! What it is not: a way to change anything, or to read other files. It answers GET and HEAD, reads the database and the
//! folder of results, and, where it listens on this machine alone, answers only to names of this machine, so that no page
//! of the network can read it through the browser of someone here.

mod files;

pub use files::percent_encoded;

use crate::database::{Database, DatabaseError, GroupRow, group, groups};
use crate::identity::sha256;
use crate::report::page::{Surroundings, data, escaped, html};
use crate::report::read;
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::path::PathBuf;

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
    pub body: Body,
}

/// The content of an answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Body {
    /// These bytes.
    Bytes(Vec<u8>),
    /// What this file holds.
    File(PathBuf),
}

/// What answers are made from.
#[derive(Debug)]
pub struct Site {
    /// The database, of which this connection changes nothing.
    pub database: Database,
    /// The folder of results; links lead there once it exists.
    pub results: PathBuf,
    /// How often the data of a group were made anew.
    pub made: usize,
    /// [`Database::stamp`] when `known` was made.
    stamp: String,
    /// Data and their tag by the group's id.
    known: BTreeMap<i64, (Vec<u8>, String)>,
}

impl Site {
    /// A site of which nothing is known yet.
    pub fn new(database: Database, results: PathBuf) -> Site {
        Site { database, results, made: 0, stamp: String::new(), known: BTreeMap::new() }
    }

    fn surroundings(&self, group: i64) -> Surroundings {
        let results = self.results.is_dir().then(|| "/results".to_owned());
        Surroundings { results, live: Some(format!("/group/{group}/data.json")) }
    }

    /// The data of a group with their tag; none: there is no such group.
    fn data(&mut self, id: i64) -> Result<Option<&(Vec<u8>, String)>, DatabaseError> {
        // Asked before anything is read: what is changed meanwhile is found the next time.
        let stamp = self.database.stamp()?;
        if stamp != self.stamp {
            self.known.clear();
            self.stamp = stamp;
        }
        if !self.known.contains_key(&id) {
            if group(&self.database, id)?.is_none() {
                return Ok(None);
            }
            let body = data(&read::group(&self.database, id)?, &self.surroundings(id)).to_string().into_bytes();
            let tag = format!("\"{}\"", sha256(&body));
            self.made += 1;
            self.known.insert(id, (body, tag));
        }
        Ok(self.known.get(&id))
    }
}

const HTML: &str = "text/html; charset=utf-8";
const JSON: &str = "application/json";
/// The page contains its scripts and style; nothing else may be loaded, and nothing but its own data asked for.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; \
    connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// Answers a question; `address` is where we listen.
///
/// # Errors
///
/// When the database cannot be read.
pub fn answer(site: &mut Site, question: &Question<'_>, address: SocketAddr) -> Result<Answer, DatabaseError> {
    if !["GET", "HEAD"].contains(&question.method) {
        let mut refused = said(405, "this server only shows: use GET");
        refused.headers.push(("Allow", "GET, HEAD".to_owned()));
        return Ok(refused);
    }
    if address.ip().is_loopback() && !question.host.is_some_and(names_this_machine) {
        return Ok(said(403, "this server answers to names of its own machine only: use localhost"));
    }
    let none = said(404, "there is no such page; / has the groups");
    let parts: Vec<&str> = question.path.trim_matches('/').split('/').collect();
    Ok(match parts.as_slice() {
        [""] => {
            let all = groups(&site.database)?;
            match all.as_slice() {
                [only] => page(site, only.id)?.unwrap_or(none),
                _ => ok(HTML, index(&all).into_bytes()),
            }
        }
        ["group", id] => id.parse().map_or(Ok(None), |id| page(site, id))?.unwrap_or(none),
        ["group", id, "data.json"] => match id.parse().map_or(Ok(None), |id| site.data(id))? {
            None => none,
            Some((body, tag)) => {
                let known = question.known == Some(tag.as_str());
                let mut answer = ok(JSON, if known { Vec::new() } else { body.clone() });
                answer.status = if known { 304 } else { 200 };
                answer.headers.push(("ETag", tag.clone()));
                answer
            }
        },
        ["results", hash] => files::list(&site.results, hash).unwrap_or(none),
        ["results", hash, file] => files::file(&site.results, hash, file).unwrap_or(none),
        _ => none,
    })
}

/// The page of a group; none: there is no such group.
fn page(site: &Site, id: i64) -> Result<Option<Answer>, DatabaseError> {
    if group(&site.database, id)?.is_none() {
        return Ok(None);
    }
    let text = html(&read::group(&site.database, id)?, &site.surroundings(id));
    Ok(Some(ok(HTML, text.into_bytes())))
}

fn ok(kind: &str, body: Vec<u8>) -> Answer {
    let headers = vec![
        ("Content-Type", kind.to_owned()),
        ("Content-Security-Policy", POLICY.to_owned()),
        ("X-Content-Type-Options", "nosniff".to_owned()),
        ("Cache-Control", "no-cache".to_owned()),
    ];
    Answer { status: 200, headers, body: Body::Bytes(body) }
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
