//! The pinned scenario on the dynamic twin: chain, gear, encoder, amplifier and the controller that drives the board.
//!
//! The fast scenario of `carriage.rs` has perfect tracking and a rigid chain. Here every tow is driven by the controller at 4 kHz against
//! the two-mass plant at 20 kHz, as `froude run` does it, and reduced by the same functions; only the recorder is left out.

use std::error::Error;
use std::path::Path;

use froude::control::config::Config;
use froude::control::request::{Move, Request};
use froude::fit::budget::Uncertain;
use froude::methods::carriage::drag::coefficient::Coefficient;
use froude::methods::carriage::drag::point::Method;
use froude::methods::carriage::drag::run::RunKind;

use froude::methods::carriage::drag::{BodyState, DragReport, DragRun, DragSetup, drag_report};
use froude::records::campaign_file::read_campaign;
use froude::rig::campaign::setup;
use froude::rig::carriage::declared;
use froude::rig::closed_loop::ClosedLoop;
use froude::rig::load::{Load, TowedBody};
use froude::rig::parameters::{AMPLIFIER_A_V, AxisParameters};
use froude::rig::twin::TwinConfig;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::carriage::{CALIBRATED_TO, Errors, mcd_holds};
use crate::claims::{Claims, Verdict};
use crate::coverage::normal;
use crate::scenario::Logged;

const SECTION: &str = "Drag from a towing carriage: the pinned scenario on the dynamic twin";

const SPEEDS_M_S: [f64; 6] = [0.05, 0.15, 0.25, 0.35, 0.45, 0.55];
const PAIRS: u32 = 5;
const TOW_M: [f64; 2] = [1.4, 3.6];
/// Friction runs near one end.
const NEAR_ONE_END_M: [f64; 2] = [0.15, 1.05];
/// Stand-still before and after a run.
const STILL_S: f64 = 2.0;
/// Ticks in a logged sample: 200 samples a second.
const TICKS: u64 = 20;

pub fn all(claims: &mut Claims, root: &Path, seeds: usize) -> Result<(), Box<dyn Error>> {
    let campaign = read_campaign(&root.join("examples/towing-carriage/campaign.toml"))?;
    let carriage = declared(&campaign)?.ok_or("the example has no carriage")?;
    let control = setup::control(&carriage, 3.0 * 1000.0 * TowedBody::CYLINDER.displaced_m3)?;
    let (twin, load) = setup::twin(&carriage, Load::default())?;
    for d in [20.0, 10.0] {
        pinned(claims, &twin, load, &control, d, seeds)?;
    }
    Ok(())
}

fn pinned(
    claims: &mut Claims,
    twin: &TwinConfig,
    load: Load,
    control: &Config,
    d: f64,
    seeds: usize,
) -> Result<(), Box<dyn Error>> {
    let reports: Vec<DragReport> = (0..seeds as u64)
        .into_par_iter()
        .map(|seed| campaign(twin, load, control, d, seed))
        .collect::<Result<_, String>>()?;
    let head = format!("D_d {d}, {seeds} campaigns of five pairs out and back");
    let of = |method: Method| {
        let mut out = Errors::default();
        reports
            .iter()
            .flat_map(|r| &r.coefficients)
            .filter(|c| c.method == method)
            .for_each(|c: &Coefficient| out.add(c, d));
        out
    };
    let (low, _) = mcd_holds(claims, SECTION, &head, d, seeds, &of(Method::Mcd));
    for method in [Method::Fsm, Method::MbdpMapped] {
        let found = of(method);
        claims.holds(
            SECTION,
            &format!("{head}: {}, 95 % interval covers", method.name()),
            &format!("at least {low} of {seeds}"),
            found.text(),
            found.covered.hits >= low,
        );
    }
    let near = of(Method::MbdpConstant);
    claims.holds(
        SECTION,
        &format!("{head}: MBDP, friction identified from 0.15 to 1.05 m and used mid-tank"),
        "biased by more than 1 %, and its interval knows",
        near.text(),
        100.0 * near.bias() > 1.0 && near.covered.hits >= low,
    );
    let masses: Vec<_> = reports.iter().filter_map(|r| r.added_mass.as_ref()).collect();
    let truth = load.body.added_mass_kg + load.body.body_water_kg;
    let hits = masses.iter().filter(|m| (m.interval_95[0]..=m.interval_95[1]).contains(&truth)).count() as u64;
    let mean = masses.iter().map(|m| m.mass_kg.value).sum::<f64>() / masses.len() as f64;
    claims.holds(
        SECTION,
        &format!("{head}: added mass plus entrained water, from the ramps"),
        &format!("{truth:.2} kg; covered in at least {low} of {seeds}"),
        format!("{mean:.3} kg in the mean, {hits} of {} covered", masses.len()),
        hits >= low,
    );
    let agreeing = reports.iter().filter(|r| r.agreement.is_some_and(|a| a.is_within_band())).count();
    claims.add(
        SECTION,
        &format!("{head}: scatter predicted from dry repeats alone and that of the wet ones agree"),
        "about 95 %",
        format!("{agreeing} of {seeds}"),
        Verdict::Measured,
    );
    Ok(())
}

