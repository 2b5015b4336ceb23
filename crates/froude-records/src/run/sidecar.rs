//! What is known about a run, as text: `RUN.toml` for people, and the same entries inside `RUN.mcap`.
//!
//! A number that measures something is a text with its unit, as in every other file. An entry has one dotted key
//! (`carriage.rig.y.torque_constant.value`) in both places, so one reader does for both.
//!
//! Schema 1 knew runs of the carriage only: `kind` for the role, and what is mounted and how it was driven without sections of their
//! own. It is read as runs of the method `tow`; which axis of the body lay along the travel, it does not say.

use std::collections::BTreeMap;
use std::path::Path;

use indexmap::IndexMap;
use toml::de::DeTable;

use crate::body_axis::BodyAxis;
use crate::checksum;
use crate::error::RecordError;
use crate::hash::Fingerprint;
use crate::measured::Measured;
use crate::read;
use crate::run::channel::Meaning;
use crate::run::declarations::{self, Declarations, Stated};
use crate::run::declared::declared;
use crate::run::declared_text;
use crate::run::meta::{
    Axis, AxisConstants, BodyState, CarriageFacts, ClockAlignment, Direction, Mounted, Role, RunMeta, RunStatus, TOW,
};
use crate::run::sensor::Sensor;
use crate::section::{Section, Source, parse};
use crate::section_values::{count, one_of};
use crate::toml_text::{key_word, quoted};
use crate::units::{Dimension, parse_unit};
use crate::write::write_atomically;

/// The largest sidecar that is read.
pub(crate) const LARGEST_BYTES: u64 = 1 << 20;

/// Name of the metadata record at the beginning of `RUN.mcap`, status `running`.
pub(crate) const RECORD_NAME: &str = "froude_run";
/// Name of the one at its end, with how the run ended.
pub(crate) const END_RECORD_NAME: &str = "froude_run_end";

/// N m/A, of the torque constant.
pub const TORQUE_CONSTANT: Dimension = Dimension { m: 2, kg: 1, s: -2, k: 0, a: -1 };
/// A/V, of the amplifier.
pub const AMPLIFIER: Dimension = Dimension { m: -2, kg: -1, s: 3, k: 0, a: 2 };

/// The newest form, which is written.
const SCHEMA: u64 = 2;

/// Keys whose values are whole numbers or true and false; all others are texts.
const BARE: [&str; 9] =
    ["schema", "set", "pair", "repeat", "ballasted", "twin_seed", "start_unix_ns", "bytes", "efficiency_is_calibrated"];

/// Reads a run's sidecar.
///
/// # Errors
///
/// See [`RecordError`]; [`RecordError::Checksum`] for a sidecar whose content was changed and whose line `checksum` was left.
pub fn read_run_meta(path: &Path) -> Result<RunMeta, RecordError> {
    parse_run_meta(path, &read::text(path, LARGEST_BYTES, "a run's sidecar")?)
}

/// The same from text; `path` is for messages.
///
/// # Errors
///
/// See [`RecordError`].
pub fn parse_run_meta(path: &Path, text: &str) -> Result<RunMeta, RecordError> {
    let source = Source { path, text };
    let document = parse(source)?;
    let root = Section::new(source, "", document.get_ref(), 0);
    let schema = root.schema_up_to("run", SCHEMA)?;
    // First of all: what was changed since it was written is believed in nothing.
    if let Some(value) = root.get(checksum::KEY)
        && root.as_text(checksum::KEY, value)? != checksum::of_toml(document.get_ref())
    {
        return Err(RecordError::Checksum { place: source.place(value.span().start) });
    }
    meta(&root, schema)
}

/// Writes a run's sidecar, whole or not at all.
///
/// # Errors
///
/// [`RecordError::Write`].
pub fn write_run_meta(path: &Path, meta: &RunMeta) -> Result<(), RecordError> {
    write_atomically(path, run_meta_text(meta).as_bytes())
}

