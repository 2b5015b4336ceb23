//! The head of a column as people write it: `speed [m/s]`, `U (m/s)`, `U / m/s`, `U in m/s`, `U, m/s`, or a name over a unit.

use froude_foreign::layout::{Head, bare};

use crate::foreign_names::{meant, meant_without_unit, of_sname};
use crate::known_columns::{is_text_column, known_dimension};
use crate::label_rows::odd;
use crate::units::{Dimension, Unit, parse_unit};

/// Most letters of a symbol.
const MOST_OF_SYMBOL: usize = 3;

/// What stands above a column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Heading {
    /// As it stands there.
    pub written: String,
    /// A longer name above it.
    pub above: String,
    /// Without its unit.
    pub name: String,
    /// The unit as written.
    pub unit: Option<String>,
    /// Whether it is not in Froude's own form, `name [unit]` or `name`.
    pub is_foreign: bool,
}

impl Heading {
    /// The same in Froude's own form.
    pub fn header(&self) -> String {
        self.unit.as_ref().map_or_else(|| self.name.clone(), |unit| format!("{} [{unit}]", self.name))
    }

    /// What it measures, where its unit says so.
    pub fn dimension(&self) -> Option<Dimension> {
        parse_unit(self.unit.as_deref()?).ok().map(|unit| unit.dimension)
    }

    /// What Froude calls it, as far as its name or the longer one above it tells.
    pub fn meant(&self) -> Option<crate::foreign_names::Meant> {
        let dimension = self.dimension();
        let own = meant(&self.name, dimension);
        let above = if self.above == self.name { None } else { meant(&self.above, dimension) };
        let letters = self.name.chars().count();
        match (own, above) {
            // `R` below `Rudder force` is no resistance, `U` below `Mean speed` a speed, and `Fx` below anything a force.
            (Some(own), None) => {
                let is_open = letters == 1 && self.above != self.name && self.above.chars().count() > MOST_OF_SYMBOL;
                let mut words = self.above.split_whitespace();
                let agrees = words.any(|word| meant(word, dimension) == Some(own));
                (!is_open || agrees || meant_without_unit(&self.above).is_some()).then_some(own)
            }
            // `F` below `drag` is one, and `std` is not.
            (None, Some(above)) => (letters <= MOST_OF_SYMBOL && odd(&self.name).is_none()).then_some(above),
            (own, _) => own,
        }
    }

    /// A name with the unit that its file states; empty where it states none, so that the name may hold it.
    pub fn stated(name: &str, unit: &str) -> Self {
        let unit = bare(unit);
        if unit.is_empty() {
            return Self::own(name);
        }
        let (name, unit) = (name.to_owned(), Some(unit.to_owned()));
        Self { written: name.clone(), above: String::new(), name, unit, is_foreign: true }
    }

    /// A header in Froude's own form.
    pub fn own(written: &str) -> Self {
        let (name, unit) = split_header(written).unwrap_or((written, None));
        Self {
            written: written.to_owned(),
            above: String::new(),
            name: name.to_owned(),
            unit: unit.map(str::to_owned),
            is_foreign: false,
        }
    }
}

/// `name [unit]` as name and unit.
pub(crate) fn split_header(header: &str) -> Result<(&str, Option<&str>), &'static str> {
    let header = header.trim();
    let Some((name, rest)) = header.split_once('[') else {
        return match header {
            "" => Err("the name is empty; write `name [unit]`"),
            _ if header.contains(']') => Err("a bracket is not opened; write `name [unit]`"),
            _ => Ok((header, None)),
        };
    };
    let name = name.trim();
    let unit = rest.strip_suffix(']').ok_or("the unit must end with `]`; write `name [unit]`")?;
    if unit.contains(['[', ']']) {
        return Err("there is more than one pair of brackets; write `name [unit]`");
    }
    if name.is_empty() {
        return Err("the name is empty; write `name [unit]`");
    }
    Ok((name, Some(unit)))
}

/// Marks between a name and its unit that may also mean something else: `x / L`.
const BETWEEN: [&str; 3] = [" / ", " in ", ", "];

