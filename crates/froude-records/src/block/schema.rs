//! What `--json` of an outcome holds, as JSON Schema (draft 2020-12): each key with the type of its values and what people call it.
//!
//! Which keys there are depends on what was asked, so none is required.

use indexmap::IndexMap;
use serde::Serialize;

use super::Cells;
use super::json::{Tree, Value};

/// A schema, or a part of one.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Schema {
    #[serde(rename = "$schema", skip_serializing_if = "Option::is_none")]
    draft: Option<&'static str>,
    #[serde(skip_serializing_if = "String::is_empty")]
    description: String,
    #[serde(rename = "type")]
    types: Vec<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    items: Option<Box<Self>>,
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    properties: IndexMap<String, Self>,
}

impl Schema {
    /// Of a whole document.
    pub(crate) fn of(tree: &Tree<'_>) -> Self {
        Self { draft: Some("https://json-schema.org/draft/2020-12/schema"), ..Self::of_place(tree) }
    }

    fn of_place(tree: &Tree<'_>) -> Self {
        match &tree.value {
            Some(value) => Self::of_value(value),
            None if !tree.items.is_empty() => {
                Self::list(tree.items.iter().map(Self::of_place).fold(Self::default(), Self::or))
            }
            None => {
                let properties = tree.fields.iter().map(|field| (field.name.to_owned(), Self::of_place(field)));
                Self { properties: properties.collect(), ..Self::one(&["object"]) }
            }
        }
    }

    fn of_value(value: &Value<'_>) -> Self {
        match value {
            Value::Rows(tables) => {
                let mut object = Tree::default();
                for table in tables {
                    object.put_row(table, 0);
                }
                Self::list(Self::of_place(&object))
            }
            Value::Cell(column, _) => Self { description: column.head.clone(), ..Self::of_cells(&column.cells) },
            Value::Number(_) => {
                Self { description: "standard uncertainty".to_owned(), ..Self::one(&["number", "null"]) }
            }
            Value::Texts(_) | Value::Figures(..) => Self::list(Self::one(&["string"])),
            Value::Path(_) => Self::one(&["string"]),
            Value::Findings(_) | Value::Estimates(_) => {
                Self { description: "as in estimate.json".to_owned(), ..Self::list(Self::one(&["object"])) }
            }
        }
    }

    fn of_cells(cells: &Cells) -> Self {
        match cells {
            Cells::Number(_) => Self::one(&["number", "null"]),
            Cells::Count(_) => Self::one(&["integer", "null"]),
            Cells::Interval(_) | Cells::Numbers(_) => {
                Self { types: vec!["array", "null"], ..Self::list(Self::one(&["number", "null"])) }
            }
            Cells::Text(_) => Self::one(&["string", "null"]),
            Cells::Texts(_) => Self::list(Self::one(&["string"])),
            Cells::Flag(_) => Self::one(&["boolean", "null"]),
        }
    }

    fn one(types: &[&'static str]) -> Self {
        Self { types: types.to_vec(), ..Self::default() }
    }

    fn list(item: Self) -> Self {
        Self { items: Some(Box::new(item)), ..Self::one(&["array"]) }
    }

    /// Of what fits one of the two.
    #[must_use]
    pub fn or(mut self, other: Self) -> Self {
        for of in other.types {
            if !self.types.contains(&of) {
                self.types.push(of);
            }
        }
        for (key, schema) in other.properties {
            let mine = self.properties.entry(key).or_default();
            *mine = std::mem::take(mine).or(schema);
        }
        self.items = match (self.items, other.items) {
            (Some(a), Some(b)) => Some(Box::new(a.or(*b))),
            (a, b) => a.or(b),
        };
        if self.description.is_empty() {
            self.description = other.description;
        }
        self
    }
}
