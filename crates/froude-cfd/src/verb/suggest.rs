//! `froude cfd suggest`: which settings to compute next, as blocks of a plan.

use std::path::Path;

use froude_records::block::{Block, TableBuilder, facts};
use froude_records::outcome::Outcome;

use super::asked::Asked;
use super::collect::collected;
use super::error::VerbError;
use super::loads::LOADS;
use crate::store::Store;
use crate::suggest::{Miss, misses, suggested};

/// Rows of the table for a person.
const SHOWN: usize = 8;

/// What a campaign should compute next.
#[derive(Debug, Clone, PartialEq)]
struct Suggested {
    /// Settings that others foretell, the worst first.
    misses: Vec<Miss>,
    /// New settings: configuration, speed, m/s, and angle, rad.
    next: Vec<(String, [f64; 2])>,
}

/// Of the cases that have a result, at most `most` settings beside those that the others foretell worst.
///
/// # Errors
///
/// As [`super::collect`].
pub fn suggest(campaign: &Path, source: Option<&str>, most: usize) -> Result<Outcome, VerbError> {
    let found = collected(campaign, source)?;
    let store = Store::open(&Asked::read(campaign, source)?.folder)?;
    let flow = |id: &str| store.case(id).ok().map(|case| (case.configuration, case.flow));
    let misses = misses(&found.rows, &store.ids().filter_map(flow).collect::<Vec<_>>());
    let blocks = Suggested { next: suggested(&misses, most), misses }.blocks();
    Ok(Outcome { blocks, ..Outcome::default() })
}

impl Suggested {
    /// Blocks to put into the campaign: one for each configuration and speed.
    fn plan(&self) -> String {
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

    fn blocks(&self) -> Vec<Block> {
        let said = match (self.misses.is_empty(), self.next.is_empty()) {
            (true, _) => "no setting lies between others at its speed: plan five angles or five speeds at least",
            (_, true) => {
                "no further settings needed: each is predicted within 1 % or twice its iterative uncertainty, or its neighbours are already planned"
            }
            _ => "put these blocks under those of the source and re-run froude cfd run; existing cases are kept",
        };
        let caption = "settings with the largest error of a cubic through the two neighbours on each side, as part of the largest value of that load on that body";
        let t = TableBuilder::new("misses", caption, &self.misses);
        let mut misses = t.build(vec![
            t.text("configuration", "body", |miss| miss.configuration.clone()),
            t.number("speed_m_s", "speed [m/s]", |miss| miss.speed_m_s).significant(3),
            t.number("angle_rad", "angle [deg]", |miss| miss.angle_rad).significant(3),
            t.text("load", "load", |miss| LOADS[miss.load].to_owned()),
            t.number("missed_by", "missed by", |miss| miss.missed_part).percent(),
            t.number("uncertainty", "uncertainty", |miss| miss.std).percent(),
        ]);
        misses.shown_rows = Some((0..self.misses.len().min(SHOWN)).collect());
        let t = TableBuilder::new("next", "", &self.next);
        let next = t.build(vec![
            t.text("configuration", "", |(name, _)| name.clone()),
            t.number("speed_m_s", "", |(_, [speed, _])| *speed),
            t.number("angle_rad", "", |(_, [_, angle])| *angle),
        ]);
        let plan = self.plan();
        let f = facts("", "", &plan);
        let file = f.build(vec![f.text("plan", "", Clone::clone)]);
        let lines = plan.lines().map(str::to_owned).collect();
        vec![misses.into(), next.into(), file.into(), Block::text("", vec![said.to_owned()]), Block::text("", lines)]
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
