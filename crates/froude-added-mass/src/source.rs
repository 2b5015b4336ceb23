//! A body or a mesh as a source of a campaign.

use froude_identify::answer::{Answer, Made};
use froude_identify::method::{Declares, Found, Method, MethodError, Need};
use froude_identify::source::{ReadFile, SourceResult};
use froude_records::RecordError;
use froude_records::campaign::{Campaign, Input, Source, SourceKind};
use froude_records::estimate::Estimate;

use super::body::body;
use super::links::links;
use super::option_list::{KEYS, given};
use super::options::Asked;
use super::page;
use super::several::several;
use crate::error::AddedMassError;
use crate::water::Water;

/// Role of a body file or a mesh.
const MESH: &str = "mesh";

/// Added mass from potential flow.
#[derive(Debug)]
pub struct AddedMass;

impl Method for AddedMass {
    fn names(&self) -> &'static [&'static str] {
        &["panels"]
    }

    fn words(&self, _: &str) -> &'static str {
        "added mass from potential flow"
    }

    fn needs(&self, _: &str) -> &'static [Need] {
        const { &[Need::of(&[MESH], &[])] }
    }

    fn runs(&self) -> &'static str {
        ""
    }

    fn declares(&self) -> Option<Declares> {
        Some(Declares { section: "added_mass", keys: &KEYS, plan: &[] })
    }

    fn check(&self, source: &Source) -> Result<(), RecordError> {
        given(source).map(drop)
    }

    fn identify(
        &self,
        campaign: &Campaign,
        source: &Source,
        _: &[&'static str],
        progress: &dyn Fn(&str),
    ) -> Result<Found, MethodError> {
        let Input::Mesh(path) = &source.input else { return Ok(Found::default()) };
        let asked = Asked::of_source(path, source)?;
        Ok(found(&asked, &Water::of(campaign), source, progress)?)
    }
}

/// What is asked for, computed.
fn found(asked: &Asked, water: &Water, source: &Source, progress: &dyn Fn(&str)) -> Result<Found, AddedMassError> {
    let files = [ReadFile::new(asked.input.clone(), MESH)];
    let computed = |estimate: Estimate| {
        let estimate = Estimate { kind: source.kind.name().to_owned(), ..estimate };
        Answer::from(Made { name: estimate.source.clone(), estimate, files: files.to_vec() })
    };
    if asked.links.len() > 1 {
        let mut done = links(asked, water, &source.name, progress)?;
        let (head, blocks) = page::links(&done);
        let fits = done
            .fits
            .take()
            .map(|fits| Answer::from(SourceResult { files: files.to_vec(), ..of_kind(fits, source.kind) }));
        return Ok(Found {
            results: fits.into_iter().chain(done.estimates.into_iter().map(computed)).collect(),
            summary: Some(head),
            blocks,
            exports: done.exports,
            findings: done.findings,
            ..Found::default()
        });
    }
    if let Some(apart) = asked.apart {
        let done = several(asked, apart, water, &source.name, progress)?;
        return Ok(Found {
            summary: Some(page::several(&done)),
            results: vec![computed(done.estimate)],
            exports: done.exports,
            findings: done.findings,
            ..Found::default()
        });
    }
    let done = body(asked, water, &source.name, progress)?;
    Ok(Found {
        summary: Some(page::body(&done)),
        results: done.estimates.into_iter().map(computed).collect(),
        exports: done.exports,
        findings: done.findings,
        ..Found::default()
    })
}

/// Fits as those of a source of another kind.
fn of_kind(fits: SourceResult, kind: SourceKind) -> SourceResult {
    let of = |estimate: Estimate| Estimate { kind: kind.name().to_owned(), ..estimate };
    SourceResult { kind, estimates: fits.estimates.into_iter().map(of).collect(), ..fits }
}
