//! Claims: of several runs on one database, only one works on a simulation.
//!
//! A claim is a row with the hash of the simulation, who works on it, and when that run was last seen alive. A run
//! renews its claims every few seconds; one that has not been renewed for [`LEASE`] may be taken, and one whose run is
//! known to be gone at once. A simulation is recorded only by who holds its claim, and that ends the claim in the same
//! transaction.

use super::{Database, DatabaseError, recorded};
use crate::owner::Owner;

/// Time after which a claim that was not renewed is void, in s.
pub const LEASE: f64 = 60.0;

/// What became of the wish to work on a simulation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Claim {
    /// It is ours.
    Ours,
    /// Another run works on it.
    Elsewhere,
    /// Another run has recorded it, with this status.
    Recorded(String),
}

/// Claims a simulation.
///
/// `before`: the id of what is recorded of it and is to be replaced.
///
/// # Errors
///
/// When the database cannot be read or written.
pub fn claim(database: &Database, hash: &str, owner: &Owner, before: Option<i64>) -> Result<Claim, DatabaseError> {
    let take = format!(
        "INSERT INTO claims (hash, owner, beat) VALUES ($1, $2, {{now}}) ON CONFLICT (hash) DO UPDATE
         SET owner = excluded.owner, beat = excluded.beat
         WHERE claims.owner = excluded.owner OR claims.beat < excluded.beat - {LEASE}"
    );
    let name = owner.to_string();
    loop {
        if database.execute(&take, &[hash.into(), (&name).into()])? > 0 {
            break;
        }
        let found = database.query("SELECT owner FROM claims WHERE hash = $1", &[hash.into()])?;
        let Some(row) = found.first() else { continue };
        let other: String = row.get(0)?;
        if !other.parse::<Owner>().is_ok_and(|other| other.is_gone()) {
            return Ok(Claim::Elsewhere);
        }
        database.execute("DELETE FROM claims WHERE owner = $1", &[other.into()])?;
    }
    // Since we looked what is to do, another run may have done it; from now on none will.
    match recorded(database, hash)? {
        Some((id, status)) if Some(id) != before => {
            database.execute("DELETE FROM claims WHERE hash = $1 AND owner = $2", &[hash.into(), name.into()])?;
            Ok(Claim::Recorded(status))
        }
        _ => Ok(Claim::Ours),
    }
}

/// Renews all claims of a run.
///
/// # Errors
///
/// When the database cannot be written.
pub fn beat(database: &Database, owner: &Owner) -> Result<(), DatabaseError> {
    let owner = owner.to_string();
    database.execute("UPDATE claims SET beat = {now} WHERE owner = $1", &[owner.into()]).map(|_| ())
}

/// Gives all claims of a run back.
///
/// # Errors
///
/// When the database cannot be written.
pub fn release(database: &Database, owner: &Owner) -> Result<(), DatabaseError> {
    let owner = owner.to_string();
    database.execute("DELETE FROM claims WHERE owner = $1", &[owner.into()]).map(|_| ())
}
