//! `froude cfd suggest`: which settings to compute next, as blocks of a plan.

use std::path::Path;

use froude_cfd::store::Store;
use froude_cfd::suggest::{Miss, misses, suggested};
use froude_records::number::{percent, significant};
use froude_records::page::{DocumentSection, TextTable};
use serde_json::{Value, json};

use super::Asked;
use super::collect::{LOADS, collect};
use crate::Error;

/// Rows of the table for a person.
const SHOWN: usize = 8;

/// What a campaign should compute next.
#[derive(Debug, Clone, PartialEq)]
pub struct Suggested {
    /// Settings that others foretell, the worst first.
    pub misses: Vec<Miss>,
    /// New settings: configuration, speed, m/s, and angle, rad.
    pub next: Vec<(String, [f64; 2])>,
}

/// Of the cases that have a result, at most `most` settings beside those that the others foretell worst.
///
/// # Errors
///
/// As [`collect`].
pub fn suggest(campaign: &Path, source: Option<&str>, most: usize) -> Result<Suggested, Error> {
    let found = collect(campaign, source)?;
    let store = Store::open(&Asked::read(campaign, source)?.folder)?;
    let flow = |id: &str| store.case(id).ok().map(|case| (case.configuration, case.flow));
    let misses = misses(&found.rows, &store.ids().filter_map(flow).collect::<Vec<_>>());
    Ok(Suggested { next: suggested(&misses, most), misses })
}

impl Suggested {
    /// Blocks to put into the campaign: one for each configuration and speed.
    #[must_use]
    pub fn plan(&self) -> String {
        let mut blocks: Vec<(&str, f64, Vec<f64>)> = Vec::new();
        for (name, [speed_m_s, angle_rad]) in &self.next {
            match blocks.iter_mut().find(|(other, speed, _)| other == name && speed == speed_m_s) {
                Some((_, _, angles)) => angles.push(*angle_rad),
                None => blocks.push((name, *speed_m_s, vec![*angle_rad])),
            }
        }
        let block = |(name, speed_m_s, angles): &(&str, f64, Vec<f64>)| {
            let mut degrees: Vec<f64> = angles.iter().map(|a| a.to_degrees()).collect();
            degrees.sort_by(f64::total_cmp);
            // A halfway angle is chosen here and may be rounded; the speed is that of the line, to its last digit.
            let angles: Vec<String> = degrees.iter().map(|d| format!("\"{} deg\"", (1e3 * d).round() / 1e3)).collect();
            let of = if name.is_empty() { String::new() } else { format!("configurations = [\"{name}\"]\n") };
            format!("[[source.plan]]\n{of}speed = \"{speed_m_s} m/s\"\nangle = [{}]\n", angles.join(", "))
        };
        blocks.iter().map(block).collect()
    }

    /// What a person reads.
    #[must_use]
    pub fn section(&self) -> DocumentSection {
        let row = |miss: &Miss| {
            vec![
                miss.configuration.clone(),
                significant(miss.speed_m_s, 3),
                significant(miss.angle_rad.to_degrees(), 3),
                LOADS[miss.load].to_owned(),
                percent(miss.missed_part),
                percent(miss.std),
            ]
        };
        let said = match (self.misses.is_empty(), self.next.is_empty()) {
            (true, _) => "no setting lies between others at its speed: plan five angles or five speeds at least",
            (_, true) => {
                "no setting is foretold worse than by a hundredth or twice the uncertainty of its iterations, or what lies beside it is planned already: more settings tell nothing new"
            }
            _ => "put these blocks under those of the source, and run it again; cases that are there are kept",
        };
        let head = ["body", "speed, m/s", "angle, deg", "load", "missed by", "uncertainty"];
        DocumentSection {
            title: "To compute next".to_owned(),
            paragraphs: vec![said.to_owned()],
            tables: vec![TextTable {
                caption: "settings that a cubic through two others on each side foretells worst, over the largest of that load and body".to_owned(),
                head: head.map(str::to_owned).to_vec(),
                rows: self.misses.iter().take(SHOWN).map(row).collect(),
            }],
            charts: Vec::new(),
        }
    }

    /// The same for a program.
    #[must_use]
    pub fn as_json(&self) -> Value {
        let miss = |m: &Miss| {
            json!({
                "configuration": m.configuration,
                "speed_m_s": m.speed_m_s,
                "angle_rad": m.angle_rad,
                "load": LOADS[m.load],
                "missed_by": m.missed_part,
                "uncertainty": m.std,
            })
        };
        let next = |(name, [speed, angle]): &(String, [f64; 2])| json!({"configuration": name, "speed_m_s": speed, "angle_rad": angle});
        json!({
            "misses": self.misses.iter().map(miss).collect::<Vec<_>>(),
            "next": self.next.iter().map(next).collect::<Vec<_>>(),
            "plan": self.plan(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_of_one_speed_are_one_block() {
        let at = |speed: f64, degrees: f64| ("H1LT".to_owned(), [speed, f64::to_radians(degrees)]);
        // 0.77 kn has no short form.
        let odd = 0.77 * 1852.0 / 3600.0;
        let found = Suggested { misses: Vec::new(), next: vec![at(odd, 61.5), at(0.2, -51.0), at(odd, 51.0)] };
        let block = |speed: &str, angle: &str| {
            format!("[[source.plan]]\nconfigurations = [\"H1LT\"]\nspeed = \"{speed} m/s\"\nangle = [{angle}]\n")
        };
        let expected = block(&odd.to_string(), "\"51 deg\", \"61.5 deg\"") + &block("0.2", "\"-51 deg\"");
        assert_eq!(found.plan(), expected);
        let back = froude_records::units::parse_quantity(&format!("{odd} m/s")).unwrap();
        assert_eq!(back.value_si, odd);
    }
}
