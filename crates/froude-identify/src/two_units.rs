//! Loads of one setting that differ a hundredfold: two units under one header.
//!
//! A table put together from two exports may hold newtons in some rows and
//! gram-force in the others. The column has one unit, so no check of dimensions
//! sees it, and a fit takes the mean of both.
//!
//! **Rule.** Within one setting (everything alike but the speed) |f|/U² of a body changes little. Where the rows
//! of a setting fall into two tight groups that lie thirtyfold apart, the column has two units. A load that is noise
//! (a side force at no angle), or that depends on something that the table does not state, is spread over the gap and
//! changes its sign, and is passed over.
//!
//! **The law decides.** Inertia and drag cancel at one speed of an accelerated motion, and lift and drag at one angle: such rows look a hundred times too small, but the law predicts them. It does
//! not predict rows in another unit: fitted to a mixture of units, a law leaves most of the load unexplained.

use std::collections::BTreeMap;

use froude_fit::distribution::coverage_factor;
use froude_records::campaign::{Campaign, Source};

use crate::dataset::{Dataset, labels};
use crate::law::ForceLaw;
use crate::lint::counts::SIGN_MATTERS_ABOVE;
use crate::lint::repeats::{is_outcome, within};
use crate::regression::{Settings, regress};
use crate::source::models::laws;

/// Rows slower than this part of the fastest are left to the zero of the sensor.
const SLOW: f64 = 0.3;
/// |f|/U² of one unit: from [`SLOW`] to the fastest, laws of exponent 0.7 to 3.3 move it by less.
const TIGHT: f64 = 5.0;
/// Groups this far apart are in two units: gram-force is 102, a prefix 1000.
const APART: f64 = 30.0;
/// Fewest rows of a setting that are judged from.
const FEWEST_ROWS: usize = 4;
/// Rows whose speeds differ by less are near each other, and their |f|/U² differ by less than the second where they are no noise.
const NEAR: f64 = 1.5;
/// See [`NEAR`].
const REPEATED: f64 = 1.5;
/// Half of the rows of one unit differ by less from the next in speed where the load is no noise.
const SCATTER: f64 = 0.2;
/// Of fewer rows, noise makes two such groups once in 2,000 settings.
const MANY_ROWS: usize = 6;
/// A single row may be wild for any reason, and few rows by chance; by a unit's own factor, within this, it is probably the unit.
const NEAR_A_UNIT: std::ops::Range<f64> = 0.75..1.33;
/// One row is in another unit where the others scatter about it with a chance below what is left of this.
const SURE: f64 = 0.9999;
/// A setting that is repeated is repeated this well, as part of the largest.
const SETTING_WITHIN: f64 = 0.01;

/// What a factor between rows comes from.
const CAUSES: [(f64, &str); 3] = [
    (101.97, "some rows are in gram-force under a header in newtons (1 N is 102 gf)"),
    (1e3, "some rows lack a prefix (N and mN, kN and N)"),
    (1e6, "some rows lack two prefixes (kN and mN)"),
];

/// Rows of one load in two units.
#[derive(Debug, Clone, PartialEq)]
pub struct TwoUnits {
    /// The load.
    pub load: &'static str,
    /// Two rows of one setting, the larger load first; indices into the data.
    pub rows: [usize; 2],
    /// How many times the one group is the other.
    pub factor: f64,
    /// The rows of the group with fewer rows.
    few: Vec<usize>,
}

impl TwoUnits {
    /// What probably happened.
    #[must_use]
    pub fn cause(&self) -> &'static str {
        cause(self.factor).unwrap_or("some rows are in another unit")
    }
}

fn cause(factor: f64) -> Option<&'static str> {
    CAUSES.iter().find(|(by, _)| NEAR_A_UNIT.contains(&(factor / by))).map(|(_, cause)| *cause)
}

