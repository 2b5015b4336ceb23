//! What speed and cost of transport owe to each coefficient, and which of them to measure next.
//!
//! | quantity | what it is |
//! | --- | --- |
//! | elasticity | ∂ ln U / ∂ ln c: per cent of speed for a per cent of the coefficient; central differences through the motion that repeats |
//! | standard uncertainty | √(gᵀ Σ g), g the derivatives, Σ the record's covariance |
//! | known | the part of that variance which would go if this coefficient were known exactly: (Σ g)ⱼ² / (Σⱼⱼ gᵀ Σ g) |
//!
//! The parts add up to one only where coefficients are not correlated.
//!
//! **Source.** JCGM 100:2008, 5.1 and 5.2; the conditional variance of a normal vector.

use crate::blueprint::{Blueprint, Number};
use crate::dynamics::Dynamics;
use crate::robot::Robot;

/// Of a coefficient, or of its standard uncertainty where it is zero.
const STEP: f64 = 1e-3;

/// Of speed or cost.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Effect {
    /// ∂y/∂c, SI.
    pub derivative: f64,
    /// ∂ ln y / ∂ ln c.
    pub elasticity: f64,
    /// Part of the variance that goes when the coefficient is known; `None` where no covariance is stated.
    pub known: Option<f64>,
}

/// Of one coefficient.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivity {
    /// The coefficient.
    pub number: Number,
    /// Of speed and of cost of transport; `None` where it is zero without an uncertainty.
    pub effects: Option<[Effect; 2]>,
}

/// Of all coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivities {
    /// Of each.
    pub each: Vec<Sensitivity>,
    /// Standard uncertainty of speed and of cost; `None` where no covariance is stated.
    pub standard: Option<[f64; 2]>,
}

impl Blueprint {
    /// Of a gait whose speed and cost of transport `swim` tells; `None` where it has no answer beside the estimate.
    pub fn sensitivities<C: Dynamics>(&self, swim: impl Fn(&Robot<C>) -> Option<[f64; 2]>) -> Option<Sensitivities> {
        let values = self.values();
        let found = swim(&self.robot(&values))?;
        let mut all = Vec::with_capacity(values.len());
        for (j, number) in self.numbers().iter().enumerate() {
            let size = if number.value == 0.0 { number.standard.unwrap_or(0.0) } else { number.value.abs() };
            if size == 0.0 {
                all.push(Sensitivity { number: number.clone(), effects: None });
                continue;
            }
            let mut beside = values.clone();
            let [above, below] = [1.0, -1.0].map(|side| {
                beside[j] = number.value + side * STEP * size;
                swim(&self.robot(&beside))
            });
            let (above, below) = (above?, below?);
            let effect = |k: usize| {
                let derivative = (above[k] - below[k]) / (2.0 * STEP * size);
                Effect { derivative, elasticity: derivative * number.value / found[k], known: None }
            };
            all.push(Sensitivity { number: number.clone(), effects: Some([effect(0), effect(1)]) });
        }
        let mut standard = None;
        if let Some(covariance) = self.covariance() {
            standard = Some([0, 1].map(|k| shares(&mut all, &covariance, k).sqrt()));
        }
        Some(Sensitivities { each: all, standard })
    }
}

/// Puts in what each coefficient takes of the variance of speed or cost; the variance.
fn shares(all: &mut [Sensitivity], covariance: &[Vec<f64>], k: usize) -> f64 {
    let g: Vec<f64> = all.iter().map(|s| s.effects.map_or(0.0, |e| e[k].derivative)).collect();
    let with: Vec<f64> = covariance.iter().map(|row| row.iter().zip(&g).map(|(c, g)| c * g).sum()).collect();
    let variance: f64 = with.iter().zip(&g).map(|(c, g)| c * g).sum::<f64>().max(0.0);
    for (j, s) in all.iter_mut().enumerate() {
        if let Some(effects) = &mut s.effects {
            let is_uncertain = covariance[j][j] > 0.0 && variance > 0.0;
            effects[k].known = Some(if is_uncertain { with[j] * with[j] / (covariance[j][j] * variance) } else { 0.0 });
        }
    }
    variance
}
