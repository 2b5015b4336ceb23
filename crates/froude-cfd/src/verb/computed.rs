//! Computed cases as a source of `froude identify`: collected, and fitted as the rows of a table whose scatter is the error of the law.

use std::collections::BTreeMap;

use crate::collect::Collected as Row;
use crate::keys::KEYS;
use crate::outcome::Loads;
use crate::section::{CFD, declared};
use crate::wall::std_of_wall;
use froude_fit::budget::Kind;
use froude_identify::method::{Declares, Found, Method, MethodError, Need};
use froude_identify::reduce::{Observations, reduce_table};
use froude_identify::source::{ReadFile, identify_observations};
use froude_identify::uncertainty::SharedError;
use froude_identify::validation::{STD_ITERATIVE, STD_NUMERICAL};
use froude_records::RecordError;
use froude_records::block::Section;
use froude_records::campaign::{Campaign, Source};
use froude_records::finding::{Finding, Severity};
use froude_records::output::inside;
use froude_records::table::Table;

use super::asked::Asked;
use super::collect::{Collected, of_folder};
use super::error::VerbError;
use super::findings;
use super::loads::LOADS;

/// The cases of a CFD campaign.
#[derive(Debug)]
pub struct Computed;

impl Method for Computed {
    fn names(&self) -> &'static [&'static str] {
        &["cfd"]
    }

    fn words(&self, _: &str) -> &'static str {
        "computed cases"
    }

    fn needs(&self, _: &str) -> &'static [Need] {
        const { &[Need::of(&["cases"], &[])] }
    }

    fn runs(&self) -> &'static str {
        ""
    }

    fn declares(&self) -> Option<Declares> {
        Some(Declares { section: CFD, keys: KEYS, plan: &[] })
    }

    fn check(&self, source: &Source) -> Result<(), RecordError> {
        declared(source).map(drop)
    }

    fn identify(
        &self,
        campaign: &Campaign,
        source: &Source,
        _: &[&'static str],
        progress: &dyn Fn(&str),
    ) -> Result<Found, MethodError> {
        progress("collecting cases");
        // Another source may read the same cases, of which one says how they were computed.
        let of_cases = |other: &&Source| other.has_section(CFD) && other.input == source.input;
        let all = || std::iter::once(source).chain(&campaign.sources);
        let spec = all().find(of_cases).map(declared).transpose()?.flatten().unwrap_or_default();
        let may_write = || inside(&campaign.path, source.input.path(), &source.place, "cases", "froude identify");
        let input = |e: VerbError| MethodError::input(source.input.path(), e.to_string());
        let planned = all().find(|other| of_cases(other) && !other.plan.is_empty());
        // A campaign that can no longer be planned is not the one that was planned.
        let inputs_sha256 = planned.map(|other| {
            let asked = Asked::of(campaign, other, source.input.path().to_owned());
            asked.map_or_else(|_| String::new(), |asked| asked.inputs_sha256())
        });
        let collected = of_folder(source.input.path(), &spec, inputs_sha256.as_deref(), may_write).map_err(input)?;
        // Cases of one configuration err alike.
        let group = source.group.clone().or_else(|| Some("configuration".to_owned()));
        let source = Source { group, ..source.clone() };
        let files = vec![ReadFile::new(collected.path.clone(), "table")];
        let mut observations = reduce_table(campaign, &source, &loads_alone(&collected.table), files)?;
        let std: BTreeMap<&str, Loads> = (collected.rows.iter())
            .filter_map(|row| Some((row.case.id.as_str(), row.outcome.std_iterative?)))
            .collect();
        observations.shared_errors.extend(iterative(&observations, &std));
        observations.shared_errors.extend(of_grid(&observations, &collected));
        observations.findings.extend(findings::of_missing(&collected));
        observations.findings.extend(findings::of_collected(&collected));
        observations.findings.extend(findings::of_flows(&collected, &spec, &source));
        let mut result = identify_observations(campaign, &source, observations, "cfd", &|model| {
            progress(&format!("fitting {model}"));
        })?;
        let findings = std::mem::take(&mut result.findings).into_iter().filter(|f| !is_of_a_rig(f)).collect();
        let blocks = vec![Section::new("Collected", collected.blocks())];
        Ok(Found { results: vec![result.into()], findings, blocks, ..Found::default() })
    }
}

