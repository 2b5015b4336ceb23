//! The cases of a folder, with the speed and drift of each: from the names of their folders, from a list, or from their inflow.

use std::path::{Path, PathBuf};

use froude_identify::method::MethodError;
use froude_records::table_file::read_table;
use froude_records::units::Dimension;

use super::dat::triple;
use super::files::objects;
use super::keys::ForcesSpec;
use super::pattern::Pattern;
use crate::input;

/// Inflow and stated motion may differ by this part of the speed: an angle by 1°.
const SAME_MOTION: f64 = 0.02;
/// Speed out of the horizontal plane, over the whole, that counts as none.
const LEVEL: f64 = 1e-6;

/// A case and how its body moves through the water.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Setting {
    /// Name of its folder.
    pub(super) name: String,
    pub(super) folder: PathBuf,
    /// U, m/s.
    pub(super) speed_m_s: f64,
    /// Drift θ, rad: v = U (cos θ, −sin θ) in body axes.
    pub(super) angle_rad: f64,
    /// Empty if not stated.
    pub(super) configuration: String,
}

/// The cases of a source.
#[derive(Debug, Clone, Default)]
pub(super) struct Settings {
    pub(super) cases: Vec<Setting>,
    /// Names of folders with force files that are not among them.
    pub(super) left_out: Vec<String>,
    /// Cases whose inflow contradicts what is stated: in words.
    pub(super) contradicted: Vec<String>,
    /// Where speeds and angles come from, in words.
    pub(super) origin: String,
}

/// The cases below a folder, sorted by name.
pub(super) fn settings(folder: &Path, spec: &ForcesSpec) -> Result<Settings, MethodError> {
    let mut out = match (&spec.pattern, &spec.list) {
        (Some(pattern), _) => by_pattern(folder, spec, pattern)?,
        (None, Some(list)) => by_list(folder, list)?,
        (None, None) => by_inflow(folder, spec)?,
    };
    if out.cases.is_empty() {
        let names = out.left_out.join(", ");
        let found = if names.is_empty() {
            "no folder in it has postProcessing with force files".to_owned()
        } else {
            let pattern = spec.pattern.as_deref().unwrap_or_default();
            format!("no folder with force files matches the pattern {pattern:?}: {names}")
        };
        return Err(MethodError::input(
            folder,
            format!(
                "{found}; write the folder of the cases in `runs` and, in [source.openfoam_forces], a pattern that fits the whole name of each (\"U{{speed [m/s]}}_b{{angle [deg]}}\" fits U1.5_b-8 and U1p5_b-8), or a list"
            ),
        ));
    }
    for case in &out.cases {
        let is_number = case.speed_m_s.is_finite() && case.speed_m_s > 0.0 && case.angle_rad.is_finite();
        if !is_number {
            let what = format!(
                "has the speed {} m/s; expected one above zero (a speed has no sign: astern the angle is 180 deg)",
                case.speed_m_s
            );
            return Err(MethodError::input(&case.folder, what));
        }
    }
    drift_is_declared(&out.cases, spec)?;
    if spec.pattern.is_some() || spec.list.is_some() {
        out.contradicted = out.cases.iter().filter_map(|case| contradiction(case, spec)).collect();
    }
    Ok(out)
}

/// With drift it matters what was turned, and a plane along the body's middle is no symmetry of the flow.
fn drift_is_declared(cases: &[Setting], spec: &ForcesSpec) -> Result<(), MethodError> {
    let Some(askew) = cases.iter().find(|case| case.angle_rad.sin().abs() > LEVEL) else { return Ok(()) };
    let angle = format!("{} has a drift of {:.4}°", askew.name, askew.angle_rad.to_degrees());
    let is_starboard = |k: &usize| spec.body[1][*k] != 0.0;
    if let Some(k) = spec.plane.filter(is_starboard) {
        let problem = format!(
            "is \"{} = 0\", the plane along the body's middle, and {angle}: such a flow is not symmetric about it. With drift only the plane along the body's axis and square to its vertical can end a half domain; compute the whole one",
            ["x", "y", "z"][k]
        );
        return Err(spec.wrong("symmetry", problem).into());
    }
    if spec.is_body_turned.is_none() {
        let problem = format!(
            "{angle}. Write turned = \"inflow\" where the inflow was turned and the axes of the mesh lie with the body, or turned = \"body\" where the body was turned in the mesh and the loads are along the axes of the flow"
        );
        return Err(spec.missing("turned", &problem).into());
    }
    Ok(())
}

fn sub_folders(folder: &Path) -> Result<Vec<(String, PathBuf)>, MethodError> {
    let failed = |source| MethodError::Folder { path: folder.to_owned(), source };
    let mut out = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if let Some(name) = path.file_name().filter(|_| path.is_dir()) {
            out.push((name.to_string_lossy().into_owned(), path));
        }
    }
    out.sort();
    Ok(out)
}

fn by_pattern(folder: &Path, spec: &ForcesSpec, text: &str) -> Result<Settings, MethodError> {
    let pattern = Pattern::parse(text).map_err(|problem| spec.wrong("pattern", problem))?;
    let mut out = Settings { origin: format!("the names of the folders, {text:?}"), ..Settings::default() };
    for (name, path) in sub_folders(folder)? {
        match pattern.read(&name) {
            Some(stated) => out.cases.push(Setting {
                name,
                folder: path,
                speed_m_s: stated.speed_m_s.unwrap_or(f64::NAN),
                angle_rad: stated.angle_rad.unwrap_or(0.0),
                configuration: stated.configuration.unwrap_or_default(),
            }),
            // What has no force files is no case.
            None if !objects(&path)?.is_empty() => out.left_out.push(name),
            None => {}
        }
    }
    Ok(out)
}

