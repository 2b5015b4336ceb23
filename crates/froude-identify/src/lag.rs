//! A lag between load and motion that nobody declared.
//!
//! A load that is late by τ is f(t − τ) = f − τ ḟ, so −τ is the coefficient of ḟ beside a law. Its Student's t, with the scatter of rows in time, says whether it is there. It is not fitted: a load that
//! depends on the history of the motion (the wake) may look alike, and only a person knows the filters and clocks of a rig. In a table ḟ is the slope of the fitted load, which has no noise of its own.
//!
//! **Units.** SI; a positive lag is a load behind the motion. **Source.** Student (1908); first order of Taylor's series, for lags that are short beside the motion.

use froude_fit::distribution::{coverage_factor, t_two_sided};
use froude_records::campaign::{Campaign, SourceKind};
use froude_records::finding::{Finding, Severity};
use froude_records::number::{p_equation, significant};
use froude_records::units::Dimension;
use indexmap::IndexMap;

use crate::dataset::{Dataset, labels};
use crate::regression::{ModelFit, Settings, regress};

/// Chance of reporting a lag that is not there, over all loads of a law.
pub const ALARM: f64 = 0.004;
/// Steps of Newton from the first order to the lag itself.
const STEPS: usize = 3;
/// Names of the channel ḟ and of its coefficient.
const SLOPE: &str = "load_slope";
const COEFFICIENT: &str = "lag";

/// A lag as it is found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lag {
    /// τ, s.
    pub lag_s: f64,
    /// Its standard uncertainty, s.
    pub standard_s: f64,
    /// Degrees of freedom of that.
    pub dof: f64,
}

/// The lag of one load behind the motion, whose slope in time is given for each row; `None` where the motion does not tell it.
#[must_use]
pub fn of_load(campaign: &Campaign, model: &ModelFit, data: &Dataset, load: &str, slope: Vec<f64>) -> Option<Lag> {
    let mut data = data.clone();
    data.put(SLOPE, slope, data.dimension(load)?.checked_div(Dimension::TIME)?);
    let mut texts: IndexMap<String, String> = model.law.texts.clone();
    let text = texts.get_mut(load)?;
    *text = format!("{text} - {COEFFICIENT}*{SLOPE}");
    let law = model.law.rewritten(&model.law.name, &texts, &data).ok()?;
    let settings =
        Settings { scatter: &model.scatter, ..Settings::new(&model.law.name, SourceKind::Tank, &campaign.identify) };
    let wide = regress(&law, &data, settings).ok()?;
    let at = wide.specs.iter().position(|spec| spec.name == COEFFICIENT)?;
    let found = wide.combined[at]?;
    let lag = Lag { lag_s: wide.coefficients[at], standard_s: found.standard, dof: found.dof };
    (lag.lag_s.is_finite() && lag.standard_s > 0.0).then_some(lag)
}

/// What is said of the loads of a table in time that lag the motion.
pub(crate) fn findings(campaign: &Campaign, model: &ModelFit, data: &Dataset) -> Vec<Finding> {
    // Where successive rows count as independent, anything that follows in time looks like a lag.
    let (true, Some(times)) = (model.is_in_time(data), data.values("time")) else { return Vec::new() };
    let runs = labels(&data.run);
    let level = ALARM / model.law.responses.len().max(1) as f64;
    let of = |(r, load): (usize, &String)| {
        let at = |law: &[f64], data: &Dataset| {
            let fitted = model.law.predict(data, law).ok()?;
            of_load(campaign, model, data, load, slope(times, &runs, &fitted[r * data.rows..(r + 1) * data.rows]))
        };
        let Lag { mut lag_s, mut standard_s, dof } = at(model.law_coefficients(), data)?;
        let p = t_two_sided(lag_s / standard_s, dof);
        if p >= level {
            return None;
        }
        // To first order only: the law was fitted to loads that came late.
        for _ in 0..STEPS {
            let mut shifted = data.clone();
            shifted.put(load, earlier(times, &runs, data.values(load)?, lag_s), data.dimension(load)?);
            let settings = Settings {
                scatter: &model.scatter,
                ..Settings::new(&model.law.name, SourceKind::Tank, &campaign.identify)
            };
            let law = regress(&model.law, &shifted, settings).ok()?;
            let rest = at(law.law_coefficients(), &shifted)?;
            (lag_s, standard_s) = (lag_s + rest.lag_s, rest.standard_s);
        }
        lag_s.is_finite().then(|| {
            let text = format!(
                "{}, {load}: the load {} the motion by {} ± {} s (95 %, {}): drag and added mass are biased by this. A filter in one channel or separate clocks can cause this: shift the load by the delay that they are known to have, not by one found from these rows",
                model.law.name,
                if lag_s > 0.0 { "lags" } else { "leads" },
                significant(lag_s.abs(), 2),
                significant(coverage_factor(0.95, dof) * standard_s, 2),
                p_equation(p)
            );
            Finding::new(Severity::Warning, "lag", text)
        })
    };
    model.law.responses.iter().enumerate().filter_map(of).collect()
}

