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
                    Some(u) if si.is_finite() && *u > 0.0 => {
                        // A difference: the zero of its unit does not enter.
                        let factor = self.unit.as_ref().map_or(1.0, |unit| unit.factor);
                        Some(short_form(self.shown(si), u / factor))
                    }
                    _ => self.number(si),
                }
            }
            Cells::Count(all) => all.get(row).copied().flatten().map(count),
            Cells::Interval(all) => {
                let [low, high] = all.get(row).copied().flatten()?.map(|si| self.shown(si));
                Some(match self.digits {
                    Digits::Range => format!("{} to {}", significant(low, 3), significant(high, 3)),
                    _ => interval([low, high]),
                })
            }
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
            Digits::Range => significant(x, 3),
            Digits::Plain(n) => plain(x, n.into()),
            Digits::Places(n) => fixed(x, n.into()),
            Digits::Percent => percent(x),
            Digits::PValue => p_value(x),
            Digits::Duration => duration(x),
            Digits::Bytes => bytes(x),
            Digits::Normalised => fixed(x, 2),
            Digits::Symbol => plain(x, 5),
        })
    }
}