/// The sidecar's text, with the checksum of what it says.
#[must_use]
pub fn run_meta_text(meta: &RunMeta) -> String {
    let mut text = String::from("# A run that Froude recorded: what is known about the .mcap file of the same name.\n");
    let mut section = String::new();
    for (key, value) in summed(meta) {
        let (own, name) = split_section(&key);
        if own != section {
            text += &format!("\n[{own}]\n");
            own.clone_into(&mut section);
        }
        text += &format!("{name} = {}\n", written(&key, &value));
    }
    text
}

/// `carriage.rig.y` and `torque_constant.value`; sections are one word, of the rig three.
fn split_section(key: &str) -> (&str, &str) {
    let mut dots = key.match_indices('.').map(|(at, _)| at);
    let at = if key.starts_with("carriage.rig.") { dots.nth(2) } else { dots.next() };
    at.map_or(("", key), |at| (&key[..at], &key[at + 1..]))
}

/// The entries as the metadata record of `RUN.mcap` holds them.
pub(crate) fn to_record(meta: &RunMeta) -> BTreeMap<String, String> {
    summed(meta).into_iter().collect()
}

/// All entries, and behind the schema the checksum of the others.
fn summed(meta: &RunMeta) -> Vec<(String, String)> {
    let mut all = entries(meta);
    let text: String = all.iter().map(|(key, value)| format!("{key} = {}\n", written(key, value))).collect();
    // What is written here is TOML; a sum of nothing would be refused when it is read.
    let sum = DeTable::parse(&text).map(|table| checksum::of_toml(table.get_ref())).unwrap_or_default();
    all.insert(1, (checksum::KEY.to_owned(), sum));
    all
}

/// Keys that two descriptions of a run give different values; neither checksum nor fingerprint counts.
pub(crate) fn differing(a: &RunMeta, b: &RunMeta) -> Vec<String> {
    let all = |meta: &RunMeta| -> BTreeMap<String, String> {
        entries(&RunMeta { log: None, ..meta.clone() }).into_iter().collect()
    };
    let (a, b) = (all(a), all(b));
    let mut keys: Vec<String> =
        a.iter().filter(|(key, value)| b.get(*key) != Some(value)).map(|(k, _)| k.clone()).collect();
    keys.extend(b.keys().filter(|key| !a.contains_key(*key)).cloned());
    keys
}

/// Reads them back; `path` is the `.mcap` file, for messages.
pub(crate) fn of_record(path: &Path, record: &BTreeMap<String, String>) -> Result<RunMeta, RecordError> {
    let text: String = record.iter().map(|(key, value)| format!("{key} = {}\n", written(key, value))).collect();
    parse_run_meta(path, &text)
}

/// A value as TOML: a table or bare as it is, or a text in quotes.
fn written(key: &str, value: &str) -> String {
    let last = key.rsplit('.').next().unwrap_or(key);
    if declared_text::is_verbatim(key) {
        return value.to_owned();
    }
    let is_named_freely = ["versions.", "constants.", "conditions."].iter().any(|section| key.starts_with(section));
    if BARE.contains(&last) && !is_named_freely { value.to_owned() } else { quoted(value) }
}