/// The first of some loads that stands in two units.
#[must_use]
pub fn found(data: &Dataset, loads: &[&'static str]) -> Option<TwoUnits> {
    let settings = settings(data);
    loads.iter().find_map(|load| of_load(load, data.values(load)?, data, &settings))
}

/// A law describes a load if its relative residual is below this.
const DESCRIBES: f64 = 0.3;
/// Largest RMS residual of these rows, relative to that of the others, at which the law predicts them.
const LIKE_OTHERS: f64 = 4.0;

/// A row that a law predicts lies within this part of the predicted load.
const NEAR_LOAD: f64 = 0.5;

/// Whether one of the laws predicts the rows that look as if they were in another unit.
pub(crate) fn is_predicted(of: &TwoUnits, data: &Dataset, campaign: &Campaign, source: &Source) -> bool {
    let laws = laws(campaign, source, data).unwrap_or_default();
    let settings = Settings::new(&source.name, source.kind, &campaign.identify);
    let predicts = |law: &ForceLaw| {
        let (Some(r), Ok(model)) = (law.responses.iter().position(|l| l == of.load), regress(law, data, settings))
        else {
            return false;
        };
        let left = |i: &usize| {
            let row = r * data.rows + i;
            (model.fit.residuals[row] / (1.0 - model.fit.leverage[row]).max(f64::MIN_POSITIVE)).powi(2)
        };
        // What is in another unit is foretold as many times too large or too small.
        let is_near = |i: &usize| {
            model.fit.residuals[r * data.rows + i].abs() < NEAR_LOAD * model.fit.fitted[r * data.rows + i].abs()
        };
        if !of.few.iter().all(is_near) {
            return false;
        }
        let (few, others): (Vec<usize>, Vec<usize>) = (0..data.rows).partition(|i| of.few.contains(i));
        let mean = |rows: &[usize]| (rows.iter().map(left).sum::<f64>() / rows.len() as f64).sqrt();
        model.fit.components[r].relative_residual < DESCRIBES && mean(&few) <= LIKE_OTHERS * mean(&others)
    };
    laws.iter().filter(|law| !law.in_logarithms()).any(predicts)
}

fn of_load(load: &'static str, f: &[f64], data: &Dataset, settings: &[Vec<usize>]) -> Option<TwoUnits> {
    let speed = data.values("speed");
    let fastest = speed.map_or(0.0, |u| u.iter().fold(0.0_f64, |m, x| m.max(x.abs())));
    // At rest (a rotor's torque) the load itself is compared.
    let u = |i: usize| speed.map(|u| u[i].abs()).filter(|_| fastest > 0.0).unwrap_or(1.0);
    // The upper quartile: one wild row does not make all others small.
    let mut sizes: Vec<f64> = f.iter().map(|x| x.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let small = SIGN_MATTERS_ABOVE * sizes.get(3 * sizes.len() / 4)?;
    settings.iter().find_map(|setting| {
        let mut rows: Vec<(f64, usize)> =
            setting.iter().filter(|&&i| u(i) >= SLOW * fastest).map(|&i| (f[i].abs() / (u(i) * u(i)), i)).collect();
        // Astern, with a speed below zero, a load that resists has the other sign; a lift has not.
        let way = |i: usize| if speed.is_some_and(|u| u[i] < 0.0) { -1.0 } else { 1.0 };
        let has_one_sign = |of: &dyn Fn(usize) -> f64| {
            rows.iter().all(|(_, i)| of(*i) > 0.0) || rows.iter().all(|(_, i)| of(*i) < 0.0)
        };
        let is_one_sided = has_one_sign(&|i| f[i]) || has_one_sign(&|i| way(i) * f[i]);
        if rows.len() < FEWEST_ROWS || !is_one_sided || rows.iter().all(|(_, i)| f[*i].abs() < small) {
            return None;
        }
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        let gap = |k: &usize| rows[*k].0 / rows[*k - 1].0;
        let cut = (1..rows.len()).max_by(|a, b| gap(a).total_cmp(&gap(b)))?;
        let (low, high) = rows.split_at(cut);
        let is_tight = |group: &[(f64, usize)]| group[group.len() - 1].0 < TIGHT * group[0].0;
        let factor = high[high.len() / 2].0 / low[low.len() / 2].0;
        let is_thin = low.len() == 1 || high.len() == 1 || rows.len() < MANY_ROWS;
        if gap(&cut) < APART || !is_tight(low) || !is_tight(high) || (is_thin && cause(factor).is_none()) {
            return None;
        }
        // A zero that nobody subtracted, as large as the load of the slowest row.
        if let [(_, alone)] = low
            && near_zero(high, *alone, f, &u)
        {
            return None;
        }
        let pairs = high.iter().flat_map(|(_, i)| low.iter().map(move |(_, j)| [*i, *j]));
        let apart = |[i, j]: &[usize; 2]| (u(*i) / u(*j)).ln().abs();
        let rows = pairs.min_by(|a, b| apart(a).total_cmp(&apart(b)))?;
        // What is as large as its noise may come near zero by chance: next to such a row others of its speed scatter too.
        let spread = |group: &[(f64, usize)], i: usize| {
            let near = group.iter().filter(|(_, k)| (u(*k) / u(i)).ln().abs() < NEAR.ln()).map(|(c, _)| *c);
            near.clone().fold(0.0, f64::max) / near.fold(f64::INFINITY, f64::min)
        };
        let most = if high.len() >= low.len() { high } else { low };
        if spread(high, rows[0]) > REPEATED || spread(low, rows[1]) > REPEATED || scatter(most, &u) > SCATTER {
            return None;
        }
        let few = if high.len() < low.len() { high } else { low }.iter().map(|(_, i)| *i).collect();
        Some(TwoUnits { load, rows, factor, few })
    })
}

/// Whether the other rows of a setting, by a square of the speed and a zero, foretell such a load: less than half of what their |f|/U² does, or within what they scatter.
fn near_zero(others: &[(f64, usize)], row: usize, f: &[f64], u: &dyn Fn(usize) -> f64) -> bool {
    let n = others.len() as f64;
    let mean = |of: &dyn Fn(usize) -> f64| others.iter().map(|(_, i)| of(*i)).sum::<f64>() / n;
    let (x, y) = (mean(&|i| u(i) * u(i)), mean(&|i| f[i]));
    let variance = mean(&|i| (u(i) * u(i) - x).powi(2));
    // At one speed there is no slope.
    let varies = variance.sqrt() > SETTING_WITHIN * x;
    let slope = if varies { mean(&|i| (u(i) * u(i) - x) * (f[i] - y)) / variance } else { 0.0 };
    let by_speed = |i: usize| y + slope * (u(i) * u(i) - x);
    let dof = n - if varies { 2.0 } else { 1.0 };
    let scatter = (n * mean(&|i| (f[i] - by_speed(i)).powi(2)) / dof).sqrt();
    let foretold = by_speed(row);
    foretold.abs() < 0.5 * others[others.len() / 2].0 * u(row) * u(row)
        || (foretold - f[row]).abs() < coverage_factor(SURE, dof) * (1.0 + 1.0 / n).sqrt() * scatter
}

/// Median |ln| of the ratio of neighbours in speed.
fn scatter(group: &[(f64, usize)], u: &dyn Fn(usize) -> f64) -> f64 {
    let mut rows = group.to_vec();
    rows.sort_by(|a, b| u(a.1).total_cmp(&u(b.1)));
    let mut steps: Vec<f64> = rows.windows(2).map(|pair| (pair[1].0 / pair[0].0).ln().abs()).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(0.0)
}

/// Rows of each setting.
fn settings(data: &Dataset) -> Vec<Vec<usize>> {
    let mut keys = vec![labels(&data.configuration), labels(&data.setup)];
    for (name, channel) in &data.channels {
        if is_outcome(name) || name == "speed" {
            continue;
        }
        let key = within(&channel.values, SETTING_WITHIN);
        let distinct = key.iter().max().map_or(0, |most| most + 1);
        // What differs in nearly every row was measured, not set.
        if known(name) || 2 * distinct <= data.rows {
            keys.push(key);
        }
    }
    let mut by_setting: BTreeMap<Vec<usize>, Vec<usize>> = BTreeMap::new();
    for i in 0..data.rows {
        by_setting.entry(keys.iter().map(|key| key[i]).collect()).or_default().push(i);
    }
    let mut settings: Vec<Vec<usize>> = by_setting.into_values().collect();
    settings.sort();
    settings
}

fn known(name: &str) -> bool {
    froude_records::known_columns::known_dimension(name).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::LOADS;
    use froude_records::units::Dimension;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    /// A drag and a side force with errors of 2 % and of `noise_n`; `factor` of a row is what its loads are written times.
    fn table(seed: u128, noise_n: f64, repeats: usize, angles_deg: &[f64], factor: impl Fn(usize) -> f64) -> Dataset {
        let mut rng = Pcg64::new(seed, 1);
        let mut noise = move || -> f64 { StandardNormal.sample(&mut rng) };
        let mut data = Dataset::default();
        let (mut speed, mut angle, mut x, mut y) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for a in angles_deg {
            for k in 1..=10 {
                for _ in 0..repeats {
                    let (u, a) = (0.1 * f64::from(k) * (1.0 + 0.002 * noise()), a.to_radians());
                    let by = factor(speed.len());
                    speed.push(u);
                    angle.push(a);
                    let mut load = |n: f64| by * (n * (1.0 + 0.02 * noise()) + noise_n * noise());
                    x.push(load(-5.0 * (u * a.cos()).powi(2)));
                    y.push(load(60.0 * u * u * a.sin() * a.sin().abs()));
                }
            }
        }
        data.rows = speed.len();
        for text in [&mut data.configuration, &mut data.setup, &mut data.run] {
            *text = vec![String::new(); data.rows].into();
        }
        data.put("speed", speed, Dimension::SPEED);
        data.put("angle", angle, Dimension::ANGLE);
        data.put("f_x", x, Dimension::FORCE);
        data.put("f_y", y, Dimension::FORCE);
        data
    }

    #[test]
    fn rows_in_gram_force_are_found_however_they_are_mixed() {
        let gf = 101.97;
        for seed in 0..20 {
            let second = table(seed, 0.02, 2, &[0.0], |i| if i % 2 == 0 { gf } else { 1.0 });
            let twice = found(&second, &LOADS).unwrap();
            assert_eq!(
                (twice.load, twice.cause()),
                ("f_x", "some rows are in gram-force under a header in newtons (1 N is 102 gf)")
            );
            let [large, small] = twice.rows.map(|i| second.values("f_x").unwrap()[i].abs());
            assert!(large > 50.0 * small);
            let upper_half = table(seed, 0.02, 1, &[0.0, 10.0], |i| if i % 10 >= 5 { gf } else { 1.0 });
            assert!(found(&upper_half, &LOADS).is_some_and(|t| (t.factor / gf - 1.0).abs() < 0.2), "{seed}");
            let one_row = table(seed, 0.02, 2, &[0.0], |i| if i == 15 { gf } else { 1.0 });
            assert!(found(&one_row, &LOADS).is_some(), "{seed}");
            let milli = table(seed, 0.02, 2, &[0.0], |i| if i % 2 == 0 { 1e3 } else { 1.0 });
            assert_eq!(found(&milli, &LOADS).unwrap().cause(), "some rows lack a prefix (N and mN, kN and N)");
        }
    }

    /// The zero of a setup takes the load of its slowest row nearly away: by chance a hundredth is left.
    #[test]
    fn a_zero_is_no_unit() {
        let mut data = table(1, 0.0, 1, &[0.0], |_| 1.0);
        let speed = data.values("speed").unwrap().to_vec();
        let load = |zero: f64| speed.iter().map(|u| -5.0 * u * u + zero).collect::<Vec<f64>>();
        let slow = 5.0 * speed[3] * speed[3];
        data.put("f_x", load(0.99 * slow), Dimension::FORCE);
        let fast: Vec<usize> = (3..10).collect();
        assert_eq!(found(&data.subset(&fast), &["f_x"]), None);
        let mut one = load(0.0);
        one[3] *= 0.01;
        data.put("f_x", one, Dimension::FORCE);
        assert!(found(&data.subset(&fast), &["f_x"]).is_some());
    }

    /// A load that passes through zero at one speed, as that of a sway does: by chance a hundredth is left of one row.
    #[test]
    fn a_load_within_its_scatter_is_no_unit() {
        let mut data = table(1, 0.0, 1, &[0.0], |_| 1.0);
        data.put("speed", vec![1.0; 10], Dimension::SPEED);
        let load = |of: [f64; 7]| {
            let mut data = data.subset(&(0..7).collect::<Vec<_>>());
            data.put("f_x", of.to_vec(), Dimension::FORCE);
            found(&data, &["f_x"])
        };
        assert_eq!(load([-0.89, -0.8, -0.7, -0.65, -0.75, -0.6, -0.0075]), None);
        assert!(load([-0.89, -0.88, -0.9, -0.885, -0.895, -0.89, -0.0089]).is_some());
    }

    /// Two mounts of one body may load a sensor a hundredfold differently.
    #[test]
    fn two_setups_are_no_two_units() {
        let mut data = table(1, 0.02, 2, &[0.0], |i| if i % 2 == 0 { 101.97 } else { 1.0 });
        assert!(found(&data, &LOADS).is_some());
        data.setup = (0..data.rows).map(|i| if i % 2 == 0 { "sting" } else { "strut" }.to_owned()).collect();
        assert_eq!(found(&data, &LOADS), None);
    }

    /// Clean tables from a good balance to one that sees nothing, 4,000 of them. A load no larger than its noise may fall into two
    /// groups by chance: in simulations once in 10,000 settings, so that two are allowed; a load that is one never.
    #[test]
    fn clean_tables_are_passed_over() {
        let drift: &[f64] = &[-20.0, -10.0, 0.0, 10.0, 20.0];
        for (noise_n, allowed) in [(0.002, 0), (0.02, 0), (0.2, 2), (2.0, 2)] {
            let alarms = (0..500)
                .flat_map(|seed| [table(seed, noise_n, 2, drift, |_| 1.0), table(seed, noise_n, 3, &[0.0], |_| 1.0)])
                .filter(|clean| found(clean, &LOADS).is_some())
                .count();
            assert!(alarms <= allowed, "{noise_n} N: {alarms} of 1000");
        }
    }

    /// The angle is not in the table: the side force of rows that look alike goes through zero.
    #[test]
    fn a_setting_that_the_table_does_not_say_is_no_unit() {
        for seed in 0..200 {
            let mut data = table(seed, 0.02, 2, &[-20.0, -15.0, -10.0, -5.0, 0.0, 5.0, 10.0, 15.0, 20.0], |_| 1.0);
            data.channels.shift_remove("angle");
            assert_eq!(found(&data, &LOADS), None, "{seed}");
            let mut one_side = table(seed, 0.02, 2, &[0.0, 5.0, 10.0, 15.0, 20.0], |_| 1.0);
            one_side.channels.shift_remove("angle");
            assert_eq!(found(&one_side, &LOADS), None, "{seed}");
        }
    }
}
