//! Dictionaries of OpenFOAM, written as its tutorials have them.

/// A dictionary: keywords with values, in the order in which they are written.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Dictionary {
    entries: Vec<(String, Entry)>,
}

/// What stands behind a keyword.
#[derive(Debug, Clone, PartialEq)]
pub enum Entry {
    /// Up to the semicolon.
    Value(String),
    /// Between braces.
    Dictionary(Dictionary),
}

impl Dictionary {
    /// With one entry more.
    #[must_use]
    pub fn with(mut self, keyword: &str, entry: impl Into<Entry>) -> Self {
        self.entries.push((keyword.to_owned(), entry.into()));
        self
    }

    /// The whole file: header, entries.
    ///
    /// `class` is `dictionary`, `volVectorField`, …; `object` the file's name.
    #[must_use]
    pub fn file(&self, class: &str, object: &str) -> String {
        let header =
            Self::default().with("version", "2.0").with("format", "ascii").with("class", class).with("object", object);
        format!("{}\n{}", Self::default().with("FoamFile", header).text(), self.text())
    }

    /// The entries alone, as they continue a file.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = String::new();
        self.write(0, &mut text);
        text
    }

    fn write(&self, depth: usize, text: &mut String) {
        let indent = "    ".repeat(depth);
        for (keyword, entry) in &self.entries {
            match entry {
                Entry::Value(value) => text.push_str(&format!("{indent}{keyword:<15} {value};\n")),
                Entry::Dictionary(inner) => {
                    text.push_str(&format!("{indent}{keyword}\n{indent}{{\n"));
                    inner.write(depth + 1, text);
                    text.push_str(&format!("{indent}}}\n"));
                }
            }
        }
    }
}

impl From<Dictionary> for Entry {
    fn from(inner: Dictionary) -> Self {
        Self::Dictionary(inner)
    }
}

impl From<&str> for Entry {
    fn from(value: &str) -> Self {
        Self::Value(value.to_owned())
    }
}

impl From<String> for Entry {
    fn from(value: String) -> Self {
        Self::Value(value)
    }
}

impl From<f64> for Entry {
    fn from(value: f64) -> Self {
        Self::Value(format!("{value:e}"))
    }
}

impl From<usize> for Entry {
    fn from(value: usize) -> Self {
        Self::Value(value.to_string())
    }
}

/// Three numbers between parentheses, to the last digit.
#[must_use]
pub fn vector([x, y, z]: [f64; 3]) -> String {
    format!("({x:e} {y:e} {z:e})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dictionary_is_written_as_the_tutorials_have_it() {
        let far = Dictionary::default().with("type", "freestreamVelocity");
        let text = Dictionary::default()
            .with("nu", 1e-6)
            .with("origin", vector([0.5, 0.0, -1.0]))
            .with("boundaryField", Dictionary::default().with("far", far))
            .file("dictionary", "some");
        let expected = "FoamFile\n{\n    version         2.0;\n    format          ascii;\n    class           dictionary;\n    object          some;\n}\n\nnu              1e-6;\norigin          (5e-1 0e0 -1e0);\nboundaryField\n{\n    far\n    {\n        type            freestreamVelocity;\n    }\n}\n";
        assert_eq!(text, expected);
    }
}
