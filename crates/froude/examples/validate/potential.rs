//! Added mass from potential flow: the paper's Table 6 and 7 with the stand-ins of the data's README.

use std::error::Error;
use std::path::Path;

use froude::methods::added_mass::links::{Configuration, LinksOutcome, links};
use froude::methods::added_mass::options::Asked;
use froude::methods::added_mass::water::Water;
use froude::panel::refine::Wanted;
use froude::records::csv_table::read_csv;
use froude::records::units::Dimension;

use crate::claims::{Claims, Verdict};

const TABLE: &str = "Added mass from potential flow: Table 6 and 7 of the USR paper with a necked stand-in";
const SMOOTH: &str = "Added mass from potential flow: the smooth stand-in";

/// Sway mass [kg] and C_Ax of the necked stand-in by an independent panel code (the data's README), H1LT to H9LT, as printed there.
const NECKED: [(f64, f64); 9] = [
    (1.925, 0.265),
    (3.489, 0.191),
    (5.070, 0.159),
    (6.659, 0.140),
    (8.249, 0.129),
    (9.841, 0.121),
    (11.434, 0.115),
    (13.027, 0.110),
    (14.622, 0.106),
];

/// The same of the smooth stand-in: links, sway mass, C_Ax.
const SMOOTH_ONE: [(usize, f64, f64); 4] =
    [(1, 2.058, 0.104), (3, 5.194, 0.048), (6, 9.948, 0.027), (9, 14.710, 0.019)];

/// What two codes may differ by that each extrapolate from meshes of their own: the source states no uncertainty, only its digits.
const APART: f64 = 0.01;

pub const SMOOTH_BODY: &str = r#"
schema = 1
name = "Mamba, smooth stand-in"
[fluid]
density = "1025 kg/m^3"
[body]
shape = "robot"
link = { major_semi_axis = "52.4 mm", minor_semi_axis = "37.2 mm", half_length = "90 mm" }
ends = { length = "77.2 mm" }
"#;

/// Everything of this page.
pub fn all(claims: &mut Claims, root: &Path, full: bool) -> Result<(), Box<dyn Error>> {
    necked(claims, root, full)?;
    smooth(claims)
}

fn run(body: &Path, links_of: Vec<usize>) -> Result<LinksOutcome, Box<dyn Error>> {
    in_water(body, links_of, &Water::default())
}

/// Configurations of a robot in the water of a campaign.
pub fn in_water(body: &Path, links_of: Vec<usize>, water: &Water) -> Result<LinksOutcome, Box<dyn Error>> {
    let wanted = Wanted { tolerance: 0.005, ..Wanted::default() };
    let asked = Asked { links: links_of, wanted, ..Asked::of(body) };
    Ok(links(&asked, water, "", &|_| {})?)
}

/// Against the other code: within its digits and ours a pass, within what two extrapolations may differ by a finding.
fn independent(claims: &mut Claims, section: &'static str, c: &Configuration, sway: f64, axial: f64) {
    let r = &c.refined;
    let (own_sway, own_axial) = (1025.0 * r.uncertainty[1][1], r.uncertainty[0][0] / r.volume_m3);
    let apart = [sway_kg(c) - sway, surge(c) - axial];
    let is_in = apart[0].abs() <= own_sway + 0.0005 && apart[1].abs() <= own_axial + 0.0005;
    let is_near = apart[0].abs() <= APART * sway + 0.0005 && apart[1].abs() <= APART * axial + 0.0005;
    let verdict = match (is_in, is_near) {
        (true, _) => Verdict::Pass,
        (_, true) => Verdict::Finding,
        _ => Verdict::Miss,
    };
    claims.add(
        section,
        &format!("{} against an independent code", c.name),
        &format!(
            "μ_y {sway} kg, C_Ax {axial} within their digits and our uncertainty (the data's README states no uncertainty; its dimensions are printed to 0.1 mm, 0.2 % of μ_y)"
        ),
        format!(
            "{:.4} ± {own_sway:.4} kg, {:.5} ± {own_axial:.5} ({:+.2} %, {:+.2} %)",
            sway_kg(c),
            surge(c),
            100.0 * apart[0] / sway,
            100.0 * apart[1] / axial
        ),
        verdict,
    );
}

pub fn sway_kg(c: &Configuration) -> f64 {
    1025.0 * c.refined.value[1][1]
}

fn surge(c: &Configuration) -> f64 {
    c.refined.value[0][0] / c.refined.volume_m3
}

