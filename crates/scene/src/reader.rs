//! Reads the tables of a scene through the schema and gathers everything that is wrong.
//!
//! [`Reader::fields`] checks the keys of a table; one method per [`Kind`] then reads a value, checks its type,
//! dimension and range, and returns `None` after noting what is wrong.
//! So a function that fills a struct reads all its keys first and gives up with `?` last: one pass finds all errors.
//!
//! Asking for a key that the section lacks, or with the method of another kind, is a bug here and panics.

use crate::catalogue::Catalogue;
use crate::choice::{Choice, Named};
use crate::dimension::Dimension;
use crate::error::{Problem, SceneError, Warning};
use crate::location::{Location, Spanned};
use crate::node::{Entry, Node, Value, shortened};
use crate::range::Range;
use crate::schema::{Key, Kind, Presence, Section};
use crate::suggestion::nearest;
use crate::units;

/// What a parse knows and has found out so far.
pub(crate) struct Reader<'c> {
    pub(crate) catalogue: &'c Catalogue,
    pub(crate) errors: Vec<SceneError>,
    pub(crate) warnings: Vec<Warning>,
}

/// The keys of one table.
pub(crate) struct Fields<'n> {
    pub(crate) section: &'static Section,
    pub(crate) at: Location,
    entries: Vec<&'n Entry>,
    /// Keys that the section does not list, where it allows them.
    pub(crate) others: Vec<&'n Entry>,
}

impl<'n> Fields<'n> {
    fn key(&self, name: &str) -> &'static Key {
        self.section.key(name).unwrap_or_else(|| panic!("the schema of {} has no key `{name}`", self.section.header))
    }

    /// The value of a key that was given.
    pub(crate) fn node(&self, name: &str) -> Option<&'n Node> {
        let key = self.key(name);
        self.entries.iter().find(|entry| entry.name == key.name).map(|entry| &entry.node)
    }

    /// Where a key was given.
    pub(crate) fn key_at(&self, name: &str) -> Option<&'n Location> {
        let key = self.key(name);
        self.entries.iter().find(|entry| entry.name == key.name).map(|entry| &entry.at)
    }

    /// Whether a key was given.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.node(name).is_some()
    }

    /// Where a key was given, or else where the table starts.
    pub(crate) fn place(&self, name: &str) -> Location {
        self.key_at(name).unwrap_or(&self.at).clone()
    }
}

impl<'c> Reader<'c> {
    pub(crate) fn new(catalogue: &'c Catalogue) -> Self {
        Reader { catalogue, errors: Vec::new(), warnings: Vec::new() }
    }

    pub(crate) fn error(&mut self, location: Location, problem: Problem) {
        self.errors.push(SceneError { location, problem });
    }

    pub(crate) fn conflict(&mut self, location: Location, message: impl Into<String>) {
        self.error(location, Problem::Conflict(message.into()));
    }

    pub(crate) fn warn(&mut self, location: Location, message: impl Into<String>) {
        self.warnings.push(Warning { location, message: message.into() });
    }

    /// A value of the wrong type.
    pub(crate) fn wrong_type(&mut self, key: &str, expected: impl Into<String>, node: &Node) {
        let problem = Problem::WrongType { key: key.to_owned(), expected: expected.into(), found: node.found() };
        self.error(node.at.clone(), problem);
    }

    /// A name that is none of `known`.
    pub(crate) fn unknown_name(&mut self, what: &str, found: &Spanned<String>, known: Vec<String>) {
        let nearest = nearest(&found.value, known.iter().map(String::as_str)).map(str::to_owned);
        let found_text = shortened(&found.value);
        let problem = Problem::UnknownName { what: what.to_owned(), found: found_text, nearest, known };
        self.error(found.at.clone(), problem);
    }

    /// A key without which the table makes no sense.
    pub(crate) fn missing(&mut self, fields: &Fields<'_>, name: &str) {
        let key = fields.key(name);
        let problem =
            Problem::Missing { section: fields.section.header, key: key.name.to_owned(), about: key.about.to_owned() };
        self.error(fields.at.clone(), problem);
    }

