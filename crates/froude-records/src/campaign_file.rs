//! The campaign's TOML, section by section. Names and defaults are the contract of the book's conventions page.

use std::collections::BTreeSet;
use std::f64::consts::FRAC_PI_4;
use std::path::Path;

use froude_hydro::drag_curves::Shape;
use indexmap::IndexMap;

use crate::body::link;
use crate::body_axis::BodyAxis;
use crate::campaign::{
    AngleOffset, BodySpec, BoundKind, BoundsSpec, BudgetEntry, Campaign, Fluid, Identify, Input, OwnSections,
    PlanBlock, PriorRecord, PriorSpec, RangeBlock, SensorSpec, Shared, Simulate, Source, SourceKind, StatedTruth,
    StatedUnit, Tank, Tare, Truth, UserModel,
};
use crate::campaign_keys::{
    BODY, CASES, COVARIANCES, FLUID, IDENTIFY, PRIOR, RANGE_BLOCK, ROOT, ROWS, SENSOR, SIMULATE, SOURCE, TANK,
    UNCERTAINTY,
};
use crate::declare::{Values, names};
use crate::document::Document;
use crate::error::RecordError;
use crate::estimate::ErrorKind;
use crate::hash::short_key;
use crate::keep::parse_keep;
use crate::known_columns::known_dimension;
use crate::nearest::nearest;
use crate::plausible;
use crate::prior_record;
use crate::read;
use crate::run::Declared;
use crate::section::{Section, Value, found};
use crate::section_values::{Asks, MOST_RUNS, OF_RUNS, at_most, configurations, plan_of, product};
use crate::units::{Dimension, Quantity, Unit};

/// Where the numbers of a source can lie.
pub const INPUTS: [&str; 5] = ["table", "record", "runs", "cases", "mesh"];

/// Two areas of a sphere that differ by more are of two spheres.
const SAME_AREA: f64 = 0.05;

/// The largest campaign that is read.
const LARGEST_BYTES: u64 = 4 << 20;

/// Reads a campaign; the files that it names must exist, except those that a plan will make.
///
/// # Errors
///
/// See [`RecordError`].
pub fn read_campaign(path: &Path) -> Result<Campaign, RecordError> {
    let mut campaign = parse_campaign(path, &read::text(path, LARGEST_BYTES, "a campaign")?)?;
    campaign.check_files()?;
    prior_record::resolve(&mut campaign)?;
    Ok(campaign)
}

/// The same from text, without looking at the files that it names.
///
/// # Errors
///
/// See [`RecordError`].
pub fn parse_campaign(path: &Path, text: &str) -> Result<Campaign, RecordError> {
    let document = Document::parse(path, text)?;
    let root = document.root();
    root.schema("campaign")?;
    root.only(&names(ROOT))?;
    let campaign = Campaign {
        path: path.to_owned(),
        key: short_key(text.as_bytes()),
        name: root.need_text("name", "write name = \"what this campaign is\"")?.to_owned(),
        cite: root.texts("cite")?,
        fluid: root.section("fluid")?.map(|s| fluid(&s)).transpose()?.unwrap_or_default(),
        body: root.section("body")?.map(|s| body(&s)).transpose()?,
        tank: root.section("tank")?.map(|s| tank(&s)).transpose()?,
        constants: root.section("constants")?.map(|s| constants(&s)).transpose()?.unwrap_or_default(),
        sources: (root.sections("source")?.iter().enumerate())
            .map(|(index, s)| read_source(s, &document, index))
            .collect::<Result<_, _>>()?,
        identify: root.section("identify")?.map(|s| identify(&s)).transpose()?.unwrap_or_default(),
        simulate: root.section("simulate")?.map(|s| simulate(&s)).transpose()?,
        document: Some(document.clone()),
    };
    let mut names = BTreeSet::new();
    for a in &campaign.sources {
        if !names.insert(&a.name) {
            let problem = format!("{:?} is the name of two sources; give each its own", a.name);
            return Err(RecordError::value(a.place.clone(), "name", problem));
        }
    }
    Ok(campaign)
}

