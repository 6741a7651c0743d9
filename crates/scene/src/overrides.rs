//! `--set key=value`: changes of single values of a scene from the command line.
//!
//! The key is a dotted path: `time.end`, `body.0.density` (entry 0 of a list), `body.bar.density` (the entry named
//! `bar`), `material.0.young` (short for the first body's), `body."left bar".density` (quoted where a name has dots or
//! spaces).
//! The value is TOML; a value that is not valid TOML and does not start like a quoted text, list or table is taken as a
//! text, so that `integrator.method=rk4` and `material.0.young=4 kPa` need no quotes inside the shell's quotes.

use crate::location::Location;
use crate::node::{Entry, Node, Value, shortened, value_of_override};
use crate::suggestion::nearest;

/// No path of a scene is this deep; a longer one is a mistake, and must not nest tables without end.
const SEGMENTS_AT_MOST: usize = 16;

/// Applies one override to the tree, placing its value at `at`; what is wrong comes back in words.
pub(crate) fn apply(root: &mut Node, text: &str, at: &Location) -> Result<(), String> {
    let (mut path, value) = path_and_value(text)?;
    // `material.0.young` is short for `body.0.material.0.young`.
    let first = path[0].as_str();
    if crate::scene::SCENE.key(first).is_none() && crate::body::BODY.key(first).is_some() {
        path.splice(0..0, ["body".to_owned(), "0".to_owned()]);
    }
    if path.len() > SEGMENTS_AT_MOST {
        return Err(format!("the key has {} parts; no key of a scene has more than {SEGMENTS_AT_MOST}", path.len()));
    }
    let node = value_node(value, at)?;
    let (last, parents) = path.split_last().expect("path_and_value gives at least one part");
    let mut target = root;
    for (depth, segment) in parents.iter().enumerate() {
        let into_list = path[depth + 1].parse::<usize>().is_ok();
        target = child(target, segment, &path[..depth], into_list, at)?;
    }
    put(target, last, parents, node, at)
}

/// The part of `node` that `segment` names; a missing table is made.
fn child<'n>(
    node: &'n mut Node,
    segment: &str,
    before: &[String],
    into_list: bool,
    at: &Location,
) -> Result<&'n mut Node, String> {
    let index = match &node.value {
        Value::Table(entries) => entries.iter().position(|entry| entry.name == segment),
        Value::Array(items) => Some(entry_index(items, segment, before)?),
        _ => return Err(no_parts(node, before, segment)),
    };
    match (&mut node.value, index) {
        (Value::Array(items), Some(index)) => Ok(&mut items[index]),
        (Value::Table(entries), Some(index)) => Ok(&mut entries[index].node),
        (Value::Table(_), None) if into_list => Err(format!("the scene has no list `{}`", joined(before, segment))),
        (Value::Table(entries), None) => {
            let node = Node { value: Value::Table(Vec::new()), at: at.clone() };
            let made = entries.len();
            entries.push(Entry { name: segment.to_owned(), at: at.clone(), node });
            Ok(&mut entries[made].node)
        }
        _ => unreachable!("the first match leaves lists with an index, and tables"),
    }
}

/// Sets or replaces the part of `node` that `segment` names.
fn put(node: &mut Node, segment: &str, before: &[String], value: Node, at: &Location) -> Result<(), String> {
    if !matches!(node.value, Value::Table(_) | Value::Array(_)) {
        return Err(no_parts(node, before, segment));
    }
    match &mut node.value {
        Value::Table(entries) => {
            match entries.iter_mut().find(|entry| entry.name == segment) {
                Some(entry) => entry.node = value,
                None => entries.push(Entry { name: segment.to_owned(), at: at.clone(), node: value }),
            }
            Ok(())
        }
        Value::Array(items) => {
            let index = entry_index(items, segment, before)?;
            items[index] = value;
            Ok(())
        }
        _ => unreachable!("checked above"),
    }
}

fn no_parts(node: &Node, before: &[String], segment: &str) -> String {
    format!("`{}` is {}; it has no `{}`", before.join("."), node.found(), shortened(segment))
}

fn joined(before: &[String], segment: &str) -> String {
    before.iter().map(String::as_str).chain([segment]).collect::<Vec<_>>().join(".")
}

/// The entry of a list by number or by the value of its `name`.
fn entry_index(items: &[Node], segment: &str, before: &[String]) -> Result<usize, String> {
    let path = before.join(".");
    if let Ok(index) = segment.parse::<usize>() {
        return match items.len() {
            _ if index < items.len() => Ok(index),
            0 => Err(format!("the list `{path}` is empty")),
            1 => Err(format!("`{path}` has only one entry, 0")),
            count => Err(format!("`{path}` has the entries 0 to {}, not {index}", count - 1)),
        };
    }
    let names: Vec<Option<&str>> = items.iter().map(name_of).collect();
    if let Some(index) = names.iter().position(|name| *name == Some(segment)) {
        return Ok(index);
    }
    let known: Vec<&str> = names.into_iter().flatten().collect();
    let segment = shortened(segment);
    if known.is_empty() {
        return Err(format!(
            "`{path}` is a list without names: write the number of the entry, as in `{path}.0`, not `{segment}`"
        ));
    }
    let hint = crate::error::did_you_mean(nearest(&segment, known.iter().copied()));
    Err(format!("`{path}` has no entry named `{segment}`{hint}; its entries: {}", known.join(", ")))
}

fn name_of(item: &Node) -> Option<&str> {
    let Value::Table(entries) = &item.value else { return None };
    entries.iter().find(|entry| entry.name == "name").and_then(|entry| match &entry.node.value {
        Value::Text(name) => Some(name.as_str()),
        _ => None,
    })
}

/// Splits `a."b.c".d=value` into its parts; quotes protect dots and the equals sign.
fn path_and_value(text: &str) -> Result<(Vec<String>, &str), String> {
    let mut path = vec![String::new()];
    let mut quote = None;
    for (offset, c) in text.char_indices() {
        match (quote, c) {
            (Some(open), _) if c == open => quote = None,
            (None, '"' | '\'') => quote = Some(c),
            (None, '.') => path.push(String::new()),
            (None, '=') => {
                let path: Vec<String> = path.iter().map(|part| part.trim().to_owned()).collect();
                if path.iter().any(String::is_empty) {
                    return Err("a part of the key is empty; write `key=value` as in `time.end=0.5`".to_owned());
                }
                return Ok((path, text[offset + 1..].trim()));
            }
            _ => path.last_mut().expect("it starts with one part").push(c),
        }
    }
    Err("there is no `=`; write `key=value` as in `time.end=0.5`".to_owned())
}

fn value_node(text: &str, at: &Location) -> Result<Node, String> {
    if text.is_empty() {
        return Err("there is no value after `=`; write `key=value` as in `time.end=0.5`".to_owned());
    }
    match value_of_override(text, at) {
        Some(node) => Ok(node),
        None if text.starts_with(['"', '\'', '[', '{']) => {
            Err(format!("the value `{}` is not valid TOML; texts inside lists and tables need quotes", shortened(text)))
        }
        None => Ok(Node { value: Value::Text(text.to_owned()), at: at.clone() }),
    }
}
