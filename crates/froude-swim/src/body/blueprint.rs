//! A robot for any coefficients: all that its file and records say, apart from the numbers that were fitted.
//!
//! The numbers are the coefficients of the drag's law in its order and, behind them, each C_A that an added mass comes from. Added mass that stands in numbers, or as a matrix of potential flow, is part of the robot.
//!
//! **Covariance.** As the records state it. Errors that two estimates of one file share by their key make a covariance between them; estimates of two files have none.

use std::path::{Path, PathBuf};

use froude_hydro::{DragModel, Setting};
use froude_records::estimate::{Covariance, Estimate, OWN, Range, Status, beside};

use crate::added::{Added, added_masses, c_a_of};
use crate::drag::{Cross, LinkDrag, Turning};
use crate::dynamics::Dynamics;
use crate::robot::{Robot, RobotError, law, selected, setting};
use crate::robot_file::{AddedFile, FromRecord, RobotFile};
use crate::shares::{Distribution, Torque, gains, shares};

/// Up to which speed drag must resist where the record does not say at what it was fitted, m/s.
const RANGE_M_S: f64 = 1.0;
/// A gain of less than this part of what drag takes is one of rounding.
const ROUNDING: f64 = 1e-12;

/// A robot without its coefficients.
#[derive(Debug, Clone)]
pub struct Blueprint {
    file: RobotFile,
    model: DragModel,
    setting: Setting,
    added: Vec<Added>,
    added_ids: Vec<String>,
    /// Which C_A a module's added mass goes with.
    by_link: Vec<Option<usize>>,
    mass_kg: f64,
    heavy_kg: Option<f64>,
    drag: Fitted,
    coefficients: Vec<Number>,
    origins: Vec<Fitted>,
}

/// A number that was fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct Number {
    /// As its record calls it.
    pub name: String,
    /// SI, `1` for a pure number.
    pub unit: String,
    /// As estimated.
    pub value: f64,
    /// Combined standard uncertainty; `None` where none is stated.
    pub standard: Option<f64>,
    /// Estimate without bounds, about which the uncertainty is stated; `None` where it stands at one and the record does not say.
    pub centre: Option<f64>,
    /// Degrees of freedom of the uncertainty; `None` where there is no end to them, or none are stated.
    pub dof: Option<f64>,
}

/// An estimate of a record.
#[derive(Debug, Clone)]
struct Fitted {
    path: PathBuf,
    estimate: Estimate,
    covariance: Option<Covariance>,
}

impl Fitted {
    fn new(from: &FromRecord) -> Result<Self, RobotError> {
        let (mut record, at) = selected(from)?;
        Ok(Self::at(&from.path, record.estimates.swap_remove(at)))
    }

    fn at(path: &Path, estimate: Estimate) -> Self {
        let covariance = estimate.covariance();
        Self { path: path.to_owned(), estimate, covariance }
    }

    fn number(&self, name: &str, unit: &str, value: f64) -> Number {
        let variance = self.between(name, self, name);
        let coefficient = self.estimate.coefficients.get(name);
        Number {
            name: name.to_owned(),
            unit: unit.to_owned(),
            value,
            standard: (variance > 0.0).then_some(variance.sqrt()),
            centre: match coefficient {
                Some(c) if matches!(c.status, Status::AtBound | Status::BoundContradicted) => c.unconstrained,
                Some(c) => c.unconstrained.or(Some(value)),
                None => Some(value),
            },
            dof: coefficient.and_then(|c| c.effective_dof),
        }
    }

    /// Covariance of one of its numbers and one of another estimate.
    fn between(&self, own: &str, other: &Self, others: &str) -> f64 {
        let is_same = self.path == other.path && self.estimate.id == other.estimate.id;
        if is_same {
            let stated = self.covariance.as_ref().and_then(|c| {
                let at = |name: &str| c.names.iter().position(|n| n == name);
                Some(c.matrix[at(own)?][at(others)?])
            });
            let alone = || self.estimate.coefficients.get(own).and_then(|c| c.standard_uncertainty);
            return match stated {
                Some(covariance) => covariance,
                None if own == others => alone().map_or(0.0, |u| u * u),
                None => 0.0,
            };
        }
        if self.path != other.path {
            return 0.0;
        }
        let shared = self.estimate.errors.iter().filter(|(key, _)| !key.starts_with(OWN));
        let parts = shared.filter_map(|(key, error)| {
            let row = |of: &Self, name: &str| of.estimate.type_a.as_ref()?.names.iter().position(|n| n == name);
            let there = other.estimate.errors.get(key)?;
            let (s, t) = (error.sensitivity.get(row(self, own)?)?, there.sensitivity.get(row(other, others)?)?);
            Some(error.between(s, t))
        });
        parts.sum()
    }
}

impl Blueprint {
    /// What a file and the records that it names say; of a robot of three dimensions, what the plane sees of it.
    ///
    /// # Errors
    ///
    /// [`RobotError`]: records that cannot be read, estimates that do not describe a robot, numbers without what they refer to.
    pub fn of(file: &RobotFile) -> Result<Self, RobotError> {
        Self::by(file, Fitted::new(&file.drag)?)
    }