fn fluid(s: &Section<'_>) -> Result<Fluid, RecordError> {
    let values = Values::read(s, FLUID)?;
    let density = values.constant("density");
    let out = Fluid {
        density_kg_m3: density.map(|declared| declared.value),
        density_standard_kg_m3: density.map_or(0.0, |declared| declared.standard_uncertainty),
        kinematic_viscosity_m2_s: values.number("kinematic_viscosity"),
        temperature_degc: values.number("temperature").map(|kelvin| kelvin - 273.15),
        salinity_g_kg: values.number("salinity").map(|fraction| fraction * 1e3),
    };
    if let (Some(rho), Some(value)) = (out.density_kg_m3, s.get("density"))
        && let Some(problem) = plausible::density(rho, out.kinematic_viscosity_m2_s)
    {
        return Err(s.wrong("density", value, format!("is {}, which {problem}", found(value))));
    }
    Ok(out)
}

fn body(s: &Section<'_>) -> Result<BodySpec, RecordError> {
    let values = Values::read(s, BODY)?;
    let mut volumes = IndexMap::new();
    if let Some(table) = s.section("volumes")? {
        for (configuration, _, value) in table.entries() {
            let volume = table.as_positive(configuration, value, Dimension::VOLUME)?;
            volumes.insert(configuration.to_owned(), volume);
        }
    }
    let length_m = values.number("reference_length");
    let shape = values.word("shape", &Shape::ALL);
    let area = area(&values, shape, length_m)?;
    Ok(BodySpec {
        reference_point: values.text("reference_point").map(str::to_owned),
        link: link(s)?,
        head_side_area_m2: values.number("head_side_area"),
        tail_side_area_m2: values.number("tail_side_area"),
        reference_length_m: length_m,
        reference_area_m2: area.map(|declared| declared.value),
        reference_area_standard_m2: area.map_or(0.0, |declared| declared.standard_uncertainty),
        shape,
        travel: values.word("travel", &BodyAxis::ALL),
        volume_m3: values.number("volume"),
        volumes,
        link_volume_m3: values.number("link_volume"),
    })
}

/// The area of C_D: as declared, or of a sphere by its diameter.
fn area(values: &Values, shape: Option<Shape>, length_m: Option<f64>) -> Result<Option<Declared>, RecordError> {
    let stated = values.constant("reference_area");
    let (Some(Shape::Sphere), Some(diameter_m)) = (shape, length_m) else { return Ok(stated) };
    let of_sphere = FRAC_PI_4 * diameter_m * diameter_m;
    match stated {
        Some(area) if (area.value / of_sphere - 1.0).abs() > SAME_AREA => {
            let problem = format!(
                "is {} m^2, and a sphere of the diameter reference_length = {diameter_m} m has {of_sphere:.4e} m^2: correct one of them, or leave reference_area out",
                area.value
            );
            Err(values.wrong("reference_area", problem))
        }
        Some(area) => Ok(Some(area)),
        None => Ok(Some(Declared::exact(of_sphere))),
    }
}

fn tank(s: &Section<'_>) -> Result<Tank, RecordError> {
    let values = Values::read(s, TANK)?;
    Ok(Tank {
        width_m: values.number("width"),
        depth_m: values.number("depth"),
        submergence_m: values.number("submergence"),
    })
}

fn constants(s: &Section<'_>) -> Result<IndexMap<String, Quantity>, RecordError> {
    s.entries().map(|(name, _, value)| Ok((name.to_owned(), s.as_quantity(name, value)?))).collect()
}

/// What belongs to the rows of a table, and would be passed over elsewhere.
pub const OF_TABLES: [&str; 8] = ["models", "keep", "group", "actuator", "uncertainty", "tare", "plan", "sidecar"];

