//! The inverse of a fitted thruster: which command gives a load.

use faer::Mat;
use froude_records::units::{Dimension, Unit, parse_unit};

use crate::dataset::Dataset;
use crate::law::Kind;
use crate::regression::ModelFit;

/// Loads in each direction, up to the largest that was measured.
const STEPS: u32 = 10;

/// The command for a load in still water.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Inverse {
    /// `thrust` or `torque`, as the table has it.
    pub(crate) load: String,
    /// The load, in the unit of the table.
    pub(crate) value: f64,
    pub(crate) unit: String,
    /// The command, in the unit of the table.
    pub(crate) command: f64,
    pub(crate) command_unit: String,
    /// 95 % interval of the command if the law is true.
    pub(crate) interval: [f64; 2],
}

/// The commands for loads up to the largest measured in each direction; none for another law.
///
/// x = ±(δ + √(|T|/k)), with the interval from the covariance of δ and k by ∂x/∂δ = ±1, ∂x/∂k = ∓½ √(|T|/k)/k (GUM 5.2).
pub(crate) fn commands(model: &ModelFit, data: &Dataset) -> Vec<Inverse> {
    let Kind::Thruster { command, parts, .. } = &model.law.kind else { return Vec::new() };
    let unit_of_command = unit_of(data, command);
    let mut out = Vec::new();
    for (r, load) in model.law.responses.iter().enumerate() {
        let (Some(thruster), Some(measured)) = (model.law.thruster_of(r, model.law_coefficients()), data.values(load))
        else {
            continue;
        };
        let unit = unit_of(data, load);
        let ends = measured.iter().fold([0.0_f64; 2], |[high, low], t| [high.max(*t), low.min(*t)]);
        for (side, step) in [1, 0].into_iter().flat_map(|side| (1..=STEPS).map(move |step| (side, step))) {
            // From the largest pull astern to the largest ahead.
            let part = f64::from(if side == 1 { STEPS + 1 - step } else { step }) / f64::from(STEPS);
            let value = part * ends[side];
            let Some([x, beyond]) = thruster.command(value) else { continue };
            let slope = |[of, which]: [usize; 2]| match which {
                _ if of != r => 0.0,
                own if own == side => -0.5 * beyond / thruster.slope[side] * x.signum(),
                own if own == 3 + side => x.signum(),
                _ => 0.0,
            };
            let row = Mat::from_fn(1, parts.len(), |_, j| slope(parts[j]));
            let line: Vec<f64> = (0..parts.len()).map(|j| row[(0, j)]).collect();
            let [below, above] = model.arms(&line, model.scatter_dof(&row, 0..1));
            out.push(Inverse {
                load: load.clone(),
                value: unit.from_si(value),
                unit: unit.text.clone(),
                command: unit_of_command.from_si(x),
                command_unit: unit_of_command.text.clone(),
                interval: [x - below, x + above].map(|x| unit_of_command.from_si(x)),
            });
        }
    }
    out
}

/// The unit that the table writes a column in.
fn unit_of(data: &Dataset, name: &str) -> Unit {
    let text = data.header(name).split_once('[').and_then(|(_, unit)| unit.split(']').next());
    let written = text.and_then(|text| parse_unit(text).ok());
    written.unwrap_or_else(|| Unit::si(data.dimension(name).unwrap_or(Dimension::ONE)))
}
