//! What was gathered from force files: each case with its window, and what all have in common.

use froude_identify::source::ReadFile;
use froude_records::run::step::Step;

use super::files::Read;
use super::judged::Judged;
use super::settings::{Setting, Settings};

/// A case with its mean loads.
#[derive(Debug, Clone)]
pub(super) struct Case {
    pub(super) setting: Setting,
    pub(super) read: Read,
    pub(super) rows: usize,
    pub(super) is_resampled: bool,
    pub(super) judged: Judged,
}

impl Case {
    /// Its files, with the window that their mean is over.
    pub(super) fn files(&self) -> impl Iterator<Item = ReadFile> {
        let [from, to] = self.judged.span;
        let words = format!(
            "mean over the end of the case, judged as {}; the start-up transient before it is left out",
            self.judged.status.word()
        );
        // An iteration has no unit, and a file does not say whether its first column is iterations or seconds.
        let step = Step::new("window", "", words).with("from", from, "1").with("to", to, "1");
        self.read
            .files
            .iter()
            .map(move |path| ReadFile { steps: vec![step.clone()], ..ReadFile::new(path.clone(), "case") })
    }
}

/// What the cases of a source gave.
#[derive(Debug)]
pub(super) struct Gathered {
    pub(super) cases: Vec<Case>,
    /// Names of cases without a mean that counts, and why.
    pub(super) without: Vec<(String, String)>,
    pub(super) settings: Settings,
    /// Loads that all cases determine.
    pub(super) loads: Vec<usize>,
    /// Density of the water over that of the files; `None` of coefficients.
    pub(super) density_ratio: Option<f64>,
    /// Point of the mesh that moments are about, m.
    pub(super) origin_m: Option<[f64; 3]>,
}
