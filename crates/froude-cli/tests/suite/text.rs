//! Text is only text: what steers a terminal, or turns the order of letters, never reaches one, wherever it came from.

use std::path::Path;
use std::process::{Command, Output};

/// A colour, a cleared screen by its one-character form, a bell, an overwritten line, an erased letter, delete, a turned order by
/// override, isolate and mark, and a letter that shows nothing.
const HIDDEN: [char; 10] =
    ['\u{1b}', '\u{9b}', '\u{7}', '\r', '\u{8}', '\u{7f}', '\u{202e}', '\u{2066}', '\u{61c}', '\u{200b}'];

/// All that may stand in the output of a terminal: letters and line feeds.
fn is_plain(c: char) -> bool {
    c == '\n'
        || !(c.is_control()
            || HIDDEN.contains(&c)
            || ('\u{202a}'..='\u{202e}').contains(&c)
            || ('\u{2066}'..='\u{2069}').contains(&c))
}

fn froude(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_froude")).args(args).current_dir(folder).output().unwrap()
}

/// A place where somebody else's text stands: files with `@` for it, what is run on them, and whether that succeeds.
struct Place {
    what: &'static str,
    files: &'static [(&'static str, &'static str)],
    args: &'static [&'static str],
    is_fine: bool,
}

const TABLE: &str = "speed [m/s],f_x [N]\n0.1,-0.5\n0.2,-2.0\n0.3,-4.4\n0.4,-8.1\n0.5,-12.4\n";
const NAMED: &str = "schema = 1\nname = \"c\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[[source]]\nname = \"a@b\"\nkind = \"tank\"\n\
    table = \"t.csv\"\n[identify]\nmodels = [\"quadratic\"]\n";
const TWIN: &str = "schema = 1\nname = \"c\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[[source]]\nname = \"a@b\"\nkind = \"tank\"\n\
    table = \"twin.csv\"\n[[source.plan]]\nspeed = [\"0.1 m/s\", \"0.2 m/s\", \"0.3 m/s\"]\n[identify]\n[simulate]\nseed = 7\n\
    model = \"quadratic\"\n[simulate.coefficients]\nD_x_II = 50.0\n";
const BODY: &str = "schema = 1\nname = \"a@b\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[body]\nshape = \"ellipsoid\"\n\
    semi_axis_x = \"0.4 m\"\nsemi_axis_y = \"0.3 m\"\nsemi_axis_z = \"0.2 m\"\n";

/// The places; each with all of [`HIDDEN`].
const PLACES: [Place; 14] = [
    Place { what: "a word of the command line", files: &[], args: &["a@b"], is_fine: false },
    Place { what: "an option", files: &[], args: &["identify", "--a@b", "x"], is_fine: false },
    Place {
        what: "a value of an option",
        files: &[],
        args: &["added-mass", "m.obj", "--density", "a@b"],
        is_fine: false,
    },
    Place { what: "the name of a file that is not there", files: &[], args: &["inspect", "a@b.csv"], is_fine: false },
    Place { what: "the name of a file", files: &[("a@b.csv", TABLE)], args: &["identify", "a@b.csv"], is_fine: true },
    Place {
        what: "a header",
        files: &[("t.csv", "speed [m/s],f_x [N],\"a@b [m]\"\n0.1,-0.5,1\n0.2,-2,2\n")],
        args: &["inspect", "t.csv"],
        is_fine: true,
    },
    Place {
        what: "a header without unit",
        files: &[("t.csv", "\"spe@ed\",f_x [N]\n0.1,-0.5\n")],
        args: &["identify", "t.csv"],
        is_fine: false,
    },
    Place {
        what: "a cell",
        files: &[("t.csv", "speed [m/s],f_x [N]\n0.1,\"a@b\"\n")],
        args: &["identify", "t.csv"],
        is_fine: false,
    },
    Place {
        what: "the name of a source",
        files: &[("t.csv", TABLE), ("c.toml", NAMED)],
        args: &["identify", "c.toml"],
        is_fine: true,
    },
    Place {
        what: "a source, inspected",
        files: &[("t.csv", TABLE), ("c.toml", NAMED)],
        args: &["inspect", "c.toml"],
        is_fine: true,
    },
    Place { what: "a source of a twin", files: &[("c.toml", TWIN)], args: &["simulate", "c.toml"], is_fine: true },
    Place {
        what: "a key",
        files: &[("c.toml", "schema = 1\nname = \"c\"\n\"a@b\" = 1\n")],
        args: &["inspect", "c.toml"],
        is_fine: false,
    },
    Place {
        what: "the name of a body",
        files: &[("b.toml", BODY)],
        args: &["added-mass", "b.toml", "--tolerance", "50 %"],
        is_fine: true,
    },
    Place {
        what: "a mesh",
        files: &[("m.obj", "v 0 0 a@b\n")],
        args: &["added-mass", "m.obj", "--density", "1 kg/m^3"],
        is_fine: false,
    },
];

