//! What is told of the cases: their loads, how the files were understood, and what is doubtful.

use froude_records::block::{ResultTable, TableBuilder};
use froude_records::finding::{Finding, Severity};
use froude_records::number::plain;
use froude_records::text::counted;

use super::gathered::{Case, Gathered};
use super::judged::{DRIFT, norm};
use super::keys::ForcesSpec;
use crate::outcome::Status;
use crate::verb::{LOADS, unit};

/// Each case with its mean loads and the window that they are of.
pub(super) fn cases(gathered: &Gathered) -> ResultTable {
    let caption = "Mean loads of the water on the whole body, in its axes, with the window in the time of the files.";
    let t = TableBuilder::new("cases", caption, &gathered.cases);
    let mut columns = vec![
        t.text("case", "case", |case: &Case| case.setting.name.clone()),
        t.number("speed_m_s", "speed [m/s]", |case| case.setting.speed_m_s).plain(4),
        t.number("angle_rad", "angle [deg]", |case| case.setting.angle_rad).plain(4),
    ];
    for &k in &gathered.loads {
        let head = format!("{} [{}]", LOADS[k], unit(k));
        columns.push(t.uncertain(
            [LOADS[k], &format!("std_{}", LOADS[k])],
            &head,
            move |case| case.judged.window.mean[k],
            move |case| case.judged.window.std_of_mean[k],
        ));
    }
    columns.extend([
        t.count("rows", "rows", |case| case.rows),
        t.number("from", "from", |case| case.judged.span[0]).plain(5),
        t.number("to", "to", |case| case.judged.span[1]).plain(5),
        t.text("ended", "ended", |case| case.judged.status.word().to_owned()),
    ]);
    t.build(columns)
}

/// How the files were understood, and what is doubtful.
pub(super) fn findings(gathered: &Gathered, spec: &ForcesSpec) -> Vec<Finding> {
    let mut out = vec![
        Finding::new(Severity::Note, "openfoam-read", understood(gathered, spec)),
        Finding::new(Severity::Note, "openfoam-window", windows(&gathered.cases)),
    ];
    if let Some((name, why)) = gathered.without.first() {
        let more = gathered.without.len() - 1;
        let others = if more > 0 {
            let names: Vec<&str> = gathered.without.iter().skip(1).map(|(name, _)| name.as_str()).collect();
            format!("; also {}", names.join(", "))
        } else {
            String::new()
        };
        let cases = counted(gathered.without.len(), "case has", "cases have");
        out.push(warning("openfoam-cases-missing", format!("{cases} no usable mean loads: {name}: {why}{others}")));
    }
    let left = &gathered.settings.left_out;
    if !left.is_empty() {
        let folders = counted(left.len(), "folder with force files is", "folders with force files are");
        out.push(warning("openfoam-cases-left-out", format!("{folders} not among the cases: {}", left.join(", "))));
    }
    if let Some(first) = gathered.settings.contradicted.first() {
        let cases = counted(gathered.settings.contradicted.len(), "case", "cases");
        let text = format!(
            "the inflow of {cases} does not match the stated speed and angle: {first}. Check the pattern or the list, `turned`, and the sign of the angle (v = U (cos θ, −sin θ): at a positive one the water comes from port)"
        );
        out.push(warning("openfoam-inflow", text));
    }
    out.extend(across(gathered, spec));
    let notes: Vec<&String> = gathered.cases.iter().flat_map(|case| &case.read.notes).collect();
    if let Some(first) = notes.first() {
        let more = notes.len() - 1;
        let others = if more > 0 { format!(" (likewise {more} more)") } else { String::new() };
        out.push(Finding::new(Severity::Note, "openfoam-files", format!("{first}{others}")));
    }
    let swinging = gathered.cases.iter().filter(|case| case.judged.status == Status::Oscillating).count();
    if swinging > 0 {
        let text = format!(
            "the loads of {} swing about a steady mean, whose error is part of the intervals",
            counted(swinging, "case", "cases")
        );
        out.push(Finding::new(Severity::Note, "openfoam-oscillating", text));
    }
    out
}

