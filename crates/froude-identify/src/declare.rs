//! The keys of a method's section of a campaign, declared once. Both the parser, with positions and spelling suggestions, and the book's key
//! table come from them.
//!
//! ```
//! use froude_identify::declare::{IfMissing, Key, Kind, Range, key_table};
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
mod values;

pub use crate::declare::by_configuration::ByConfiguration;
pub use crate::declare::key::{IfMissing, Key, Kind, Range, key_table};
pub use crate::declare::values::Values;
