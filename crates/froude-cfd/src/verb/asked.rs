//! What a campaign says of its computed source, and whether that has changed since the cases were planned.

use std::path::{Path, PathBuf};

use froude_added_mass::load::is_body_file;
use froude_records::campaign::{Campaign, Input, Source};
use froude_records::campaign_file::read_campaign;
use froude_records::hash::{sha256_of_bytes, sha256_of_file};
use froude_records::output::inside;

use super::error::VerbError;
use crate::case::Water;
use crate::section::{CfdSpec, declared};
use crate::store::check_links;

/// Warning if the inputs have changed since the cases were planned.
pub(super) const OUTDATED: &str = "the campaign, its body file or Froude has changed since the cases were planned, and these results belong to the previous plan; froude cfd plan or run updates it";

/// What a campaign says of its computed source.
#[derive(Debug, Clone)]
pub(super) struct Asked {
    /// Name of the campaign.
    pub(super) title: String,
    pub(super) source: Source,
    pub(super) spec: CfdSpec,
    /// The folder of the cases.
    pub(super) folder: PathBuf,
    /// The file of the body.
    pub(super) body: PathBuf,
    pub(super) water: Water,
    /// `reference_length` and `reference_area` of the campaign's body, m and m².
    pub(super) reference: [Option<f64>; 2],
}

impl Asked {
    /// Of a campaign's only source that plans `cases`, or the one of a name; others may read the same cases.
    pub(super) fn read(path: &Path, name: Option<&str>) -> Result<Self, VerbError> {
        let campaign = read_campaign(path)?;
        let refused = |problem: String| VerbError::input(path, problem);
        let has_cases = |source: &&Source| matches!(source.input, Input::Cases(_));
        let mut computed: Vec<&Source> = campaign.sources.iter().filter(has_cases).collect();
        if name.is_none() && computed.iter().any(|source| !source.plan.is_empty()) {
            computed.retain(|source| !source.plan.is_empty());
        }
        let names = || computed.iter().map(|s| format!("{:?}", s.name)).collect::<Vec<_>>().join(", ");
        let source = match (name, computed.as_slice()) {
            (_, []) => {
                let problem =
                    "has no source with cases: write kind = \"cfd\" and cases = \"cases\", the folder for them";
                return Err(refused(problem.to_owned()));
            }
            (None, [only]) => *only,
            (None, _) => {
                let problem = format!("has the sources {} with cases; say which with --source", names());
                return Err(refused(problem));
            }
            (Some(name), _) => *computed
                .iter()
                .find(|s| s.name == name)
                .ok_or_else(|| refused(format!("has no source {name:?} with cases; it has {}", names())))?,
        };
        if source.plan.is_empty() {
            let problem = format!(
                "source {:?} plans nothing: add a [[source.plan]] with configurations, speed and angle",
                source.name
            );
            return Err(refused(problem));
        }
        inside(path, source.input.path(), &source.place, "cases", "froude cfd")?;
        check_links(source.input.path())?;
        Self::of(&campaign, source, source.input.path().to_owned())
    }

    /// Of a source, whose cases are in a folder.
    pub(super) fn of(campaign: &Campaign, source: &Source, folder: PathBuf) -> Result<Self, VerbError> {
        let refused = |problem: String| VerbError::input(&campaign.path, problem);
        let need = |what: &str, example: &str| {
            refused(format!("[fluid] states no {what}, which a flow depends on; write {example}"))
        };
        let fluid = &campaign.fluid;
        let water = match (fluid.density_kg_m3, fluid.kinematic_viscosity_m2_s, fluid.temperature_degc) {
            (Some(density_kg_m3), Some(viscosity_m2_s), _) => Water { density_kg_m3, viscosity_m2_s },
            (density, viscosity, Some(temperature)) => {
                let water = froude_hydro::fluid::Water::at(temperature, fluid.salinity_g_kg.unwrap_or(0.0))
                    .map_err(|e| refused(e.to_string()))?;
                Water {
                    density_kg_m3: density.unwrap_or(water.density_kg_m3),
                    viscosity_m2_s: viscosity.unwrap_or(water.kinematic_viscosity_m2_s()),
                }
            }
            (None, _, None) => {
                return Err(need("density", "density = \"1025 kg/m^3\", or temperature = \"20 degC\""));
            }
            (_, None, None) => {
                return Err(need("viscosity", "kinematic_viscosity = \"1.19e-6 m^2/s\", or temperature = \"20 degC\""));
            }
        };
        let spec = declared(source)?.unwrap_or_default();
        let body = spec.body.clone().ok_or_else(|| {
            refused(format!("source {:?} names no body: write body = \"body.toml\" in [source.cfd]", source.name))
        })?;
        let is_pitched = source.plan.iter().any(|block| block.pitch_rad.iter().any(|p| *p != 0.0));
        if spec.is_half && is_pitched {
            let problem = "plans angles out of the plane of symmetry, and half a domain has none: write domain = \"full\" in [source.cfd]";
            return Err(refused(problem.to_owned()));
        }
        if spec.tank.is_some() && is_pitched {
            let problem = "plans angles out of the horizontal plane in a tank, whose walls lie along the velocity: leave pitch out, or tank";
            return Err(refused(problem.to_owned()));
        }
        let stated = campaign.body.as_ref();
        let reference = [stated.and_then(|b| b.reference_length_m), stated.and_then(|b| b.reference_area_m2)];
        Ok(Self { title: campaign.name.clone(), source: source.clone(), spec, folder, body, water, reference })
    }

    /// SHA-256 of what cases are planned from: the body file, the flow settings of the campaign and the version of Froude. Notes, laws and uncertainty budgets are excluded.
    pub(super) fn inputs_sha256(&self) -> String {
        let lies: Vec<[&str; 2]> = self.spec.lies.iter().map(|given| [&*given.name, &*given.text]).collect();
        let spec = CfdSpec { body: None, lies: Vec::new(), ..self.spec.clone() };
        let body = sha256_of_file(&self.body).unwrap_or_default();
        // Of a body file the campaign's references are not used.
        let reference = if is_body_file(&self.body) { [None; 2] } else { self.reference };
        let version = env!("CARGO_PKG_VERSION");
        let all = format!("{version} {body} {lies:?} {spec:?} {:?} {:?} {reference:?}", self.source.plan, self.water);
        sha256_of_bytes(all.as_bytes())
    }
}