/// Slopes in time, within each run.
fn slope(times: &[f64], runs: &[usize], values: &[f64]) -> Vec<f64> {
    let n = times.len();
    let neighbour = |i: usize, j: usize| if j < n && runs.get(i) == runs.get(j) { j } else { i };
    let at = |i: usize| {
        let (before, after) = (neighbour(i, i.wrapping_sub(1)), neighbour(i, i + 1));
        let step = times[after] - times[before];
        if step > 0.0 { (values[after] - values[before]) / step } else { 0.0 }
    };
    (0..n).map(at).collect()
}

/// Values as they are `lag_s` later, within each run and between its rows in a straight line; the ends of a run are held.
fn earlier(times: &[f64], runs: &[usize], values: &[f64], lag_s: f64) -> Vec<f64> {
    let n = times.len();
    let is_of = |i: usize, j: usize| runs.get(i) == runs.get(j);
    let at = |i: usize| {
        let wanted = times[i] + lag_s;
        let mut k = i;
        while k + 1 < n && is_of(i, k + 1) && times[k + 1] <= wanted {
            k += 1;
        }
        while k > 0 && is_of(i, k - 1) && times[k] > wanted {
            k -= 1;
        }
        let next = if k + 1 < n && is_of(i, k + 1) { k + 1 } else { k };
        let step = times[next] - times[k];
        let part = if step > 0.0 { ((wanted - times[k]) / step).clamp(0.0, 1.0) } else { 0.0 };
        values[k] + part * (values[next] - values[k])
    };
    (0..n).map(at).collect()
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    use crate::source::identify_source;

    /// What is said of a vehicle's log at 10 Hz, three sines of speed: a load that comes late, with errors that follow each other.
    fn said(late_s: f64, seed: u128) -> Vec<String> {
        let mut rng = Pcg64::new(seed, 15);
        let mut table = "time [s],speed [m/s],v_x_dot [m/s^2],f_x [N]\n".to_owned();
        let motion = |t: f64| {
            let parts = [(0.5, 0.31), (0.3, 0.83), (0.15, 1.7)];
            let v: f64 = 1.2 + parts.iter().map(|(a, w)| a * (w * t).sin()).sum::<f64>();
            [v, parts.iter().map(|(a, w)| a * w * (w * t).cos()).sum()]
        };
        let mut error = 0.0;
        for i in 0..600 {
            let t = 0.1 * f64::from(i);
            let z: f64 = StandardNormal.sample(&mut rng);
            error = 0.8 * error + 0.6 * z;
            let ([v, a], [then, at]) = (motion(t), motion(t - late_s));
            let f = -95.0 * at - 31.0 * then - 200.0 * then * then.abs() + error;
            let _ = writeln!(table, "{t:.1},{v:.5},{a:.5},{f:.4}");
        }
        let folder = tempfile::tempdir().unwrap();
        let campaign = "schema = 1\nname = \"a\"\n[[source]]\nname = \"t\"\nkind = \"towing\"\ntable = \"t.csv\"\n[identify]\ncovariance = \"serial\"\n\
                        [[identify.model]]\nname = \"free\"\nf_x = \"-A*v_x_dot - D*v_x - Q*v_x*abs(v_x)\"\n";
        std::fs::write(folder.path().join("t.csv"), table).unwrap();
        std::fs::write(folder.path().join("c.toml"), campaign).unwrap();
        let campaign = froude_records::campaign_file::read_campaign(&folder.path().join("c.toml")).unwrap();
        let found = identify_source(&campaign, &campaign.sources[0], &|_| {}).unwrap();
        found.findings.into_iter().filter(|f| f.code == "lag").map(|f| f.message).collect()
    }

    #[test]
    fn a_load_that_lags_or_leads_is_reported_with_its_time() {
        let [late] = said(0.3, 1).try_into().unwrap();
        assert!(late.contains("the load lags the motion by 0.30 ± 0.0"), "{late}");
        let [early] = said(-0.1, 2).try_into().unwrap();
        assert!(early.contains("the load leads the motion by 0.10 ± 0.0"), "{early}");
    }

    /// 0.4 % of sound tables, plus three standard deviations of the count.
    #[test]
    fn a_load_in_time_is_rarely_said_to_lag() {
        let alarms = (0..150).filter(|seed| !said(0.0, 100 + seed).is_empty()).count();
        assert!(alarms <= 3, "{alarms} of 150");
    }
}
