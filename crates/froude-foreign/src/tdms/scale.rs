//! Scales that turn what is stored in a channel into what was measured.
//!
//! Source: the properties `NI_Scale[…]` that LabVIEW and DAQmx write, as npTDMS 1.13 reads them.

use std::cell::Cell;
use std::collections::BTreeMap;

use super::bytes::Value;
use super::data::Raw;

type Properties = BTreeMap<String, Value>;

/// The source of a scale that takes what is stored.
const STORED: f64 = 4_294_967_295.0;

/// Most scales of a channel.
const MAX_SCALES: usize = 1000;

/// What is measured, of what is stored; `levels` are the properties of the channel, its group and the file, and the first with scales
/// counts.
///
/// # Errors
///
/// A scale that is not read, by its name, or that lacks a property.
pub(super) fn scaled(raw: &Raw, levels: [&Properties; 3]) -> Result<Vec<f64>, String> {
    let scales = levels.into_iter().find_map(|properties| Some((properties, count(properties).filter(|n| *n > 0)?)));
    let is_stored = |properties: &Properties| text(properties, "NI_Scaling_Status") == Some("scaled");
    match scales.filter(|(properties, _)| !is_stored(properties)) {
        Some((_, n)) if n > MAX_SCALES => Err(format!("has {n} scales; at most {MAX_SCALES} are read")),
        Some((properties, n)) => Chain { raw, properties, n, steps: Cell::new(0) }.output(n - 1, n + 1),
        None if !raw.scalers.is_empty() => Err("has raw samples of DAQmx and no scale for them".to_owned()),
        None => Ok(raw.numbers.clone()),
    }
}

/// What properties outside of `NI_Scale` state about whole numbers, which may be counts of a converter: `Slope = 0.005, Offset = 2`.
pub(super) fn not_applied(raw: &Raw, own: &Properties) -> Option<String> {
    const NAMES: [&str; 6] = ["slope", "gain", "scale", "scale factor", "scale_factor", "offset"];
    if raw.numbers.is_empty() || raw.numbers.iter().any(|x| x.fract() != 0.0) || count(own).is_some_and(|n| n > 0) {
        return None;
    }
    let stated = own.iter().filter_map(|(name, value)| {
        let (lower, number) = (name.to_lowercase(), value.number()?);
        let changes = number != if lower == "offset" { 0.0 } else { 1.0 };
        (NAMES.contains(&lower.as_str()) && changes).then(|| format!("{name} = {number}"))
    });
    Some(stated.collect::<Vec<_>>().join(", ")).filter(|stated| !stated.is_empty())
}

fn text<'a>(properties: &'a Properties, name: &str) -> Option<&'a str> {
    properties.get(name)?.text()
}

/// How many scales there are.
fn count(properties: &Properties) -> Option<usize> {
    if let Some(n) = properties.get("NI_Number_Of_Scales") {
        return n.number().map(|n| n as usize);
    }
    let numbers = properties.keys().filter_map(|name| {
        name.strip_prefix("NI_Scale[")?.strip_suffix("]_Scale_Type")?.parse::<usize>().ok()?.checked_add(1)
    });
    numbers.max()
}

struct Chain<'a> {
    raw: &'a Raw,
    properties: &'a Properties,
    n: usize,
    /// Scales that were computed.
    steps: Cell<usize>,
}

