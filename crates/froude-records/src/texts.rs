//! A column of texts, in which most rows repeat one of few.

use std::iter::{Map, Repeat, Zip, repeat};
use std::ops::Index;
use std::slice::Iter;
use std::sync::Arc;

use indexmap::IndexSet;

/// The texts of rows: each once, and its number in every row, which takes four bytes. Copies share the texts.
#[derive(Debug, Clone, Default)]
pub struct Texts {
    distinct: Arc<IndexSet<String>>,
    of_row: Vec<u32>,
}

impl Texts {
    /// Rows that all have one text.
    #[must_use]
    pub fn repeated(text: &str, rows: usize) -> Self {
        Self { distinct: Arc::new(IndexSet::from([text.to_owned()])), of_row: vec![0; rows] }
    }

    /// How many rows there are.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.of_row.len()
    }

    /// Whether there are none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.of_row.is_empty()
    }

    /// The text of a row.
    #[must_use]
    pub fn get(&self, row: usize) -> Option<&String> {
        self.of_row.get(row).and_then(|number| self.distinct.get_index(*number as usize))
    }

    /// The texts of the rows, in their order.
    #[must_use]
    pub fn iter(&self) -> <&Self as IntoIterator>::IntoIter {
        self.into_iter()
    }

    /// Puts a row behind the others.
    pub fn push(&mut self, text: String) {
        let last = self.of_row.last().map(|number| *number as usize);
        let number = match last.filter(|number| self.distinct[*number] == text) {
            Some(number) => number,
            None => Arc::make_mut(&mut self.distinct).insert_full(text).0,
        };
        // A table of 2³² rows does not fit into memory.
        self.of_row.push(u32::try_from(number).unwrap_or(u32::MAX));
    }

    /// The rows named by `keep`, in that order.
    #[must_use]
    pub fn subset(&self, keep: &[usize]) -> Self {
        let of_row = keep.iter().filter_map(|&row| self.of_row.get(row).copied()).collect();
        Self { distinct: Arc::clone(&self.distinct), of_row }
    }
}

impl Index<usize> for Texts {
    type Output = String;

    fn index(&self, row: usize) -> &String {
        &self.distinct[self.of_row[row] as usize]
    }
}

impl<'a> IntoIterator for &'a Texts {
    type Item = &'a String;
    type IntoIter =
        Map<Zip<Iter<'a, u32>, Repeat<&'a IndexSet<String>>>, fn((&'a u32, &'a IndexSet<String>)) -> &'a String>;

    fn into_iter(self) -> Self::IntoIter {
        self.of_row.iter().zip(repeat(&*self.distinct)).map(|(number, texts)| &texts[*number as usize])
    }
}

impl FromIterator<String> for Texts {
    fn from_iter<I: IntoIterator<Item = String>>(texts: I) -> Self {
        let mut out = Self::default();
        texts.into_iter().for_each(|text| out.push(text));
        out
    }
}

impl From<Vec<String>> for Texts {
    fn from(texts: Vec<String>) -> Self {
        texts.into_iter().collect()
    }
}

impl<const N: usize> PartialEq<[&str; N]> for &Texts {
    fn eq(&self, other: &[&str; N]) -> bool {
        self.iter().eq(other)
    }
}

impl PartialEq for Texts {
    fn eq(&self, other: &Self) -> bool {
        self.len() == other.len() && self.iter().eq(other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_those_that_were_put_in() {
        let rows = ["a", "b", "a", "", "b"].map(str::to_owned);
        let texts: Texts = rows.to_vec().into();
        assert!(texts.iter().eq(&rows) && texts.len() == 5 && texts.distinct.len() == 3);
        assert_eq!((texts.get(3), texts.get(5), &texts[4]), (Some(&String::new()), None, &"b".to_owned()));
        let mut some = texts.subset(&[4, 1, 9]);
        assert_eq!(some, Texts::from(vec!["b".to_owned(); 2]));
        for text in ["c", "b"] {
            some.push(text.to_owned());
        }
        assert!(some != texts && some.iter().eq(["b", "b", "c", "b"]) && texts.iter().eq(&rows));
        assert_eq!(Texts::repeated("b", 2), texts.subset(&[1, 4]));
    }
}
