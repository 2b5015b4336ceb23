//! What facets change in a matrix, and how uncertain that is.

use froude_panel::refine::Refined;

pub(super) type Matrix = [[f64; 6]; 6];

/// What facets change, over ρ.
#[derive(Debug, Clone, PartialEq)]
pub struct Facets {
    /// Smooth body minus polyhedron: it is in the value of the case.
    pub correction: Matrix,
    /// Expanded uncertainty of the facets; with that of the panels, in squares, it gives that of the case.
    pub uncertainty: Matrix,
    /// Smooth body minus polyhedron, volume, m³: it is in that of the case.
    pub volume_m3: f64,
    /// Expanded uncertainty of the volume of the case, m³.
    pub volume_uncertainty_m3: f64,
    /// Largest correction of displaced water and of added mass along the axes, as part of each.
    pub largest: f64,
    /// Part of the correction that is uncertain.
    pub part: f64,
}

impl Facets {
    /// Of the polyhedron's matrix with the uncertainty of its panels.
    pub(super) fn uncertainty_of(&self, refined: &Refined) -> Matrix {
        let volume = self.volume_uncertainty_m3 / (refined.volume_m3 + self.volume_m3);
        core::array::from_fn(|i| {
            core::array::from_fn(|j| {
                uncertain([refined.value[i][j], self.correction[i][j]], volume, self.part, refined.uncertainty[i][j])
            })
        })
    }

    /// The same in another surrounding, where the body has more or less added mass.
    pub(super) fn beside(&self, here: &Refined, there: &Refined) -> Self {
        let root = |i: usize| (there.value[i][i] / here.value[i][i]).max(0.0).sqrt();
        let part = |i: usize| if here.value[i][i] > 0.0 { root(i) } else { 1.0 };
        let correction = core::array::from_fn(|i| core::array::from_fn(|j| self.correction[i][j] * part(i) * part(j)));
        let mut out = Self { correction, ..self.clone() };
        out.uncertainty = out.uncertainty_of(there);
        out
    }
}

/// Expanded uncertainty of the facets of an entry, of which `panels` is that of the panels: their sum in squares is the sum itself, since the
/// polyhedron is the end of an interval and not a draw. `volume` is the uncertainty of the volume, `part` that of the correction.
pub(super) fn uncertain([value, correction]: [f64; 2], volume: f64, part: f64, panels: f64) -> f64 {
    let facets = (part * correction.abs()).max(volume * (value + correction).abs());
    if panels.is_finite() { (facets * (facets + 2.0 * panels)).sqrt() } else { facets }
}