/// All entries, in the order of the sidecar.
fn entries(meta: &RunMeta) -> Vec<(String, String)> {
    let mut out: Vec<(String, String)> = Vec::new();
    let mut put = |key: &str, value: String| out.push((key.to_owned(), value));
    put("schema", SCHEMA.to_string());
    put("id", meta.id.clone());
    put("campaign", meta.campaign.clone());
    if !meta.campaign_sha256.is_empty() {
        put("campaign_sha256", meta.campaign_sha256.clone());
    }
    put("method", meta.method.clone());
    put("role", meta.role.name().to_owned());
    put("status", meta.status.name().to_owned());
    put("date", meta.date.clone());
    put("start_unix_ns", meta.start_unix_ns.to_string());
    put("log_rate", format!("{} Hz", meta.log_rate_hz));
    put("note", meta.note.clone());
    for (key, value) in declared_text::at_the_head(&meta.declared) {
        put(&key, value);
    }
    let Mounted { body, is_ballasted, hung_weight_n, travel } = &meta.mounted;
    let CarriageFacts { set, pair, repeat, axis, target_speed_m_s, direction, rig, twin_seed } = &meta.carriage;
    let known = [
        ("mounted.body", Some(body.name().to_owned())),
        ("mounted.ballasted", Some(is_ballasted.to_string())),
        ("mounted.hung_weight", hung_weight_n.map(|w| format!("{w} N"))),
        ("mounted.travel", travel.map(|axis| axis.name().to_owned())),
        ("mounted.configuration", Some(meta.configuration.clone()).filter(|name| !name.is_empty())),
        ("carriage.axis", Some(axis.name().to_owned())),
        ("carriage.set", set.map(|n| n.to_string())),
        ("carriage.pair", pair.map(|n| n.to_string())),
        ("carriage.repeat", repeat.map(|n| n.to_string())),
        ("carriage.target_speed", target_speed_m_s.map(|v| format!("{v} m/s"))),
        ("carriage.direction", direction.map(|d| d.name().to_owned())),
        ("carriage.twin_seed", twin_seed.map(|seed| seed.to_string())),
    ];
    let is_driven = meta.carriage != CarriageFacts::default();
    for (key, value) in known {
        if let Some(value) = value.filter(|_| is_driven || !key.starts_with("carriage.")) {
            put(key, value);
        }
    }
    for (axis, constants) in rig {
        let axis = key_word(axis);
        let declared = [
            ("torque_constant", "N m/A", Some(constants.torque_constant_n_m_a)),
            ("amplifier", "A/V", Some(constants.amplifier_a_v)),
            ("gear_ratio", "1", Some(constants.gear_ratio)),
            ("sprocket_radius", "m", Some(constants.sprocket_radius_m)),
            ("efficiency_forward", "1", constants.efficiency_forward),
            ("efficiency_backward", "1", constants.efficiency_backward),
        ];
        let mut put = |key: &str, value: String| put(&format!("carriage.rig.{axis}.{key}"), value);
        for (key, unit, constant) in declared {
            if let Some(constant) = constant {
                put(&format!("{key}.value"), format!("{} {unit}", constant.value));
                put(&format!("{key}.standard"), format!("{} {unit}", constant.standard_uncertainty));
            }
        }
        put("counts_per_revolution", format!("{} 1", constants.counts_per_revolution));
        put("efficiency_is_calibrated", constants.is_calibrated.to_string());
    }
    for (name, meaning) in &meta.channels {
        put(&format!("channels.{}", key_word(name)), declared_text::channel(meaning, meta.stated.get(name)));
    }
    for (key, value) in declared_text::in_sections(&meta.declared) {
        put(&key, value);
    }
    if let Some(log) = &meta.log {
        put("log.bytes", log.bytes.to_string());
        put("log.sha256", log.sha256.clone());
    }
    if let Some(clock) = &meta.clock {
        put("clock.host_at_zero", format!("{} s", clock.host_at_zero_s));
        put("clock.drift", format!("{} 1", clock.drift));
        put("clock.standard_uncertainty", format!("{} s", clock.standard_uncertainty_s));
    }
    for (name, condition) in &meta.conditions {
        put(&format!("conditions.{}", key_word(name)), format!("{} {}", condition.value, condition.unit));
    }
    for (name, constant) in &meta.constants {
        put(&format!("constants.{}", key_word(name)), format!("{} {}", constant.value, constant.unit));
    }
    for (name, version) in &meta.versions {
        put(&format!("versions.{}", key_word(name)), version.clone());
    }
    out
}

/// Keys of every form.
const ALWAYS: [&str; 14] = [
    "schema",
    "checksum",
    "id",
    "campaign",
    "campaign_sha256",
    "status",
    "date",
    "start_unix_ns",
    "log_rate",
    "note",
    "log",
    "clock",
    "constants",
    "versions",
];
const MOUNTED: [&str; 3] = ["body", "ballasted", "hung_weight"];
const CARRIAGE: [&str; 8] = ["set", "pair", "repeat", "axis", "target_speed", "direction", "twin_seed", "rig"];

