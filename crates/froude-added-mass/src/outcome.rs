//! What was computed of one body.

use froude_identify::method::Export;
use froude_panel::problem::Frame;
use froude_panel::refine::Refined;
use froude_records::block::Block;
use froude_records::estimate::Estimate;
use froude_records::finding::{Finding, Severity};

use crate::facet_correction::Facets;

/// A matrix in one surrounding.
#[derive(Debug, Clone)]
pub struct Case {
    /// `Deeply submerged`.
    pub title: String,
    /// In a sentence.
    pub surroundings: String,
    /// Limit of frequency that it stands for: `1` in the name of a file.
    pub is_lid: Option<bool>,
    /// The matrix.
    pub refined: Refined,
    /// What the facets of a mesh changed in it.
    pub facets: Option<Facets>,
}

impl Case {
    /// Its surroundings as a key.
    #[must_use]
    pub const fn key(&self) -> &'static str {
        match self.is_lid {
            None => "unbounded",
            Some(true) => "rigid_lid",
            Some(false) => "free_surface",
        }
    }
}

/// What came out.
#[derive(Debug, Clone)]
pub struct BodyOutcome {
    /// Name.
    pub name: String,
    /// Density, kg/m³.
    pub density_kg_m3: f64,
    /// From end to end along the body, m.
    pub length_m: f64,
    /// Axes of the matrices and the point that they are about, as the mesh has them.
    pub frame: Frame,
    /// The same in words.
    pub place: String,
    /// Matrices.
    pub cases: Vec<Case>,
    /// What is known about body and mesh, a sentence each.
    pub notes: Vec<String>,
    /// Cross-checks and hydrostatics.
    pub tables: Vec<Block>,
    /// Doubts.
    pub findings: Vec<Finding>,
    /// A record a matrix.
    pub estimates: Vec<Estimate>,
    /// The pressure on the body, and what was asked for beside the record.
    pub exports: Vec<Export>,
}

/// A finding where the tolerance was not reached.
pub(super) fn not_within(name: &str, refined: &Refined) -> Option<Finding> {
    let why = refined.stopped.as_ref()?;
    let message = if refined.worst.is_finite() {
        format!("{name}: the numerical uncertainty is {:.2} % where less was asked for: {why}", 100.0 * refined.worst)
    } else {
        format!("{name}: the numerical uncertainty is not known: {why}")
    };
    Some(Finding::new(Severity::Warning, "not-converged", message))
}