/// One campaign, from power-up to the report.
fn campaign(twin: &TwinConfig, mut load: Load, control: &Config, d: f64, seed: u64) -> Result<DragReport, String> {
    load.body.drag_n_s2_m2 = d;
    let mut rig = Rig::homed(twin, control, seed)?;
    let mut runs = Vec::new();
    let dry = Load { mounting: BodyState::Dry, ..load };
    let wet = Load { mounting: BodyState::Wet, ballast_kg: load.balancing_ballast_kg(), ..load };
    rig.sweep(&mut runs, RunKind::Friction, dry, 1, NEAR_ONE_END_M)?;
    for pair in 1..=PAIRS {
        let halves = if pair % 2 == 1 { [dry, wet] } else { [wet, dry] };
        for half in halves {
            rig.sweep(&mut runs, RunKind::Tow, half, pair, TOW_M)?;
        }
    }
    let mut rng = Pcg64::new(u128::from(seed), 81);
    let axis = AxisParameters::long();
    let ideal = axis.torque_constant_n_m_a * AMPLIFIER_A_V / axis.chain_m_rad();
    let k = axis.efficiency_forward * ideal * (1.0 + CALIBRATED_TO * normal(&mut rng));
    let mut declared = DragSetup::of_the_paper();
    declared.reference_area_m2 = Some(0.04);
    declared.speed_scale_relative = 0.0;
    declared.calibration = Some(Uncertain::new(k, CALIBRATED_TO * k));
    declared.ballast = froude::methods::carriage::drag::setup::Ballast::Matched {
        carried_kg: Some(Uncertain::new(load.balancing_ballast_kg(), 0.0)),
    };
    let views: Vec<DragRun<'_>> = runs.iter().map(Logged::view).collect();
    drag_report(&views, &declared).map_err(|e| e.to_string())
}

/// The loop, and how many runs it has made.
struct Rig {
    driven: ClosedLoop,
    seed: u64,
    run: u64,
    acceleration_m_s2: f64,
}

impl Rig {
    fn homed(twin: &TwinConfig, control: &Config, seed: u64) -> Result<Self, String> {
        let mut twin = *twin;
        twin.axes[0].start_m = 0.02;
        let mut driven = ClosedLoop::new(&twin, *control, seed).map_err(|e| e.to_string())?;
        driven.step();
        let is_homed = driven.carry_out(Request::Enable { axis: 0 }, 0, 1)
            && driven.carry_out(Request::Home { axis: 0 }, 0, 400_000);
        let fault = driven.output.status.fault;
        is_homed.then_some(Self { driven, seed, run: 0, acceleration_m_s2: 0.6 }).ok_or(format!("homing: {fault:?}"))
    }