/// Whether a finding is about the mounting of a sensor, of which a computation has none: one sign of the angle is enough, and suction at the nose pushes a body forward at large angles. That all rows point along the motion is an error whatever made them.
pub(crate) fn is_of_a_rig(finding: &Finding) -> bool {
    finding.code == "one-sign-of-angle" || (finding.code == "force-along-motion" && finding.severity < Severity::Error)
}

/// Columns about the mesh, which no law reads.
const ABOUT_THE_MESH: [&str; 5] = ["non_orthogonality", "skewness", "layer_coverage", "layers_requested", "layers"];

/// A table without what it says about its own loads and nothing reads: the iterations' part is that of the numerical uncertainty where this is known.
fn loads_alone(table: &Table) -> Table {
    let has_numerical = table.columns.iter().any(|c| c.name.starts_with(STD_NUMERICAL));
    let is_about = |name: &str| {
        ABOUT_THE_MESH.contains(&name)
            || name.starts_with("correction_")
            || (has_numerical && name.starts_with(STD_ITERATIVE))
    };
    Table { columns: table.columns.iter().filter(|c| !is_about(&c.name)).cloned().collect(), ..table.clone() }
}

/// What is left of the solver's iterations in each row: part of the scatter.
fn iterative(observations: &Observations, std: &BTreeMap<&str, Loads>) -> Vec<SharedError> {
    let runs = &observations.data.run;
    let of = |(k, load): (usize, &&'static str)| {
        observations.data.values(load)?;
        let standard: Vec<f64> = runs.iter().map(|run| std.get(run.as_str()).map_or(0.0, |s| s[k])).collect();
        Some(SharedError::of_each_row("iterations of the solver", load, &standard).evaluated_as(Kind::Numerical))
    };
    LOADS.iter().enumerate().filter_map(of).collect()
}

/// What mesh, wall and domain leave in the loads, as errors that all cases share.
///
/// A mesh errs in one direction about bodies that differ in their length alone, and at all speeds: its error does not average down, over cases or over configurations. (It is no constant: all configurations have as many stations, so that the cells of a longer body are longer.) So each load has one, of the size that it has in each row. What an endless domain changes is known with its sign; loads are not corrected for it, so it lies between nothing and all of it.
fn of_grid(observations: &Observations, collected: &Collected) -> Vec<SharedError> {
    let rows: BTreeMap<&str, &Row> = collected.rows.iter().map(|row| (row.case.id.as_str(), row)).collect();
    let of = |left: &dyn Fn(&Row) -> Option<Loads>, load: usize| -> Option<Vec<f64>> {
        let row = |run: &String| Some(left(rows.get(run.as_str())?)?[load]);
        observations.data.run.iter().map(row).collect()
    };
    let of_load = |name: &str, load: &'static str, standard: &[f64]| {
        SharedError::of_load(&format!("{name} ({load})"), load, standard, 1.0, f64::INFINITY)
    };
    let mut out = Vec::new();
    for (k, load) in LOADS.iter().enumerate().filter(|(_, load)| observations.data.values(load).is_some()) {
        let of_mesh = of(&|row| collected.numerical.std_of_mesh(&row.case), k);
        out.extend(of_mesh.map(|standard| of_load("mesh", load, &standard)));
        let of_wall = of(&|row| Some(std_of_wall(&row.case, &row.outcome)), k);
        let of_wall = of_wall.filter(|all| all.iter().any(|std| *std > 0.0));
        out.extend(of_wall.map(|standard| of_load("mesh at the wall", load, &standard)));
        let of_domain = of(&|row| collected.numerical.endless(&row.case), k);
        let between = |change: Vec<f64>| SharedError::between(&format!("domain ({load})"), load, &change, [-1.0, 0.0]);
        out.extend(of_domain.map(between));
    }
    out.into_iter().map(|error| error.evaluated_as(Kind::Numerical)).collect()
}