/// The text for a format: TOML takes controls by their escapes only.
fn written(name: &str, text: &str, c: char) -> String {
    let is_toml = Path::new(name).extension().is_some_and(|e| e == "toml");
    text.replace('@', &if is_toml { format!("\\U{:08x}", u32::from(c)) } else { c.to_string() })
}

#[test]
fn nothing_that_steers_a_terminal_reaches_one() {
    let mut cases = 0;
    for place in &PLACES {
        // A carriage return in a mesh is the end of a line.
        for c in HIDDEN.into_iter().filter(|c| *c != '\r' || place.what != "a mesh") {
            let folder = tempfile::tempdir().unwrap();
            for (name, text) in place.files {
                std::fs::write(folder.path().join(name.replace('@', &c.to_string())), written(name, text, c)).unwrap();
            }
            let args: Vec<String> = place.args.iter().map(|a| a.replace('@', &c.to_string())).collect();
            let args: Vec<&str> = args.iter().map(String::as_str).collect();
            let output = froude(folder.path(), &args);
            let what = format!("{}, U+{:04X}", place.what, u32::from(c));
            let said = [output.stdout, output.stderr].map(|b| String::from_utf8(b).unwrap()).concat();
            assert_eq!(output.status.success(), place.is_fine, "{what}: {said:?}");
            assert!(said.chars().all(is_plain), "{what}: {said:?}");
            // Shown, and not dropped: as \u{1b} or, in a quoted text, as Rust's \r.
            let shown = [c.escape_unicode().to_string(), c.escape_debug().to_string()];
            assert!(shown.iter().any(|s| said.contains(s.as_str())), "{what}: {said:?}");
            cases += 1;
        }
    }
    assert_eq!(cases, PLACES.len() * HIDDEN.len() - 1);
}

#[test]
fn json_keeps_them_as_its_own_escapes() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), TABLE).unwrap();
    for c in HIDDEN {
        std::fs::write(folder.path().join("c.toml"), written("c.toml", NAMED, c)).unwrap();
        let output = froude(folder.path(), &["--json", "inspect", "c.toml"]);
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.chars().all(is_plain), "{text:?}");
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(value["sources"][0]["name"], format!("a{c}b"));
    }
}

#[test]
fn a_report_runs_and_loads_nothing_and_turns_no_order() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), TABLE).unwrap();
    let evil = NAMED.replace("a@b", r"<script>alert(1)</script>\u202efdp.exe\u001b[2J");
    std::fs::write(folder.path().join("c.toml"), evil).unwrap();
    assert!(froude(folder.path(), &["identify", "c.toml"]).status.success());
    let page = std::fs::read_to_string(folder.path().join("c-results/report.html")).unwrap();
    let policy = "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; \
                  form-action 'none'\">";
    let at = page.find(policy).expect("a policy");
    assert!(at < page.find("<title").unwrap() && at < page.find("<style").unwrap(), "it holds for what follows it");
    // All that the page is made of is allowed by it: nothing is fetched, and there is no script.
    for forbidden in
        ["<script", "src=", "url(", "@import", "<link", "<iframe", "<object", "<form", "javascript:", " onload"]
    {
        assert!(!page.contains(forbidden), "{forbidden}");
    }
    assert!(page.contains("&lt;script&gt;") && page.contains(r"\u{202e}fdp.exe"));
    assert!(page.chars().all(is_plain));
    for figure in std::fs::read_dir(folder.path().join("c-results/figures")).unwrap() {
        assert!(std::fs::read_to_string(figure.unwrap().path()).unwrap().chars().all(is_plain));
    }
}