    /// The keys of a table: unknown and missing ones are noted.
    pub(crate) fn fields<'n>(&mut self, name: &str, node: &'n Node, section: &'static Section) -> Option<Fields<'n>> {
        let Value::Table(entries) = &node.value else {
            self.wrong_type(name, format!("a table ({})", section.about), node);
            return None;
        };
        let mut fields = Fields { section, at: node.at.clone(), entries: Vec::new(), others: Vec::new() };
        for entry in entries {
            match section.key(&entry.name) {
                Some(_) => fields.entries.push(entry),
                None if section.other_keys.is_some() => fields.others.push(entry),
                None => self.unknown_key(section, entry),
            }
        }
        for key in section.keys {
            if key.presence == Presence::Required && !fields.has(key.name) {
                self.missing(&fields, key.name);
            }
        }
        Some(fields)
    }

    fn unknown_key(&mut self, section: &'static Section, entry: &Entry) {
        let known: Vec<&'static str> = section.keys.iter().map(|key| key.name).collect();
        let near = nearest(&entry.name, known.iter().copied()).map(str::to_owned);
        let elsewhere = crate::schema::schema().into_iter().find(|s| s.key(&entry.name).is_some()).map(|s| s.header);
        let key = shortened(&entry.name);
        let problem = Problem::UnknownKey { key, section: section.header, nearest: near, elsewhere, known };
        self.error(entry.at.clone(), problem);
    }

    pub(crate) fn text(&mut self, fields: &Fields<'_>, name: &str) -> Option<Spanned<String>> {
        debug_assert!(matches!(fields.key(name).kind, Kind::Text | Kind::Choice(_) | Kind::Element));
        let node = fields.node(name)?;
        self.text_of(name, node)
    }

    pub(crate) fn text_of(&mut self, name: &str, node: &Node) -> Option<Spanned<String>> {
        let Value::Text(text) = &node.value else {
            self.wrong_type(name, "a text in quotes", node);
            return None;
        };
        Some(Spanned::new(text.clone(), node.at.clone()))
    }

    pub(crate) fn boolean(&mut self, fields: &Fields<'_>, name: &str) -> Option<Spanned<bool>> {
        let node = fields.node(name)?;
        let Value::Boolean(value) = node.value else {
            self.wrong_type(name, "true or false", node);
            return None;
        };
        Some(Spanned::new(value, node.at.clone()))
    }

    pub(crate) fn whole(&mut self, fields: &Fields<'_>, name: &str) -> Option<Spanned<u32>> {
        let Kind::Whole(least, most) = fields.key(name).kind else { panic!("`{name}` is not a whole number") };
        let node = fields.node(name)?;
        let value = self.whole_of(name, node, least, most)?;
        Some(Spanned::new(value, node.at.clone()))
    }

    fn whole_of(&mut self, name: &str, node: &Node, least: u32, most: u32) -> Option<u32> {
        let Value::Integer(value) = node.value else {
            self.wrong_type(name, "a whole number", node);
            return None;
        };
        if value >= i64::from(least) && value <= i64::from(most) {
            return Some(value as u32);
        }
        let expected = if most == u32::MAX { format!("at least {least}") } else { format!("from {least} to {most}") };
        let problem = Problem::OutOfRange { key: name.to_owned(), expected, found: value.to_string(), hint: None };
        self.error(node.at.clone(), problem);
        None
    }

    pub(crate) fn whole_vector(&mut self, fields: &Fields<'_>, name: &str) -> Option<Spanned<[u32; 3]>> {
        let Kind::WholeVector(least) = fields.key(name).kind else { panic!("`{name}` is not three whole numbers") };
        let node = fields.node(name)?;
        let Some(items) = three(node) else {
            self.wrong_type(name, "a list of three whole numbers", node);
            return None;
        };
        let values = items.map(|item| self.whole_of(name, item, least, u32::MAX));
        Some(Spanned::new([values[0]?, values[1]?, values[2]?], node.at.clone()))
    }