    /// That of the estimate, and one for each other law of its source that the data do not contradict and this robot can have; beside them the ids of those that it cannot, or that cannot be drawn.
    ///
    /// # Errors
    ///
    /// As [`Self::of`], of the estimate itself.
    pub fn of_all_laws(file: &RobotFile) -> Result<(Vec<Self>, Vec<String>), RobotError> {
        let own = Self::of(file)?;
        let (record, at) = selected(&file.drag)?;
        let others = beside(&record.estimates, &record.estimates[at]).into_iter();
        let (mut all, mut left_out) = (vec![own], Vec::new());
        for estimate in others {
            let law = Self::by(file, Fitted::at(&file.drag.path, estimate.clone()));
            match law.ok().filter(|law| law.draws(2, 1).is_ok()) {
                Some(law) => all.push(law),
                None => left_out.push(estimate.id.clone()),
            }
        }
        Ok((all, left_out))
    }

    /// Itself, where it has all that a chain of this space needs.
    ///
    /// # Errors
    ///
    /// [`RobotError::Unfit`], by C_A of sway alone.
    pub fn fitting<C: Dynamics>(self) -> Result<Self, RobotError> {
        let id = (C::TILTS && self.by_link.iter().any(Option::is_some)).then(|| self.added_ids.join(", "));
        id.map_or(Ok(self), |id| {
            Err(RobotError::Unfit(format!(
                "{id} has C_A, which is of sway alone, and three dimensions need the added mass of all six motions: write them in numbers, or name the record of froude added-mass of one module"
            )))
        })
    }

    fn by(file: &RobotFile, drag: Fitted) -> Result<Self, RobotError> {
        let setting = setting(file, &drag.estimate)?;
        let (model, values) = law(&file.drag, &drag.estimate)?;
        if file.model.torque == Torque::Friction && model == DragModel::F6 {
            let (id, law) = (&drag.estimate.id, &drag.estimate.law.name);
            return Err(RobotError::Unfit(format!(
                "{id} is {law}, which has no friction of links: write torque = \"cross_flow\", or drag = \"strip\""
            )));
        }
        let named = model.coefficients().iter().zip(values);
        let mut coefficients: Vec<Number> = named.map(|(c, value)| drag.number(c.name, c.unit, value)).collect();
        let mut origins = vec![drag.clone(); coefficients.len()];
        let (added, added_ids) = added_masses(file)?;
        let (mut known, mut by_link): (Vec<&FromRecord>, _) = (Vec::new(), Vec::new());
        for (module, added) in file.modules.iter().zip(&added) {
            let from = match module.added.as_ref().unwrap_or(&file.added_mass) {
                AddedFile::Record(from) if added.is_by_link => from,
                _ => {
                    by_link.push(None);
                    continue;
                }
            };
            let at = known.iter().position(|k| k.path == from.path && k.select == from.select);
            if at.is_none() {
                known.push(from);
                let fitted = Fitted::new(from)?;
                if let Some((name, value)) = c_a_of(&fitted.estimate) {
                    coefficients.push(fitted.number(name, "1", value));
                    origins.push(fitted);
                }
            }
            by_link.push(Some(at.unwrap_or(known.len() - 1)));
        }
        let mass_kg = file.modules.iter().map(|m| m.mass_kg).sum();
        let displaced: Option<f64> = file.modules.iter().map(|m| Some(m.volume_m3? * file.density_kg_m3)).sum();
        Ok(Self {
            file: file.clone(),
            model,
            setting,
            added,
            added_ids,
            by_link,
            mass_kg,
            heavy_kg: displaced.map(|displaced| mass_kg - displaced),
            drag,
            coefficients,
            origins,
        })
    }

    /// The numbers that were fitted, those of the drag's law first.
    #[must_use]
    pub fn numbers(&self) -> &[Number] {
        &self.coefficients
    }

