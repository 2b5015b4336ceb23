//! What the rig's thread hands over, on its way into a run's log.

use std::path::PathBuf;

use crate::carriage::plan::PlannedRun;
use froude_records::RecordError;
use froude_records::run::{
    AxisSample, BodyState, CarriageFacts, CarriageSample, ClockAlignment, EventKind, Layout, Mounted, Packing,
    Recorder, Role, RunMeta, RunStatus, TOW,
};
use indexmap::IndexMap;

use crate::campaign::runner::setting::Setting;
use crate::drive::{HostClock, Rig, Sample};

/// What a rig is, for the record.
pub(super) struct RigFacts {
    pub rate_hz: f64,
    pub ticks_per_sample: u64,
    pub version: String,
}

impl RigFacts {
    pub fn of(rig: &dyn Rig) -> Self {
        Self { rate_hz: rig.rate_hz(), ticks_per_sample: rig.ticks_per_sample(), version: rig.version() }
    }
}

/// A run being recorded.
pub(super) struct Recording<'a> {
    setting: &'a Setting,
    has_x: bool,
    recorder: Recorder,
    row: Vec<f64>,
}

impl<'a> Recording<'a> {
    /// Begins the log of a run; `probe` tells which sensors there are.
    pub fn create(
        setting: &'a Setting,
        run: &PlannedRun,
        facts: &RigFacts,
        probe: &Sample,
    ) -> Result<Self, RecordError> {
        let rate_hz = facts.rate_hz * facts.ticks_per_sample as f64 / setting.decimation as f64;
        let meta = RunMeta {
            campaign: setting.campaign.clone(),
            campaign_sha256: setting.campaign_sha256.clone(),
            id: run.id.clone(),
            method: TOW.to_owned(),
            role: run.role,
            mounted: Mounted {
                body: run.body,
                is_ballasted: run.is_ballasted,
                hung_weight_n: (run.role == Role::Calibration).then_some(run.hung_weight_n),
                travel: setting.travel.filter(|_| run.body != BodyState::None),
            },
            carriage: CarriageFacts {
                set: run.set,
                pair: run.pair,
                repeat: run.pair,
                axis: run.axis,
                target_speed_m_s: run.speed_m_s(),
                direction: run.direction(),
                rig: setting.constants.clone(),
                twin_seed: setting.twin_seed,
            },
            constants: run.drive.constants(),
            status: RunStatus::Running,
            note: String::new(),
            versions: IndexMap::from([
                ("froude".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
                ("board".to_owned(), facts.version.clone()),
            ]),
            log_rate_hz: rate_hz,
            date: setting.date.clone(),
            start_unix_ns: setting.start_unix_ns,
            ..RunMeta::default()
        };
        let truths: &[(&str, &str)] = if probe.truth.is_some() { &TRUTHS } else { &[] };
        // The short axis is recorded where it is declared, or where it is the one that moves.
        let has_x = setting.constants.contains_key("x") || run.axis == froude_records::run::Axis::X;
        let layout = Layout::carriage(has_x, probe.force_n.is_some(), truths)?;
        let recorder = Recorder::create(&setting.folder, meta, layout, Packing::Lz4)?;
        Ok(Self { setting, has_x, recorder, row: Vec::new() })
    }

    /// Records what happened at a tick, counted as for [`Self::sample`].
    pub fn event(&mut self, number: u64, kind: &EventKind, sentence: &str) -> Result<(), RecordError> {
        self.recorder.event(number / self.setting.decimation, kind, sentence)
    }

    /// Records the sample of a tick, counted from the first one of the motion, where it is due.
    pub fn sample(&mut self, number: u64, sample: &Sample) -> Result<(), RecordError> {
        if !number.is_multiple_of(self.setting.decimation) {
            return Ok(());
        }
        let axis = |i: usize| {
            let a = &sample.axes[i];
            let fault = sample.fault.filter(|&(_, on)| usize::from(on) == i || usize::from(on) >= sample.axes.len());
            AxisSample {
                encoder: a.count,
                position_m: a.position_m,
                reference_position_m: a.reference_m,
                reference_velocity_m_s: a.reference_m_s,
                reference_acceleration_m_s2: a.reference_m_s2,
                command_v: a.command_v,
                current_a: a.current_a,
                state: a.phase as u8,
                fault: fault.map_or(0, |(f, _)| f as u8),
            }
        };
        let row = CarriageSample { y: axis(0), x: self.has_x.then(|| axis(1)), force_n: sample.force_n.unwrap_or(0.0) };
        let mut truths = [0.0; TRUTHS.len()];
        let n = match &sample.truth {
            Some([y, _]) => {
                truths = [y.load_position_m, y.load_speed_m_s, y.drag_n, y.spring_n];
                truths.len()
            }
            None => 0,
        };
        row.row(sample.force_n.is_some(), &truths[..n], &mut self.row);
        self.recorder.record(number / self.setting.decimation, &self.row)
    }

    /// Closes the log: how it ended, why if not as planned, and where its first tick lies on the host's clock.
    pub fn finish(
        mut self,
        status: RunStatus,
        note: Option<String>,
        clock: Option<HostClock>,
    ) -> Result<PathBuf, RecordError> {
        let start_ns = self.setting.start_unix_ns;
        let meta = self.recorder.meta_mut();
        if let Some(note) = note {
            meta.note = note;
        }
        if let Some(clock) = clock {
            meta.clock = Some(ClockAlignment {
                host_at_zero_s: clock.unix_s - 1e-9 * start_ns as f64,
                drift: clock.drift,
                standard_uncertainty_s: clock.standard_uncertainty_s,
            });
        }
        self.recorder.finish(status)
    }
}

/// What only the twin knows, for tests and for looking on; no identification reads it.
const TRUTHS: [(&str, &str); 4] =
    [("truth/y/load_position", "m"), ("truth/y/load_velocity", "m/s"), ("truth/y/drag", "N"), ("truth/y/spring", "N")];
