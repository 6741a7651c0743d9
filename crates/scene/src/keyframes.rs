//! Values at given times: moved regions and loads that change.
//!
//! Between two keys the value is linear in time; before the first and after the last it is held.

use serde::Serialize;

use crate::dimension::Dimension;
use crate::error::Problem;
use crate::node::{Node, Value};
use crate::range::Range;
use crate::reader::{Fields, Reader};
use crate::schema::Kind;

/// A value and its time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Keyframe<T> {
    /// Time (s).
    pub time: f64,
    /// Value; its unit is that of the list.
    pub value: T,
}

/// The scalar at a time: `v = v₀ + (v₁ − v₀) (t − t₀) / (t₁ − t₀)`; 0 without keys.
///
/// Times must increase, as they do in every parsed scene.
pub fn scalar_at(keys: &[Keyframe<f64>], time: f64) -> f64 {
    let (before, after, weight) = match bracket(keys, time) {
        None => return 0.0,
        Some(found) => found,
    };
    before + (after - before) * weight
}

/// The vector at a time, as [`scalar_at`].
pub fn vector_at(keys: &[Keyframe<[f64; 3]>], time: f64) -> [f64; 3] {
    let (before, after, weight) = match bracket(keys, time) {
        None => return [0.0; 3],
        Some(found) => found,
    };
    std::array::from_fn(|axis| before[axis] + (after[axis] - before[axis]) * weight)
}

/// The values of the keys around a time and the weight of the second.
fn bracket<T: Copy>(keys: &[Keyframe<T>], time: f64) -> Option<(T, T, f64)> {
    let first = keys.first()?;
    let next = keys.partition_point(|key| key.time <= time);
    if next == 0 {
        return Some((first.value, first.value, 0.0));
    }
    let before = &keys[next - 1];
    Some(match keys.get(next) {
        None => (before.value, before.value, 0.0),
        Some(after) => (before.value, after.value, (time - before.time) / (after.time - before.time)),
    })
}

impl Reader<'_> {
    /// `[[time, value], …]`.
    pub(crate) fn curve(&mut self, fields: &Fields<'_>, name: &str) -> Option<Vec<Keyframe<f64>>> {
        let Some(Kind::Curve(dimension)) = fields.section.key(name).map(|key| key.kind) else {
            panic!("`{name}` is not a curve")
        };
        self.keys(name, fields.node(name)?, |reader, node| reader.number_of(name, node, dimension, Range::ANY))
    }

    /// `[[time, [x, y, z]], …]`.
    pub(crate) fn vector_curve(&mut self, fields: &Fields<'_>, name: &str) -> Option<Vec<Keyframe<[f64; 3]>>> {
        let Some(Kind::VectorCurve(dimension)) = fields.section.key(name).map(|key| key.kind) else {
            panic!("`{name}` is not a curve of vectors")
        };
        self.keys(name, fields.node(name)?, |reader, node| reader.vector_of(name, node, dimension, Range::ANY))
    }

    fn keys<T>(
        &mut self,
        name: &str,
        node: &Node,
        mut read: impl FnMut(&mut Self, &Node) -> Option<T>,
    ) -> Option<Vec<Keyframe<T>>> {
        let items = match &node.value {
            Value::Array(items) if !items.is_empty() => items,
            _ => {
                self.wrong_type(name, "a list of pairs [[time, value], …] with at least one pair", node);
                return None;
            }
        };
        let mut keys: Vec<Keyframe<T>> = Vec::with_capacity(items.len());
        let mut complete = true;
        for item in items {
            let pair = match &item.value {
                Value::Array(pair) if pair.len() == 2 => pair,
                _ => {
                    self.wrong_type(name, "a list of pairs [time, value]", item);
                    complete = false;
                    continue;
                }
            };
            let time = self.number_of(name, &pair[0], Dimension::TIME, Range::NOT_NEGATIVE);
            let (Some(time), Some(value)) = (time, read(self, &pair[1])) else {
                complete = false;
                continue;
            };
            if let Some(last) = keys.last().filter(|last| time <= last.time) {
                let problem = Problem::OutOfRange {
                    key: name.to_owned(),
                    expected: format!("a list whose times increase: after {} s comes a later one", last.time),
                    found: format!("{time} s"),
                    hint: None,
                };
                self.error(pair[0].at.clone(), problem);
                complete = false;
                continue;
            }
            keys.push(Keyframe { time, value });
        }
        complete.then_some(keys)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_linear_between_keys_and_held_outside() {
        let keys = [Keyframe { time: 1.0, value: 10.0 }, Keyframe { time: 3.0, value: 30.0 }];
        for (time, value) in [(0.0, 10.0), (1.0, 10.0), (1.5, 15.0), (3.0, 30.0), (9.0, 30.0)] {
            assert_eq!(scalar_at(&keys, time), value, "at {time}");
        }
        assert_eq!(scalar_at(&[], 1.0), 0.0);
        let keys = [Keyframe { time: 0.0, value: [0.0; 3] }, Keyframe { time: 2.0, value: [2.0, -4.0, 0.0] }];
        assert_eq!(vector_at(&keys, 1.0), [1.0, -2.0, 0.0]);
    }
}
