//! Lines of the validation page.

/// How a line ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The figure is within the stated band.
    Pass,
    /// The figure is outside the stated band.
    Miss,
    /// A figure that contradicts a paper or a data set, as expected to be found.
    Finding,
    /// A figure without an acceptance band.
    Measured,
    /// The data are not there.
    Skipped,
}

impl Verdict {
    /// Of something that must hold where it is judged, and is reported where it is not.
    pub fn of(is_judged: bool, holds: bool) -> Self {
        match (is_judged, holds) {
            (true, true) => Self::Pass,
            (true, false) => Self::Miss,
            (false, _) => Self::Measured,
        }
    }
}

/// One line.
#[derive(Debug, Clone)]
pub struct Line {
    /// Section of the page.
    pub section: &'static str,
    /// What is claimed.
    pub claim: String,
    /// What was expected, with its source.
    pub expected: String,
    /// What was found.
    pub found: String,
    /// How it ended.
    pub verdict: Verdict,
}

impl Line {
    /// The line for a terminal, without its verdict.
    pub fn text(&self) -> String {
        format!("{}: {} (expected {})", self.claim, self.found, self.expected)
    }
}

/// All lines.
#[derive(Debug, Default)]
pub struct Claims {
    /// In order.
    pub lines: Vec<Line>,
    /// Intervals that were judged in the family of the tank methods.
    pub tank_intervals: usize,
}

impl Claims {
    /// A line that is what it is.
    pub fn add(&mut self, section: &'static str, claim: &str, expected: &str, found: String, verdict: Verdict) {
        // The page is read elsewhere: files are named from the project's root.
        let here = concat!(env!("CARGO_MANIFEST_DIR"), "/../../");
        let found = found.replace(here, "");
        eprintln!("[{verdict:?}] {section}: {claim}: {found}");
        self.lines.push(Line { section, claim: claim.to_owned(), expected: expected.to_owned(), found, verdict });
    }

    /// A number against a value and a half-width, both stated before the run.
    pub fn near(
        &mut self,
        section: &'static str,
        claim: &str,
        found: f64,
        expected: f64,
        half_width: f64,
        source: &str,
    ) {
        let verdict = if (found - expected).abs() <= half_width { Verdict::Pass } else { Verdict::Miss };
        self.add(section, claim, &format!("{expected} ± {half_width} ({source})"), format!("{found:.5}"), verdict);
    }

    /// Something that must hold.
    pub fn holds(&mut self, section: &'static str, claim: &str, expected: &str, found: String, holds: bool) {
        self.add(section, claim, expected, found, if holds { Verdict::Pass } else { Verdict::Miss });
    }

    /// The lines for a terminal.
    pub fn text(&self) -> String {
        let mut out = String::new();
        for (section, lines) in self.sections() {
            out += &format!("\n{section}\n");
            for l in lines {
                out += &format!("  [{}] {}\n", mark(l.verdict), l.text());
            }
        }
        out
    }

