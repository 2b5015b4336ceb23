//! The least-squares problem of a law: columns, response, weights.

use froude_fit as fit;
use froude_records::campaign::{AngleOffset, Identify};
use froude_records::texts::Texts;

use crate::dataset::{Dataset, distinct, labels};
use crate::error::IdentifyError;
use crate::law::thrust::COEFFICIENTS;
use crate::law::{CoefficientSpec, ForceLaw};
use crate::regression::settings::{Settings, Weight};

/// Dead bands that the iteration of a thruster may start at, up to this part of the largest command.
const DEAD_BANDS: u32 = 64;
const DEAD_BAND_TO: f64 = 0.9;

/// Logarithms of the loads, for the error model "every point has the same relative error".
pub(crate) fn logarithms(
    law: &ForceLaw,
    newtons: &[f64],
    data: &Dataset,
    settings: Settings<'_>,
) -> Result<Vec<f64>, IdentifyError> {
    let crate::law::Kind::PowerLaw { channel, .. } = &law.kind else { return Ok(newtons.to_vec()) };
    let v = data.values(channel).unwrap_or_default();
    newtons
        .iter()
        .zip(v)
        .enumerate()
        .map(|(i, (f, v))| {
            if !data.observes(&law.responses[0], i) {
                Ok(0.0)
            } else if f * v < 0.0 {
                Ok(f.abs().ln())
            } else {
                Err(IdentifyError::Campaign {
                    place: format!("source {:?}, model {}", settings.source_name, law.name),
                    what: format!(
                        "a fit in logarithms needs a load that opposes the motion in every row; on {} \
                         {channel} is {v} and the load {f}: leave the row out with `keep`, or use power_law",
                        data.row_name(i)
                    ),
                })
            }
        })
        .collect()
}

/// Setups or groups that have an offset of their own, and that of each row.
#[derive(Default)]
pub(crate) struct Offsets {
    pub(crate) names: Vec<String>,
    of_row: Vec<usize>,
}

impl Offsets {
    fn of(texts: &Texts) -> Self {
        Self { names: distinct(texts), of_row: labels(texts) }
    }

    /// Setups whose angle offset is estimated.
    pub(crate) fn of_setups(law: &ForceLaw, data: &Dataset, identify: &Identify) -> Self {
        let both_loads = law.responses == ["f_x", "f_y"];
        // A row is turned with both of its loads.
        let is_whole = law.responses.iter().all(|load| !data.observed.contains_key(load));
        let is_asked = identify.angle_offset == AngleOffset::Estimate && both_loads && is_whole;
        if is_asked { Self::of(&data.setup) } else { Self::default() }
    }

    /// Groups that have an offset in each load, of `group_offset = "estimate"`; none for a law that is fitted by steps, whose start knows no
    /// offset.
    pub(crate) fn of_groups(law: &ForceLaw, data: &Dataset, identify: &Identify) -> Self {
        let group = data.group.as_ref().filter(|_| identify.group_offset && !law.is_nonlinear());
        group.map_or_else(Self::default, Self::of)
    }
}

