//! What can be asked of an added mass: one list of options, flags of `froude added-mass` and keys of `[source.added_mass]` alike.
//!
//! Here they are texts with their places; what they mean is for the method to say.

use std::fmt;

use crate::error::Place;

/// An option.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AddedMassOption {
    /// Its key in a campaign.
    pub name: &'static str,
    /// The flag, without its dashes: the key with `-` for `_`.
    pub flag: &'static str,
    /// What it takes; nothing where it is set or not.
    pub takes: Option<&'static str>,
    /// The only words that it takes, where these are few.
    pub words: &'static [&'static str],
    /// What it says.
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

/// All of them.
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
    option("unit", "UNIT", "Unit of a mesh whose file states none: m, mm, cm, in"),
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

/// An option as it was given.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GivenOption {
    /// Its [`AddedMassOption::name`].
    pub name: String,
    /// What stands there; `true` for one that is set or not.
    pub text: String,
    /// Where it stands in a campaign; `None` for a flag.
    pub place: Option<Place>,
}

impl fmt::Display for GivenOption {
    /// `--most-panels "none"`, or `campaign.toml:9:15: most_panels = "none"`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Some(place) => write!(f, "{place}: {} = {:?}", self.name, self.text),
            None => write!(f, "--{} {:?}", self.name.replace('_', "-"), self.text),
        }
    }
}