fn meta(s: &Section<'_>, schema: u64) -> Result<RunMeta, RecordError> {
    let text = |key: &'static str| Ok::<_, RecordError>(s.text(key)?.unwrap_or_default().to_owned());
    let role = |key: &'static str| {
        one_of(s, key, &Role::NAMES, &Role::ALL)?
            .ok_or_else(|| s.missing(key, "state what the run is for: \"wet\", \"dry\", \"still\", …"))
    };
    let (method, role, mounted, carriage) = if schema == 1 {
        s.only(&[&ALWAYS[..], &["kind"], &MOUNTED, &CARRIAGE].concat())?;
        (TOW.to_owned(), role("kind")?, mounted(s)?, carriage(s)?)
    } else {
        s.only(
            &[&ALWAYS[..], &["method", "role", "mounted", "conditions", "carriage", "channels"], &declarations::KEYS]
                .concat(),
        )?;
        let advice = "state the kind of experiment that it belongs to: \"tow\", \"free_decay\", …";
        let method = s.need_text("method", advice)?;
        let mounted = s.section("mounted")?.map(|m| {
            m.only(&[&MOUNTED[..], &["travel", "configuration"]].concat())?;
            mounted(&m)
        });
        let carriage = s.section("carriage")?.map(|c| {
            c.only(&CARRIAGE)?;
            carriage(&c)
        });
        let (mounted, carriage) = (mounted.transpose()?, carriage.transpose()?);
        (method.to_owned(), role("role")?, mounted.unwrap_or_default(), carriage.unwrap_or_default())
    };
    let mut out = RunMeta {
        campaign: text("campaign")?,
        campaign_sha256: text("campaign_sha256")?,
        id: s.need_text("id", "write id = \"…\", the name of the run's files")?.to_owned(),
        method,
        role,
        mounted,
        carriage,
        configuration: configuration(s)?,
        conditions: quantities(s, "conditions")?,
        status: one_of(s, "status", &RunStatus::NAMES, &RunStatus::ALL)?.ok_or_else(|| {
            s.missing("status", "state how it ended: \"complete\", \"interrupted\", \"faulted\" or \"cut\"")
        })?,
        note: text("note")?,
        log_rate_hz: s.quantity("log_rate", Dimension::ANGULAR_SPEED)?.unwrap_or(0.0),
        date: text("date")?,
        start_unix_ns: s.integer("start_unix_ns")?.unwrap_or(0),
        declared: Declarations::read(s)?,
        ..RunMeta::default()
    };
    if let Some(channels) = s.section("channels")? {
        for (name, _, value) in channels.entries() {
            let entry = channels.as_section(name, value)?;
            let (meaning, words) = Meaning::read(&entry, name, &out.declared.frame_names())?;
            let sensor = Sensor::read(&entry, parse_unit(&meaning.unit).ok().map(|unit| unit.dimension))?;
            let undeclared = ["sign", "frame", "clock"].into_iter().filter(|key| entry.get(key).is_none()).collect();
            let frame = words.declared_frame().map(str::to_owned);
            let stated = Stated { sensor, frame, undeclared };
            if stated != Stated::default() {
                out.stated.insert(name.to_owned(), stated);
            }
            out.channels.insert(name.to_owned(), meaning);
        }
    }
    if let Some(log) = s.section("log")? {
        log.only(&["bytes", "sha256"])?;
        let advice = "both are written when a log is finished; without them leave the section out";
        let bytes = log.integer("bytes")?.ok_or_else(|| log.missing("bytes", advice))?;
        out.log = Some(Fingerprint { bytes, sha256: log.need_text("sha256", advice)?.to_owned() });
    }
    if let Some(clock) = s.section("clock")? {
        clock.only(&["host_at_zero", "drift", "standard_uncertainty"])?;
        let part = |key, dimension| Ok::<_, RecordError>(clock.quantity(key, dimension)?.unwrap_or(0.0));
        out.clock = Some(ClockAlignment {
            host_at_zero_s: part("host_at_zero", Dimension::TIME)?,
            drift: part("drift", Dimension::ONE)?,
            standard_uncertainty_s: part("standard_uncertainty", Dimension::TIME)?,
        });
    }
    out.constants = quantities(s, "constants")?;
    if let Some(versions) = s.section("versions")? {
        for (name, _, value) in versions.entries() {
            out.versions.insert(name.to_owned(), versions.as_text(name, value)?.to_owned());
        }
    }
    Ok(out)
}