fn read_source(s: &Section<'_>, document: &Document, index: usize) -> Result<Source, RecordError> {
    let (methods, method_places): (Vec<String>, Vec<_>) = s.placed_texts("method")?.into_iter().unzip();
    let known = names(SOURCE);
    s.asks(|key| methods.iter().any(|method| method == key));
    let is_section = |(key, _, value): &(&str, usize, &Value<'_>)| !known.contains(key) && value.get_ref().is_table();
    if let Some((key, _, value)) = s.others().into_iter().find(is_section) {
        let problem = match (nearest(key, methods.iter().map(String::as_str)), nearest(key, known.iter().copied())) {
            (Some(method), _) => format!("is not called as the method is, {method:?}: name both alike"),
            (None, Some(near)) => format!("is no section of a source; did you mean `{near}`?"),
            _ => format!(
                "is neither a key of a source nor one of its methods; write method = {key:?}, or delete the section"
            ),
        };
        return Err(s.wrong(key, value, problem));
    }
    let values = Values::read(s, SOURCE)?;
    let text = |key: &str| values.text(key).map(str::to_owned);
    let name = values.need("name", text("name"))?;
    let kinds = [SourceKind::Tank, SourceKind::Towing, SourceKind::Cfd, SourceKind::Potential, SourceKind::Published];
    let kind = values.need("kind", values.word("kind", &kinds))?;
    let path = |key: &str| values.text(key).map(|text| s.source.relative(text));
    let given = [
        path("table").map(Input::Table),
        path("record").map(|path| Input::Record { path, select: text("select") }),
        path("runs").map(|path| Input::Runs { paths: vec![path], campaign: None }),
        path("cases").map(Input::Cases),
        path("mesh").map(Input::Mesh),
    ];
    let mut given: Vec<Input> = given.into_iter().flatten().collect();
    let Some(input) = given.pop().filter(|_| given.is_empty()) else {
        let named: Vec<&str> = INPUTS.into_iter().filter(|key| s.get(key).is_some()).collect();
        let named = if named.is_empty() { "none".to_owned() } else { named.join(" and ") };
        let problem = format!("names {named}; a source needs exactly one of table, runs, cases, mesh, record");
        return Err(RecordError::value(s.place(), name, problem));
    };
    let is_record = matches!(input, Input::Record { .. });
    s.refuse("select", !is_record, "picks an estimate of a record, but the source names no record")?;
    let is_validation = values.word("role", &[false, true]).unwrap_or_default();
    let problem = "holds fits against the rows of a table, but the source names none: write table = \"tomorrow.csv\"";
    s.refuse("role", is_validation && !matches!(input, Input::Table(_)), problem)?;
    let keep = s
        .get("keep")
        .map(|v| parse_keep(s.as_text("keep", v)?).map_err(|e| s.wrong("keep", v, format!("cannot be read: {e}"))))
        .transpose()?;
    let tare = values
        .table("tare")
        .map(|tare| -> Result<Tare, RecordError> {
            Ok(Tare {
                record: s.source.relative(tare.need("record", tare.text("record"))?),
                select: tare.text("select").map(str::to_owned),
                is_removed: tare.flag("removed"),
            })
        })
        .transpose()?;
    let (models, model_places) = s.placed_texts("models")?.into_iter().unzip();
    let has_runs = matches!(input, Input::Runs { .. } | Input::Table(_));
    s.refuse("method", !has_runs, "says how runs are reduced, but the source names no runs")?;
    if matches!(input, Input::Mesh(_)) {
        takes(s, &[], "a mesh has none, and says its numerical uncertainty itself")?;
    }
    let problem = "says what is asked of a mesh, but the source names none: write mesh = \"hull.stl\", or a body file";
    s.refuse("added_mass", !matches!(input, Input::Mesh(_)), problem)?;
    let has_methods = has_runs && !methods.is_empty();
    s.refuse("cfd", !matches!(input, Input::Cases(_)) && !has_methods, NO_CASES)?;
    s.refuse("decay", !has_methods, NO_DECAY)?;
    ["added_mass", "decay", "cfd"].into_iter().try_for_each(|name| s.section(name).map(drop))?;
    let blocks = s.sections("plan")?;
    // Runs are planned in the form of their method, which reads them.
    let plan = if matches!(input, Input::Runs { .. }) { Vec::new() } else { rows_of(&blocks, &input)? };
    Ok(Source {
        name,
        kind,
        is_validation,
        sidecar: path("sidecar"),
        models,
        model_places,
        methods,
        method_places,
        keep,
        group: text("group"),
        actuator: s.placed_texts("actuator")?.into_iter().map(|(load, _)| load).collect(),
        uncertainty: s.sections("uncertainty")?.iter().map(budget_entry).collect::<Result<_, _>>()?,
        tare,
        given: Vec::new(),
        own: Some(OwnSections { document: document.clone(), index }),
        plan,
        place: INPUTS
            .into_iter()
            .find_map(|key| s.get(key))
            .map_or_else(|| s.place(), |v| s.source.place(v.span().start)),
        input,
    })
}

const NO_CASES: &str = "says how a flow is computed, but the source names no cases: write cases = \"cases\", the folder for them, or method = \"forced_oscillation\"";
const NO_DECAY: &str =
    "describes a free decay, but no method of the source is one of free decay: write method = \"decay_output_error\"";

/// Refuses what belongs to the rows of a table, but for these keys; `instead` is why the source has no rows.
fn takes(s: &Section<'_>, keys: &[&str], instead: &str) -> Result<(), RecordError> {
    let is_refused = |key: &&str| !keys.contains(key);
    match OF_TABLES.into_iter().filter(is_refused).find_map(|key| Some((key, s.get(key)?))) {
        Some((key, value)) => Err(s.wrong(key, value, format!("belongs to the rows of a table; {instead}"))),
        None => Ok(()),
    }
}

impl Campaign {
    /// The whole file, for sections that belong to whoever reads them: `[rig]` and `[carriage]`.
    #[must_use]
    pub fn root(&self) -> Option<Section<'_>> {
        let root = self.document.as_ref()?.root();
        // Known keys are no misspelt ones.
        root.only(&names(ROOT)).ok()?;
        Some(root)
    }
}

