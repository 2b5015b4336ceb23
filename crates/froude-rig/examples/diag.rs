//! Temporary.
use froude_control::request::{Move, Request};
use froude_control::status::Phase;
use froude_records::run::BodyState;
use froude_rig::campaign::plan::{Drive, Step, plan};
use froude_rig::campaign::setup;
use froude_rig::drive::Rig;
use froude_rig::drive::twin::TwinRig;
use froude_rig::load::{HungWeight, Load, Mounting, TowedBody};
use std::path::Path;

fn main() {
    let path = std::env::args().nth(1).unwrap();
    let only: Option<usize> = std::env::args().nth(2).and_then(|s| s.parse().ok());
    let trace = std::env::args().nth(3).is_some();
    let campaign = froude_records::campaign::read_campaign(Path::new(&path)).unwrap();
    let carriage = campaign.carriage.clone().unwrap();
    let asked = carriage.plan.clone().unwrap();
    let displaced_m3 = 6.283e-3;
    let towed = 3.0 * 998.2 * displaced_m3;
    let control = setup::control(&carriage, towed).unwrap();
    let start_m = 0.5 * (4.9 - asked.distance_m);
    let steps = plan(&asked, start_m, 1);
    let env = |k: &str, d: f64| std::env::var(k).ok().and_then(|v| v.parse().ok()).unwrap_or(d);
    let heavy = env("HEAVY", 1.0);
    let scale = heavy * displaced_m3 / TowedBody::CYLINDER.displaced_m3;
    let body = TowedBody {
        mass_kg: 6.0 * scale,
        displaced_m3,
        body_water_kg: 0.3 * scale,
        added_mass_kg: 3.77 * scale,
        drag_n_s2_m2: 20.0,
    };
    let base = Load { body, density_kg_m3: 998.2, ..Load::default() };
    let (mut twin, base) = setup::twin(&carriage, base).unwrap();
    if std::env::var("Y0").is_ok() {
        twin.axes[0].start_m = env("Y0", 0.0);
        twin.axes[1].start_m = env("X0", 0.0);
    }
    let mut n = 0;
    let mut bad = 0;
    for step in &steps {
        let Step::Run(run) = step else { continue };
        n += 1;
        if only.is_some_and(|o| o != n) {
            continue;
        }
        let mounting = match run.body {
            BodyState::None => Mounting::None,
            BodyState::Dry => Mounting::Dry,
            BodyState::Wet => Mounting::Wet,
        };
        let ballast_kg = if run.is_ballasted && mounting == Mounting::Wet { base.balancing_ballast_kg() } else { 0.0 };
        let load = Load {
            mounting,
            ballast_kg,
            hung: HungWeight {
                weight_n: run.hung_weight_n,
                floor_m: run.floor_m.unwrap_or(f64::NEG_INFINITY),
                ..base.hung
            },
            ..base
        };
        let mut rig = TwinRig::new(&twin, control, 1).unwrap();
        rig.begin_run(&load, n as u64);
        let from_m = match run.drive {
            Drive::Profile { from_m, .. }
            | Drive::Pulses { from_m, .. }
            | Drive::Relay { from_m, .. }
            | Drive::Sweep { from_m, .. }
            | Drive::Jog { from_m, .. } => Some(from_m),
        };
        let mut jobs = vec![
            (Request::Enable { axis: 0 }, 0, "enable y"),
            (Request::Home { axis: 0 }, 0, "home y"),
            (Request::Enable { axis: 1 }, 1, "enable x"),
            (Request::Home { axis: 1 }, 1, "home x"),
        ];
        if let Some(target_m) = from_m {
            let speed_m_s = if run.hung_weight_n != 0.0 { run.speed_m_s().unwrap() } else { 0.5 };
            jobs.push((
                Request::Move {
                    axis: 0,
                    profile: Move {
                        target_m,
                        speed_m_s,
                        acceleration_m_s2: asked.acceleration_m_s2,
                        jerk_m_s3: 0.0,
                        is_shaped: true,
                    },
                },
                0,
                "approach",
            ));
        }
        let mut t = 0u64;
        'jobs: for (mut request, axis, what) in jobs {
            let mut s = rig.tick(Some(request)).unwrap();
            let mut begun = t;
            let mut vmax = 0.0_f64;
            let mut imax = 0.0_f64;
            let mut emax = 0.0_f64;
            loop {
                t += 1;
                let a = &s.axes[axis];
                let truth = s.truth.unwrap()[axis];
                vmax = vmax.max(truth.motor_speed_m_s.abs());
                imax = imax.max(a.command_v.abs());
                emax = emax.max((a.reference_m - a.position_m).abs());
                if trace && (t % 4 == 0 && what == "home x") {
                    println!(
                        "{what} {:.4} ref {:.5} {:.4} pos {:.5} | motor {:.5} {:.4} load {:.5} {:.4} cmd {:.2} i {:.3} spring {:.2} {:?}",
                        t as f64 / 4e3,
                        a.reference_m,
                        a.reference_m_s,
                        a.position_m,
                        truth.motor_position_m,
                        truth.motor_speed_m_s,
                        truth.load_position_m,
                        truth.load_speed_m_s,
                        a.command_v,
                        a.current_a,
                        truth.spring_n,
                        a.phase
                    );
                }
                if let Some((fault, on)) = s.fault {
                    bad += 1;
                    println!(
                        "{n} {} {what}: {fault:?} on {on} after {:.4} s: ref {:.5} pos {:.5} load {:.5} v_load {:.4} v_m {:.4} cmd {:.2} spring {:.2}",
                        run.id,
                        (t - begun) as f64 / 4e3,
                        a.reference_m,
                        a.position_m,
                        truth.load_position_m,
                        truth.load_speed_m_s,
                        truth.motor_speed_m_s,
                        a.command_v,
                        truth.spring_n
                    );
                    break 'jobs;
                }
                if s.refusal == Some(froude_control::status::Refusal::BeyondTravel) {
                    if let Request::Move { axis, mut profile } = request {
                        profile.speed_m_s *= 0.5;
                        request = Request::Move { axis, profile };
                        s = rig.tick(Some(request)).unwrap();
                        t += 1;
                        begun = t;
                        continue;
                    }
                }
                if let Some(r) = s.refusal {
                    bad += 1;
                    println!("{n} {} {what}: refused {r:?}", run.id);
                    break 'jobs;
                }
                if t - begun > 2 && a.phase == Phase::Holding {
                    break;
                }
                s = rig.tick(None).unwrap();
            }
            if only.is_some() {
                println!("{what}: {:.3} s vmax {vmax:.4} cmd {imax:.2} err {emax:.6}", (t - begun) as f64 / 4e3);
            }
        }
    }
    println!("{bad} bad");
}