    pub(crate) fn number(&mut self, fields: &Fields<'_>, name: &str) -> Option<Spanned<f64>> {
        let Kind::Number(dimension, range) = fields.key(name).kind else { panic!("`{name}` is not a number") };
        let node = fields.node(name)?;
        let value = self.number_of(name, node, dimension, range)?;
        Some(Spanned::new(value, node.at.clone()))
    }

    /// A number or a text with a unit, in the unit of the dimension.
    pub(crate) fn number_of(&mut self, name: &str, node: &Node, dimension: Dimension, range: Range) -> Option<f64> {
        let value = match &node.value {
            Value::Integer(value) => *value as f64,
            Value::Float(value) => *value,
            Value::Text(text) => match units::quantity(text, dimension) {
                Ok(value) => value,
                Err(source) => {
                    self.error(node.at.clone(), Problem::Unit { key: name.to_owned(), source });
                    return None;
                }
            },
            _ => {
                self.wrong_type(name, number_in_words(dimension), node);
                return None;
            }
        };
        self.checked(name, value, dimension.unit, range, node)
    }

    /// The value when it is finite and in its range; −0 becomes 0, so that equal scenes have equal text.
    pub(crate) fn checked(&mut self, name: &str, value: f64, unit: &str, range: Range, node: &Node) -> Option<f64> {
        let value = value + 0.0;
        if value.is_finite() && range.contains(value) {
            return Some(value);
        }
        let expected = if value.is_finite() { range.in_words(unit) } else { "a finite number".to_owned() };
        let found = match &node.value {
            Value::Text(text) => format!("\"{}\"", shortened(text)),
            _ => value.to_string(),
        };
        let hint = (name == "poisson" && value >= 0.5 && value.is_finite()).then(|| INCOMPRESSIBLE.to_owned());
        self.error(node.at.clone(), Problem::OutOfRange { key: name.to_owned(), expected, found, hint });
        None
    }

    pub(crate) fn vector(&mut self, fields: &Fields<'_>, name: &str) -> Option<Spanned<[f64; 3]>> {
        let node = fields.node(name)?;
        let value = match fields.key(name).kind {
            Kind::Vector(dimension, range) => self.vector_of(name, node, dimension, range)?,
            Kind::Direction => self.direction_of(name, node)?,
            _ => panic!("`{name}` is not a vector"),
        };
        Some(Spanned::new(value, node.at.clone()))
    }

    pub(crate) fn vector_of(
        &mut self,
        name: &str,
        node: &Node,
        dimension: Dimension,
        range: Range,
    ) -> Option<[f64; 3]> {
        let Some(items) = three(node) else {
            self.wrong_type(name, format!("a list of three numbers ({dimension})"), node);
            return None;
        };
        let values = items.map(|item| self.number_of(name, item, dimension, range));
        Some([values[0]?, values[1]?, values[2]?])
    }

    pub(crate) fn direction_of(&mut self, name: &str, node: &Node) -> Option<[f64; 3]> {
        let value = self.vector_of(name, node, Dimension::NUMBER, Range::ANY)?;
        if value != [0.0; 3] {
            return Some(value);
        }
        let expected = "a direction: three numbers, not all zero".to_owned();
        let problem = Problem::OutOfRange { key: name.to_owned(), expected, found: "[0, 0, 0]".to_owned(), hint: None };
        self.error(node.at.clone(), problem);
        None
    }

    pub(crate) fn choice<T: Named>(&mut self, fields: &Fields<'_>, name: &str) -> Option<Spanned<T>> {
        let node = fields.node(name)?;
        self.choice_of(name, name, node)
    }

    /// `what` is what an unknown word is called.
    fn choice_of<T: Named>(&mut self, name: &str, what: &str, node: &Node) -> Option<Spanned<T>> {
        let Value::Text(text) = &node.value else {
            self.wrong_type(name, format!("one of {}", words(T::CHOICES)), node);
            return None;
        };
        match T::by_name(text) {
            Some(value) => Some(Spanned::new(value, node.at.clone())),
            None => {
                let known = T::CHOICES.iter().map(|choice| choice.name.to_owned()).collect();
                self.unknown_name(what, &Spanned::new(text.clone(), node.at.clone()), known);
                None
            }
        }
    }

