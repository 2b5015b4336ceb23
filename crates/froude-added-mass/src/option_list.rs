//! The options of an added-mass computation: flags of `froude added-mass` and keys of `[source.added_mass]`, from one list.
//!
//! Values are kept here as written, with their places; [`Asked`](crate::options::Asked) interprets them.

use froude_records::RecordError;
use froude_records::campaign::Source;
use froude_records::declare::{IfMissing, Key, Kind, names};
use froude_records::given_option::GivenOption;
use froude_records::section::found;
use toml::de::DeValue;

/// An option.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AddedMassOption {
    /// Its key in a campaign.
    pub name: &'static str,
    /// The flag, without its dashes: the key with `-` for `_`.
    pub flag: &'static str,
    /// Placeholder of its value in the help; `None` for a switch.
    pub takes: Option<&'static str>,
    /// The only values allowed; empty if there is no fixed list.
    pub words: &'static [&'static str],
    /// Help text.
    pub help: &'static str,
}

const fn option(name: &'static str, takes: &'static str, help: &'static str) -> AddedMassOption {
    AddedMassOption { name, flag: name, takes: Some(takes), words: &[], help }
}

const fn words(name: &'static str, words: &'static [&'static str], help: &'static str) -> AddedMassOption {
    AddedMassOption { words, ..option(name, "AXIS", help) }
}

const fn switch(name: &'static str, help: &'static str) -> AddedMassOption {
    AddedMassOption { name, flag: name, takes: None, words: &[], help }
}

/// Directions along the axes of a mesh.
const DIRECTIONS: &[&str] = &["x", "-x", "y", "-y", "z", "-z"];

/// All options.
pub const ADDED_MASS_OPTIONS: [AddedMassOption; 17] = [
    option("links", "K|A..B|K,K", "Links of a robot: 3, or 1..9 for a table with a least-squares fit, or 1,3,6"),
    option("density", "QUANTITY", "Density of the water, with its unit [default: the body file's]"),
    words(
        "axes",
        &["ned", "fossen", "enu"],
        "Axes of the result, x forward in all: ned and fossen have y to starboard and z down (SNAME), enu has y to port and z up (ROS REP 103) [default: those of the mesh]",
    ),
    option(
        "at",
        "cg|cb|X, Y, Z",
        "Reference point of the moments: cg (of the body file), cb (centre of buoyancy), or \"0 m, 0 m, -0.2 m\" in the axes of the mesh \
         [default: its origin]",
    ),
    option(
        "unit",
        "UNIT",
        "Unit of the mesh: m, mm, cm, in, ft, or a length (\"0.5 m\"); or 1:50 for a model fifty times smaller than the mesh, \"1:50 mm\" for \
         one in millimetres [default: the file's, or m]",
    ),
    words("forward", DIRECTIONS, "Axis of the mesh that points forward [default: x]"),
    words("up", DIRECTIONS, "Axis of the mesh that points up [default: z]"),
    option("tolerance", "QUANTITY", "Largest numerical uncertainty of an entry [default: \"1 %\"]"),
    AddedMassOption { flag: "most-panels", ..option("most_panels", "N", "Largest number of panels [default: 120000]") },
    option(
        "surface",
        "QUANTITY",
        "Height of the water's surface above the origin of the mesh; the zero- and infinite-frequency limits are computed",
    ),
    option(
        "tank",
        "L x B x D",
        "A closed tank, length along x, breadth along y, depth of water, with the origin of the mesh in its middle: \"1.5 m x 0.9 m x 1 m\"; with \
         --surface",
    ),
    AddedMassOption {
        flag: "joint-angle",
        ..option(
            "joint_angle",
            "QUANTITY",
            "Angle of every joint about z; gives the link-by-link matrix of the bent chain",
        )
    },
    switch("chain", "Give the link-by-link matrix of the straight chain"),
    switch("apart", "Treat the disconnected parts of a mesh as separate bodies"),
    switch(
        "polyhedron",
        "The facets of a mesh are the body itself [default: the value of the smooth body, with an interval that contains both]",
    ),
    switch("smooth", "The facets of a mesh are those of a smooth body: narrower intervals"),
    option("export", "FORMAT,…", "Files to write beside the record: wamit, capytaine, csv"),
];

/// The options as keys of `[source.added_mass]`.
pub const KEYS: [Key; ADDED_MASS_OPTIONS.len()] = {
    let mut keys = [ADDED_MASS_OPTIONS[0].key(); ADDED_MASS_OPTIONS.len()];
    let mut i = 1;
    while i < keys.len() {
        keys[i] = ADDED_MASS_OPTIONS[i].key();
        i += 1;
    }
    keys
};

impl AddedMassOption {
    const fn key(self) -> Key {
        let kind = match self {
            Self { takes: None, .. } => Kind::Flag,
            Self { words: [], .. } => Kind::Either(&[Kind::Text, Kind::Whole, Kind::List(&Kind::Text)]),
            Self { words, .. } => Kind::Word(words),
        };
        Key::new(self.name, kind, IfMissing::Nothing(""), self.help)
    }
}

/// The options given for a source: flags of the verb, or keys of `[source.added_mass]`. Values are texts, whole numbers, switches or lists of texts.
///
/// # Errors
///
/// A key that is not known, or a value of another kind, with its place.
pub fn given(source: &Source) -> Result<Vec<GivenOption>, RecordError> {
    let Some(s) = source.section("added_mass")? else { return Ok(source.given.clone()) };
    s.only(&names(&KEYS))?;
    let mut out = Vec::new();
    for (name, _, value) in s.entries() {
        let takes = ADDED_MASS_OPTIONS.iter().find(|option| option.name == name).and_then(|option| option.takes);
        let text = match value.get_ref() {
            DeValue::Boolean(false) if takes.is_none() => continue,
            DeValue::Boolean(true) if takes.is_none() => "true".to_owned(),
            _ if takes.is_none() => {
                return Err(s.wrong(name, value, format!("is {}; expected true or false", found(value))));
            }
            DeValue::Integer(i) if i.radix() == 10 => i.as_str().replace('_', ""),
            DeValue::Array(list) => list.iter().map(|v| s.as_text(name, v)).collect::<Result<Vec<_>, _>>()?.join(","),
            _ => s.as_text(name, value)?.to_owned(),
        };
        let place = Some(s.source.place(value.span().start));
        out.push(GivenOption { name: name.to_owned(), text, place });
    }
    Ok(out)
}
