//! The drag law of a whole robot, shared out among its modules, so that together they have the fitted force when all move alike.
//!
//! | distribution | who has what | what it keeps |
//! | --- | --- | --- |
//! | `Uniform` | every module the n-th part of every term | if the whole takes power from the body at every speed, so does each module |
//! | `ByOrigin` | terms of links (k G_T, k G_N) the links, those of head and tail (G_HT) by their side areas across and half each along, those of all modules every module alike; cross terms (G_XY) every module alike, since the law does not say whose they are | what the law means; single modules may gain power |
//!
//! Turning about a module's centre is told apart from the drag across it by `Torque`: strips (no torque of its own), strips of the friction along it as USR eq. 8 prints them,
//! λ₂ = c₁ l²/3 and λ₃ = c₂ l³/4 with c of the skin friction of links (terms with G_T), or the same of the drag across.
//!
//! **Units.** SI. **Source.** USR eq. 8 to 14; the distributions are ours.

use froude_hydro::drag::{Axis, CrossTerm, DragModel, Factor, Motion, Setting};

use crate::drag::{Cross, LinkDrag, Turning};

/// Who has which part of a law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Distribution {
    /// Every module the same.
    #[default]
    Uniform,
    /// Head, links and tail what is theirs.
    ByOrigin,
}

/// How the turning of a module is resisted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Torque {
    /// By the strips of its drag across.
    #[default]
    Strip,
    /// At its centre, by its skin friction.
    Friction,
    /// At its centre, by its drag across.
    CrossFlow,
    /// Not at all.
    None,
}

/// ε where a law is stated as printed, which jumps at broadside, m/s.
pub const SMOOTH_M_S: f64 = 1e-3;

/// Drag of each of the k + 2 modules of a robot, head first; `coefficients` are in the order of the model.
#[must_use]
pub fn shares(
    model: DragModel,
    setting: &Setting,
    coefficients: &[f64],
    (distribution, torque): (Distribution, Torque),
) -> Vec<LinkDrag> {
    let modules = setting.n_links.round() as usize + 2;
    (0..modules).map(|i| share(model, setting, coefficients, torque, |of| part(distribution, of, i, setting))).collect()
}

/// What module i has of a term.
fn part(distribution: Distribution, of: Factor, i: usize, setting: &Setting) -> f64 {
    let modules = setting.n_links.round() as usize + 2;
    let (head, both) = (setting.body.head_side_area_m2, setting.body.head_tail_side_area_m2());
    let is_end = i == 0 || i + 1 == modules;
    match (distribution, of) {
        (Distribution::ByOrigin, Factor::LinksGT | Factor::LinksGN) if is_end => 0.0,
        (Distribution::ByOrigin, Factor::LinksGT | Factor::LinksGN) => 1.0 / (modules - 2) as f64,
        (Distribution::ByOrigin, Factor::GHTy) if is_end && both > 0.0 => {
            if i == 0 {
                head / both
            } else {
                1.0 - head / both
            }
        }
        (Distribution::ByOrigin, Factor::GHTx | Factor::GHTy) => {
            if is_end {
                0.5
            } else {
                0.0
            }
        }
        _ => 1.0 / modules as f64,
    }
}

fn share(
    model: DragModel,
    setting: &Setting,
    coefficients: &[f64],
    torque: Torque,
    part: impl Fn(Factor) -> f64,
) -> LinkDrag {
    let (mut along, mut across, mut cross, mut skin) = ([0.0; 2], [0.0; 2], [0.0; 2], [0.0; 2]);
    for (info, c) in model.coefficients().iter().zip(coefficients) {
        let size = c * info.factor.value(setting) * part(info.factor);
        let [linear, quadratic] = match info.motion {
            Motion::LinearAndQuadratic => [size * setting.v_ref_m_s, size],
            Motion::Linear => [size, 0.0],
            Motion::Quadratic => [0.0, size],
            // The paper's linear cross term pushes.
            Motion::CrossLinear => {
                cross[0] -= size;
                continue;
            }
            Motion::CrossQuadratic => {
                cross[1] += size;
                continue;
            }
        };
        let to = if info.axis == Axis::X { &mut along } else { &mut across };
        to[0] += linear;
        to[1] += quadratic;
        if matches!(info.factor, Factor::ModulesGT | Factor::LinksGT) {
            skin[0] += linear;
            skin[1] += quadratic;
        }
    }
    let l = setting.body.link.half_length_m;
    let strips = |c: [f64; 2]| Turning::Lumped([c[0] * l * l / 3.0, c[1] * l.powi(3) / 4.0]);
    let smooth_m_s = match setting.cross_term {
        CrossTerm::Smooth { epsilon_m_s } => epsilon_m_s,
        CrossTerm::AsPrinted => SMOOTH_M_S,
    };
    LinkDrag {
        along,
        across,
        cross: (cross != [0.0; 2]).then_some(Cross { of_speed: cross, smooth_m_s }),
        turning: match torque {
            Torque::Strip => Turning::Strip,
            Torque::Friction => strips(skin),
            Torque::CrossFlow => strips(across),
            Torque::None => Turning::Lumped([0.0; 2]),
        },
    }
}

