//! A lag between force and motion that nobody declared.
//!
//! A force that is late by τ is f(t − τ) = f − τ ḟ, so the load of the water gets τ ḟ beside what the law gives. τ is one more coefficient of the recommended law, and its Student's t, with the scatter of
//! the rows and what is declared of the delay, says whether it is there. It is not fitted: a drag that grows with its memory of the wake may look alike, and only a person knows the filter.

use froude_fit::distribution::t_two_sided;
use froude_identify::law::ForceLaw;
use froude_identify::regression::{ModelFit, Settings, regress};
use froude_records::campaign::{Campaign, SourceKind};
use froude_records::finding::{Finding, Severity};
use froude_records::number::{p_equation, plain, significant};
use froude_records::units::parse_unit;
use indexmap::IndexMap;

use super::law::names;
use super::reduce::{Reduced, Setup};

/// Chance of reporting a lag that is not there.
const ALARM: f64 = 0.004;
/// Names of the channel ḟ and of τ.
const SLOPE: &str = "force_slope";
const LAG: &str = "lag";

/// The lag of the force behind the motion beside the declared one, where the rows show it.
pub(super) fn finding(campaign: &Campaign, reduced: &Reduced, setup: &Setup, model: &ModelFit) -> Option<Finding> {
    let load = &names(&setup.axis)[0];
    let mut data = reduced.data.clone();
    let slope = reduced.runs.iter().flat_map(|(_, _, rows)| rows.force_slope_n_s.iter().copied()).collect();
    data.put(SLOPE, slope, parse_unit("N/s").ok()?.dimension);
    let text = format!("{} + {LAG}*{SLOPE}", model.law.texts.get(load)?);
    let law = ForceLaw::formulas(&model.law.name, &IndexMap::from([(load.clone(), text)]), &data).ok()?;
    let name = format!("{} with a lag", model.law.name);
    let settings = Settings { scatter: &model.scatter, ..Settings::new(&name, SourceKind::Tank, &campaign.identify) };
    let wide = regress(&law, &data, settings).ok()?;
    let at = wide.specs.iter().position(|spec| spec.name == LAG)?;
    let (lag_s, found) = (wide.coefficients[at], wide.combined[at]?);
    let standard_s = found.standard.hypot(setup.delay_s.standard_uncertainty);
    let p = t_two_sided(lag_s / standard_s, found.dof);
    let delay_s = setup.delay_s.value + lag_s;
    (p < ALARM && delay_s.is_finite()).then(|| {
        let text = format!(
            "{}: the force {} the motion by {} s beyond the declared delay of {} ms ({}): drag and added mass are biased by this. If a filter or a clock causes it, write delay = {{ \
             value = \"{} ms\", standard = \"{} ms\" }} in [source.accelerated_tow]",
            model.law.name,
            if lag_s > 0.0 { "lags" } else { "leads" },
            significant(lag_s.abs(), 2),
            plain(1e3 * setup.delay_s.value, 4),
            p_equation(p),
            significant(1e3 * delay_s, 3),
            significant(1e3 * standard_s, 2),
        );
        Finding::new(Severity::Warning, "lag", text)
    })
}
