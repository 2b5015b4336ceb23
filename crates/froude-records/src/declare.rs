//! The keys of a section of a campaign, declared once. The parser, with positions and spelling suggestions, the book's key table and the
//! JSON Schema for editors come from them.
//!
//! ```
//! use froude_records::declare::{IfMissing, Key, Kind, Range, key_table};
//! use froude_records::units::Dimension;
//!
//! const KEYS: &[Key] = &[Key::new(
//!     "radius",
//!     Kind::Constant(Dimension::LENGTH),
//!     IfMissing::Required("write radius = { value = \"476 mm\", standard = \"1 mm\" }"),
//!     "from the pivot axis to the body's reference point",
//! )
//! .within(Range::NotZero("the body swings about a pivot that lies away from it"))];
//! assert!(key_table(KEYS).ends_with("| `radius` | required | from the pivot axis to the body's reference point |\n"));
//! ```

mod by_configuration;
mod frequency;
mod key;
mod schema;
mod values;

pub use crate::declare::by_configuration::ByConfiguration;
pub use crate::declare::key::{IfMissing, Key, Kind, Range, key_table, names, optional, required, usual};
pub use crate::declare::schema::object_schema;
pub use crate::declare::values::Values;