/// Force across the body, over the whole force, beyond which a model that is declared whole may be a half.
const ACROSS: f64 = 0.2;

/// Half of a body, declared as a whole one, has a force across the plane that it ends at: the pressure of its other half is missing.
fn across(gathered: &Gathered, spec: &ForcesSpec) -> Option<Finding> {
    let is_across = |case: &&Case, k: usize| {
        let mean = &case.judged.window.mean;
        // With drift a side force is due.
        (k == 2 || case.setting.angle_rad.sin().abs() < 1e-6) && mean[k].abs() > ACROSS * norm(mean)
    };
    let whole = spec.plane.is_none().then_some([1, 2])?;
    let (k, cases) = whole.into_iter().filter(|k| gathered.loads.contains(k)).find_map(|k| {
        let some: Vec<&Case> = gathered.cases.iter().filter(|case| is_across(case, k)).collect();
        (!some.is_empty()).then_some((k, some))
    })?;
    let first = cases.first()?;
    let [forward, up] = [spec.lies.forward().axis, spec.lies.up().axis];
    let normal = if k == 2 { up } else { 3 - forward - up };
    let text = format!(
        "symmetry = \"none\", and {} is {} N in {}{}: a whole, symmetric body in a single-phase flow has none. If the mesh ends at a plane of symmetry, write symmetry = \"{} = 0\"; if the loads include buoyancy or lift, ignore this",
        LOADS[k],
        plain(first.judged.window.mean[k], 4),
        first.setting.name,
        if cases.len() == 1 { String::new() } else { format!(" (likewise {} more)", cases.len() - 1) },
        ["x", "y", "z"][normal],
    );
    Some(warning("openfoam-half", text))
}

fn warning(code: &str, text: String) -> Finding {
    Finding::new(Severity::Warning, code, text)
}

fn understood(gathered: &Gathered, spec: &ForcesSpec) -> String {
    let density = match gathered.density_ratio {
        Some(ratio) => format!("forces times {} (density of the water over rho_inf)", plain(ratio, 6)),
        None => "coefficients times ½ρU²A of their comment lines".to_owned(),
    };
    let domain = match spec.plane {
        Some(k) => format!(
            "half of the body up to the plane {} = 0, with the loads of its mirror image added (those that it makes zero are not fitted)",
            ["x", "y", "z"][k]
        ),
        None => "the whole body".to_owned(),
    };
    let point = match gathered.origin_m {
        Some([x, y, z]) => format!("moments about ({x} {y} {z}) m"),
        None => "no moments".to_owned(),
    };
    let turned = match spec.is_body_turned {
        Some(true) => {
            "; the body is turned in the mesh, and moments are about a point fixed in it, which is one point of the body only if the body turns about it"
        }
        _ => "",
    };
    format!(
        "{} read, speed and angle from {}: the mesh has {} forward and {} up{turned}; {density}; {domain}; {point}",
        counted(gathered.cases.len() + gathered.without.len(), "case", "cases"),
        gathered.settings.origin,
        spec.lies.forward(),
        spec.lies.up()
    )
}

/// The windows of all cases in one sentence.
fn windows(cases: &[Case]) -> String {
    let range = |of: &dyn Fn(&Case) -> f64| {
        let (low, high) =
            cases.iter().map(of).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        if low == high { plain(low, 5) } else { format!("{} … {}", plain(low, 5), plain(high, 5)) }
    };
    let resampled = cases.iter().filter(|case| case.is_resampled).count();
    let uneven = if resampled > 0 {
        format!("; the steps of {} are uneven, so the means are weighted by time", counted(resampled, "case", "cases"))
    } else {
        String::new()
    };
    format!(
        "loads are means from the time {} to {}, of cases that begin at {}; the start-up transient before the window is left out. Within it no mean force changes by more than {:.1} % from one half to the other, or it swings about a steady mean{uneven}",
        range(&|case| case.judged.span[0]),
        range(&|case| case.judged.span[1]),
        range(&|case| case.judged.begins),
        100.0 * DRIFT
    )
}
