//! The keys of a section.

use crate::units::Dimension;

/// A key of a section.
#[derive(Debug, Clone, Copy)]
pub struct Key {
    /// As it is written.
    pub name: &'static str,
    /// What its value is.
    pub kind: Kind,
    /// Which values it may have.
    pub range: Range,
    /// What applies if it is missing.
    pub default: IfMissing,
    /// What it means, for the book.
    pub doc: &'static str,
}

impl Key {
    /// A key whose value may be any of its kind.
    #[must_use]
    pub const fn new(name: &'static str, kind: Kind, default: IfMissing, doc: &'static str) -> Self {
        Self { name, kind, range: Range::Any, default, doc }
    }

    /// The same with a range, which a number, a quantity, a constant and an axis may have.
    ///
    /// # Panics
    ///
    /// Where its kind has none: while the program is compiled, of a key that is a `const`.
    #[must_use]
    pub const fn within(self, range: Range) -> Self {
        let has_range = matches!(
            self.kind,
            Kind::Quantity(_)
                | Kind::Constant(_)
                | Kind::PerConfiguration(_)
                | Kind::Axis(_)
                | Kind::Frequency
                | Kind::Number
                | Kind::By(..)
        );
        assert!(has_range, "a key of this kind has no range");
        Self { range, ..self }
    }
}

/// A key that may be left out; `instead` is what then holds.
#[must_use]
pub const fn optional(name: &'static str, kind: Kind, instead: &'static str, doc: &'static str) -> Key {
    Key::new(name, kind, IfMissing::Nothing(instead), doc)
}

/// A key that must be there; `write` is the advice where it is not.
#[must_use]
pub const fn required(name: &'static str, kind: Kind, write: &'static str, doc: &'static str) -> Key {
    Key::new(name, kind, IfMissing::Required(write), doc)
}

/// A key with a default, as it would be written.
#[must_use]
pub const fn usual(name: &'static str, kind: Kind, value: &'static str, doc: &'static str) -> Key {
    Key::new(name, kind, IfMissing::Is(value), doc)
}

/// What the value of a key is.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    /// A quantity with its unit.
    Quantity(Dimension),
    /// The same, or `{ value, standard }`.
    Constant(Dimension),
    /// A constant, or a table with one for each configuration.
    PerConfiguration(Dimension),
    /// A quantity, a list of them, or `{ start, stop, step }`: one factor of a run matrix.
    Axis(Dimension),
    /// The same of frequencies, stored as angular: Hz is multiplied by 2π, deg/s and rad/s are not.
    Frequency,
    /// A whole number from 1 to this.
    Count(u64),
    /// A whole number, zero or larger.
    Whole,
    /// A plain number, in the unit that its text states.
    Number,
    /// One of these words.
    Word(&'static [&'static str]),
    /// A text.
    Text,
    /// A text or a list of texts; another factor of a run matrix.
    Texts,
    /// True or false.
    Flag,
    /// By the word of an earlier key of the section: a kind for each.
    By(&'static str, &'static [Kind]),
    /// A table of its own.
    Table(&'static [Key]),
    /// A quantity of a dimension that follows from another key. This kind and those below are read by the reader of the section.
    AnyQuantity,
    /// A quantity, or a plain number in SI.
    Coefficient,
    /// A table with these keys, and others of one kind whose names the writer chooses.
    Named(&'static [Key], &'static Kind),
    /// A list; of tables it is written `[[name]]`.
    List(&'static Kind),
    /// One of these.
    Either(&'static [Kind]),
    /// Anything.
    Any,
}

impl Kind {
    /// Whether a value is written without quotes.
    pub(super) const fn is_bare(self) -> bool {
        matches!(self, Self::Count(_) | Self::Whole | Self::Number | Self::Flag | Self::Table(_))
    }
}

/// The names of keys.
#[must_use]
pub fn names(keys: &[Key]) -> Vec<&'static str> {
    keys.iter().map(|key| key.name).collect()
}

/// Allowed values of a quantity; for an axis, of each number. The text gives the reason.
#[derive(Debug, Clone, Copy)]
pub enum Range {
    /// All.
    Any,
    /// Larger than zero.
    Positive,
    /// Zero or larger.
    NotNegative(&'static str),
    /// From one number to another.
    Between(f64, f64),
    /// All but zero.
    NotZero(&'static str),
    /// A part of a whole: between zero and one. The text says which.
    Part(&'static str),
}

/// What applies if a key is missing.
#[derive(Debug, Clone, Copy)]
pub enum IfMissing {
    /// No value. The text names the value or the source that the method uses instead.
    Nothing(&'static str),
    /// The section is rejected with this advice on what to write.
    Required(&'static str),
    /// This value, as it would be written.
    Is(&'static str),
}

/// The key table of the book, in Markdown.
#[must_use]
pub fn key_table(keys: &[Key]) -> String {
    let default = |key: &Key| match (key.default, key.kind) {
        (IfMissing::Required(_), _) => "required".to_owned(),
        (IfMissing::Nothing(words), _) => words.to_owned(),
        (IfMissing::Is(value), Kind::Count(_) | Kind::Whole) => value.to_owned(),
        (IfMissing::Is(value), _) => format!("`{value}`"),
    };
    let row = |key: &Key| format!("| `{}` | {} | {} |\n", key.name, default(key), key.doc);
    format!("| key | default | what |\n| --- | --- | --- |\n{}", keys.iter().map(row).collect::<String>())
}