    /// A list of different words; for [`Kind::OneOrMore`] also a single word, and then the list is not empty.
    pub(crate) fn choices<T: Named>(&mut self, fields: &Fields<'_>, name: &str) -> Option<Vec<Spanned<T>>> {
        let node = fields.node(name)?;
        let single = matches!(fields.key(name).kind, Kind::OneOrMore(_));
        let items = match &node.value {
            Value::Array(items) if !(single && items.is_empty()) => items,
            Value::Text(_) if single => return Some(vec![self.choice_of(name, name, node)?]),
            _ => {
                let list = if single { "one or a list" } else { "a list" };
                self.wrong_type(name, format!("{list} of {}", words(T::CHOICES)), node);
                return None;
            }
        };
        let mut values: Vec<Spanned<T>> = Vec::new();
        let mut complete = true;
        let what = format!("word in `{name}`:");
        for item in items {
            match self.choice_of::<T>(name, &what, item) {
                None => complete = false,
                Some(value) if values.contains(&value) => {
                    self.conflict(item.at.clone(), format!("`{name}` names \"{}\" twice", value.name()));
                    complete = false;
                }
                Some(value) => values.push(value),
            }
        }
        complete.then_some(values)
    }

    /// Axes as flags, all of them by default.
    pub(crate) fn axes(&mut self, fields: &Fields<'_>, name: &str) -> Option<[bool; 3]> {
        if !fields.has(name) {
            return Some([true; 3]);
        }
        let mut flags = [false; 3];
        for axis in self.choices::<crate::choice::Axis>(fields, name)? {
            flags[axis.index()] = true;
        }
        Some(flags)
    }

    /// The id of an element of the registry.
    pub(crate) fn element(&mut self, fields: &Fields<'_>, name: &str) -> Option<Spanned<String>> {
        let id = self.text(fields, name)?;
        self.known_element(id)
    }

    pub(crate) fn known_element(&mut self, id: Spanned<String>) -> Option<Spanned<String>> {
        if souple_elements::by_id(&id).is_some() {
            return Some(id);
        }
        let known = souple_elements::all().iter().map(|element| element.id.to_owned()).collect();
        self.unknown_name("element", &id, known);
        None
    }

    /// A table inside this one.
    pub(crate) fn table<'n>(&mut self, fields: &Fields<'n>, name: &str) -> Option<Fields<'n>> {
        let Kind::Table(section) = fields.key(name).kind else { panic!("`{name}` is not a table") };
        self.fields(name, fields.node(name)?, section)
    }

    /// The tables of a list; an empty list when the key is absent.
    pub(crate) fn tables<'n>(&mut self, fields: &Fields<'n>, name: &str) -> Vec<Fields<'n>> {
        let Kind::Tables(section) = fields.key(name).kind else { panic!("`{name}` is not a list of tables") };
        match fields.node(name) {
            None => Vec::new(),
            Some(Node { value: Value::Array(items), .. }) => {
                items.iter().filter_map(|item| self.fields(name, item, section)).collect()
            }
            Some(node) => {
                self.wrong_type(name, format!("a list of tables, each starting with {}", section.header), node);
                Vec::new()
            }
        }
    }
}

const INCOMPRESSIBLE: &str = "0.5 means incompressible, which makes λ = E ν / ((1 + ν)(1 − 2ν)) infinite; use at most \
    0.499, or give `bulk` and `mu` with a large but finite `bulk`";

/// The items of a list of three.
fn three(node: &Node) -> Option<[&Node; 3]> {
    match &node.value {
        Value::Array(items) => match items.as_slice() {
            [x, y, z] => Some([x, y, z]),
            _ => None,
        },
        _ => None,
    }
}

fn number_in_words(dimension: Dimension) -> String {
    if dimension.unit.is_empty() {
        "a number".to_owned()
    } else {
        format!("a number in {} or a text such as \"{}\"", dimension.unit, dimension.example)
    }
}

fn words(choices: &[Choice]) -> String {
    choices.iter().map(|choice| format!("\"{}\"", choice.name)).collect::<Vec<_>>().join(", ")
}