impl Source {
    /// Refuses keys that none of the methods which reduce its runs takes; `keys` are those that one of them does.
    ///
    /// # Errors
    ///
    /// The first of the others, with its place.
    pub fn takes(&self, keys: &[&str]) -> Result<(), RecordError> {
        let Some(s) = self.own_section()? else { return Ok(()) };
        let is_own = |key: &str| self.methods.iter().any(|method| method == key) && !keys.contains(&key);
        if let Some((key, _, value)) = s.entries().find(|(key, ..)| is_own(key)) {
            return Err(s.wrong(key, value, "is a method without a section of its own: delete the section"));
        }
        let has_runs = matches!(self.input, Input::Runs { .. });
        if has_runs || (matches!(self.input, Input::Table(_)) && !self.methods.is_empty()) {
            s.refuse("cfd", !keys.contains(&"cfd"), NO_CASES)?;
            s.refuse("decay", !keys.contains(&"decay"), NO_DECAY)?;
        }
        if !has_runs {
            return Ok(());
        }
        let instead = "the budget of runs follows from the campaign that they were driven by (runs of the tank methods have a budget and a plan of their own, and steady, weight_tow, accelerated_tow and forced_oscillation take models)";
        takes(&s, keys, instead)
    }

    /// The blocks of its plan as settings of rows.
    ///
    /// # Errors
    ///
    /// [`RecordError::Value`] with its place where they are something else.
    pub fn rows(&self) -> Result<Vec<PlanBlock>, RecordError> {
        if !matches!(self.input, Input::Runs { .. }) {
            return Ok(self.plan.clone());
        }
        let blocks = self.own_section()?.map(|s| s.sections("plan")).transpose()?.unwrap_or_default();
        rows_of(&blocks, &self.input)
    }
}

