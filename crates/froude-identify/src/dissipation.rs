//! Whether a fitted law can deliver power to the body, and the constraint that it must not.
//!
//! Power f·v is linear in the coefficients, so "no power at these velocities" is
//! one linear inequality per velocity.

use froude_fit::Constraint;
use froude_hydro::dissipation::VelocityGrid;

use crate::dataset::Dataset;
use crate::error::IdentifyError;
use crate::law::ForceLaw;

/// A power below this part of |f||v| is the rounding of its sum.
const ROUNDING: f64 = 1e-12;

/// Velocities over ±(largest speed), down to a thousandth of it, for the shortest and the longest configuration.
///
/// The force is affine in the number of links, so what holds at both ends holds between them.
///
/// Speeds in m/s, angles in rad; 184 directions by 31 levels (see [`VelocityGrid`]).
#[must_use]
pub fn grid(data: &Dataset) -> Dataset {
    let largest = data.values("speed").map_or(0.0, |u| u.iter().fold(0.0_f64, |m, u| m.max(u.abs())));
    let velocities: Vec<[f64; 2]> = VelocityGrid::over(largest).points().collect();
    let links = |i: usize| data.values("n_links").map_or(0.0, |v| v[i]);
    let ends = [
        (0..data.rows).min_by(|&a, &b| links(a).total_cmp(&links(b))),
        (0..data.rows).max_by(|&a, &b| links(a).total_cmp(&links(b))),
    ];
    let mut ends: Vec<usize> = ends.into_iter().flatten().collect();
    ends.dedup_by_key(|i| links(*i).to_bits());
    let rows: Vec<usize> = ends.iter().flat_map(|&s| std::iter::repeat_n(s, velocities.len())).collect();
    let mut out = data.subset(&rows);
    let of = |axis: usize| ends.iter().flat_map(|_| velocities.iter().map(move |v| v[axis])).collect();
    out.put("v_x", of(0), froude_records::units::Dimension::SPEED);
    out.put("v_y", of(1), froude_records::units::Dimension::SPEED);
    out.speed_and_angle_from_velocity();
    out
}

/// Largest power f·v delivered to the body over the grid, W: at most zero where the law resists everywhere.
///
/// P = f_x·v_x + f_y·v_y with forces in N and velocities in m/s. `coefficients` are in SI, in the order of the law. A grid proves nothing between its points.
///
/// # Errors
///
/// A channel that the law needs and the data lack.
pub fn largest_power_w(law: &ForceLaw, data: &Dataset, coefficients: &[f64]) -> Result<f64, IdentifyError> {
    let grid = grid(data);
    let force = law.predict(&grid, coefficients)?;
    let n = grid.rows;
    let mut largest = f64::NEG_INFINITY;
    for i in 0..n {
        let v = grid.velocity_m_s(i);
        let (mut power, mut size) = (0.0, 0.0);
        for (r, name) in law.responses.iter().enumerate() {
            let speed = along(name, v);
            power += force[r * n + i] * speed;
            size += (force[r * n + i] * speed).abs();
        }
        // What is only rounding counts as none.
        largest = largest.max(if power <= ROUNDING * size { power.min(0.0) } else { power });
    }
    Ok(largest)
}

/// Rows `power(v)·β ≤ 0` over the grid, for `p` coefficients (offsets take no part).
///
/// A row holds Σ v_r ∂f_r/∂β_j at one velocity, W per unit of coefficient j in SI.
///
/// # Errors
///
/// A channel that the law needs and the data lack.
pub fn constraints(law: &ForceLaw, data: &Dataset, p: usize) -> Result<Vec<Constraint>, IdentifyError> {
    let grid = grid(data);
    let x = law.regressors(&grid, &vec![0.0; law.coefficients.len()])?;
    let n = grid.rows;
    let mut out = Vec::new();
    for i in 0..n {
        let v = grid.velocity_m_s(i);
        let mut row = vec![0.0; p];
        for (r, name) in law.responses.iter().enumerate() {
            let speed = along(name, v);
            for (j, value) in row.iter_mut().enumerate().take(law.coefficients.len()) {
                *value += speed * x[(r * n + i, j)];
            }
        }
        let size = row.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        if size > 0.0 {
            for x in &mut row {
                *x /= size;
            }
            out.push(Constraint { row, value: 0.0 });
        }
    }
    Ok(out)
}

/// The speed along a load's axis; loads about an axis give no power here.
fn along(load: &str, [v_x, v_y]: [f64; 2]) -> f64 {
    match load {
        "f_x" => v_x,
        "f_y" => v_y,
        _ => 0.0,
    }
}
