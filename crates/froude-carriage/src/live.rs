//! D_d while its campaign is driven, and whether enough is known of it.

use std::path::{Path, PathBuf};

use froude_records::campaign::Campaign;
use froude_records::run::{BodyState, Role, RunMeta, read_run};
use froude_records::text::counted;
use froude_records::write::write_atomically;
use froude_rig::campaign::runner::Known;
use froude_rig::carriage::plan::PlannedRun;
use froude_rig::carriage::{CarriageCampaign, CarriagePlan, Directions, DrivenCampaign};

use crate::drag::calibration::Readings;
use crate::drag::detectability::DryMean;
use crate::drag::mcd;
use crate::drag::online::{OnLine, Status};
use crate::drag::setup::DragSetup;
use crate::reduction::{calibration_from, setup_of};
use crate::runs::for_drag;
use crate::runs::whole::{LAST_RUN, STOPPED_EARLY};

/// D_d while the campaign runs: every wet run with its dry partner gives a point.
pub struct Live {
    online: Option<OnLine>,
    setup: DragSetup,
    campaign: DrivenCampaign,
    folder: PathBuf,
    /// Runs whose partner has not been driven yet; a log of megabytes is read again when it has.
    waiting: Vec<Waiting>,
    calibration: Readings,
    is_calibrated: bool,
    /// Differences seen, whether they gave a point or not.
    differences: usize,
    per_pair: usize,
}

/// What is known of a campaign before its first run: a look after each of its pairs.
pub(crate) fn setup_before(campaign: &DrivenCampaign, asked: &CarriagePlan) -> DragSetup {
    let rig = campaign.carriage.as_ref().map(|carriage| &carriage.rig);
    let axis = rig.and_then(|rig| if asked.axis as usize == 0 { Some(&rig.y) } else { rig.x.as_ref() });
    DragSetup { looks: asked.repeats, ..setup_of(Some(campaign), axis.map(|axis| &axis.constants)) }
}

/// A run that waits for its partner.
struct Waiting {
    path: PathBuf,
    meta: RunMeta,
}

impl Live {
    /// Nothing is known yet of a campaign that `carriage` drives as `asked`; what is known is noted in `folder`.
    #[must_use]
    pub fn new(campaign: &Campaign, carriage: &CarriageCampaign, asked: &CarriagePlan, folder: &Path) -> Self {
        let campaign = DrivenCampaign { campaign: campaign.clone(), carriage: Some(carriage.clone()), logs: None };
        let directions = if asked.directions == Directions::Both { 2 } else { 1 };
        Self {
            online: asked.stop_at_relative_half_width.map(|target| OnLine::new(target, directions)),
            setup: setup_before(&campaign, asked),
            campaign,
            folder: folder.to_owned(),
            waiting: Vec::new(),
            calibration: Readings::default(),
            is_calibrated: false,
            differences: 0,
            per_pair: asked.speed_m_s.len() * directions,
        }
    }

    /// Reads the run again from its file, and after a whole pair says where D_d stands and whether that is enough. A run that gives no point only gives none.
    pub fn after(&mut self, path: &Path, run: &PlannedRun) -> Known {
        self.look(path, run).unwrap_or_default()
    }

    fn look(&mut self, path: &Path, run: &PlannedRun) -> Option<Known> {
        self.online.as_ref()?;
        if !matches!(run.role, Role::Dry | Role::Wet | Role::Calibration) {
            return None;
        }
        let log = read_run(path).ok()?;
        if run.role == Role::Calibration {
            if let Ok(Some(run)) = for_drag(&log) {
                self.calibration.push(&run, self.setup.steady);
            }
            return None;
        }
        self.calibrate();
        let online = self.online.as_mut()?;
        if let Ok(Some(run)) = for_drag(&log)
            && let Some(mean) = DryMean::of(&run, &self.setup)
        {
            online.push_dry(mean);
        }
        let partner = self.waiting.iter().position(|other| {
            other.meta.carriage.pair == log.meta.carriage.pair
                && other.meta.carriage.target_speed_m_s == log.meta.carriage.target_speed_m_s
                && other.meta.carriage.direction == log.meta.carriage.direction
        });
        let Some(partner) = partner else {
            self.waiting.push(Waiting { path: path.to_owned(), meta: log.meta });
            return None;
        };
        let other = read_run(&self.waiting.swap_remove(partner).path);
        self.differences += 1;
        if let Ok(other) = &other
            && let (wet, dry) = if log.meta.mounted.body == BodyState::Wet { (&log, other) } else { (other, &log) }
            && let (Ok(Some(wet)), Ok(Some(dry))) = (for_drag(wet), for_drag(dry))
            && let Ok(point) = mcd::point(&wet, &dry, self.setup.force_per_volt_n(), self.setup.steady)
        {
            online.push(point);
        }
        // A look is taken after whole pairs only, also where a run of them gave no point.
        if !self.differences.is_multiple_of(self.per_pair) {
            return None;
        }
        let status = online.status(&self.setup)?;
        let half_width = status.half_width?;
        let estimate = format!("D_d = {:.2} ± {half_width:.2} N s²/m² after {} pairs", status.value, status.pairs);
        if !status.may_stop {
            let said = format!("{estimate}: {}", self.remaining(&status));
            return Some(Known { said: Some(said), enough: None });
        }
        let why = format!("{estimate}: its 95 % interval is as narrow as asked; the remaining pairs are left out");
        // A folder that cannot be written to has stopped the recorder long before; then the report does without.
        let said = format!("{why}\n{LAST_RUN}{}\n", run.id);
        let _ = write_atomically(&self.folder.join(STOPPED_EARLY), said.as_bytes());
        Some(Known { said: None, enough: Some(why) })
    }

    /// How many pairs the target takes, in words.
    fn remaining(&self, status: &Status) -> String {
        let left = self.setup.looks.saturating_sub(self.differences / self.per_pair);
        let planned = counted(left, "planned pair remains", "planned pairs remain");
        match status.pairs_needed {
            None if status.floor >= status.target => {
                format!(
                    "the errors that all pairs share alone give ± {:.2}, and the target is ± {:.2}; {planned}",
                    status.floor, status.target
                )
            }
            None => format!("more than {} pairs would be needed; {planned}", 10 * self.setup.looks),
            Some(needed) if needed > status.pairs + left => {
                format!("about {needed} pairs would reach the target; {planned}")
            }
            Some(needed) if needed > status.pairs => format!("about {} more will do; {planned}", needed - status.pairs),
            Some(_) => format!("the target is near; {planned}"),
        }
    }

    /// Force per volt of the weights, as the report will take them, before the first look.
    fn calibrate(&mut self) {
        if self.is_calibrated {
            return;
        }
        self.is_calibrated = true;
        let (calibration, _) = calibration_from(&self.calibration, Some(&self.campaign), &self.setup);
        self.setup.calibration = calibration.map(|c| c.force_per_volt);
    }
}
