//! The figures of a sweep: speed and cost as maps or lines over what was swept.

use froude_records::block::{Block, Section};
use froude_records::number::significant;
use froude_records::page::{Chart, ChartPanel, Map, Scale, Series};

use super::Swept;
use crate::sweep::Row;
use crate::swim::Status;

/// Columns of a gait, with their labels in degrees.
const AXES: [(&str, &str); 4] = [
    ("amplitude", "amplitude [deg]"),
    ("frequency", "frequency [deg/s]"),
    ("phase", "phase [deg]"),
    ("turn", "turn [deg]"),
];
/// What is shown, with the name of its best, and whether that is the largest.
const SHOWN: [(&str, &str, &str, bool); 2] =
    [("speed", "speed [m/s]", "fastest", true), ("cot", "cost of transport [J/m]", "least cost", false)];

impl Swept {
    /// Maps of speed and cost, or lines over what was swept.
    pub(super) fn figures(&self) -> Option<Section> {
        let swept: Vec<Varied> = AXES.iter().filter_map(|(key, label)| self.axis(key, label)).collect();
        let (title, blocks) = match &swept[..] {
            [] => return None,
            [axis] => (format!("Over the {}", axis.key), vec![Block::Chart(self.lines(axis))]),
            [x, y, ..] => {
                let maps = SHOWN.iter().filter_map(|shown| self.map((x, y), shown)).map(Block::Map);
                ("Maps".to_owned(), maps.collect())
            }
        };
        Some(Section { title, blocks, is_detail: true, ..Section::default() })
    }

    /// An axis with more than one value.
    fn axis(&self, key: &'static str, label: &'static str) -> Option<Varied> {
        let mut values: Vec<f64> = self.estimated().map(|row| row.get(key)).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        (values.len() > 1).then_some(Varied { key, label, values })
    }

    /// Rows of the coefficients that were estimated.
    fn estimated(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| row.get("draw") == 0.0)
    }

    fn lines(&self, axis: &Varied) -> Chart {
        let rows: Vec<&Row> = self.estimated().collect();
        let x: Vec<f64> = rows.iter().map(|row| row.get(axis.key).to_degrees()).collect();
        let panel = |(key, label): (&str, &str)| ChartPanel {
            y_label: label.to_owned(),
            series: vec![Series {
                x: x.clone(),
                y: rows.iter().map(|row| row.get(key)).collect(),
                ..Series::default()
            }],
            ..ChartPanel::default()
        };
        let shown = [("speed", "speed [m/s]"), ("power_net", "net power [W]"), ("cot", "cost of transport [J/m]")];
        Chart {
            name: "sweep".to_owned(),
            title: format!("Speed, power and cost over the {}", axis.key),
            caption: format!("Over the {}; a gait without an answer leaves a gap.", axis.key),
            x_label: axis.label.to_owned(),
            panels: shown.into_iter().map(panel).collect(),
            ..Chart::default()
        }
    }

    /// The plane of two axes through the best gait; `None` where no gait has an answer.
    fn map(&self, (x, y): (&Varied, &Varied), shown: &(&str, &str, &str, bool)) -> Option<Map> {
        let &(key, label, best_name, is_most) = shown;
        let size = |row: &&Row| if is_most { row.get(key) } else { -row.get(key) };
        let answered = self.estimated().filter(|row| row.status == Status::Periodic && row.get("floquet") <= 1.0);
        let best = answered.max_by(|a, b| size(a).total_cmp(&size(b)))?;
        let others: Vec<&str> = AXES.iter().map(|(key, _)| *key).filter(|key| *key != x.key && *key != y.key).collect();
        let place = |axis: &Varied, row: &Row| axis.values.binary_search_by(|v| v.total_cmp(&row.get(axis.key))).ok();
        let mut values = vec![f64::NAN; x.values.len() * y.values.len()];
        for row in self.estimated().filter(|row| others.iter().all(|key| row.get(key) == best.get(key))) {
            if let (Some(i), Some(j)) = (place(x, row), place(y, row)) {
                values[j * x.values.len() + i] = row.get(key);
            }
        }
        let unit = |key: &str| if key == "frequency" { "deg/s" } else { "deg" };
        let through: Vec<String> = (others.iter())
            .map(|key| format!("{key} {} {}", significant(best.get(key).to_degrees(), 4), unit(key)))
            .collect();
        let degrees = |axis: &Varied| axis.values.iter().map(|v| v.to_degrees()).collect();
        Some(Map {
            name: format!("map-{key}"),
            title: format!("Map of {label}"),
            caption: format!(
                "{label} over {} and {}, at {}. Hatched: gaits without an answer.",
                x.key,
                y.key,
                through.join(", ")
            ),
            x_label: x.label.to_owned(),
            y_label: y.label.to_owned(),
            value_label: label.to_owned(),
            // A gait that hardly swims costs a million times what the best one does.
            value_scale: if is_most { Scale::Linear } else { Scale::Logarithmic },
            x: degrees(x),
            y: degrees(y),
            values,
            best: place(x, best).zip(place(y, best)).map(|(i, j)| (i, j, best_name.to_owned())),
        })
    }
}

/// What was swept, with its values, rising.
struct Varied {
    key: &'static str,
    label: &'static str,
    values: Vec<f64>,
}