fn by_list(folder: &Path, list: &Path) -> Result<Settings, MethodError> {
    let table = read_table(list, None)?;
    let names = table.text("case")?;
    let speeds = table.number("speed", Dimension::SPEED)?;
    let angles = table.number("angle", Dimension::ANGLE)?;
    let configurations = table.text("configuration").ok();
    let mut out = Settings { origin: list.display().to_string(), ..Settings::default() };
    for (row, (name, (speed, angle))) in names.iter().zip(speeds.iter().zip(angles)).enumerate() {
        let line = table.line_of_row.get(row).copied().unwrap_or(row + 1);
        let refuse = |what: String| MethodError::input(list, format!("line {line}: {what}"));
        let path = folder.join(name);
        if !path.is_dir() {
            return Err(refuse(format!("there is no case {name:?} in {}", folder.display())));
        }
        if out.cases.iter().any(|case| case.name == *name) {
            return Err(refuse(format!("the case {name:?} is listed twice")));
        }
        let configuration = configurations.and_then(|all| all.get(row)).cloned().unwrap_or_default();
        out.cases.push(Setting {
            name: name.clone(),
            folder: path,
            speed_m_s: *speed,
            angle_rad: *angle,
            configuration,
        });
    }
    for (name, path) in sub_folders(folder)? {
        if out.cases.iter().all(|case| case.name != name) && !objects(&path)?.is_empty() {
            out.left_out.push(name);
        }
    }
    Ok(out)
}

fn by_inflow(folder: &Path, spec: &ForcesSpec) -> Result<Settings, MethodError> {
    let mut out = Settings { origin: "the inflow in 0/U of each case".to_owned(), ..Settings::default() };
    for (name, path) in sub_folders(folder)? {
        if objects(&path)?.is_empty() {
            continue;
        }
        let refuse = |what: &str| {
            MethodError::input(
                &path,
                format!(
                    "{what}; state the speeds in [source.openfoam_forces]: pattern = \"U{{speed [m/s]}}_b{{angle [deg]}}\" for the names of the folders, or list = \"cases.csv\" with the columns case, speed [m/s] and angle [deg]"
                ),
            )
        };
        let velocity = inflow_m_s(&path).ok_or_else(|| {
            refuse("its motion is not known: 0/U has no line `internalField uniform (…);` with a velocity")
        })?;
        if spec.is_body_turned == Some(true) {
            return Err(refuse("turned = \"body\", and the inflow in 0/U does not tell the angle of the body"));
        }
        let [u, v, w] = spec.body.map(|axis| 0.0 - axis.iter().zip(velocity).map(|(a, v)| a * v).sum::<f64>());
        let speed_m_s = u.hypot(v);
        if w.abs() > LEVEL * speed_m_s {
            return Err(refuse("the inflow in 0/U has a part along the body's vertical, which is not read"));
        }
        // Straight ahead and astern exactly: the rounding of an inflow is no drift.
        let angle_rad = match v.abs() <= LEVEL * speed_m_s {
            true if u >= 0.0 => 0.0,
            true => std::f64::consts::PI,
            false => (-v).atan2(u),
        };
        out.cases.push(Setting { name, folder: path.clone(), speed_m_s, angle_rad, configuration: String::new() });
    }
    Ok(out)
}

/// The uniform inflow of a case, m/s, axes of the mesh; `None` where its files do not state one, or where the field at the start and a boundary differ: a field
/// left from a template says nothing of the flow.
fn inflow_m_s(case: &Path) -> Option<[f64; 3]> {
    let text = ["0/U", "0.orig/U"].iter().find_map(|file| input::text(&case.join(file)).ok())?;
    let field = text.lines().map(str::trim).find_map(|line| line.strip_prefix("internalField"))?;
    let velocity = triple(field.trim().strip_prefix("uniform")?.trim().trim_end_matches(';'))?;
    // `value uniform (2 0 0);` and `freestreamValue uniform (2 0 0);`; walls have none, or zero.
    let at_boundary = text.lines().filter_map(|line| {
        let (_, value) = line.trim().split_once("alue").filter(|(key, _)| !key.contains(char::is_whitespace))?;
        triple(value.trim().strip_prefix("uniform")?.trim().trim_end_matches(';'))
    });
    let is_other = |other: &[f64; 3]| other.iter().any(|v| *v != 0.0) && *other != velocity;
    (velocity.iter().any(|v| *v != 0.0) && !at_boundary.into_iter().any(|other| is_other(&other))).then_some(velocity)
}

/// A case whose inflow is not that of its stated speed and drift.
fn contradiction(case: &Setting, spec: &ForcesSpec) -> Option<String> {
    let inflow = inflow_m_s(&case.folder)?;
    let angle = if spec.is_body_turned == Some(true) { 0.0 } else { case.angle_rad };
    let [forward, starboard, _] = spec.body;
    let expected: [f64; 3] =
        std::array::from_fn(|k| case.speed_m_s * (starboard[k] * angle.sin() - forward[k] * angle.cos()));
    let apart = inflow.iter().zip(expected).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
    (apart > SAME_MOTION * case.speed_m_s).then(|| {
        let shown = |v: [f64; 3]| v.map(|x| format!("{:.4}", x + 0.0)).join(" ");
        format!(
            "{}: its inflow in 0/U is ({}) m/s, and ({}) by its speed and angle",
            case.name,
            shown(inflow),
            shown(expected)
        )
    })
}
