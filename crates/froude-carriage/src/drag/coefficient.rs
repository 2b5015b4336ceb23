//! D_d from steady points: F = D_d v|v| through the origin, by the fit that all sources pass ([`froude_identify::seam`]).
//!
//! All points have one weight: friction repeats to a part of itself, so the scatter hardly grows with speed.

use froude_fit::budget::{Part, Uncertain};
use froude_identify::source::SourceResult;

use crate::drag::point::{Method, Point};

/// D_d by one method.
#[derive(Debug, Clone)]
pub struct Coefficient {
    /// How.
    pub method: Method,
    /// Observations (a row per point), fit and estimate, as every source has them.
    pub result: SourceResult,
    /// D_d, N s²/m².
    pub value: f64,
    /// Combined standard uncertainty; `None` where nothing tells the scatter.
    pub standard: Option<f64>,
    /// Its part from the scatter.
    pub type_a: Option<f64>,
    /// Its part from declared errors.
    pub type_b: f64,
    /// Effective degrees of freedom (Welch–Satterthwaite).
    pub dof: f64,
    /// 95 % interval, over all looks.
    pub interval_95: Option<[f64; 2]>,
    /// Looks that the interval pays for ([`looks`](crate::drag::DragSetup::looks)).
    pub looks: usize,
    /// The budget, scatter first.
    pub budget: Vec<Part>,
    /// Points.
    pub points: Vec<Point>,
    /// Pairs among them.
    pub pairs: usize,
    /// A constant force beside the drag, N (in the direction of motion's resistance), if fitted with one: friction that
    /// the dry runs did not have. Zero is expected.
    pub offset_n: Option<Uncertain>,
}

impl Coefficient {
    /// C_D = 2 D_d/(ρA), with its interval, as the record has it; `None` where no area is declared.
    #[must_use]
    pub fn drag_coefficient(&self) -> Option<(f64, Option<[f64; 2]>)> {
        let number = self.result.estimates.first()?.derived.get("C_D")?;
        Some((number.value?, number.interval_95))
    }

    /// Half-width of the interval as part of the value.
    #[must_use]
    pub fn relative_half_width(&self) -> Option<f64> {
        self.interval_95.map(|[low, high]| 0.5 * (high - low) / self.value.abs())
    }
}
