//! A cell as people read it.

use super::{Cells, Digits, ResultColumn};
use crate::number::{bytes, count, duration, fixed, interval, p_value, percent, plain, short_form, significant};

impl ResultColumn {
    /// The text of a cell; `None` where it has none.
    #[must_use]
    pub fn text(&self, row: usize) -> Option<String> {
        match &self.cells {
            Cells::Number(all) => {
                let (si, standard) = (*all.get(row)?, self.standard.as_ref().and_then(|(_, all)| all.get(row)));
                match standard {
                    Some(u) if si.is_finite() && *u > 0.0 => Some(short_form(self.shown(si), self.shown(*u))),
                    _ => self.number(si),
                }
            }
            Cells::Count(all) => all.get(row).copied().flatten().map(count),
            Cells::Interval(all) => all.get(row).copied().flatten().map(|ends| interval(ends.map(|si| self.shown(si)))),
            Cells::Numbers(all) => {
                let numbers = all.get(row)?.as_ref()?;
                let texts: Option<Vec<String>> = numbers.iter().map(|si| self.number(*si)).collect();
                texts.map(|texts| texts.join(", "))
            }
            Cells::Text(all) => all.get(row).cloned().flatten(),
            Cells::Texts(all) => all.get(row).filter(|texts| !texts.is_empty()).map(|texts| texts.join(", ")),
            Cells::Flag(all) => all.get(row).copied().flatten().map(|is| if is { "yes" } else { "no" }.to_owned()),
        }
    }

    /// In the unit that people read.
    fn shown(&self, si: f64) -> f64 {
        self.unit.as_ref().map_or(si, |unit| unit.from_si(si))
    }

    fn number(&self, si: f64) -> Option<String> {
        let x = self.shown(si);
        x.is_finite().then(|| match self.digits {
            Digits::Significant(n) => significant(x, n.into()),
            Digits::Plain(n) => plain(x, n.into()),
            Digits::Places(n) => fixed(x, n.into()),
            Digits::Percent => percent(x),
            Digits::PValue => p_value(x),
            Digits::Duration => duration(x),
            Digits::Bytes => bytes(x),
        })
    }
}
