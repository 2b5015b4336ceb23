//! A number a load, known at some settings and wanted at all: over ½ρU²A (and the length, of moments), linear in the angle.
//!
//! What a mesh does to a force is a property of the flow's shape, which turns with the angle; it grows with ½ρU²A as the force does, and little else changes with the speed. It is absolute and not a part of the force, which is zero at some angle where the mesh's error is not. So values at one angle are averaged over speeds, angles between are interpolated, those beyond the last take the last. What that leaves shows in [`OverAngles::left_out`].

use crate::case::{Case, Model};
use crate::outcome::Loads;

/// Values over ½ρU²A at some settings \[-\].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OverAngles {
    points: Vec<Point>,
}

/// A setting, and what is known there.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// The case.
    pub case: Case,
    /// Over ½ρU²A, of moments also over the length \[-\].
    pub values: Loads,
}

impl OverAngles {
    /// Of loads at settings, N and N m.
    #[must_use]
    pub fn new(loads: impl IntoIterator<Item = (Case, Loads)>) -> Self {
        let point = |(case, loads): (Case, Loads)| {
            let scales = case.load_scales();
            Point { values: each(|k| loads[k] / scales[k]), case }
        };
        Self { points: loads.into_iter().map(point).collect() }
    }

    /// Where they are known.
    #[must_use]
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// The loads at the setting of a case, N and N m; `None` where nothing is known.
    ///
    /// By the settings of its configuration and model where there are some, else by those of its model, else by all.
    #[must_use]
    pub fn at(&self, case: &Case) -> Option<Loads> {
        let all: Vec<&Point> = self.points.iter().collect();
        let scales = case.load_scales();
        interpolated(&all, case).map(|values| each(|k| values[k] * scales[k]))
    }

    /// How far the value at a setting is from what the others give for it, over ½ρU²A: root mean square over the settings. `None` where there are fewer than two.
    ///
    /// A setting at the end of the angles is then extrapolated, and one between others lies in a gap twice as wide, so this is on the safe side.
    #[must_use]
    pub fn left_out(&self) -> Option<Loads> {
        let misses: Vec<Loads> = (0..self.points.len()).filter_map(|i| self.miss(i)).collect();
        (!misses.is_empty())
            .then(|| each(|k| (misses.iter().map(|m| m[k] * m[k]).sum::<f64>() / misses.len() as f64).sqrt()))
    }

    fn miss(&self, left_out: usize) -> Option<Loads> {
        let others: Vec<&Point> =
            self.points.iter().enumerate().filter(|(i, _)| *i != left_out).map(|(_, point)| point).collect();
        let own = self.points.get(left_out)?;
        interpolated(&others, &own.case).map(|values| each(|k| values[k] - own.values[k]))
    }
}

/// Six numbers.
pub(crate) fn each(of: impl Fn(usize) -> f64) -> Loads {
    core::array::from_fn(of)
}

fn interpolated(points: &[&Point], case: &Case) -> Option<Loads> {
    let is_laminar = |c: &Case| c.model == Model::Laminar;
    let is_model = |p: &&&Point| is_laminar(&p.case) == is_laminar(case);
    let is_own = |p: &&&Point| is_model(p) && p.case.configuration == case.configuration;
    let mut chosen: Vec<&Point> = points.iter().filter(is_own).copied().collect();
    if chosen.is_empty() {
        chosen = points.iter().filter(is_model).copied().collect();
    }
    if chosen.is_empty() {
        chosen = points.to_vec();
    }
    // Of several planes the nearest.
    let off = |p: &Point| (p.case.flow.pitch_rad - case.flow.pitch_rad).abs();
    let nearest = chosen.iter().map(|p| off(p)).fold(f64::INFINITY, f64::min);
    chosen.retain(|p| off(p) <= nearest + SAME_RAD);
    let angles = means(chosen);
    let at = case.flow.angle_rad;
    let behind = angles.partition_point(|(angle, _)| *angle <= at);
    let (low, high) = (angles.get(behind.wrapping_sub(1)).or(angles.first())?, angles.get(behind).or(angles.last())?);
    let width = high.0 - low.0;
    let part = if width > 0.0 { (at - low.0) / width } else { 0.0 };
    Some(each(|k| low.1[k] + part * (high.1[k] - low.1[k])))
}