fn rows_of(blocks: &[Section<'_>], input: &Input) -> Result<Vec<PlanBlock>, RecordError> {
    let (of_rows, most_rows) = most_of(input);
    let asks = |p: &PlanBlock| Asks { count: product(&numbers(p)), samples: 0.0 };
    plan_of(blocks, of_rows, most_rows, |b| plan_block(b, input), asks)
}

fn budget_entry(s: &Section<'_>) -> Result<BudgetEntry, RecordError> {
    let values = Values::read(s, UNCERTAINTY)?;
    let quantity = values.need("quantity", values.text("quantity"))?;
    let value = values.need("standard", s.get("standard"))?;
    let standard = s.quantity_like("standard", value, known_dimension(quantity).map(|d| (quantity, d)))?;
    let relative = standard.unit.text.trim() == "%";
    let dimension = standard.unit.dimension;
    if let Some(expected) = known_dimension(quantity)
        && !relative
        && expected != dimension
    {
        let problem = format!("is {}, but {quantity} is {}", found(value), expected.describe());
        return Err(s.wrong("standard", value, problem));
    }
    let si = standard.unit.difference_to_si(standard.value);
    if si < 0.0 {
        return Err(s.wrong("standard", value, format!("is {}; a standard uncertainty is not negative", found(value))));
    }
    let levels = [Shared::Sample, Shared::Run, Shared::Setup, Shared::Campaign];
    Ok(BudgetEntry {
        quantity: quantity.to_owned(),
        standard: si,
        relative,
        shared: values.need("shared", values.word("shared", &levels))?,
        dof: values.number("dof"),
        name: values.text("name").map(str::to_owned),
        kind: values.need("kind", values.word("kind", &ErrorKind::ALL))?,
        dimension,
        place: s.get("quantity").map_or_else(|| s.place(), |v| s.source.place(v.span().start)),
    })
}

fn plan_block(s: &Section<'_>, input: &Input) -> Result<PlanBlock, RecordError> {
    let is_computed = matches!(input, Input::Cases(_));
    let values = Values::read(s, if is_computed { CASES } else { ROWS })?;
    let out = PlanBlock {
        configurations: configurations(s)?,
        speed_m_s: values.numbers("speed"),
        angle_rad: values.numbers("angle"),
        pitch_rad: if is_computed { values.numbers("pitch") } else { vec![0.0] },
        repeats: if is_computed { 1 } else { values.need("repeats", values.count("repeats"))? },
    };
    at_most(&s.place(), &numbers(&out), most_of(input).1)?;
    Ok(out)
}

/// What the lists of a block multiply to.
fn numbers(block: &PlanBlock) -> [(&'static str, usize); 5] {
    [
        ("configurations", block.configurations.len()),
        ("speed", block.speed_m_s.len()),
        ("angle", block.angle_rad.len()),
        ("pitch", block.pitch_rad.len()),
        ("repeats", block.repeats),
    ]
}

/// Most observations that the plan of a source makes: a table of some hundred megabytes.
const MOST_OBSERVATIONS: usize = 1_000_000;
/// Most computed cases of a source: each is a folder with a mesh's fields, and at two minutes they are two weeks of a processor.
const MOST_CASES: usize = 10_000;
/// What the plan of a source without a form of its own makes, why no more, and how many at most.
fn most_of(input: &Input) -> ([&'static str; 2], usize) {
    match input {
        Input::Cases(_) => (["cases", "two weeks of a processor"], MOST_CASES),
        Input::Runs { .. } => (OF_RUNS, MOST_RUNS),
        _ => (["observations", "a table of some hundred megabytes"], MOST_OBSERVATIONS),
    }
}

fn bound_kind(s: &Section<'_>, key: &str, value: &Value<'_>) -> Result<BoundKind, RecordError> {
    match value.get_ref().as_str() {
        Some("none" | "free") => Ok(BoundKind::None),
        Some("non-negative") => Ok(BoundKind::NonNegative),
        _ => Err(s.wrong(key, value, format!("is {}; expected \"none\", \"free\" or \"non-negative\"", found(value)))),
    }
}

fn bounds(s: &Section<'_>) -> Result<BoundsSpec, RecordError> {
    let Some(value) = s.get("bounds") else { return Ok(BoundsSpec::default()) };
    if value.get_ref().as_table().is_none() {
        return Ok(BoundsSpec { default: bound_kind(s, "bounds", value)?, named: IndexMap::new() });
    }
    let table = s.as_section("bounds", value)?;
    let mut out = BoundsSpec::default();
    for (name, _, value) in table.entries() {
        let kind = bound_kind(&table, name, value)?;
        if name == "default" {
            out.default = kind;
        } else {
            out.named.insert(name.to_owned(), kind);
        }
    }
    Ok(out)
}

/// A value of a coefficient: a plain number in SI, or a quantity in quotes, with its unit.
fn coefficient_value<'a>(s: &Section<'a>, key: &str, value: &'a Value<'a>) -> Result<(f64, Option<Unit>), RecordError> {
    if value.get_ref().is_str() {
        s.as_quantity(key, value).map(|q| (q.value_si, Some(q.unit)))
    } else {
        Ok((s.as_number(key, value)?, None))
    }
}

/// Keys of `[identify]` that earlier versions read: why each went, and what to do instead.
const REMOVED: [(&str, &str); 3] = [
    (
        "huber",
        "was removed: its intervals covered less often than they claim; use `keep` to \
     leave out a row that does not belong, for a reason that you can state (the finding `outlying-row` names such rows)",
    ),
    (
        "wild_bootstrap",
        "was removed: its p values covered the scatter alone; write covariance = \"cluster\", whose intervals have \
         degrees of freedom of their own",
    ),
    (
        "monte_carlo",
        "was removed: it only checked the linear propagation of the budget, which every interval has; delete it",
    ),
];

fn identify(s: &Section<'_>) -> Result<Identify, RecordError> {
    for (key, _, value) in s.entries() {
        if let Some((_, why)) = REMOVED.iter().find(|(removed, _)| *removed == key) {
            return Err(s.wrong(key, value, *why));
        }
    }
    let values = Values::read(s, IDENTIFY)?;
    let (mut fixed, mut stated_units) = (IndexMap::new(), Vec::new());
    if let Some(table) = s.section("fixed")? {
        for (name, _, value) in table.entries() {
            let (held, unit) = coefficient_value(&table, name, value)?;
            fixed.insert(name.to_owned(), held);
            let place = table.source.place(value.span().start);
            stated_units.extend(unit.map(|unit| StatedUnit { coefficient: name.to_owned(), model: None, unit, place }));
        }
    }
    let (models, model_places) = s.placed_texts("models")?.into_iter().unzip();
    Ok(Identify {
        models,
        model_places,
        bounds: bounds(s)?,
        exclude: values.texts("exclude").to_vec(),
        prior: s.sections("prior")?.iter().map(|s| prior(s, &mut stated_units)).collect::<Result<_, _>>()?,
        known: known(s, &fixed, &mut stated_units)?,
        stated_units,
        fixed,
        // It follows when the records are read.
        known_covariance: Vec::new(),
        prior_covariance: Vec::new(),
        covariance: values.word("covariance", &COVARIANCES).map(str::to_owned),
        fitted_weights: values.word("weights", &[false, true]).unwrap_or_default(),
        group_offset: values.word("group_offset", &[false, true]).unwrap_or_default(),
        cross_validation: s.sections("cross_validation")?.iter().map(range_block).collect::<Result<_, _>>()?,
        angle_offset: (values.word("angle_offset", &[AngleOffset::Ignore, AngleOffset::Estimate])).unwrap_or_default(),
        dissipative: values.flag("dissipative"),
        user_models: s.sections("model")?.iter().map(user_model).collect::<Result<_, _>>()?,
        errors_in_variables: values.flag("errors_in_variables"),
    })
}

/// Known coefficients, each held once.
fn known(
    s: &Section<'_>,
    fixed: &IndexMap<String, f64>,
    stated_units: &mut Vec<StatedUnit>,
) -> Result<Vec<PriorSpec>, RecordError> {
    let mut out: Vec<PriorSpec> = Vec::new();
    for section in s.sections("known")? {
        let one = prior(&section, stated_units)?;
        let is_twice = out.iter().any(|other| {
            other.coefficient == one.coefficient
                && (other.model == one.model || other.model.is_none() || one.model.is_none())
        });
        let is_fixed = fixed.contains_key(&one.coefficient);
        if is_twice || is_fixed {
            let what = if is_twice { "known twice" } else { "in `fixed` too" };
            let problem = format!("is {}, which is {what}; a coefficient is held at one value", one.coefficient);
            return Err(RecordError::value(section.place(), "coefficient", problem));
        }
        out.push(one);
    }
    Ok(out)
}

/// A value with its standard uncertainty, in its unit or in per cent of the value.
fn prior(s: &Section<'_>, stated_units: &mut Vec<StatedUnit>) -> Result<PriorSpec, RecordError> {
    const WRITTEN: [&str; 2] = ["value", "standard_uncertainty"];
    const OF_RECORD: [&str; 4] = ["select", "entry", "volume", "model_form"];
    let values = Values::read(s, PRIOR)?;
    let text = |key: &str| values.text(key).map(str::to_owned);
    let (coefficient, model) = (values.need("coefficient", text("coefficient"))?, text("model"));
    if let Some(record) = values.text("record") {
        for key in WRITTEN {
            s.refuse(key, true, "and record are given; a value is written, or taken from a record")?;
        }
        let entry = s.need_text("entry", "name the coefficient of the record, \"A66\" say")?;
        let record = PriorRecord {
            path: s.source.relative(record),
            select: text("select"),
            entry: entry.to_owned(),
            volume_m3: values.number("volume"),
            model_form: values.number("model_form").unwrap_or(0.0),
            place: s.place(),
        };
        // Value and uncertainty follow when the record is read.
        let (value, standard_uncertainty) = (f64::NAN, f64::NAN);
        return Ok(PriorSpec { coefficient, value, standard_uncertainty, dof: None, model, record: Some(record) });
    }
    for key in OF_RECORD {
        s.refuse(key, true, "belongs to a value of a record: write record = \"estimate.json\" beside it")?;
    }
    let mut need = |key: &'static str, percent_of: Option<f64>| -> Result<f64, RecordError> {
        let value = s.need(key, "coefficient, value and standard_uncertainty are needed")?;
        let (si, unit) = coefficient_value(s, key, value)?;
        match (unit, percent_of) {
            (Some(unit), Some(whole)) if unit.text.trim() == "%" => return Ok(si * whole.abs()),
            (Some(unit), _) => stated_units.push(StatedUnit {
                coefficient: coefficient.clone(),
                model: model.clone(),
                unit,
                place: s.source.place(value.span().start),
            }),
            _ => {}
        }
        Ok(si)
    };
    let value = need("value", None)?;
    let standard_uncertainty = need("standard_uncertainty", Some(value))?;
    let out = PriorSpec { coefficient, value, standard_uncertainty, dof: None, model, record: None };
    if out.standard_uncertainty <= 0.0 {
        let problem = "must be larger than zero; hold a value without uncertainty with `fixed`";
        return Err(RecordError::value(s.place(), "standard_uncertainty", problem));
    }
    Ok(out)
}

fn range_block(s: &Section<'_>) -> Result<RangeBlock, RecordError> {
    let values = Values::read(s, RANGE_BLOCK)?;
    let column = values.need("column", values.text("column"))?.to_owned();
    let end = |key: &'static str, open: f64| -> Result<f64, RecordError> {
        s.get(key).map_or(Ok(open), |v| match known_dimension(&column) {
            Some(dimension) => s.as_written(key, v, &column, dimension).map(|q| q.value_si),
            None => s.as_quantity(key, v).map(|q| q.value_si),
        })
    };
    let out = RangeBlock { low: end("low", f64::NEG_INFINITY)?, high: end("high", f64::INFINITY)?, column };
    if out.low >= out.high {
        return Err(RecordError::value(s.place(), "low", "is not below high"));
    }
    Ok(out)
}