/// The stacked, weighted linear problem at the current coefficients.
///
/// With an angle offset δ between sensor and body, f_sensor = Rᵀ(δ) f_body: the measured pair is rotated
/// back by the current δ, and the columns of dδ are (f_y, −f_x) of the current fit.
pub(crate) fn problem(
    law: &ForceLaw,
    data: &Dataset,
    specs: &[CoefficientSpec],
    measured: &[f64],
    weight: Option<Vec<f64>>,
    (setups, groups): (&Offsets, &Offsets),
    beta: &[f64],
) -> Result<fit::Problem, IdentifyError> {
    let n = data.rows;
    let p = law.coefficients.len();
    let mut design = law.regressors(data, &beta[..p])?;
    // What a linear law gives at the current coefficients is asked by the angle offset alone.
    let is_asked = law.is_nonlinear() || !setups.names.is_empty();
    let mut current = if is_asked { law.predict(data, &beta[..p])? } else { Vec::new() };
    if law.in_logarithms() {
        for i in 0..measured.len() {
            for j in 0..p {
                design[(i, j)] /= current[i];
            }
            current[i] = current[i].abs().ln();
        }
    }
    if specs.len() > p {
        design.resize_with(measured.len(), specs.len(), |_, _| 0.0);
    }
    let mut response = measured.to_vec();
    if law.is_nonlinear() {
        for i in 0..response.len() {
            let linear: f64 = (0..p).map(|j| design[(i, j)] * beta[j]).sum();
            response[i] += linear - current[i];
        }
    }
    if !setups.names.is_empty() {
        for i in 0..n {
            let s = setups.of_row[i];
            let (sin, cos) = beta[p + s].sin_cos();
            let (x, y) = (measured[i], measured[n + i]);
            response[i] = cos * x - sin * y;
            response[n + i] = sin * x + cos * y;
            design[(i, p + s)] = current[n + i];
            design[(n + i, p + s)] = -current[i];
            // Solved for the whole offset, so that a fixed value or a prior means the offset and not its last step.
            response[i] += beta[p + s] * design[(i, p + s)];
            response[n + i] += beta[p + s] * design[(n + i, p + s)];
        }
    }
    if !groups.names.is_empty() {
        let first = p + setups.names.len();
        for row in 0..measured.len() {
            design[(row, first + row / n * groups.names.len() + groups.of_row[row % n])] = 1.0;
        }
    }
    for row in (0..measured.len()).filter(|row| !data.observes(&law.responses[row / n], row % n)) {
        response[row] = 0.0;
        design.row_mut(row).fill(0.0);
    }
    let component: Vec<usize> = (0..measured.len()).map(|row| row / n).collect();
    Ok(fit::Problem {
        design,
        response,
        weight,
        component,
        components: law.responses.clone(),
        cluster: data.group.as_ref().map(|g| {
            let of_row = labels(g);
            (0..measured.len()).map(|row| of_row[row % n]).collect()
        }),
        names: specs.iter().map(|s| s.name.clone()).collect(),
    })
}

/// Weights of the rows, 0 where a load was not measured; `None` where all are one.
pub(crate) fn weights(law: &ForceLaw, data: &Dataset, weight: Weight) -> Result<Option<Vec<f64>>, IdentifyError> {
    let of_std = of_std(law, data, weight)?;
    if !law.responses.iter().any(|load| data.observed.contains_key(load)) {
        return Ok(of_std);
    }
    let n = data.rows;
    let mut out = of_std.unwrap_or_else(|| vec![1.0; law.responses.len() * n]);
    for (r, load) in law.responses.iter().enumerate() {
        let own = &mut out[r * n..(r + 1) * n];
        for (i, w) in own.iter_mut().enumerate() {
            *w = if data.observes(load, i) { *w } else { 0.0 };
        }
        let count = own.iter().filter(|w| **w > 0.0).count().max(1) as f64;
        let mean = own.iter().sum::<f64>() / count;
        for w in own.iter_mut() {
            *w /= mean;
        }
    }
    Ok(Some(out))
}