    /// Sections in the order in which they begin; parts that run beside each other come back to one.
    fn sections(&self) -> Vec<(&'static str, Vec<&Line>)> {
        let mut out: Vec<(&'static str, Vec<&Line>)> = Vec::new();
        for line in &self.lines {
            match out.iter_mut().find(|(section, _)| *section == line.section) {
                Some((_, lines)) => lines.push(line),
                None => out.push((line.section, vec![line])),
            }
        }
        out
    }

    /// The page of the book.
    pub fn page(&self, repetitions: usize) -> String {
        let mut out = format!(
            "# Validation\n\nThis page is written by `cargo xtask validate`; no figure is typed by hand. Coverage cases ran \
             {repetitions} seeded repetitions. *Pass*: within the band stated before the run. *Miss*: outside it. *Finding*: \
             a figure that contradicts a paper or a data set. *Measured*: a figure without an acceptance band. *Skipped*: the data are not \
             part of this repository and were not there.\n"
        );
        let cell = |t: &str| t.replace('|', "\\|").replace('\n', "<br>");
        for (section, lines) in self.sections() {
            out += &format!("\n## {section}\n\n| | claim | expected | found |\n| --- | --- | --- | --- |\n");
            for l in lines {
                out += &format!(
                    "| {} | {} | {} | {} |\n",
                    mark(l.verdict),
                    cell(&l.claim),
                    cell(&l.expected),
                    cell(&l.found)
                );
            }
        }
        out
    }
}

/// An old page with the sections of a new one in the place of its own of the same title, or at its end.
pub fn with_sections_of(old: &str, new: &str) -> String {
    let parts = |page: &str| -> Vec<String> { page.split("\n## ").map(str::to_owned).collect() };
    let title = |section: &str| section.lines().next().unwrap_or_default().to_owned();
    let mut out = parts(old);
    for section in parts(new).into_iter().skip(1) {
        let section = section.trim_end().to_owned() + "\n";
        match out.iter().skip(1).position(|s| title(s) == title(&section)) {
            Some(place) => out[place + 1] = section,
            None => out.push(section),
        }
    }
    out.join("\n## ")
}

/// Title of the section that a page opens with.
const OVERVIEW: &str = "Summary";

/// A page with one screen before its sections: how many lines of each hold, contradict a source, or miss.
pub fn with_overview(page: &str) -> String {
    let mut sections: Vec<&str> = page.split("\n## ").collect();
    sections.retain(|section| !section.starts_with(OVERVIEW));
    let Some((head, sections)) = sections.split_first() else { return page.to_owned() };
    let marks = [Verdict::Pass, Verdict::Finding, Verdict::Measured, Verdict::Skipped, Verdict::Miss].map(mark);
    let counts = |section: &str| marks.map(|m| section.lines().filter(|l| l.starts_with(&format!("| {m} |"))).count());
    let mut table = String::new();
    let mut total = [0; 5];
    for section in sections {
        let title = section.lines().next().unwrap_or_default();
        let own = counts(section);
        total = std::array::from_fn(|i| total[i] + own[i]);
        table += &format!("| [{title}](#{}) | {} |\n", anchor(title), own.map(|n| n.to_string()).join(" | "));
    }
    let missed: Vec<&str> = sections
        .iter()
        .flat_map(|s| s.lines())
        .filter(|l| l.starts_with(&format!("| {} |", mark(Verdict::Miss))))
        .collect();
    let misses = if missed.is_empty() {
        "No line misses its band.".to_owned()
    } else {
        format!("What misses:\n\n| | claim | expected | found |\n| --- | --- | --- | --- |\n{}", missed.join("\n"))
    };
    format!(
        "{}\n\n## {OVERVIEW}\n\n{} lines pass, {} contradict a paper or a data set, {} are measured without an acceptance band, {} were skipped, {} miss. {misses}\n\n\
         | section | pass | finding | measured | skipped | miss |\n| --- | --: | --: | --: | --: | --: |\n{table}\n## {}",
        head.trim_end(),
        total[0],
        total[1],
        total[2],
        total[3],
        total[4],
        sections.join("\n## ")
    )
}

/// The anchor that mdBook gives a heading: letters and digits in lower case, spaces as dashes, all else left out.
fn anchor(title: &str) -> String {
    let of = |c: char| match c {
        ' ' => Some('-'),
        '-' | '_' => Some(c),
        c if c.is_alphanumeric() => Some(c.to_ascii_lowercase()),
        _ => None,
    };
    title.chars().filter_map(of).collect()
}

fn mark(v: Verdict) -> &'static str {
    match v {
        Verdict::Pass => "pass",
        Verdict::Miss => "MISS",
        Verdict::Finding => "finding",
        Verdict::Measured => "measured",
        Verdict::Skipped => "skipped",
    }
}