/// The largest power that a module gains from still water, over its velocities up to a range, m/s, with the velocity: `None` where it gains none.
///
/// A grid is no proof between its points. A law none of whose terms pushes needs none.
#[must_use]
pub fn gains(drag: &LinkDrag, range_m_s: f64) -> Option<(f64, [f64; 2])> {
    let cross = drag.cross.map_or([0.0; 2], |cross| cross.of_speed);
    if [drag.along, drag.across, cross].concat().iter().all(|c| *c >= 0.0) {
        return None;
    }
    let grid = froude_hydro::dissipation::VelocityGrid::over(range_m_s);
    // Its levels are the outermost one, drawn in.
    let outermost: Vec<[f64; 2]> = grid.points().take(grid.n_directions).collect();
    (0..grid.n_levels)
        .flat_map(|level| {
            let part = 10_f64.powf(-(level as f64) / 10.0);
            outermost.iter().map(move |v| v.map(|x| x * part))
        })
        .map(|velocity| (drag.power_w(velocity), velocity))
        .filter(|(power, _)| *power > 0.0)
        .max_by(|a, b| a.0.total_cmp(&b.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use froude_hydro::{Body, Link};

    fn setting(n_links: f64) -> Setting {
        let link = Link { major_semi_axis_m: 0.0588, minor_semi_axis_m: 0.0394, half_length_m: 0.09 };
        let body = Body { link, head_side_area_m2: 0.011, tail_side_area_m2: 0.008 };
        let cross_term = CrossTerm::Smooth { epsilon_m_s: 1e-3 };
        Setting { cross_term, ..Setting::as_published(body, n_links, 1025.0) }
    }

    /// f4 of the tank, Table 9, in the order of the model.
    fn f4_of_the_tank() -> Vec<f64> {
        let table = [
            ("C_d_II", 1.4272),
            ("C_f_II", 0.0133),
            ("C_fHT_I", 0.0148),
            ("C_dHT_I", 0.1769),
            ("C_fHT_II", 0.2451),
            ("C_dHT_II", 1.1770),
            ("C_XY_I", 0.0351),
            ("C_XY_II", 0.4612),
        ];
        DragModel::F4
            .coefficients()
            .iter()
            .map(|info| table.iter().find(|(name, _)| *name == info.name).map_or(0.0, |(_, c)| *c))
            .collect()
    }

    /// Whatever the law and the distribution, modules that move alike have the whole robot's force.
    #[test]
    fn modules_that_move_alike_have_the_force_of_the_whole() {
        for model in [DragModel::F1, DragModel::F2, DragModel::F3, DragModel::F4, DragModel::F5, DragModel::F6] {
            let c: Vec<f64> = (0..model.coefficients().len()).map(|j| 0.3 + 0.1 * j as f64).collect();
            for distribution in [Distribution::Uniform, Distribution::ByOrigin] {
                let all = shares(model, &setting(4.0), &c, (distribution, Torque::Strip));
                assert_eq!(all.len(), 6);
                for v in [[0.3, -0.2], [-0.1, 0.4], [0.0, 0.2], [0.25, 0.0]] {
                    let whole = model.force_n(&setting(4.0), v, &c);
                    let sum = all
                        .iter()
                        .map(|d| d.load(0.09, [0.0, v[0], v[1]]))
                        .fold([0.0; 2], |s, f| [s[0] + f[1], s[1] + f[2]]);
                    for k in 0..2 {
                        // A sum of sixty products.
                        assert!((sum[k] - whole[k]).abs() < 1e-12 * (1.0 + whole[k].abs()), "{model:?} {v:?}");
                    }
                }
            }
        }
    }

    /// The published f4 of the tank takes power at every speed as a whole and in equal shares; by origin, the plain links have cross terms without the ends' friction along them.
    #[test]
    fn single_modules_by_origin_gain_power_where_the_whole_does_not() {
        let c = f4_of_the_tank();
        let uniform = shares(DragModel::F4, &setting(8.0), &c, (Distribution::Uniform, Torque::Strip));
        assert!(uniform.iter().all(|d| gains(d, 0.5).is_none()));
        let by_origin = shares(DragModel::F4, &setting(8.0), &c, (Distribution::ByOrigin, Torque::Strip));
        let (power, [u, v]) = gains(&by_origin[3], 0.5).unwrap();
        assert!(power > 0.0 && u != 0.0 && v != 0.0);
        assert!(gains(&by_origin[0], 0.5).is_none());
    }
}
