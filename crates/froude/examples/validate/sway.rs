//! Pure sway: a vehicle on a planar motion mechanism on its twin, as the example campaign declares it.

use std::error::Error;
use std::path::Path;

use froude::methods::tank::sway::Sway;

use crate::claims::Claims;
use crate::driven::Case;
use crate::family::{answered, between_runs, factors};

const SECTION: &str = "Pure sway: a planar motion mechanism by its twin";

pub fn all(claims: &mut Claims, root: &Path, seeds: usize) -> Result<(), Box<dyn Error>> {
    let mut case: Case<Sway> = Case::read(root, "sway", &["delay"], 142)?;
    for noise in [("0.1 N and 0.05 N m", 1.0), ("1 N and 0.5 N m", 10.0)] {
        case.coverage(claims, SECTION, noise, seeds, &[])?;
    }
    // Four runs are too few to be clusters: force and moment change each for itself, which the fit has to see apart.
    case.twin.planned.remove(0);
    let (all, refused) = answered(seeds, |seed| {
        let runs = case.twin.planned.len();
        let both = factors(runs, seed).into_iter().zip(factors(runs, seed + 1_000_000));
        let each: Vec<Vec<f64>> = both.map(|(force, moment)| vec![force, moment]).collect();
        case.one(&each, case.sensors(), seed)
    });
    between_runs(claims, SECTION, &format!("{seeds} campaigns of 4 runs"), &case.counts(&all, &[]), &refused);
    Ok(())
}
