//! Numbers attached to the nodes or to the elements of a mesh, to be written beside it.

use super::error::FormatError;
use crate::Mesh;

/// What a field's values are attached to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Location {
    /// One tuple per node.
    Nodes,
    /// One tuple per element: blocks in the order of the mesh, elements in the order of the block.
    ///
    /// When writing, a field may also hold the elements of the highest dimension only (in the same order); the others
    /// then get NaN, or -1 in a field of integers.
    Elements,
}

/// The numbers of a field.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Real numbers.
    F64(Vec<f64>),
    /// Integers.
    I64(Vec<i64>),
}

impl Values {
    /// How many numbers.
    pub fn len(&self) -> usize {
        match self {
            Values::F64(v) => v.len(),
            Values::I64(v) => v.len(),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A named field.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Name shown by the programs that read the file.
    pub name: String,
    /// Numbers per node or element: 1 (scalar), 3 (vector) or 9 (tensor, row by row).
    pub components: usize,
    /// Nodes or elements.
    pub location: Location,
    /// Flat: the components of the first node or element, then those of the next.
    pub values: Values,
}

/// The fields with one tuple for each node and each element, or why one cannot be written.
pub(super) fn fitted(mesh: &Mesh, fields: &[Field], format: &'static str) -> Result<Vec<Field>, FormatError> {
    let elements: usize = mesh.blocks.iter().map(|b| b.len()).sum();
    let mut fitted: Vec<Field> = Vec::with_capacity(fields.len());
    for field in fields {
        let refuse = |why: String| FormatError::NotWritable { what: format!("field \"{}\"", field.name), format, why };
        if !matches!(field.components, 1 | 3 | 9) {
            return Err(refuse(format!("it has {} components; 1, 3 or 9 can be written", field.components)));
        }
        if field.name.is_empty() || field.name.chars().any(char::is_control) {
            return Err(refuse("its name is empty or holds control characters; rename it".to_owned()));
        }
        if fitted.iter().any(|f| f.name == field.name && f.location == field.location) {
            return Err(refuse("another field has the same name; rename one of them".to_owned()));
        }
        let (count, what) = match field.location {
            Location::Nodes => (mesh.nodes.len(), "nodes"),
            Location::Elements => (elements, "elements"),
        };
        let solids = mesh.element_count();
        if field.values.len() == count * field.components {
            fitted.push(field.clone());
        } else if field.location == Location::Elements && field.values.len() == solids * field.components {
            fitted.push(Field { values: spread(mesh, field), ..field.clone() });
        } else {
            return Err(refuse(format!(
                "the mesh has {count} {what}, so {} values are needed, not {}",
                count * field.components,
                field.values.len()
            )));
        }
    }
    Ok(fitted)
}

/// Values of the elements of the highest dimension, spread over all elements.
fn spread(mesh: &Mesh, field: &Field) -> Values {
    fn place<T: Copy>(mesh: &Mesh, components: usize, given: &[T], none: T) -> Vec<T> {
        let dimension = mesh.dimension();
        let mut given = given.iter().copied();
        let mut all = Vec::new();
        for block in &mesh.blocks {
            let count = block.len() * components;
            if block.element.dimension() == dimension {
                all.extend(given.by_ref().take(count));
            } else {
                all.extend(std::iter::repeat_n(none, count));
            }
        }
        all
    }
    match &field.values {
        Values::F64(v) => Values::F64(place(mesh, field.components, v, f64::NAN)),
        Values::I64(v) => Values::I64(place(mesh, field.components, v, -1)),
    }
}
