//! The map over a period of a swimmer that goes step by step.

use crate::dynamics::Dynamics;
use crate::moving::Moving;
use crate::newton::{Form, Map};

/// A swimmer from period to period.
pub(crate) struct Stepped<'m, C> {
    moving: Box<dyn Moving<C> + 'm>,
    form: Form,
    period_s: f64,
    steps: usize,
    periods: usize,
}

impl<'m, C: Dynamics> Stepped<'m, C> {
    /// In so many steps a period, s, of which a smaller number may make one.
    pub(crate) fn new(moving: impl Moving<C> + 'm, chain: &C, (period_s, steps): (f64, usize)) -> Self {
        let [turn, speed] = chain.flat().per_period(period_s);
        let size =
            if C::TILTS { vec![turn, turn, turn, speed, speed, speed, 1.0, 1.0] } else { vec![turn, speed, speed] };
        let form = Form { size, tilt: C::TILTS.then_some(6), has_corners: true };
        Self { moving: Box::new(moving), form, period_s, steps, periods: 0 }
    }

    /// With angles of driven joints before the head's numbers, and their rates, of these sizes, behind them.
    pub(crate) fn add_joints(&mut self, rates: impl ExactSizeIterator<Item = f64>) {
        let j = rates.len();
        self.form.size.splice(..0, std::iter::repeat_n(1.0, j));
        self.form.size.extend(rates);
        self.form.tilt = self.form.tilt.map(|roll| roll + j);
    }
}

impl<C: Dynamics> Map for Stepped<'_, C> {
    fn form(&self) -> &Form {
        &self.form
    }

    fn over(&mut self, from: &[f64], one_of: usize) -> Option<Vec<f64>> {
        self.periods += 1;
        let steps = self.steps / one_of;
        let h = self.period_s / steps as f64;
        self.moving.begin(from);
        for i in 0..steps {
            let time_s = i as f64 * h;
            self.moving.first(time_s)?;
            self.moving.rest(time_s, h)?;
        }
        let end = self.moving.numbers();
        end.iter().all(|x| x.is_finite()).then_some(end)
    }

    fn periods(&self) -> usize {
        self.periods
    }
}
