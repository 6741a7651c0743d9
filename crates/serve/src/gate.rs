//! Who may connect: pages of this server, and programs that are no pages.
//!
//! A browser lets any page of the world open a WebSocket to an address of this machine. Two headers stop it:
//!
//! * `Origin` names the page's server; it must be the one that `Host` names.
//! * `Host` must be an address in digits, `localhost`, or a name that was allowed: else a page could give its own name
//!   this machine's address (DNS rebinding), and both headers would agree.
//!
//! Neither stops a program on a machine that reaches this address: whoever binds to more than the loopback should know.

use std::net::{IpAddr, Ipv6Addr};

/// Why a request is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// No `Host`.
    #[error("the request has no Host header")]
    NoHost,
    /// A name that is not known here.
    #[error("this server is not known as `{0}`; start it with --allow-host {0} if it should be")]
    Host(String),
    /// A page of another site.
    #[error("pages of `{origin}` may not use the simulation at `{host}`")]
    Origin {
        /// Where the page comes from.
        origin: String,
        /// What it wants.
        host: String,
    },
}

/// Host name without port, brackets and case.
fn name_of(host: &str) -> String {
    let name = match host.strip_prefix('[') {
        Some(rest) => rest.split(']').next().unwrap_or(rest),
        None => host.split(':').next().unwrap_or(host),
    };
    name.to_ascii_lowercase()
}

/// Judges a request by its headers; `allowed` are names beyond the obvious ones.
///
/// # Errors
/// Why it is refused.
pub fn judge(host: Option<&str>, origin: Option<&str>, allowed: &[String]) -> Result<(), Refusal> {
    let host = host.ok_or(Refusal::NoHost)?;
    let name = name_of(host);
    let digits = name.parse::<IpAddr>().is_ok() || name.parse::<Ipv6Addr>().is_ok();
    if !digits && name != "localhost" && !allowed.iter().any(|a| a.eq_ignore_ascii_case(&name)) {
        return Err(Refusal::Host(name));
    }
    // Programs that are no browsers send no Origin.
    let Some(origin) = origin else { return Ok(()) };
    let authority = origin.strip_prefix("http://").or_else(|| origin.strip_prefix("https://"));
    match authority.is_some_and(|a| a.eq_ignore_ascii_case(host)) {
        true => Ok(()),
        false => Err(Refusal::Origin { origin: origin.to_owned(), host: host.to_owned() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pages of this server and programs may enter; pages of others, and this server under a stranger's name, may not.
    #[test]
    fn only_own_pages_enter() {
        let allowed = ["sim.example.org".to_owned()];
        for (host, origin) in [
            ("127.0.0.1:8017", None),
            ("127.0.0.1:8017", Some("http://127.0.0.1:8017")),
            ("localhost:9000", Some("http://LOCALHOST:9000")),
            ("[::1]:8017", Some("http://[::1]:8017")),
            ("192.168.1.7:8017", Some("http://192.168.1.7:8017")),
            ("sim.example.org", Some("https://sim.example.org")),
        ] {
            assert_eq!(judge(Some(host), origin, &allowed), Ok(()), "{host} {origin:?}");
        }
        for (host, origin) in [
            (None, None),
            (Some("127.0.0.1:8017"), Some("http://evil.example")),
            (Some("127.0.0.1:8017"), Some("http://127.0.0.1:8018")),
            (Some("127.0.0.1:8017"), Some("null")),
            (Some("127.0.0.1:8017"), Some("http://127.0.0.1:8017.evil.example")),
            (Some("evil.example:8017"), Some("http://evil.example:8017")),
            (Some("evil.example:8017"), None),
            (Some("127.0.0.1.evil.example"), None),
            (Some(""), None),
        ] {
            assert!(judge(host, origin, &allowed).is_err(), "{host:?} {origin:?}");
        }
    }
}