/// Whether what stands behind a unit names a channel, a run or an end of a line, and nothing that may change the numbers: `- AI 1`, `Run 3`.
fn is_place(rest: &str) -> bool {
    let rest = rest.trim_start_matches("- ");
    let word = rest.trim_end_matches(|c: char| c.is_ascii_digit() || matches!(c, ' ' | '_' | '#'));
    let is_numbered = word.len() < rest.len();
    (is_numbered && ["AI", "Ch", "CH", "ch", "Channel", "Run", "Sensor"].contains(&word))
        || ["at End A", "at End B"].contains(&rest)
}

/// Name and unit of a header in round parentheses, or with a mark between them; the mark is empty for parentheses.
fn split(written: &str) -> Option<(&str, &str, &'static str)> {
    let is_unit = |unit: &str| unit.parse::<f64>().is_err() && parse_unit(unit).is_ok();
    if let Some(inner) = written.strip_suffix(')') {
        let parts = inner.match_indices('(').map(|(at, _)| (&inner[..at], inner[at + 1..].trim()));
        // `F(t)` is a force over time, and no tonnes.
        let is_time = |name: &str| meant(name, Some(Dimension::TIME)).is_some();
        let is_argument =
            |name: &str, unit: &str| !name.ends_with(' ') && !is_time(name) && matches!(unit, "t" | "s" | "h");
        let found =
            parts.into_iter().find(|(name, unit)| !name.trim().is_empty() && is_unit(unit) && !is_argument(name, unit));
        return found.map(|(name, unit)| (name.trim().trim_end_matches(['/', ',']).trim_end(), unit, ""));
    }
    // Where and by what it was measured stands behind the unit: `Fx (kN) - AI 1`, `tension (kN) at End A`.
    if let Some((before, rest)) = written.split_once(") ")
        && let Some((name, unit)) = before.rsplit_once('(')
        && is_place(rest)
        && !name.trim().is_empty()
        && is_unit(unit.trim())
    {
        return Some((name.trim(), unit.trim(), ""));
    }
    BETWEEN.iter().find_map(|mark| {
        let (name, unit) = written.split_once(mark)?;
        let unit = bare(unit);
        (!name.trim().is_empty() && is_unit(unit)).then_some((name.trim(), unit, *mark))
    })
}

/// The unit of a head, or the one that stands alone below it: `drag [N]`, `drag (N)`, `[N]`, `N`.
pub(crate) fn unit_in(head: &str) -> Option<Unit> {
    let own = split_header(head).ok().and_then(|(_, unit)| unit);
    let unit = own.or_else(|| split(head).map(|(_, unit, _)| unit)).unwrap_or(bare(head));
    parse_unit(unit).ok()
}

/// The headings of a table: each head with its unit, from its own text or from the row of units.
///
/// # Errors
///
/// A head and a row of units that contradict each other, in words.
pub(crate) fn headings(heads: &[Head], is_number: &[bool]) -> Result<Vec<Heading>, String> {
    let parts: Vec<_> = heads.iter().map(|head| split(&head.name)).collect();
    let of_mark = |mark: &str| parts.iter().flatten().filter(|(.., own)| *own == mark).count();
    let one = |(at, head): (usize, &Head)| {
        // `x / L` alone is a ratio; where others are written so, or the quantity is known, it is a unit.
        let found = parts[at].filter(|(name, unit, mark)| {
            mark.is_empty()
                || of_mark(mark) > 1
                || parse_unit(unit).is_ok_and(|unit| meant(name, Some(unit.dimension)).is_some())
        });
        let own = Heading::own(&head.name);
        let own_name = own.name.trim_end_matches([',', '/']).trim_end();
        let (name, stated) = match found {
            Some((name, unit, _)) if own.unit.is_none() => (name.to_owned(), Some(unit.to_owned())),
            _ => (if own.unit.is_some() { own_name.to_owned() } else { own.name }, own.unit),
        };
        let is_number = is_number.get(at).copied().unwrap_or(false);
        let below = head.unit.as_deref().filter(|_| is_number).and_then(|unit| match unit {
            // `TS` and `RN` of Campbell's loggers: a stamp, the number of a record.
            "" | "TS" | "RN" => None,
            "-" | "--" | "–" if is_text_column(&name) => None,
            "-" | "--" | "–" => Some("1"),
            unit => Some(unit),
        });
        match (&stated, below) {
            (Some(stated), Some(below)) if stated != below && below != "1" => Err(format!(
                "column `{}` has the unit {stated}, and {below} in the line of the units; correct one of them",
                head.name
            )),
            _ => Ok(Heading {
                written: head.name.clone(),
                above: head.above.clone(),
                is_foreign: found.is_some() || head.unit.is_some(),
                name,
                unit: stated.or_else(|| below.map(str::to_owned)),
            }),
        }
    };
    heads.iter().enumerate().map(one).collect()
}