    /// All speeds out and back.
    fn sweep(
        &mut self,
        out: &mut Vec<Logged>,
        kind: RunKind,
        load: Load,
        pair: u32,
        [from_m, to_m]: [f64; 2],
    ) -> Result<(), String> {
        // As slow as a heavy wet carriage may come near an end.
        self.go(from_m, 0.2)?;
        for speed_m_s in SPEEDS_M_S {
            for (start_m, end_m) in [(from_m, to_m), (to_m, from_m)] {
                self.run += 1;
                self.driven.twin.begin_run([load; 2], self.seed << 16 | self.run);
                let body = if load.mounting == BodyState::Wet { BodyState::Wet } else { BodyState::Dry };
                let direction = (end_m - start_m).signum();
                let id = format!("{body:?} {pair} {:+.2} m/s", direction * speed_m_s);
                out.push(self.tow(id, kind, body, pair, end_m, speed_m_s, direction)?);
            }
        }
        Ok(())
    }

    fn request(&self, target_m: f64, speed_m_s: f64) -> Request {
        let acceleration_m_s2 = self.acceleration_m_s2;
        let profile = Move { target_m, speed_m_s, acceleration_m_s2, jerk_m_s3: 0.0, is_shaped: true };
        Request::Move { axis: 0, profile }
    }

    fn go(&mut self, target_m: f64, speed_m_s: f64) -> Result<(), String> {
        let request = self.request(target_m, speed_m_s);
        let is_there = self.driven.carry_out(request, 0, 1_000_000);
        let status = self.driven.output.status;
        is_there.then_some(()).ok_or(format!("move to {target_m} m: {:?} {:?}", status.fault, status.refusal))
    }

    /// Stands still, moves, stands still; logs the mean command of every 20 ticks.
    fn tow(
        &mut self,
        id: String,
        kind: RunKind,
        body: BodyState,
        pair: u32,
        target_m: f64,
        speed_m_s: f64,
        direction: f64,
    ) -> Result<Logged, String> {
        let mut out = Logged {
            id,
            time_s: Vec::new(),
            position_m: Vec::new(),
            reference_speed_m_s: Vec::new(),
            command_v: Vec::new(),
            force_n: Vec::new(),
            kind,
            body,
            target_speed_m_s: speed_m_s,
            direction,
            pair,
            is_ballasted: true,
            hung_weight_n: None,
        };
        let still = (STILL_S * 4000.0) as u64;
        self.log(&mut out, still);
        self.driven.request(self.request(target_m, speed_m_s));
        self.log(&mut out, TICKS);
        let mut patience = 60_000;
        while self.driven.output.status.axes[0].reference_m_s != 0.0 || patience == 60_000 {
            self.log(&mut out, TICKS);
            patience -= 1;
            let status = self.driven.output.status;
            if patience == 0 || status.fault.is_some() || status.refusal.is_some() {
                return Err(format!("{}: {:?} {:?}", out.id, status.fault, status.refusal));
            }
        }
        self.log(&mut out, still);
        Ok(out)
    }

    fn log(&mut self, out: &mut Logged, ticks: u64) {
        for _ in 0..ticks / TICKS {
            let mut sums = [0.0; 4];
            for _ in 0..TICKS {
                let command_v = self.driven.output.command.axes[0].volts;
                self.driven.step();
                let axis = &self.driven.output.status.axes[0];
                let row = [command_v, axis.position_m, axis.reference_m_s, self.driven.twin.force_n()];
                sums.iter_mut().zip(row).for_each(|(sum, x)| *sum += x);
            }
            let [command_v, position_m, reference_m_s, force_n] = sums.map(|s| s / TICKS as f64);
            out.time_s.push(out.time_s.len() as f64 * TICKS as f64 / 4000.0);
            out.command_v.push(command_v);
            out.position_m.push(position_m);
            out.reference_speed_m_s.push(reference_m_s);
            out.force_n.push(force_n);
        }
    }
}
