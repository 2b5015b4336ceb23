//! The shipped example is cut after every run and inside every phase of the next one, and driven on from there.
//!
//! By default at the twenty runs that once could not be resumed and at one of each other kind; at all 205 with `FROUDE_TEST_RESUMES=N`,
//! in N of the eight phases each.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use froude::carriage::drive::{DriveJob, Prepared, drive, prepare};
use froude::records::run::{
    Layout, Packing, Recorder, RunMeta, RunStatus, TOW, read_run, read_run_meta, write_run_meta,
};
use froude::rig::campaign::runner::{Operator, Progress};
use froude::rig::campaign::stop::StopSwitch;
use froude::rig::carriage::plan::PlannedRun;
use froude::rig::drive::Sample;
use froude_control::status::Phase;

/// Runs that could not be driven first in a session, by their number: homing the short axis with the body wet and ballasted ended in
/// over-speed, saturation or an encoder that seemed stuck, each time alike.
const ONCE_FAILED: [usize; 20] =
    [99, 100, 105, 106, 107, 108, 112, 114, 119, 120, 148, 156, 157, 162, 163, 164, 166, 167, 199, 202];

/// Where the program dies in a run, and what it leaves.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Cut {
    /// Before the run.
    Before,
    Homing,
    Approach,
    Tow,
    Brake,
    /// Between log and sidecar, when the run begins.
    NoSidecar,
    /// Between log and sidecar, when the run ends.
    EndedLog,
    /// Between the two renames of putting an interrupted run aside.
    HalfAside,
}

const CUTS: [Cut; 8] =
    [Cut::Before, Cut::Homing, Cut::Approach, Cut::Tow, Cut::Brake, Cut::NoSidecar, Cut::EndedLog, Cut::HalfAside];

