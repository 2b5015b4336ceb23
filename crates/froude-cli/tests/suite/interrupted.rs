//! Every call by which a job writes fails once, or is the last one before a `kill -9`: the folder then holds the old files or the new ones,
//! never half of them, and what else is left the next run clears.

use std::collections::BTreeMap;
use std::os::unix::process::ExitStatusExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use froude::records::manifest::{MANIFEST, first_alien};

/// How many faults each job sees; `all` for every call with every fault.
const FAULTS: &str = "FROUDE_TEST_FAULTS";
/// Without it.
const FEW: usize = 8;

/// The calls by which files come into being.
const CALLS: [&str; 8] = ["write", "fsync", "rename", "renameat", "renameat2", "openat", "mkdir", "mkdirat"];

/// What strace makes of such a call.
const KINDS: [&str; 3] = ["error=ENOSPC", "error=EIO", "signal=KILL"];

/// Files and their content, but not what an unfinished job left.
type State = BTreeMap<PathBuf, Vec<u8>>;

fn state(folder: &Path) -> State {
    fn walk(folder: &Path, root: &Path, out: &mut State) {
        for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
            let path = entry.path();
            if entry.file_name().to_string_lossy().starts_with(".froude-") {
                continue;
            }
            if path.is_dir() {
                walk(&path, root, out);
            } else {
                out.insert(path.strip_prefix(root).unwrap().to_owned(), std::fs::read(&path).unwrap());
            }
        }
    }
    let mut out = State::new();
    walk(folder, folder, &mut out);
    out
}

fn left_over(folder: &Path) -> usize {
    let names = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name());
    names.filter(|n| n.to_string_lossy().starts_with(".froude-")).count()
}

fn copy(from: &Path, to: &Path) {
    for (name, content) in state(from) {
        let path = to.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    }
}

fn froude(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_froude")).args(args).current_dir(folder).output().unwrap()
}

/// The program below strace; one thread computes, so that calls come in one order.
fn traced(folder: &Path, args: &[&str], options: &[&str]) -> Output {
    Command::new("strace")
        .args(["-f", "-qq"])
        .args(options)
        .arg(env!("CARGO_BIN_EXE_froude"))
        .args(args)
        .current_dir(folder)
        .env("RAYON_NUM_THREADS", "1")
        .output()
        .expect("this test needs strace; cargo xtask test installs it")
}

/// How often the program's first thread makes each call.
fn counted(folder: &Path, args: &[&str]) -> Vec<(&'static str, usize)> {
    let log = folder.join("calls");
    let trace = format!("trace={}", CALLS.join(","));
    let done = traced(folder, args, &["-o", log.to_str().unwrap(), "-e", &trace]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let text = String::from_utf8_lossy(&std::fs::read(&log).unwrap()).into_owned();
    let first = text.split_whitespace().next().unwrap().to_owned();
    let own = |call: &str| {
        text.lines()
            .filter_map(|line| line.strip_prefix(&first))
            .filter(|line| line.trim_start().strip_prefix(call).is_some_and(|rest| rest.starts_with('(')))
            .count()
    };
    CALLS.map(|call| (call, own(call))).into_iter().filter(|(_, n)| *n > 0).collect()
}

/// Whether everything is new: the files of an undisturbed run, bit by bit, or, in a folder of results whose sums may end in another last digit
/// each time, as its own list of fingerprints has them.
fn is_new(folder: &Path, results: Option<&str>, old: &State, new: &State) -> bool {
    let found = state(folder);
    found == *new
        || results.is_some_and(|results| {
            let is_own = |name: &PathBuf| name.starts_with(results);
            let inputs = |s: &State| {
                s.iter().filter(|(name, _)| !is_own(name)).map(|(n, c)| (n.clone(), c.clone())).collect::<State>()
            };
            let list = Path::new(results).join(MANIFEST);
            found.keys().eq(new.keys())
                && inputs(&found) == inputs(new)
                && found[&list] != old[&list]
                && first_alien(&folder.join(results)).unwrap().is_none()
        })
}

/// Runs a job with faults in a copy of `template`, which holds what it reads and what an earlier run wrote. `results`: a folder of
/// which the last digits are not those of every run.
fn endures(template: &Path, args: &[&str], results: Option<&str>) {
    let fresh = || {
        let folder = tempfile::tempdir().unwrap();
        copy(template, folder.path());
        folder
    };
    let old = state(template);
    let undisturbed = fresh();
    let done = froude(undisturbed.path(), args);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let new = state(undisturbed.path());
    assert!(old != new && left_over(undisturbed.path()) == 0);

    let mut points: Vec<(&str, usize, &str)> = Vec::new();
    for (call, n) in counted(fresh().path(), args) {
        points.extend((1..=n).flat_map(|k| KINDS.map(|kind| (call, k, kind))));
    }
    let all = points.len();
    let asked = std::env::var(FAULTS).ok();
    let some = asked.as_deref().map_or(FEW, |n| n.parse().unwrap_or(all)).clamp(1, all);
    // Evenly over all calls, each kind in its turn.
    let (mut olds, mut news, mut cleared) = (0, 0, 0);
    for i in 0..some {
        let at = (2 * i + 1) * all / (2 * some);
        let (call, k, kind) = points[if some == all { at } else { at - at % 3 + i % 3 }];
        let folder = fresh();
        let what = format!("{call} {k}, {kind}");
        let inject = format!("inject={call}:{kind}:when={k}");
        let done = traced(folder.path(), args, &["-o", "/dev/null", "-e", &format!("trace={call}"), "-e", &inject]);
        assert!(kind != "signal=KILL" || done.status.signal() == Some(9), "{what}: it was not killed");
        let found = state(folder.path());
        let said = String::from_utf8_lossy(&done.stderr);
        if is_new(folder.path(), results, &old, &new) {
            news += 1;
        } else {
            let names = |s: &State| s.keys().cloned().collect::<Vec<_>>();
            // A list that names both is written before a table takes its place.
            let files = |s: &State| {
                s.iter()
                    .filter(|(name, _)| !name.ends_with(MANIFEST))
                    .map(|(n, c)| (n.clone(), c.clone()))
                    .collect::<State>()
            };
            assert!(files(&found) == files(&old), "{what}: neither old nor new, but {:?}; {said}", names(&found));
            assert!(!done.status.success(), "{what}: success is claimed of old files");
            olds += 1;
        }
        if kind != "signal=KILL" && !done.status.success() {
            assert!(!said.trim().is_empty() && !said.contains("panicked"), "{what}: {said}");
        }
        let is_listed_alone =
            found != old && found.keys().eq(old.keys()) && !is_new(folder.path(), results, &old, &new);
        if left_over(folder.path()) > 0 || is_listed_alone {
            let again = froude(folder.path(), args);
            assert!(again.status.success(), "{what}, run again: {}", String::from_utf8_lossy(&again.stderr));
            assert_eq!(
                (left_over(folder.path()), is_new(folder.path(), results, &old, &new)),
                (0, true),
                "{what}, run again"
            );
            cleared += 1;
        }
    }
    println!(
        "{}: {some} of {all} faults: {olds} old, {news} new, {cleared} left something that the next run cleared",
        args[0]
    );
}

const TABLE: &str = "speed [m/s],f_x [N]\n0.1,-0.5\n0.2,-2.0\n0.3,-4.4\n0.4,-8.1\n0.5,-12.4\n";

#[test]
fn identify_replaces_old_results_or_leaves_them() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("t.csv"), TABLE).unwrap();
    assert!(froude(at, &["identify", "t.csv"]).status.success());
    std::fs::write(at.join("t.csv"), TABLE.replace("12.4", "12.6")).unwrap();
    endures(at, &["identify", "t.csv", "--models", "quadratic"], None);
}

