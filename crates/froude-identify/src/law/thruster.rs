//! The law of a thruster over its command: coefficients of [`Thruster`], for thrust and torque.

use froude_records::units::Dimension;
use indexmap::IndexMap;

use super::terms::THRUSTER;
use super::thrust::{COEFFICIENTS, Thruster};
use super::{CoefficientSpec, ForceLaw, Kind, is_torque};
use crate::dataset::Dataset;

/// Places of the dead bands in [`Thruster::sensitivity`], ahead and astern.
const DEAD_BANDS: [usize; 2] = [3, 4];

impl ForceLaw {
    /// Thrust and torque of a thruster ([`Thruster`]) over the channels of the command and of an inflow; `sides` says whether commands above and below zero were run.
    pub(crate) fn thruster(
        data: &Dataset,
        loads: &[&str],
        (command, inflow): (&str, Option<&str>),
        sides: [bool; 2],
    ) -> Self {
        let of = |name: &str| data.dimension(name).unwrap_or(Dimension::ONE);
        let (mut parts, mut coefficients) = (Vec::new(), Vec::new());
        for (r, load) in loads.iter().enumerate() {
            let (letter, end) = if is_torque(load) { ("Q", "_Q") } else { ("T", "") };
            // No unit of a load and a command has exponents that run over.
            let over = |a: Dimension, b: Dimension| a.checked_div(b).unwrap_or(a);
            let by_command = over(of(load), of(command));
            let square = over(by_command, of(command));
            let by_inflow = over(by_command, Dimension::SPEED);
            let all = [
                (format!("{letter}_ahead"), square, sides[0]),
                (format!("{letter}_astern"), square, sides[1]),
                (format!("{letter}_inflow"), by_inflow, inflow.is_some()),
                (format!("dead_band{end}_ahead"), of(command), sides[0]),
                (format!("dead_band{end}_astern"), of(command), sides[1]),
            ];
            for (which, (name, dimension, _)) in all.into_iter().enumerate().filter(|(_, (.., is_there))| *is_there) {
                parts.push([r, which]);
                coefficients.push(CoefficientSpec { name, unit: dimension.written_beside(&[of(command)]) });
            }
        }
        Self {
            name: THRUSTER.to_owned(),
            kind: Kind::Thruster { command: command.to_owned(), inflow: inflow.map(str::to_owned), parts },
            responses: loads.iter().map(|load| (*load).to_owned()).collect(),
            coefficients,
            texts: IndexMap::new(),
            named: None,
        }
    }

    /// Whether it is that of a thruster.
    pub(crate) const fn is_thruster(&self) -> bool {
        matches!(self.kind, Kind::Thruster { .. })
    }

    /// The thruster of a response, where the law is one.
    pub(crate) fn thruster_of(&self, response: usize, at: &[f64]) -> Option<Thruster> {
        let Kind::Thruster { parts, .. } = &self.kind else { return None };
        let mut all = [0.0; COEFFICIENTS];
        for ([_, which], value) in parts.iter().zip(at).filter(|([of, _], _)| *of == response) {
            all[*which] = *value;
        }
        Some(Thruster::of(all))
    }

    /// Whether the responses are linear in a coefficient with the others held.
    pub(super) fn is_factor(&self, j: usize) -> bool {
        match &self.kind {
            Kind::PowerLaw { .. } => j == 0,
            Kind::Thruster { parts, .. } => parts.get(j).is_some_and(|[_, which]| !DEAD_BANDS.contains(which)),
            Kind::Drag { .. } | Kind::Formulas(_) => true,
        }
    }

    /// Derivatives of every response by every coefficient at the coefficients `at`, given to `put` as row, column and number.
    pub(super) fn of_thruster(
        &self,
        command: &[f64],
        inflow_m_s: Option<&[f64]>,
        at: &[f64],
        mut put: impl FnMut(usize, usize, f64),
    ) {
        let Kind::Thruster { parts, .. } = &self.kind else { return };
        for r in 0..self.responses.len() {
            let thruster = self.thruster_of(r, at).unwrap_or_default();
            for (i, x) in command.iter().enumerate() {
                let all = thruster.sensitivity(*x, inflow_m_s.and_then(|u| u.get(i)).copied().unwrap_or(0.0));
                for (j, [_, which]) in parts.iter().enumerate().filter(|(_, [of, _])| *of == r) {
                    put(r * command.len() + i, j, all[*which]);
                }
            }
        }
    }
}