fn necked(claims: &mut Claims, root: &Path, full: bool) -> Result<(), Box<dyn Error>> {
    let body = root.join("examples/mamba-necked/body.toml");
    let numbers: Vec<usize> = (1..=9).filter(|k| full || k % 2 == 1).collect();
    let done = run(&body, numbers.clone())?;
    for c in &done.configurations {
        let (sway, axial) = NECKED[c.links - 1];
        independent(claims, TABLE, c, sway, axial);
    }
    let coefficient = |model: &str, name: &str| {
        let fit = done.fits.iter().flat_map(|fits| &fits.estimates).find(|e| e.law.name == model);
        fit.and_then(|e| e.coefficients.get(name)?.value).ok_or_else(|| format!("no {model}/{name}"))
    };
    claims.near(
        TABLE,
        "slope of μ_y on the links [kg]",
        coefficient("affine", "m_link")?,
        1.59,
        0.01,
        "Table 6: 1.592",
    );
    if full {
        let c_ax = coefficient("displaced_volume", "C_Ax")?;
        let c_ay = coefficient("displaced_volume", "C_Ay")?;
        claims.near(
            TABLE,
            "Table 7, C_Ax over the paper's − 1 [%]",
            100.0 * (c_ax / 0.1194 - 1.0),
            0.0,
            1.0,
            "Table 7",
        );
        claims.near(
            TABLE,
            "Table 7, C_Ay over the paper's − 1 [%]",
            100.0 * (c_ay / 1.3601 - 1.0),
            0.0,
            1.0,
            "Table 7",
        );
    }
    against_table_6(claims, root, &done)
}

/// The paper's own rows: within the bands of the issue, or a finding.
fn against_table_6(claims: &mut Claims, root: &Path, done: &LinksOutcome) -> Result<(), Box<dyn Error>> {
    let table = read_csv(&root.join("examples/mamba-added-mass/table6.csv"), None)?;
    let column = |name: &str, dimension| table.number(name, dimension).map(<[f64]>::to_vec);
    let (links, volume) = (column("n_links", Dimension::ONE)?, column("volume", Dimension::VOLUME)?);
    let (mu_x, mu_y) = (column("mu_x", Dimension::MASS)?, column("mu_y", Dimension::MASS)?);
    for c in &done.configurations {
        let Some(row) = links.iter().position(|k| *k == c.links as f64) else { continue };
        let sway = 100.0 * (sway_kg(c) / mu_y[row] - 1.0);
        let printed = mu_x[row] / (1025.0 * volume[row]);
        let axial = 100.0 * (surge(c) / printed - 1.0);
        let found = format!("μ_y {sway:+.2} %, C_Ax {axial:+.2} %");
        let claim = format!("H{}LT against the paper's row", c.links);
        match c.links {
            1 => claims.add(
                TABLE,
                &claim,
                "out: the paper's H1LT is head, link and tail added up (its volume is 12 % above the others' line), and its μ_x half of theirs",
                found,
                Verdict::Finding,
            ),
            2 => claims.add(TABLE, &claim, "out: its volume lies 2 % below the line of H3LT to H9LT", found, Verdict::Finding),
            5 => claims.add(TABLE, &claim, "μ_y within 2.5 %; C_Ax is the paper's outlier", found, verdict(sway.abs() <= 2.5)),
            _ => {
                let is_in = sway.abs() <= 2.5 && axial.abs() <= 5.0;
                claims.add(TABLE, &claim, "μ_y within 2.5 %, C_Ax within 5 %", found, verdict(is_in));
            }
        }
    }
    Ok(())
}

/// What lies outside is reported as such: the stand-in is not the robot, and an independent code finds the same for it.
fn verdict(is_in: bool) -> Verdict {
    if is_in { Verdict::Pass } else { Verdict::Finding }
}

fn smooth(claims: &mut Claims) -> Result<(), Box<dyn Error>> {
    let scratch = tempfile::tempdir()?;
    let body = scratch.path().join("smooth.toml");
    std::fs::write(&body, SMOOTH_BODY)?;
    let done = run(&body, SMOOTH_ONE.map(|s| s.0).to_vec())?;
    for (c, (_, sway, axial)) in done.configurations.iter().zip(SMOOTH_ONE) {
        independent(claims, SMOOTH, c, sway, axial);
    }
    if let Some(nine) = done.configurations.iter().find(|c| c.links == 9) {
        claims.add(
            SMOOTH,
            "C_Ax of H9LT, smooth",
            "the paper has 0.1106, the necked stand-in 0.106: the water held at the joints makes most of C_Ax",
            format!("{:.4}: {:.0} % of the paper's", surge(nine), 100.0 * surge(nine) / 0.1106),
            Verdict::Finding,
        );
    }
    Ok(())
}