impl Chain<'_> {
    /// What a scale gives; `depth` scales at most lie below it.
    fn output(&self, scale: usize, depth: usize) -> Result<Vec<f64>, String> {
        if scale >= self.n || depth == 0 {
            return Err(format!("takes its values from scale {scale}, which is not there or takes them from itself"));
        }
        self.steps.set(self.steps.get() + 1);
        if self.steps.get() > MAX_SCALES {
            return Err(format!("has scales that take their values from each other more than {MAX_SCALES} times"));
        }
        let name = |rest: &str| format!("NI_Scale[{scale}]_{rest}");
        let Some(kind) = text(self.properties, &name("Scale_Type")) else {
            // What comes from the device has its scaler's number.
            let found = u32::try_from(scale).ok().and_then(|id| self.raw.scalers.get(&id));
            return found.cloned().ok_or_else(|| format!("lacks the property {}", name("Scale_Type")));
        };
        let number = |rest: String| {
            let value = self.properties.get(&name(&rest)).and_then(Value::number);
            value.ok_or_else(|| format!("lacks the property {}", name(&rest)))
        };
        let source = |rest: &str| {
            let source = self.properties.get(&name(rest)).and_then(Value::number).unwrap_or(STORED);
            if source == STORED {
                if self.raw.scalers.is_empty() {
                    Ok(self.raw.numbers.clone())
                } else {
                    Err("is scaled from stored values, and has raw samples of DAQmx".to_owned())
                }
            } else {
                self.output(source as usize, depth - 1)
            }
        };
        match kind {
            "Linear" => {
                let (slope, intercept) = (number("Linear_Slope".to_owned())?, number("Linear_Y_Intercept".to_owned())?);
                let mut values = source("Linear_Input_Source")?;
                for value in &mut values {
                    *value = *value * slope + intercept;
                }
                Ok(values)
            }
            "Polynomial" => {
                let n = number("Polynomial_Coefficients_Size".to_owned()).unwrap_or(4.0);
                let coefficients = (0..(n as usize).min(MAX_SCALES))
                    .map(|i| number(format!("Polynomial_Coefficients[{i}]")))
                    .collect::<Result<Vec<_>, _>>()?;
                let mut values = source("Polynomial_Input_Source")?;
                for value in &mut values {
                    *value = coefficients.iter().rev().fold(0.0, |sum, c| sum * *value + c);
                }
                Ok(values)
            }
            "Table" => {
                let n = number("Table_Pre_Scaled_Values_Size".to_owned())?;
                if n != number("Table_Scaled_Values_Size".to_owned())? || !(1.0..=1e6).contains(&n) {
                    return Err("has a table whose columns differ in length".to_owned());
                }
                let column = |what: &str| {
                    (0..n as usize).map(|i| number(format!("Table_{what}_Values[{i}]"))).collect::<Result<Vec<_>, _>>()
                };
                let mut table: Vec<(f64, f64)> = column("Pre_Scaled")?.into_iter().zip(column("Scaled")?).collect();
                if table.is_sorted_by(|a, b| a.0 > b.0) {
                    table.reverse();
                }
                if !table.is_sorted_by(|a, b| a.0 < b.0) {
                    return Err("has a table that goes up and down".to_owned());
                }
                let mut values = source("Table_Input_Source")?;
                for value in &mut values {
                    *value = interpolated(&table, *value);
                }
                Ok(values)
            }
            "Add" | "Subtract" => {
                let sides = ["Left", "Right"].map(|side| source(&format!("{kind}_{side}_Operand_Input_Source")));
                let [left, right] = sides;
                // The left operand is subtracted from the right one, as NI's own reader for spreadsheets does.
                let sign = if kind == "Add" { 1.0 } else { -1.0 };
                Ok(left?.iter().zip(right?).map(|(left, right)| right + sign * left).collect())
            }
            "AdvancedAPI" => source("AdvancedAPI_Input_Source"),
            other => Err(format!("has a scale of the kind {other}, which is not read; write scaled values")),
        }
    }
}

/// Between the points of a table; beyond them its first or last value.
fn interpolated(table: &[(f64, f64)], x: f64) -> f64 {
    let behind = table.partition_point(|point| point.0 <= x);
    match (behind.checked_sub(1).and_then(|i| table.get(i)), table.get(behind)) {
        (Some((x0, y0)), Some((x1, y1))) => y0 + (y1 - y0) * (x - x0) / (x1 - x0),
        (Some((_, y)), None) | (None, Some((_, y))) => *y,
        (None, None) => f64::NAN,
    }
}