fn user_model(s: &Section<'_>) -> Result<UserModel, RecordError> {
    let name = s.need_text("name", "write name = \"sway\", for example")?.to_owned();
    let mut formulas = IndexMap::new();
    for (load, _, value) in s.others() {
        formulas.insert(load.to_owned(), s.as_text(load, value)?.to_owned());
    }
    if formulas.is_empty() {
        return Err(s.missing("f_x", "a model needs a formula: f_y = \"Y_v*v + Y_vav*v*abs(v)\""));
    }
    Ok(UserModel { name, formulas })
}

fn simulate(s: &Section<'_>) -> Result<Simulate, RecordError> {
    let values = Values::read(s, SIMULATE)?;
    let select = values.text("select").map(str::to_owned);
    let record = values.text("record").map(|r| Truth::Record { path: s.source.relative(r), select });
    let mut stated = Vec::new();
    let written = s
        .section("coefficients")?
        .map(|table| -> Result<Truth, RecordError> {
            let model = values.text("model");
            let model =
                model.ok_or_else(|| s.missing("model", "name the force model that the coefficients belong to"))?;
            let mut truths = IndexMap::new();
            for (name, start, value) in table.entries() {
                let (truth, unit) = coefficient_value(&table, name, value)?;
                truths.insert(name.to_owned(), truth);
                stated.push(StatedTruth { coefficient: name.to_owned(), unit, place: s.source.place(start) });
            }
            Ok(Truth::Coefficients { model: model.to_owned(), values: truths })
        })
        .transpose()?;
    let ((Some(truth), None) | (None, Some(truth))) = (record, written) else {
        let problem = "a twin needs exactly one truth: record (with select), or model and [simulate.coefficients]";
        return Err(s.missing("record", problem));
    };
    Ok(Simulate {
        seed: values.need("seed", values.count("seed"))? as u64,
        truth,
        stated,
        sensors: s.sections("sensor")?.iter().map(sensor).collect::<Result<_, _>>()?,
        misalignment_rad: values.number("misalignment"),
    })
}

fn sensor(s: &Section<'_>) -> Result<SensorSpec, RecordError> {
    let values = Values::read(s, SENSOR)?;
    let quantity = values.need("quantity", values.text("quantity"))?.to_owned();
    let dimension = known_dimension(&quantity);
    let part = |key: &'static str| -> Result<Option<f64>, RecordError> {
        s.get(key)
            .map(|v| match dimension {
                Some(d) => s.as_written(key, v, &quantity, d).map(|q| q.value_si),
                None => s.as_quantity(key, v).map(|q| q.value_si),
            })
            .transpose()
    };
    Ok(SensorSpec {
        place: Some(s.place()),
        noise: part("noise")?,
        resolution: part("resolution")?,
        drift: part("drift")?,
        bias: part("bias")?,
        correlation_s: values.number("correlation"),
        quantity,
    })
}