    /// Values of all of them, as estimated.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        self.coefficients.iter().map(|c| c.value).collect()
    }

    /// File of the drag's record.
    #[must_use]
    pub fn record(&self) -> &std::path::Path {
        &self.drag.path
    }

    /// Id of the drag's estimate.
    #[must_use]
    pub fn id(&self) -> &str {
        &self.drag.estimate.id
    }

    /// Covariance of all of them; `None` where no record states any.
    #[must_use]
    pub fn covariance(&self) -> Option<Vec<Vec<f64>>> {
        self.coefficients.iter().any(|c| c.standard.is_some()).then_some(())?;
        let all = self.origins.iter().zip(&self.coefficients);
        let row = |(of, c): (&Fitted, &Number)| {
            all.clone().map(|(other, d)| of.between(&c.name, other, &d.name)).collect::<Vec<f64>>()
        };
        Some(all.clone().map(row).collect())
    }

    /// The robot with other numbers, in the order of [`Self::numbers`]; in the plane what that sees of it.
    #[must_use]
    pub fn robot<C: Dynamics>(&self, values: &[f64]) -> Robot<C> {
        let n = self.model.coefficients().len();
        // All of it goes with C_A.
        let part = |by_link: &Option<usize>| by_link.map_or(1.0, |k| values[n + k] / self.coefficients[n + k].value);
        let added = self.added.iter().zip(&self.by_link).map(|(added, by_link)| {
            let part = part(by_link);
            added.matrix.map(|row| row.map(|entry| part * entry))
        });
        let drags = shares(self.model, &self.setting, &values[..n], self.forms());
        Robot {
            chain: C::built(&self.file, &drags, &added.collect::<Vec<_>>()),
            estimates: (self.drag.estimate.id.clone(), (!self.added_ids.is_empty()).then(|| self.added_ids.join(", "))),
            is_by_link: self.by_link.iter().any(Option::is_some),
            refers_to: self.setting.body.link,
            speed_m_s: self.range("speed"),
            angle_rad: self.range("angle"),
            mass_kg: self.mass_kg,
            heavy_kg: self.heavy_kg,
        }
    }

    /// The robot with the numbers that were estimated.
    #[must_use]
    pub fn estimated<C: Dynamics>(&self) -> Robot<C> {
        self.robot(&self.values())
    }

    fn forms(&self) -> (Distribution, Torque) {
        (self.file.model.distribution, self.file.model.torque)
    }

    fn range(&self, key: &str) -> Option<[f64; 2]> {
        self.drag.estimate.validity.get(key).map(|Range { low, high, .. }| [*low, *high])
    }

    /// The module, from 1 at the head, to which still water gives power at speeds up to those of the fit (1 m/s where they are not stated), or whose added mass is not positive; `None`: a body that water can only slow down.
    #[must_use]
    pub fn driven_by_water(&self, robot: &Robot) -> Option<usize> {
        let links = &robot.chain.links;
        // Modules that are alike are looked at once.
        let is_new = |i: usize| !links[..i].iter().any(|before| before.drag == links[i].drag);
        let is_driven = |i: usize| is_new(i) && gained(&links[i].drag, range_m_s(robot)).is_some();
        let light = self.of_no_added_mass(robot);
        light.or_else(|| (0..links.len()).find(|i| is_driven(*i))).map(|i| i + 1)
    }

    /// From 0, the module whose added mass by C_A is not positive.
    pub(crate) fn of_no_added_mass(&self, robot: &Robot) -> Option<usize> {
        let links = robot.chain.links.iter().zip(&self.by_link);
        links.clone().position(|(link, by_link)| by_link.is_some() && link.added.y <= 0.0)
    }

    /// Power that still water gives the straight robot at a velocity for one of each number, W: power is linear in them.
    pub(crate) fn power_row(&self, velocity_m_s: [f64; 2]) -> Vec<f64> {
        let n = self.model.coefficients().len();
        let of = |j: usize| {
            let mut one = vec![0.0; n];
            one[j] = 1.0;
            shares(self.model, &self.setting, &one, self.forms()).iter().map(|drag| drag.power_w(velocity_m_s)).sum()
        };
        (0..self.coefficients.len()).map(|j| if j < n { of(j) } else { 0.0 }).collect()
    }
}

impl<C: Dynamics> Robot<C> {
    /// The robot of a file.
    ///
    /// # Errors
    ///
    /// [`RobotError`]: records that cannot be read, estimates that do not describe a robot, numbers without what they refer to, in three dimensions an added mass of sway alone.
    pub fn of(file: &RobotFile) -> Result<Self, RobotError> {
        Ok(Blueprint::of(file)?.fitting::<C>()?.estimated())
    }
}

/// The velocity, m/s, at which still water gives the straight robot the most power; `None` where it gives none. Shared out by origin, a law that takes power of the whole may give it to a module.
pub(crate) fn drives_the_whole(robot: &Robot) -> Option<[f64; 2]> {
    gained(&whole(robot.chain.links.iter().map(|link| link.drag)), range_m_s(robot))
}

/// Up to which speed drag must resist, m/s.
fn range_m_s(robot: &Robot) -> f64 {
    robot.speed_m_s.map_or(RANGE_M_S, |[low, high]| low.abs().max(high.abs()))
}

/// The velocity at which a drag gains the most, by more than rounding.
fn gained(drag: &LinkDrag, range: f64) -> Option<[f64; 2]> {
    let takes = [drag.along, drag.across].map(|[c1, c2]| (c1.abs() + c2.abs() * range) * range * range);
    gains(drag, range).filter(|(power, _)| *power > ROUNDING * (takes[0] + takes[1])).map(|(_, velocity)| velocity)
}

/// The force of modules that move alike.
fn whole(drags: impl Iterator<Item = LinkDrag>) -> LinkDrag {
    let sum = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
    drags.fold(LinkDrag { turning: Turning::Lumped([0.0; 2]), ..LinkDrag::NONE }, |all, one| LinkDrag {
        along: sum(all.along, one.along),
        across: sum(all.across, one.across),
        cross: match (all.cross, one.cross) {
            (Some(a), Some(b)) => Some(Cross { of_speed: sum(a.of_speed, b.of_speed), ..a }),
            (a, b) => a.or(b),
        },
        ..all
    })
}
