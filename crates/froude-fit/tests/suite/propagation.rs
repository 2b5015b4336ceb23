//! Effective degrees of freedom.

use froude_fit::propagate::{coverage_factor, effective_dof, expanded};

use crate::assert_close;

#[test]
fn welch_satterthwaite_of_equal_variances_adds_the_degrees() {
    assert_close(effective_dof(&[(1.0, 5.0), (1.0, 5.0)]), 10.0, 1e-15);
    assert_eq!(effective_dof(&[(1.0, f64::INFINITY)]), f64::INFINITY);
    assert_eq!(effective_dof(&[(2.0, 7.0), (0.0, 1.0)]), 7.0);
    let u = expanded(&[(9.0, 5.0), (16.0, f64::INFINITY)], 0.95);
    assert_close(u.standard, 5.0, 1e-15);
    assert_close(u.dof, 625.0 / (81.0 / 5.0), 1e-14);
    assert_close(u.expanded, 5.0 * coverage_factor(0.95, u.dof), 1e-14);
}
