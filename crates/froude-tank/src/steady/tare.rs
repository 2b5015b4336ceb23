//! The rig without its body, towed alike (role `tare`) and subtracted at the same speed and angle.
//!
//! y ← y − (U/U_t)² t with t the mean load of the tares at that setting: what speed they differ by, 2 % at most, is taken as that of quadratic drag.
//! The error of t is one that all observations of the setting share.

use froude_identify::uncertainty::SharedError;

use super::point::Point;
use super::row::Row;
use crate::error::TankError;

/// Speeds alike, as part of them.
const SAME_SPEED: f64 = 0.02;
/// Angles alike, rad.
const SAME_ANGLE_RAD: f64 = 0.0175;

/// A tare, reduced as any run is.
#[derive(Debug, Clone, PartialEq)]
pub struct Tare {
    /// Its angle, rad.
    pub angle_rad: f64,
    /// Its observation.
    pub point: Point,
}

/// Subtracts the tares from the observations; what their errors do is returned.
///
/// # Errors
///
/// The first observation without one.
pub fn subtract(points: &mut [Row], tares: &[Tare], source: &str) -> Result<Vec<SharedError>, TankError> {
    // Tares of one setting are a group; observations name theirs.
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut uses: Vec<(usize, f64)> = Vec::new();
    for Row { run, angle_rad, point, .. } in points.iter() {
        let is_alike = |tare: &Tare| {
            (tare.point.speed_m_s / point.speed_m_s - 1.0).abs() <= SAME_SPEED
                && (tare.angle_rad - angle_rad).abs() <= SAME_ANGLE_RAD
        };
        let own: Vec<usize> = (0..tares.len()).filter(|&t| is_alike(&tares[t])).collect();
        if own.is_empty() {
            let away = |t: &&Tare| {
                (t.point.speed_m_s - point.speed_m_s).abs() / point.speed_m_s.abs() + (t.angle_rad - angle_rad).abs()
            };
            let nearest = tares.iter().min_by(|a, b| away(a).total_cmp(&away(b))).map_or_else(String::new, |t| {
                format!("{:.4} m/s, {:.2} deg", t.point.speed_m_s, t.angle_rad.to_degrees())
            });
            let what = format!(
                "no run of the role \"tare\" is at its speed and angle ({:.4} m/s, {:.2} deg); the nearest is at {nearest}; tow the rig without the body there, \
                 or subtract a fitted tare (tare = {{ record = \"…\" }})",
                point.speed_m_s,
                angle_rad.to_degrees()
            );
            return Err(TankError::of_run(run, what));
        }
        let speed = own.iter().map(|&t| tares[t].point.speed_m_s).sum::<f64>() / own.len() as f64;
        let ratio = (point.speed_m_s / speed).powi(2);
        let group = groups.iter().position(|g| *g == own).unwrap_or_else(|| {
            groups.push(own);
            groups.len() - 1
        });
        uses.push((group, ratio));
    }
    let n = points.len();
    let n_loads = points.first().map_or(0, |row| row.point.loads.len());
    let mut errors = Vec::new();
    for (g, group) in groups.iter().enumerate() {
        let of_group = |i: usize| uses[i].0 == g;
        for l in 0..n_loads {
            let (value, standard, dof) = pooled(group.iter().map(|&t| &tares[t].point.loads[l]));
            let name = points[0].point.loads[l].name.clone();
            for i in (0..n).filter(|&i| of_group(i)) {
                points[i].point.loads[l].value -= uses[i].1 * value;
            }
            let column: Vec<f64> = (0..n).map(|i| if of_group(i) { -uses[i].1 } else { 0.0 }).collect();
            let words = format!("tare of {source} at {:.3} m/s", tares[group[0]].point.speed_m_s);
            errors.push(SharedError::of_load(&words, &name, &column, standard, dof));
        }
    }
    Ok(errors)
}

/// Mean of tares of one setting, its standard uncertainty and the degrees of freedom of that: from run to run where there are several.
fn pooled<'a>(loads: impl Iterator<Item = &'a super::point::Load>) -> (f64, f64, f64) {
    let loads: Vec<_> = loads.collect();
    let n = loads.len() as f64;
    let value = loads.iter().map(|l| l.value).sum::<f64>() / n;
    let within = (loads.iter().map(|l| l.standard.powi(2)).sum::<f64>() / n / n).sqrt();
    if loads.len() < 2 {
        return (value, within, (loads[0].read.effective_n - 1.0).max(1.0));
    }
    let between = (loads.iter().map(|l| (l.value - value).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt();
    let effective = loads.iter().map(|l| (l.read.effective_n - 1.0).max(1.0)).sum();
    if between > within { (value, between, n - 1.0) } else { (value, within, effective) }
}
