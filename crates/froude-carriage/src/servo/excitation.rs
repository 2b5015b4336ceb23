//! Whether a motion determines the coefficients of an axis; if not, a suitable motion is recommended.
//!
//! A log is not a designed test. A disturbance also moves the axis, so acceleration and speed follow it, and least squares attribute it to inertia and friction. The resulting bias is at most
//! 1/R² of a coefficient. R is the ratio of two forces: that of the coefficient, without what the other columns explain, to the residual. If the speed hardly varies within a direction,
//! viscous and Coulomb friction cannot be distinguished.
//!
//! | coefficient | needed | at least |
//! |-------------|--------|-------|
//! | M | R = \|M\| rms(a⊥)/σ | 5 |
//! | F_v, F_c | the same R of M; rms(x⊥)/rms(x) of their own column | 2; 0.07 |
//!
//! x⊥ is what the other columns leave of a column: rms(x⊥) = σ/(s √n), s the standard deviation of its coefficient with white residuals.
//!
//! **Source.** Ljung (1999), System Identification, 13.4 (the bias of a direct method in a loop); Belsley, Kuh & Welsch (1980), 3.2. The limits are ours: twelve motions of a simulated axis
//! (tests/servo_logs.rs).

use froude_records::number::significant;

/// Least force of the inertia over what the model leaves.
const LEAST_FORCE: f64 = 5.0;
/// The same for any coefficient: below, the motion is that of the disturbance.
const LEAST_FORCE_OF_ANY: f64 = 2.0;
/// Least part of a column of friction that the other columns do not have.
const LEAST_PART: f64 = 0.07;

/// A column of the regression with its coefficient.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Column<'a> {
    pub name: &'a str,
    pub value: f64,
    /// Standard deviation of the coefficient, if residuals were white.
    pub classical: f64,
    /// Root mean square of the column.
    pub rms: f64,
}

/// What is wrong with the motion, and which coefficients it does not tell.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Weak {
    /// A sentence for each kind of coefficient.
    pub findings: Vec<String>,
    /// Whether the motion tells each column's coefficient.
    pub is_told: Vec<bool>,
}

/// Judges columns of `n` rows, of which the model leaves `sigma_n`.
pub(crate) fn weak(columns: &[Column<'_>], sigma_n: f64, n: usize) -> Weak {
    let root = (n as f64).sqrt();
    let force = |c: &Column<'_>| c.value.abs() / (c.classical * root);
    let part = |c: &Column<'_>| sigma_n / (c.classical * root * c.rms);
    let of_inertia = columns.iter().find(|c| c.name == "M").map_or(f64::INFINITY, force);
    let is_driven = of_inertia >= LEAST_FORCE_OF_ANY;
    let is_told = |c: &Column<'_>| match c.name {
        "M" => force(c) >= LEAST_FORCE,
        name if name.starts_with("F_") => is_driven && part(c) >= LEAST_PART,
        _ => true,
    };
    let mut findings = Vec::new();
    for c in columns.iter().filter(|c| c.name == "M" && !is_told(c)) {
        let of = if is_driven { "M" } else { "M and friction" };
        findings.push(format!(
            "{of}: no interval is given, because the inertia force is {} times the residual force (at least {LEAST_FORCE} times is needed); move with larger accelerations (pulses, steps, a sine of \
             1 Hz or more)",
            significant(force(c), 2)
        ));
    }
    let friction: Vec<&Column<'_>> =
        columns.iter().filter(|c| c.name.starts_with("F_") && is_driven && !is_told(c)).collect();
    if let Some(least) = friction.iter().map(|c| part(c)).reduce(f64::min) {
        let names: Vec<&str> = friction.iter().map(|c| c.name).collect();
        findings.push(format!(
            "{}: no interval is given, because the speed hardly varies within a direction, so that viscous and Coulomb friction cannot be distinguished (independent part of the column {}, \
             at least {LEAST_PART} is needed); move at two or more speeds, or through a range of speeds (pulses, a sine)",
            names.join(", "),
            significant(least, 2)
        ));
    }
    Weak { findings, is_told: columns.iter().map(is_told).collect() }
}