#[test]
fn identify_makes_its_first_results_or_none() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), TABLE).unwrap();
    endures(folder.path(), &["identify", "t.csv", "--models", "quadratic"], None);
}

/// What a network disk does: it cannot exchange two folders.
#[test]
fn a_disk_that_cannot_exchange_folders_takes_two_renames() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("t.csv"), TABLE).unwrap();
    assert!(froude(at, &["identify", "t.csv"]).status.success());
    let old = state(at);
    let args = ["identify", "t.csv", "--models", "quadratic"];
    let cannot = ["-o", "/dev/null", "-e", "trace=renameat2,rename", "-e", "inject=renameat2:error=EINVAL"];
    let done = traced(at, &args, &cannot);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let new = state(at);
    assert!(new != old && left_over(at) == 0);
    // Killed between the two: the old folder stands aside, and the next run begins by putting it back.
    std::fs::rename(at.join("t-results"), at.join(".froude-old-t-results")).unwrap();
    std::fs::write(at.join("t.csv"), "speed [m/s],f_x [N]\n0.1,nothing\n").unwrap();
    assert!(!froude(at, &args).status.success());
    std::fs::write(at.join("t.csv"), TABLE).unwrap();
    assert!(froude(at, &["identify", "t.csv"]).status.success());
    assert_eq!((state(at) == old, left_over(at)), (true, 0));
}

#[test]
fn added_mass_replaces_old_results_or_leaves_them() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let egg = |x: &str| {
        format!(
            "schema = 1\nname = \"egg\"\n[fluid]\ndensity = \"1025 kg/m^3\"\n[body]\nshape = \"ellipsoid\"\nsemi_axis_x = \"{x}\"\n\
             semi_axis_y = \"0.3 m\"\nsemi_axis_z = \"0.2 m\"\n"
        )
    };
    let args = ["added-mass", "egg.toml", "--tolerance", "50 %", "--export", "csv"];
    std::fs::write(at.join("egg.toml"), egg("0.4 m")).unwrap();
    assert!(froude(at, &args).status.success());
    std::fs::write(at.join("egg.toml"), egg("0.5 m")).unwrap();
    endures(at, &args, Some("egg-added-mass"));
}

#[test]
fn simulate_replaces_an_old_table_or_leaves_it() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let campaign = "schema = 1\nname = \"twin\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[[source]]\nname = \"tank\"\nkind = \"tank\"\n\
        table = \"twin.csv\"\n[[source.plan]]\nspeed = [\"0.1 m/s\", \"0.2 m/s\", \"0.3 m/s\"]\n[simulate]\nseed = 7\n\
        model = \"quadratic\"\n[simulate.coefficients]\nD_x_II = 50.0\n[[simulate.sensor]]\nquantity = \"f_x\"\nnoise = \"0.02 N\"\n";
    std::fs::write(at.join("c.toml"), campaign).unwrap();
    assert!(froude(at, &["simulate", "c.toml"]).status.success());
    std::fs::write(at.join("c.toml"), campaign.replace("seed = 7", "seed = 8")).unwrap();
    endures(at, &["simulate", "c.toml", "--replace"], None);
}

#[test]
fn a_demo_is_there_or_not() {
    let folder = tempfile::tempdir().unwrap();
    endures(folder.path(), &["demo", "here"], None);
}
