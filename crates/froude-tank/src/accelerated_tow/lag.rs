//! A lag between force and motion beside the declared delay ([`froude_identify::lag`]); its slope is that of the force as it is read.

use froude_fit::distribution::t_two_sided;
use froude_identify::lag::{ALARM, Lag, of_load};
use froude_identify::regression::ModelFit;
use froude_records::campaign::Campaign;
use froude_records::finding::Finding;
use froude_records::number::{p_equation, plain, significant};

use super::law::names;
use super::reduce::Reduced;
use super::setup::Setup;
use crate::findings::warning;

/// The lag of the force behind the motion, where the rows show it.
pub(super) fn finding(campaign: &Campaign, reduced: &Reduced, setup: &Setup, model: &ModelFit) -> Option<Finding> {
    let load = &names(&setup.axis)[0];
    // The load of the water is m a less the force.
    let slope = reduced.runs.iter().flat_map(|(_, _, rows)| rows.force_slope_n_s.iter().map(|s| -s)).collect();
    let Lag { lag_s, standard_s, dof } = of_load(campaign, model, &reduced.data, load, slope)?;
    let standard_s = standard_s.hypot(setup.delay_s.standard_uncertainty);
    let p = t_two_sided(lag_s / standard_s, dof);
    (p < ALARM && lag_s.is_finite()).then(|| {
        let text = format!(
            "{}: the force {} the motion by {} s beyond the declared delay of {} ms ({}): drag and added mass are biased by this. A filter in one channel or separate clocks can cause this. Declare the delay known of the filters and clocks, not one found from these same runs",
            model.law.name,
            if lag_s > 0.0 { "lags" } else { "leads" },
            significant(lag_s.abs(), 2),
            plain(1e3 * setup.delay_s.value, 4),
            p_equation(p)
        );
        warning("lag", text)
    })
}