/// Relative weights from `std_*` columns, scaled so that their mean is one within a response.
fn of_std(law: &ForceLaw, data: &Dataset, weight: Weight) -> Result<Option<Vec<f64>>, IdentifyError> {
    let stds: Vec<Option<&[f64]>> = law.responses.iter().map(|r| data.values(&format!("std_{r}"))).collect();
    if weight == Weight::One || stds.iter().all(Option::is_none) {
        return Ok(None);
    }
    let mut out = Vec::with_capacity(stds.len() * data.rows);
    for (std, response) in stds.into_iter().zip(&law.responses) {
        let Some(std) = std else {
            out.extend(std::iter::repeat_n(1.0, data.rows));
            continue;
        };
        if let Some(i) = (0..std.len()).find(|&i| std[i] <= 0.0 && data.observes(response, i)) {
            return Err(IdentifyError::Campaign {
                place: format!("model {}", law.name),
                what: format!(
                    "std_{response} on {} is {}: a weight needs a standard deviation above zero",
                    data.row_name(i),
                    std[i]
                ),
            });
        }
        // A logarithm has the relative standard deviation.
        let loads = data.values(response).unwrap_or_default();
        let weight: Vec<f64> = std
            .iter()
            .zip(loads)
            .enumerate()
            .map(|(i, (s, f))| {
                if !data.observes(response, i) {
                    0.0
                } else if law.in_logarithms() {
                    (f / s).powi(2)
                } else {
                    1.0 / (s * s)
                }
            })
            .collect();
        let mean = weight.iter().sum::<f64>() / weight.len() as f64;
        out.extend(weight.iter().map(|w| w / mean));
    }
    Ok(Some(out))
}

/// Where the iteration starts: zero for linear laws, the log–log line for the power law.
pub(crate) fn start(law: &ForceLaw, data: &Dataset, measured: &[f64], p: usize) -> Vec<f64> {
    let mut beta = vec![0.0; p];
    if let crate::law::Kind::PowerLaw { channel, .. } = &law.kind
        && let Some(v) = data.values(channel)
    {
        let points: Vec<(f64, f64)> = v
            .iter()
            .zip(measured)
            .filter(|(v, f)| v.abs() > 0.0 && **v * **f < 0.0)
            .map(|(v, f)| (v.abs().ln(), f.abs().ln()))
            .collect();
        let count = points.len() as f64;
        let (mx, my) =
            (points.iter().map(|p| p.0).sum::<f64>() / count, points.iter().map(|p| p.1).sum::<f64>() / count);
        let sxx: f64 = points.iter().map(|p| (p.0 - mx).powi(2)).sum();
        let sxy: f64 = points.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum();
        let n = if sxx > 0.0 { sxy / sxx } else { 2.0 };
        beta[0] = if count > 0.0 { (my - n * mx).exp() } else { 1.0 };
        beta[1] = n;
    }
    if let crate::law::Kind::Thruster { command, parts, .. } = &law.kind
        && let Some(x) = data.values(command)
    {
        for (r, load) in measured.chunks(data.rows.max(1)).enumerate() {
            let start = thruster_start(x, load);
            for (j, [_, which]) in parts.iter().enumerate().filter(|(_, [of, _])| *of == r) {
                beta[j] = start[*which];
            }
        }
    }
    beta
}

/// In each direction the dead band of a grid whose parabola leaves least of a load, with it; the inflow is left to the iteration.
fn thruster_start(command: &[f64], load: &[f64]) -> [f64; COEFFICIENTS] {
    let mut out = [0.0; COEFFICIENTS];
    for (side, sign) in [1.0, -1.0].into_iter().enumerate() {
        let rows = || command.iter().zip(load).filter(|(x, _)| **x * sign > 0.0);
        let largest = rows().fold(0.0_f64, |most, (x, _)| most.max(x.abs()));
        let mut least = f64::INFINITY;
        for step in 0..DEAD_BANDS {
            let band = DEAD_BAND_TO * largest * f64::from(step) / f64::from(DEAD_BANDS);
            let square = |x: &f64| sign * (x.abs() - band).max(0.0).powi(2);
            let along: f64 = rows().map(|(x, load)| square(x) * load).sum();
            let size: f64 = rows().map(|(x, _)| square(x).powi(2)).sum();
            let slope = if size > 0.0 { along / size } else { 0.0 };
            let left: f64 = rows().map(|(x, load)| (load - slope * square(x)).powi(2)).sum();
            if left < least {
                (least, out[side], out[3 + side]) = (left, slope, band);
            }
        }
    }
    out
}

/// The next coefficients.
pub(crate) fn step(fitted: &fit::Fit) -> Vec<f64> {
    fitted.coefficients.iter().map(|c| c.value.unwrap_or(0.0)).collect()
}
