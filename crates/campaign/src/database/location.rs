//! Where a database is: a file, or a server by its URL.

use std::fmt;
use std::path::{Path, PathBuf};

/// Where a database is.
#[derive(Clone, PartialEq, Eq)]
pub enum Location {
    /// An SQLite file.
    File(PathBuf),
    /// A PostgreSQL server: `postgres://USER:PASSWORD@HOST:PORT/DATABASE`.
    Server(String),
}

impl Location {
    /// What `--db` means.
    pub fn parse(text: &str) -> Location {
        match text.starts_with("postgres://") || text.starts_with("postgresql://") {
            true => Location::Server(text.to_owned()),
            false => Location::File(PathBuf::from(text)),
        }
    }

    /// The folder of results: beside `campaign.db` it is `campaign.results`; of a server `DATABASE.results` in the
    /// present folder.
    pub fn results(&self) -> PathBuf {
        match self {
            Location::File(path) => path.with_extension("results"),
            Location::Server(url) => {
                let path = url.split(['?', '#']).next().unwrap_or("").rsplit('/').next().unwrap_or("");
                let name: String = path.chars().filter(|c| c.is_alphanumeric() || "-_".contains(*c)).collect();
                PathBuf::from(format!("{}.results", if name.is_empty() { "campaign" } else { &name }))
            }
        }
    }
}

/// For people: without the password.
impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Location::File(path) => write!(f, "{}", path.display()),
            Location::Server(url) => f.write_str(&without_password(url)),
        }
    }
}

impl fmt::Debug for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

fn without_password(url: &str) -> String {
    let url = match url.split_once("password=") {
        None => url.to_owned(),
        Some((before, after)) => format!("{before}password=…{}", after.find('&').map_or("", |at| &after[at..])),
    };
    let Some((scheme, rest)) = url.split_once("://") else { return url };
    let Some((user, host)) = rest.split_once('@') else { return url };
    format!("{scheme}://{}@{host}", user.split(':').next().unwrap_or(""))
}

/// How to reach a server, with what people expect where the URL says nothing: `PGUSER` or who runs the program, this
/// machine, `PGPASSWORD`, and else the password file (`PGPASSFILE`, or `.pgpass` at home).
///
/// # Errors
///
/// When the URL is none; the message says why.
pub(super) fn server(url: &str) -> Result<postgres::Config, String> {
    let mut config: postgres::Config = url.parse().map_err(|e| format!("not a PostgreSQL URL: {e}"))?;
    let variable = |name: &str| std::env::var(name).ok().filter(|value| !value.is_empty());
    if config.get_user().is_none()
        && let Some(user) = variable("PGUSER").or_else(|| variable("USER"))
    {
        config.user(&user);
    }
    if config.get_hosts().is_empty() && config.get_hostaddrs().is_empty() {
        config.host(&variable("PGHOST").unwrap_or_else(|| "localhost".to_owned()));
    }
    if config.get_password().is_none() {
        let file = || {
            let home = variable("HOME").map(|home| Path::new(&home).join(".pgpass"));
            let text = std::fs::read_to_string(variable("PGPASSFILE").map(PathBuf::from).or(home)?).ok()?;
            let host = match config.get_hosts().first() {
                Some(postgres::config::Host::Tcp(name)) => name.clone(),
                _ => "localhost".to_owned(),
            };
            let port = config.get_ports().first().copied().unwrap_or(5432).to_string();
            let user = config.get_user().unwrap_or("");
            password(&text, [&host, &port, config.get_dbname().unwrap_or(user), user])
        };
        if let Some(password) = variable("PGPASSWORD").or_else(file) {
            config.password(password);
        }
    }
    if config.get_connect_timeout().is_none() {
        config.connect_timeout(std::time::Duration::from_secs(10));
    }
    config.application_name("souple-campaign");
    Ok(config)
}

/// The password of the first line `host:port:database:user:password` that fits; `*` fits everything, and a backslash
/// takes the meaning from what follows it.
fn password(file: &str, wanted: [&str; 4]) -> Option<String> {
    file.lines().filter(|line| !line.starts_with('#')).find_map(|line| {
        let mut fields = vec![String::new()];
        let mut letters = line.chars();
        while let Some(letter) = letters.next() {
            if letter == ':' && fields.len() < 5 {
                fields.push(String::new());
                continue;
            }
            let last = fields.last_mut().expect("there is always a field");
            last.extend(if letter == '\\' { letters.next() } else { Some(letter) });
        }
        let fits = fields.len() == 5 && fields.iter().zip(wanted).all(|(field, w)| field == "*" || field == w);
        fits.then(|| fields.swap_remove(4))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A password is shown nowhere.
    #[test]
    fn passwords_are_not_shown() {
        for url in ["postgres://me:secret@here/db", "postgresql://here/db?user=me&password=secret&x=1"] {
            let location = Location::parse(url);
            assert!(!format!("{location} {location:?}").contains("secret"), "{location}");
            assert!(location.to_string().contains("here"));
        }
        assert_eq!(Location::parse("postgres://a@b/study?x=y").results(), Path::new("study.results"));
        assert_eq!(Location::parse("x/a.db").results(), Path::new("x/a.results"));
    }

    /// The first line of a password file that fits gives the password; escaped colons belong to their field.
    #[test]
    fn password_files_are_read() {
        let file = "# comment\nother:*:*:*:no\nhere:5432:db:me:a\\:b\\\\c\n*:*:*:*:last\n";
        assert_eq!(password(file, ["here", "5432", "db", "me"]).as_deref(), Some("a:b\\c"));
        assert_eq!(password(file, ["there", "1", "db", "me"]).as_deref(), Some("last"));
        assert_eq!(password("a:b\n", ["a", "b", "c", "d"]), None);
    }
}
