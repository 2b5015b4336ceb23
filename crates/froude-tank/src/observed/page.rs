//! What a page shows of the runs where a method adds nothing of its own: each as it was reduced.

use froude_records::block::{Block, ResultColumn, Section, TableBuilder};

use super::reduced::Reduced;
use super::spec::Condition;
use crate::steady::page::load_column;

/// The runs as a table.
pub(super) fn section<F>(conditions: &[Condition], runs: &[Reduced<F>]) -> Section {
    let t = TableBuilder::new("runs", "Each run as it was reduced.", runs);
    let mut columns = vec![
        t.text("run", "run", |run| run.point.id.clone()),
        t.text("configuration", "configuration", |run| run.point.configuration.clone()),
    ];
    let is_stated = |name: &str| runs.iter().any(|run| run.point.conditions.contains_key(name));
    columns.extend(conditions.iter().filter(|condition| is_stated(condition.name)).map(|condition| {
        let [key, head] = condition.column;
        ResultColumn { digits: condition.digits, ..t.number(key, head, |run| run.point.condition(condition.name)) }
    }));
    if !is_stated("speed") {
        columns.push(t.number("speed_m_s", "speed [m/s]", |run| run.observation.speed_m_s).plain(5));
    }
    let loads = runs.first().map_or(&[][..], |run| run.observation.loads.as_slice());
    columns.extend(
        loads
            .iter()
            .enumerate()
            .map(|(k, load)| load_column(&t, &load.name, move |run: &Reduced<F>| run.observation.loads.get(k))),
    );
    Section::new("Runs", [Block::from(t.build(columns))])
}
