//! `froude predict` on real data that its records were not fitted to.

use std::error::Error;
use std::path::Path;

use froude::identify::prediction::{Job as Predict, predicted as predict};
use froude::pipeline::{Job, identify};

use crate::claims::{Claims, Verdict};

const ROOM: &str = "Predicted forces of real data that no fit has seen";

/// A table and another one, or the odd and the even rows of one.
pub fn all(claims: &mut Claims, root: &Path) -> Result<(), Box<dyn Error>> {
    let data = root.join("examples/unh-rm2");
    for (what, table, other) in [
        ("UNH RM2, tare drag: the even runs by the odd ones", "Tare-drag", None),
        ("UNH RM2, tare torque: the even runs by the odd ones", "Tare-torque", None),
        ("UNH RM2, rotor at tip speed ratio 3.1: the second series by the first", "Perf-tsr_0", Some("Perf-tsr_0-b")),
    ] {
        let folder = tempfile::tempdir()?;
        let place = |name: &str| folder.path().join(name);
        let text = std::fs::read_to_string(data.join(format!("{table}.csv")))?;
        let second = match other {
            Some(other) => std::fs::read_to_string(data.join(format!("{other}.csv")))?,
            None => rows(&text, 1),
        };
        std::fs::write(place("fitted.csv"), if other.is_some() { text } else { rows(&text, 0) })?;
        std::fs::write(place("held.csv"), second)?;
        for name in ["fitted.toml", "held.toml"] {
            std::fs::copy(data.join(format!("{table}.toml")), place(name))?;
        }
        identify(&Job { out: Some(place("results")), ..Job::new(place("fitted.csv")) }, &|_| {})?;
        let job = Predict {
            record: place("results/estimate.json"),
            table: place("held.csv"),
            sidecar: None,
            laws: Vec::new(),
            out: None,
        };
        let found = predict(&job)?;
        let first = found.estimates.first().ok_or("nothing predicted")?;
        let joint = first.joint.ok_or("no joint number")?;
        let counted: Vec<f64> = first.rows.iter().filter(|r| r.outside.is_empty()).filter_map(|r| r.e_n).collect();
        let beyond = counted.iter().filter(|e| e.abs() > 1.0).count();
        claims.add(
            ROOM,
            what,
            "p of one χ² over all rows; |E_n| beyond 1 in one of twenty by chance",
            format!(
                "{}: p = {:.3}, |E_n| > 1 in {beyond} of {} rows",
                first.law,
                joint.p.ok_or("no p")?,
                counted.len()
            ),
            Verdict::Measured,
        );
    }
    Ok(())
}

/// The head of a table and every other row of it.
fn rows(text: &str, which: usize) -> String {
    let mut lines = text.lines();
    let head = lines.next().unwrap_or_default().to_owned();
    lines.skip(which).step_by(2).fold(head + "\n", |out, line| out + line + "\n")
}