/// `configuration` in `[mounted]`.
pub(crate) fn configuration(s: &Section<'_>) -> Result<String, RecordError> {
    let Some(mounted) = s.section("mounted")? else { return Ok(String::new()) };
    Ok(mounted.text("configuration")?.unwrap_or_default().to_owned())
}

/// A section of quantities by name, in SI: `[conditions]`, `[constants]`.
pub(crate) fn quantities(s: &Section<'_>, key: &'static str) -> Result<IndexMap<String, Measured>, RecordError> {
    let Some(section) = s.section(key)? else { return Ok(IndexMap::new()) };
    let mut out = IndexMap::new();
    for (name, _, value) in section.entries() {
        let quantity = section.as_quantity(name, value)?;
        let unit = quantity.unit.dimension.to_string();
        out.insert(name.to_owned(), Measured::of(quantity.value_si, unit));
    }
    Ok(out)
}

/// What is mounted: of a section of its own, in schema 1 of the file.
fn mounted(s: &Section<'_>) -> Result<Mounted, RecordError> {
    Ok(Mounted {
        body: one_of(s, "body", &BodyState::NAMES, &BodyState::ALL)?.unwrap_or_default(),
        is_ballasted: s.flag("ballasted")?.unwrap_or(false),
        hung_weight_n: s.quantity("hung_weight", Dimension::FORCE)?,
        travel: one_of(s, "travel", &BodyAxis::NAMES, &BodyAxis::ALL)?,
    })
}

/// How a carriage drove it: of a section of its own, in schema 1 of the file.
fn carriage(s: &Section<'_>) -> Result<CarriageFacts, RecordError> {
    let number = |key: &'static str| count(s, key, u64::from(u32::MAX)).map(|n| n.map(|n| n as u32));
    let mut out = CarriageFacts {
        set: number("set")?,
        pair: number("pair")?,
        repeat: number("repeat")?,
        axis: one_of(s, "axis", &Axis::NAMES, &Axis::ALL)?.unwrap_or_default(),
        target_speed_m_s: s.quantity("target_speed", Dimension::SPEED)?,
        direction: one_of(s, "direction", &Direction::NAMES, &Direction::ALL)?,
        twin_seed: s.integer("twin_seed")?,
        ..CarriageFacts::default()
    };
    if let Some(rig) = s.section("rig")? {
        for (axis, _, value) in rig.entries() {
            out.rig.insert(axis.to_owned(), axis_constants(&rig.as_section(axis, value)?)?);
        }
    }
    Ok(out)
}

fn axis_constants(s: &Section<'_>) -> Result<AxisConstants, RecordError> {
    s.only(&[
        "torque_constant",
        "amplifier",
        "gear_ratio",
        "sprocket_radius",
        "efficiency_forward",
        "efficiency_backward",
        "counts_per_revolution",
        "efficiency_is_calibrated",
    ])?;
    let part = |key, dimension| Ok::<_, RecordError>(declared(s, key, dimension)?.unwrap_or_default());
    Ok(AxisConstants {
        torque_constant_n_m_a: part("torque_constant", TORQUE_CONSTANT)?,
        amplifier_a_v: part("amplifier", AMPLIFIER)?,
        gear_ratio: part("gear_ratio", Dimension::ONE)?,
        sprocket_radius_m: part("sprocket_radius", Dimension::LENGTH)?,
        counts_per_revolution: s.quantity("counts_per_revolution", Dimension::ONE)?.unwrap_or(0.0),
        efficiency_forward: declared(s, "efficiency_forward", Dimension::ONE)?,
        efficiency_backward: declared(s, "efficiency_backward", Dimension::ONE)?,
        is_calibrated: s.flag("efficiency_is_calibrated")?.unwrap_or(false),
    })
}
