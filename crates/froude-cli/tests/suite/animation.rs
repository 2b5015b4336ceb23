//! The animation of a swim: small, and used in a browser as a person does, where Chromium is installed (`FROUDE_BROWSER` names another).

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::bench::{froude, text};
use serde_json::Value;

const GAIT: [&str; 6] = ["--amplitude", "30 deg", "--frequency", "80 deg/s", "--phase", "40 deg"];
/// 2π over the frequency.
const PERIOD_S: f64 = 360.0 / 80.0;

/// The page of the example in a current, and what the verb says.
fn page(folder: &Path, periods: &str) -> (PathBuf, Value) {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/mamba-swim/robot.toml");
    let published = example.parent().unwrap().join("../mamba/published");
    let robot = std::fs::read_to_string(example).unwrap().replace("../mamba/published", text(&published));
    let robot = robot.replacen("[coefficients]", "current = [\"0.05 m/s\", \"-20 mm/s\"]\n[coefficients]", 1);
    let path = folder.join("robot.toml");
    std::fs::write(&path, robot).unwrap();
    let out = folder.join("swum");
    let more = ["--out", text(&out), "--periods", periods, "--json"];
    let output = froude(&[&["swim", text(&path)], &GAIT[..], &more].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let said: Value = serde_json::from_slice(&output.stdout).unwrap();
    (PathBuf::from(said["animation"].as_str().unwrap()), said)
}

/// A page of many periods shows its first ones, says so and stays small.
#[test]
fn a_long_animation_is_cut_and_stays_small() {
    let folder = tempfile::tempdir().unwrap();
    let (path, _) = page(folder.path(), "200");
    let page = std::fs::read_to_string(path).unwrap();
    assert!(page.len() < 2_000_000, "{} bytes", page.len());
    let data = page.split("application/json\">").nth(1).unwrap().split("</script>").next().unwrap();
    let data: Value = serde_json::from_str(data).unwrap();
    let frames = data["place"].as_array().unwrap().len();
    assert!(frames > 4000, "{frames}");
    assert_eq!(data["cut"], 200 * 100 + 1 - frames);
}

/// Keys, slider and button do what is written beneath, the readout follows, and everything in the legend is drawn; no error, no request.
#[test]
fn an_animation_is_used_in_a_browser() {
    let Some(browser) = browser() else {
        eprintln!("no Chromium here: the animation was not opened");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let (path, said) = page(folder.path(), "3");
    let page = std::fs::read_to_string(&path).unwrap();
    let watch = format!("<script>{}</script>", include_str!("animation/watch.js"));
    let probe = format!("<script>{}</script></body>", include_str!("animation/probe.js"));
    let probed = page.replacen("<title>", &format!("{watch}<title>"), 1).replacen("</body>", &probe, 1);
    let file = folder.path().join("probed.html");
    std::fs::write(&file, probed).unwrap();
    // Wide and light; narrow and dark; with less motion, where nothing moves before it is asked to.
    for (size, colours, moves) in [("1100,800", "1", "Pause"), ("390,780", "0", "Pause"), ("800,600", "1", "Play")] {
        let saw = opened(&browser, folder.path(), &file, [size, colours], moves == "Play");
        let number = |key: &str| saw[key].as_f64().unwrap_or_else(|| panic!("{key} of {saw}"));
        assert_eq!(saw["errors"], serde_json::json!([]), "{saw}");
        assert_eq!(saw["requests"], 0, "{saw}");
        for (key, expected) in
            [("at_first", moves), ("paused", "Play"), ("playing", "Pause"), ("clicked", "Play"), ("two_value", "2")]
        {
            assert_eq!(saw[key], expected, "{key} of {saw}");
        }
        // The readout has two decimals.
        let frame = PERIOD_S / 100.0;
        for (key, frames) in [
            ("home_s", 0.0),
            ("two_s", 2.0),
            ("one_s", 1.0),
            ("end_s", 300.0),
            ("beyond_s", 300.0),
            ("scrubbed_s", 10.0),
        ] {
            assert!((number(key) - frames * frame).abs() < 0.0051, "{key} of {saw}");
        }
        assert!(number("played_s") > number("scrubbed_s"), "{saw}");
        assert_ne!(saw["home_power_w"], saw["two_power_w"], "{saw}");
        for (name, points) in saw["ink"].as_object().unwrap() {
            assert!(points.as_u64().unwrap() > 20, "{name} of {saw}");
        }
        for key in ["wide", "framed", "end_value"] {
            assert_eq!(saw[key], true, "{key} of {saw}");
        }
        assert!(saw["text"].as_str().unwrap().contains(" m/s"), "{saw}");
        assert!(saw["title"].as_str().unwrap().contains(said["robot"].as_str().unwrap()), "{saw}");
        assert!(saw["label"].as_str().unwrap().contains("from above"), "{saw}");
    }
}

fn browser() -> Option<PathBuf> {
    if let Some(named) = std::env::var_os("FROUDE_BROWSER") {
        return Some(named.into());
    }
    let path = std::env::var_os("PATH")?;
    let names = ["chromium", "chromium-browser", "google-chrome"];
    std::env::split_paths(&path).flat_map(|at| names.map(|name| at.join(name))).find(|found| found.is_file())
}

/// What the probe left in the document.
fn opened(browser: &Path, folder: &Path, file: &Path, [size, colours]: [&str; 2], is_still: bool) -> Value {
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--dump-dom", "--virtual-time-budget=5000"])
        .arg(format!("--user-data-dir={}", text(&folder.join("profile"))))
        .arg(format!("--window-size={size}"))
        .arg(format!("--blink-settings=preferredColorScheme={colours}"))
        .args(is_still.then_some("--force-prefers-reduced-motion"))
        .arg(format!("file://{}", text(file)))
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let document = String::from_utf8_lossy(&output.stdout);
    let saw = document.split("<pre id=\"saw\">").nth(1).and_then(|rest| rest.split("</pre>").next());
    let saw = saw.unwrap_or_else(|| panic!("{document:.2000}\n{}", String::from_utf8_lossy(&output.stderr)));
    serde_json::from_str(&saw.replace("&amp;", "&").replace("&lt;", "<").replace("&gt;", ">")).unwrap()
}