/// Gives the letters of SNAME the names of Froude; what was renamed, as `u` → `v_x`.
pub(crate) fn rename_sname(headings: &mut [Heading]) -> Vec<(String, &'static str)> {
    let columns: Vec<(&str, Option<Dimension>)> =
        headings.iter().map(|heading| (heading.name.as_str(), heading.dimension())).collect();
    let found = of_sname(&columns);
    let mut renamed = Vec::new();
    for (at, name) in found {
        if let Some(heading) = headings.get_mut(at) {
            renamed.push((std::mem::replace(&mut heading.name, name.to_owned()), name));
        }
    }
    renamed
}

/// Columns that are known by another name than Froude's, and would be passed over.
pub(crate) fn passed_over(headings: &[Heading]) -> impl Iterator<Item = (usize, &'static str)> + '_ {
    let has = |name: &str| headings.iter().any(|heading| heading.name == name);
    headings.iter().enumerate().filter_map(move |(at, heading)| {
        let meant = heading.meant()?;
        let is_missed = heading.is_foreign
            && heading.unit.is_some()
            && meant.name != heading.name
            && known_dimension(meant.name).is_some()
            && !has(meant.name);
        is_missed.then_some((at, meant.name))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(names: &[&str]) -> Vec<String> {
        let heads: Vec<Head> = names.iter().map(|name| Head { name: (*name).to_owned(), ..Head::default() }).collect();
        headings(&heads, &vec![true; names.len()]).unwrap().iter().map(Heading::header).collect()
    }

    #[test]
    fn units_are_read_where_people_write_them() {
        assert_eq!(of(&["U (m/s)"]), ["U [m/s]"]);
        assert_eq!(
            of(&["Carriage speed(mm/s)", "drag (tare)", "run (1)"]),
            ["Carriage speed [mm/s]", "drag (tare)", "run (1)"]
        );
        assert_eq!(of(&["strain (N) (N)", "mu (kg/(m s))"]), ["strain (N) [N]", "mu [kg/(m s)]"]);
        assert_eq!(of(&["Fx (kN) - AI 1", "mass (kg) ratio"]), ["Fx [kN]", "mass (kg) ratio"]);
        assert_eq!(of(&["f_x (N) - std", "f_x (N) Change"]), ["f_x (N) - std", "f_x (N) Change"]);
        assert_eq!(of(&["Time(s)"]), ["Time [s]"]);
        assert_eq!(of(&["t / s", "F / N"]), ["t [s]", "F [N]"]);
        assert_eq!(of(&["Geschwindigkeit in m/s"]), ["Geschwindigkeit [m/s]"]);
        assert_eq!(of(&["Speed, m/s", "Force, [N]"]), ["Speed [m/s]", "Force [N]"]);
        assert_eq!(of(&["f_x [N]", "U"]), ["f_x [N]", "U"]);
    }

    #[test]
    fn a_ratio_or_a_function_is_no_unit() {
        assert_eq!(of(&["F(t)", "x(s)", "t (s)", "F(N)"]), ["F(t)", "x(s)", "t [s]", "F [N]"]);
        assert_eq!(of(&["x / L"]), ["x / L"]);
        assert_eq!(of(&["Lift/Drag", "U/V"]), ["Lift/Drag", "U/V"]);
        assert_eq!(of(&["Zeit / s"]), ["Zeit [s]"]);
    }

    #[test]
    fn a_row_of_units_gives_what_the_head_leaves_out() {
        let head =
            |name: &str, unit: &str| Head { name: name.to_owned(), unit: Some(unit.to_owned()), ..Head::default() };
        let all = [head("Lauf", "-"), head("U", "m/s"), head("Note", "")];
        let headers: Vec<String> = headings(&all, &[true, true, false]).unwrap().iter().map(Heading::header).collect();
        assert_eq!(headers, ["Lauf [1]", "U [m/s]", "Note"]);
        assert!(headings(&[head("U [m/s]", "km/h")], &[true]).unwrap_err().contains("km/h in the line of the units"));
    }
}