/// The example with short waits and a coarse log, without an early end.
fn example(folder: &Path) -> PathBuf {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/towing-carriage/campaign.toml");
    let mut text = std::fs::read_to_string(path).unwrap();
    for (from, to) in [
        (r#"settling = { dry = "5 s", wet = "120 s" }"#, r#"settling = { dry = "0.5 s", wet = "0.5 s" }"#),
        (r#"still = "5 s""#, r#"still = "1.6 s""#),
        (r#"log_rate = "1 kHz""#, r#"log_rate = "100 Hz""#),
        (r#"stop_when = "2.5 %""#, "#"),
    ] {
        assert!(text.contains(from), "the example has no {from}");
        text = text.replace(from, to);
    }
    let path = folder.join("campaign.toml");
    std::fs::write(&path, text).unwrap();
    path
}

fn prepared(campaign: &Path, out: &Path) -> Prepared {
    let job = DriveJob {
        campaign: campaign.to_owned(),
        out: Some(out.to_owned()),
        start_unix_ns: 0,
        date: "2026-11-22".to_owned(),
    };
    let prepared = prepare(&job).unwrap();
    assert_eq!(prepared.objections, []);
    prepared
}

struct Yes;

impl Operator for Yes {
    fn confirm(&mut self, _: &str, _: &dyn Fn() -> bool) -> bool {
        true
    }
}

/// Presses the switch when a run begins that is one too many; dies where it is asked to.
struct Watch {
    switch: StopSwitch,
    last: usize,
    dies: Cut,
    motions: usize,
    was_moving: bool,
}

impl Progress for Watch {
    fn run_begins(&mut self, _: &PlannedRun, number: usize, _: usize) {
        if number > self.last {
            self.switch.press();
        }
    }

    fn sample(&mut self, run: &PlannedRun, sample: &Sample, _: f64) {
        let axis = &sample.axes[run.axis as usize];
        let is_moving = matches!(axis.phase, Phase::Moving | Phase::Exciting);
        self.motions += usize::from(is_moving && !self.was_moving);
        self.was_moving = is_moving;
        let is_braking = axis.reference_m_s * axis.reference_m_s2 < 0.0 || axis.phase == Phase::Exciting;
        let is_there = match self.dies {
            Cut::Homing => sample.axes.iter().any(|a| a.phase == Phase::Homing),
            Cut::Approach => is_moving && self.motions == 1,
            Cut::Tow | Cut::NoSidecar | Cut::HalfAside => is_moving && self.motions == 2,
            Cut::Brake => is_moving && is_braking && self.motions == 2,
            Cut::Before | Cut::EndedLog => false,
        };
        assert!(!is_there, "dies here");
    }

    fn say(&mut self, _: &str) {}
}

/// Drives up to the run of this number; `false` where it died on the way.
fn goes(prepared: &Prepared, last: usize, dies: Cut) -> bool {
    let switch = StopSwitch::default();
    let mut watch = Watch { switch: switch.clone(), last, dies, motions: 0, was_moving: false };
    // What the recorder leaves behind when it is dropped is what a killed program leaves, but for the last chunk.
    let ended = catch_unwind(AssertUnwindSafe(|| drive(prepared, &switch, &mut Yes, &mut watch)));
    match ended {
        Err(_) => false,
        Ok(Ok(outcome)) => {
            assert_eq!(outcome.cut, Vec::<String>::new());
            true
        }
        Ok(Err(error)) => {
            assert!(error.to_string().starts_with("stopped by the operator"), "{error}");
            true
        }
    }
}

/// A complete run without a tick: what a campaign that goes on asks of it is its status.
fn done(folder: &Path, run: &PlannedRun, campaign: &str) {
    let meta = RunMeta {
        campaign: campaign.to_owned(),
        id: run.id.clone(),
        method: TOW.to_owned(),
        role: run.role,
        log_rate_hz: 100.0,
        ..RunMeta::default()
    };
    let layout = Layout::carriage(false, true, &[]).unwrap();
    Recorder::create(folder, meta, layout, Packing::Lz4).unwrap().finish(RunStatus::Complete).unwrap();
}

fn files(folder: &Path, name: &str) -> [PathBuf; 2] {
    ["mcap", "toml"].map(|e| folder.join(format!("{name}.{e}")))
}

/// Cuts the campaign in the run after the first `k`, lets it go on for one run, and looks at what lies there.
fn cut_and_resumed(campaign: &Path, k: usize, cut: Cut) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("runs");
    let prepared = prepared(campaign, &out);
    let runs: Vec<&PlannedRun> = prepared.runs().collect();
    std::fs::create_dir(&out).unwrap();
    std::fs::copy(campaign, out.join("campaign.toml")).unwrap();
    let name = prepared.name().to_owned();
    runs[..k].iter().for_each(|run| done(&out, run, &name));
    let content = |run: &&PlannedRun| files(&out, &run.id).map(|p| std::fs::read(p).unwrap());
    let before: Vec<_> = runs[..k].iter().map(content).collect();
    let (run, what) = (runs[k], format!("{} cut: {cut:?}", runs[k].id));
    let aside = format!("{}.interrupted-1", run.id);

    match cut {
        Cut::Before => {}
        Cut::EndedLog => {
            assert!(goes(&prepared, k + 1, cut), "{what}");
            let [_, sidecar] = files(&out, &run.id);
            let meta = RunMeta { status: RunStatus::Running, ..read_run_meta(&sidecar).unwrap() };
            write_run_meta(&sidecar, &meta).unwrap();
        }
        _ => assert!(!goes(&prepared, k + 1, cut), "{what}: it never came there"),
    }
    match cut {
        Cut::NoSidecar => std::fs::remove_file(&files(&out, &run.id)[1]).unwrap(),
        Cut::HalfAside => std::fs::rename(&files(&out, &run.id)[0], &files(&out, &aside)[0]).unwrap(),
        _ => {}
    }

    assert!(goes(&prepared, k + 1, Cut::Before), "{what}");
    let log = read_run(&files(&out, &run.id)[0]).unwrap();
    assert_eq!((log.meta.status, log.meta.id.as_str()), (RunStatus::Complete, run.id.as_str()), "{what}");
    assert!(log.time_s.len() > 100 && log.lost.is_empty(), "{what}: {} ticks", log.time_s.len());
    let kept = files(&out, &aside).map(|p| p.exists());
    let expected = match cut {
        Cut::Before | Cut::Homing | Cut::Approach => [false, false],
        Cut::NoSidecar => [true, false],
        Cut::Tow | Cut::Brake | Cut::EndedLog | Cut::HalfAside => [true, true],
    };
    assert_eq!(kept, expected, "{what}");
    assert_eq!(runs[..k].iter().map(content).collect::<Vec<_>>(), before, "{what}: a finished run was touched");
    let next = runs.get(k + 1).map(|r| files(&out, &r.id)[0].exists());
    assert_ne!(next, Some(true), "{what}: one run was to be driven");
}

/// One run of each kind (and weight), the first and the last, and those that once failed.
fn spread(runs: &[&PlannedRun]) -> Vec<usize> {
    let mut out: Vec<usize> = ONCE_FAILED.iter().map(|number| number - 1).collect();
    let mut seen = Vec::new();
    for (k, run) in runs.iter().enumerate() {
        let sort = (run.role, run.body, run.hung_weight_n.to_bits());
        if !seen.contains(&sort) {
            seen.push(sort);
            out.push(k);
        }
    }
    out.push(runs.len() - 1);
    out.sort_unstable();
    out
}

#[test]
fn a_campaign_that_was_cut_anywhere_goes_on_from_there() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = example(folder.path());
    let all = prepared(&campaign, &folder.path().join("none"));
    let runs: Vec<&PlannedRun> = all.runs().collect();
    assert_eq!(runs.len(), 205);
    assert!(ONCE_FAILED.iter().all(|n| runs[n - 1].id.contains("-wet-")));
    // A panic that is meant says nothing.
    let loud = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        if !info.to_string().contains("dies here") {
            loud(info);
        }
    }));
    let phases: Option<usize> = std::env::var("FROUDE_TEST_RESUMES").ok().map(|n| n.parse().unwrap());
    let jobs: Vec<(usize, Cut)> = match phases {
        Some(n) => (0..runs.len()).flat_map(|k| (0..n).map(move |i| (k, CUTS[(k + i) % CUTS.len()]))).collect(),
        None => spread(&runs).into_iter().zip(CUTS.into_iter().cycle()).collect(),
    };
    let n = jobs.len();
    for (k, cut) in jobs {
        cut_and_resumed(&campaign, k, cut);
    }
    println!("{n} cuts, all resumed");
}
