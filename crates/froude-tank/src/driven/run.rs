//! One run.

use super::spec::Point;

/// One run: columns of one length, time increasing.
#[derive(Debug, Clone, PartialEq)]
pub struct Run<'a> {
    /// Name of the run, for messages.
    pub id: &'a str,
    /// What it is.
    pub point: Point,
    /// Time, s.
    pub time_s: &'a [f64],
    /// The motion, rad or m.
    pub motion: &'a [f64],
    /// The loads of the rig on the body; their zeros are free.
    pub loads: Vec<&'a [f64]>,
}