/// Angles closer than this are one.
const SAME_RAD: f64 = 1e-9;

/// By angle, the mean over what is known at it.
fn means(mut points: Vec<&Point>) -> Vec<(f64, Loads)> {
    points.sort_by(|a, b| a.case.flow.angle_rad.total_cmp(&b.case.flow.angle_rad));
    let groups = points.chunk_by(|a, b| b.case.flow.angle_rad - a.case.flow.angle_rad <= SAME_RAD);
    let mean = |group: &[&Point]| each(|k| group.iter().map(|p| p.values[k]).sum::<f64>() / group.len() as f64);
    groups.filter_map(|group| Some((group.first()?.case.flow.angle_rad, mean(group)))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{Flow, Reference, Stop, Water};

    fn case(configuration: &str, speed_m_s: f64, angle_rad: f64) -> Case {
        Case {
            id: format!("{configuration}-u{speed_m_s}-a{angle_rad}"),
            configuration: configuration.to_owned(),
            mesh: String::new(),
            is_half: true,
            flow: Flow { speed_m_s, angle_rad, pitch_rad: 0.0 },
            water: Water { density_kg_m3: 1000.0, viscosity_m2_s: 1e-6 },
            model: Model::Laminar,
            stop: Stop { iterations: 10, window: 5, drift: 1e-3, spread: 1e-2 },
            reference: Reference { length_m: 2.0, width_m: 0.1, area_m2: 0.5, point_m: [0.0; 3] },
            start_from: None,
        }
    }

    fn known(settings: &[(&str, f64, f64)], law: impl Fn(&str, f64) -> f64) -> OverAngles {
        OverAngles::new(settings.iter().map(|&(configuration, speed, angle)| {
            let case = case(configuration, speed, angle);
            let scales = case.load_scales();
            let loads = each(|k| scales[k] * law(configuration, angle));
            (case, loads)
        }))
    }

    /// ½·1000·0.2²·0.5 = 10 N and 20 N m.
    #[test]
    fn a_value_that_is_linear_in_the_angle_is_found_at_every_angle_and_speed() {
        let found =
            known(&[("H1LT", 0.1, 0.0), ("H1LT", 0.4, 0.0), ("H1LT", 0.3, 1.5)], |_, angle| 0.02 - 0.01 * angle);
        let at = |speed, angle| found.at(&case("H1LT", speed, angle)).unwrap();
        let [f_x, .., m_z] = at(0.2, 0.6);
        assert!((f_x - 10.0 * 0.014).abs() < 1e-12 && (m_z - 20.0 * 0.014).abs() < 1e-12, "{f_x} {m_z}");
        // Beyond the last the last.
        assert!((at(0.2, 1.7)[1] - 10.0 * 0.005).abs() < 1e-12);
        assert!(OverAngles::default().at(&case("H1LT", 0.2, 0.0)).is_none());
    }

    #[test]
    fn a_configuration_goes_by_its_own_settings_and_by_those_of_others_where_it_has_none() {
        let law = |c: &str, _| if c == "H1LT" { 0.01 } else { 0.03 };
        let found = known(&[("H1LT", 0.4, 0.0), ("H2LT", 0.4, 0.0)], law);
        let at = |c: &str| found.at(&case(c, 0.2, 0.5)).unwrap()[0] / 10.0;
        assert!((at("H1LT") - 0.01).abs() < 1e-12 && (at("H2LT") - 0.03).abs() < 1e-12);
        assert!((at("H3LT") - 0.02).abs() < 1e-12);
    }

    /// Values 0, 1, 0 at equal steps miss by 1 each: the ends take their neighbour, the middle the mean of the ends.
    #[test]
    fn what_is_left_out_is_missed_by_what_its_neighbours_do_not_know() {
        let settings = [("H1LT", 0.4, 0.0), ("H1LT", 0.4, 0.5), ("H1LT", 0.4, 1.0)];
        let found = known(&settings, |_, angle| if angle == 0.5 { 1.0 } else { 0.0 });
        assert!(found.left_out().unwrap().iter().all(|miss| (miss - 1.0).abs() < 1e-12));
        assert!(known(&settings, |_, _| 0.3).left_out().unwrap().iter().all(|miss| miss.abs() < 1e-12));
        assert!(known(&settings[..1], |_, _| 0.3).left_out().is_none());
    }
}
