//! Who works: a process that can be told from all others, also from later ones of the same number.
//!
//! Its text, `HOST.PROCESS.START`, names claims in the database and folders of simulations that are not done.

use std::fmt;
use std::str::FromStr;

/// A process.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Owner {
    /// Its machine, or the container in which its number means something.
    pub host: String,
    /// Its number.
    pub process: u32,
    /// When it began, in ticks since the machine did; 0 where the system does not tell.
    pub start: u64,
}

impl Owner {
    /// This process.
    pub fn this() -> Owner {
        let process = std::process::id();
        Owner { host: host(), process, start: start(process).unwrap_or(0) }
    }

    /// Whether the process is known to have ended; false where that cannot be seen from here.
    pub fn is_gone(&self) -> bool {
        let visible = self.start != 0 && self.host == host();
        visible && start(self.process) != Some(self.start)
    }
}

/// Name of the machine, with the number space of processes, which containers on one machine do not share.
fn host() -> String {
    let name = std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let space = std::fs::read_link("/proc/self/ns/pid").map(|link| link.display().to_string()).unwrap_or_default();
    let clean = |text: &str| text.chars().filter(|c| c.is_ascii_alphanumeric() || *c == '-').collect::<String>();
    let (name, space) = (clean(name.trim()), clean(&space));
    if name.is_empty() { "unknown".to_owned() } else { format!("{name}-{space}") }
}

/// When a process began; none when there is no such process, or it has ended and nobody has asked how.
fn start(process: u32) -> Option<u64> {
    let text = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    // The name stands in parentheses and may contain anything; the state follows it, and 19 fields later the start.
    let mut fields = text.rsplit_once(')')?.1.split_whitespace();
    let state = fields.next()?;
    if matches!(state, "Z" | "X") { None } else { fields.nth(18)?.parse().ok() }
}

impl fmt::Display for Owner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}.{}", self.host, self.process, self.start)
    }
}

/// Not the name of a process.
#[derive(Debug, thiserror::Error)]
#[error("expected HOST.PROCESS.START")]
pub struct NoOwner;

impl FromStr for Owner {
    type Err = NoOwner;

    fn from_str(text: &str) -> Result<Owner, NoOwner> {
        let mut parts = text.rsplitn(3, '.');
        let mut next = || parts.next().ok_or(NoOwner);
        let (start, process, host) = (next()?, next()?, next()?);
        let whole = |text: &str| text.parse::<u64>().map_err(|_| NoOwner);
        let process = u32::try_from(whole(process)?).map_err(|_| NoOwner)?;
        Ok(Owner { host: host.to_owned(), process, start: whole(start)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// This process is not gone; one of the same number that began at another time is; of other machines nothing is
    /// known; and the text reads back.
    #[test]
    fn only_what_is_known_to_be_gone_is_gone() {
        let this = Owner::this();
        assert!(!this.is_gone());
        assert_eq!(this.to_string().parse::<Owner>().unwrap(), this);
        if this.start != 0 {
            assert!(Owner { start: this.start + 1, ..this.clone() }.is_gone());
        }
        assert!(!Owner { host: "elsewhere".to_owned(), ..this }.is_gone());
        assert!("x.1".parse::<Owner>().is_err() && "a.b.c".parse::<Owner>().is_err());
    }
}
