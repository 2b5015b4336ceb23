//! Logs with sidecars that were damaged: imported and conditioned, they give a run or an error, and never a panic. `PROPTEST_CASES=200000` runs as many.

use std::path::Path;

use froude_records::csv_table::parse_csv;
use froude_records::run::run_of_table;
use froude_records::sidecar::parse_sidecar;
use froude_tank::conditioning::condition;
use froude_tank::log::TankLog;
use proptest::prelude::*;

const SEEDS: [&[u8]; 3] = [
    include_bytes!("../../../../fuzz/seeds/run_log/all"),
    include_bytes!("../../../../fuzz/seeds/run_log/plain"),
    include_bytes!("../../../../fuzz/seeds/run_log/oscillation"),
];

/// What is put in the place of something else.
const WORDS: [&str; 24] = [
    "0",
    "-1",
    "1e300",
    "1e-300",
    "nan",
    "\"\"",
    "\"0 s\"",
    "\"1e49 s\"",
    "\"-3 N\"",
    "[]",
    "[[]]",
    "{}",
    "true",
    "\"cell\"",
    "\"body\"",
    "\"camera\"",
    "\"log\"",
    "\"±1 uV\"",
    "\"f_x\"",
    "0.05",
    "\"g1\"",
    "\"butterworth\"",
    "\"0.2 s\"",
    "5",
];

/// One change of a text: which, where, and with what.
type Change = (u8, u16, u8);

fn changed(text: &str, changes: &[Change]) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    for &(what, at, with) in changes {
        if lines.is_empty() {
            break;
        }
        let i = usize::from(at) % lines.len();
        let word = WORDS[usize::from(with) % WORDS.len()];
        match what % 6 {
            0 => drop(lines.remove(i)),
            1 => {
                let line = lines[i].clone();
                lines.insert((i + usize::from(with)) % (lines.len() + 1), line);
            }
            // The value of a key, or a cell.
            2 => {
                let line = &lines[i];
                lines[i] = match line.split_once('=') {
                    Some((key, _)) => format!("{key}= {word}"),
                    None => line
                        .split(',')
                        .enumerate()
                        .map(|(k, c)| if k == usize::from(with) % 5 { word } else { c })
                        .collect::<Vec<_>>()
                        .join(","),
                };
            }
            // A value inside of an entry.
            3 => {
                let parts: Vec<&str> = lines[i].split(", ").collect();
                let k = usize::from(with) % parts.len();
                let part =
                    parts[k].split_once(" = ").map_or_else(|| word.to_owned(), |(key, _)| format!("{key} = {word}"));
                let mut parts: Vec<String> = parts.into_iter().map(str::to_owned).collect();
                parts[k] = part;
                lines[i] = parts.join(", ");
            }
            4 => {
                let cut: String = lines[i].chars().take(usize::from(with) % 40).collect();
                lines[i] = cut;
            }
            _ => {
                let j = usize::from(with) % lines.len();
                lines.swap(i, j);
            }
        }
    }
    lines.join("\n") + "\n"
}

proptest! {
    #![proptest_config(ProptestConfig { max_shrink_iters: 1000, ..ProptestConfig::default() })]

    #[test]
    fn a_damaged_sidecar_gives_a_run_or_an_error(
        seed in 0_usize..3, sidecar in prop::collection::vec(any::<Change>(), 0..4), log in prop::collection::vec(any::<Change>(), 0..3),
    ) {
        let (length, rest) = SEEDS[seed].split_first_chunk::<2>().unwrap();
        let (own, csv) = rest.split_at(usize::from(u16::from_le_bytes(*length)));
        let text = changed(std::str::from_utf8(own).unwrap(), &sidecar);
        let csv = changed(std::str::from_utf8(csv).unwrap(), &log);
        let sidecar = match parse_sidecar(Path::new("run.toml"), &text) {
            Ok(sidecar) => sidecar,
            Err(error) => {
                prop_assert!(error.to_string().starts_with("run.toml"), "{}", error);
                return Ok(());
            }
        };
        let Ok(table) = parse_csv(Path::new("run.csv"), &csv, Some(&sidecar)) else { return Ok(()) };
        for method in ["steady", "forced_oscillation", "another"] {
            let Ok(run) = run_of_table(&table, Some(&sidecar)) else { return Ok(()) };
            let mut run = TankLog::from(run);
            if let Err(error) = condition(&mut run, method) {
                let text = error.to_string();
                prop_assert!(text.starts_with("run.csv") || text.starts_with("run.toml"), "{}", text);
                continue;
            }
            prop_assert!(run.log.time_s.windows(2).all(|w| w[0] < w[1]));
            prop_assert!(run.log.channels.values().all(|channel| channel.values.len() == run.log.time_s.len()));
            prop_assert!(run.done.iter().flat_map(|step| step.parameters.values()).all(|p| p.value.is_finite()));
        }
    }
}

/// The seeds themselves go through: else the test above looks at nothing.
#[test]
fn the_seeds_are_conditioned() {
    for seed in SEEDS {
        let (length, rest) = seed.split_first_chunk::<2>().unwrap();
        let (own, csv) = rest.split_at(usize::from(u16::from_le_bytes(*length)));
        let sidecar = parse_sidecar(Path::new("run.toml"), std::str::from_utf8(own).unwrap()).unwrap();
        let table = parse_csv(Path::new("run.csv"), std::str::from_utf8(csv).unwrap(), Some(&sidecar)).unwrap();
        let mut run = TankLog::from(run_of_table(&table, Some(&sidecar)).unwrap());
        condition(&mut run, "steady").unwrap();
        assert!(run.done.len() >= 2, "{:?}", run.done);
    }
}
