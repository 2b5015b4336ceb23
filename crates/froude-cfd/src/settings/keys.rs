//! The keys of `[source.cfd]`.

use froude_records::declare::{Key, Kind, Range, optional, required, usual};
use froude_records::units::Dimension;

/// Most cells in one direction.
const MOST_CELLS: u64 = 2000;
/// Most layers at a wall.
const MOST_LAYERS: u64 = 100;
/// Most iterations of a case.
const MOST_ITERATIONS: u64 = 100_000;

const fn length(name: &'static str, write: &'static str, doc: &'static str) -> Key {
    required(name, Kind::Quantity(Dimension::LENGTH), write, doc).within(Range::Positive)
}

const fn cells(name: &'static str, doc: &'static str) -> Key {
    required(name, Kind::Count(MOST_CELLS), OF_O_GRID, doc)
}

const OF_O_GRID: &str = "an O-grid needs stations, layers, azimuth and first_layer, cubes surface_cell and first_layer";
const OF_CUBES: &str = "cubes need surface_cell and first_layer";
const OF_TANK: &str = "a tank needs width, depth, and the submergence of the body's origin";

/// Keys of `[source.cfd]`.
pub const KEYS: &[Key] = &[
    optional("body", Kind::Text, "the campaign's own", "a body file, or a closed surface mesh"),
    optional("unit", Kind::Text, "m", "unit of a surface mesh: \"mm\""),
    optional("forward", Kind::Text, "x", "axis of a surface mesh that points forward"),
    optional("up", Kind::Text, "z", "axis of a surface mesh that points up"),
    optional("mesh", MESH, "coarse", "cells about the body: `coarse`, `medium`, `fine`, an O-grid or cubes"),
    optional("radius", Kind::Number, "3, and 25 widths at least", "radius of the domain, in lengths of the body")
        .within(Range::Between(1.0, 1000.0)),
    usual(
        "domain",
        Kind::Word(&["half", "full"]),
        "half",
        "`half`: cut at the body's plane of symmetry z = 0; two angles need `full`",
    ),
    optional("tank", Kind::Table(TANK), "unbounded water", "walls, bottom and surface about the body"),
    usual("model", Kind::Word(&["sst", "laminar"]), "sst", "model of turbulence, or none"),
    usual(
        "laminar_below",
        Kind::Number,
        "0",
        "Reynolds number of the width below which no case has a model of turbulence",
    )
    .within(Range::Between(0.0, 1e7)),
    usual("both_below", Kind::Number, "0", "Reynolds number below which a case is computed with and without one")
        .within(Range::Between(0.0, 1e7)),
    usual("iterations", Kind::Count(MOST_ITERATIONS), "600", "most iterations of a case"),
    usual("window", Kind::Count(MOST_ITERATIONS), "60", "iterations that forces are judged over"),
    usual("cold", Kind::Number, "0.1", "part of the cases that are repeated from the inflow")
        .within(Range::Between(0.0, 1.0)),
    optional("fine", Kind::Table(FINE), "none", "cases that are also computed on a finer mesh"),
    optional(
        "study",
        Kind::List(&Kind::Table(STUDY)),
        "none",
        "settings of the plan that are computed on other grids and in other domains",
    ),
];

const MESH: Kind = Kind::Either(&[Kind::Word(&["coarse", "medium", "fine"]), Kind::Table(O_GRID), Kind::Table(CUBES)]);

/// Keys of an O-grid.
pub(super) const O_GRID: &[Key] = &[
    length("first_layer", OF_O_GRID, "height of the layer at the wall"),
    cells("stations", "cells along the meridian, from tip to tip"),
    cells("layers", "cells from the wall to the far field"),
    cells("azimuth", "cells over half a turn"),
];

/// Keys of a mesh of cubes.
pub(super) const CUBES: &[Key] = &[
    length("surface_cell", OF_CUBES, "edge of the cubes at the surface"),
    length("first_layer", OF_CUBES, "height of the layer at the wall"),
    optional(
        "layers",
        Kind::Count(MOST_LAYERS),
        "until the last is 0.15 times as high as the cubes",
        "layers at the wall",
    ),
    usual("growth", Kind::Number, "1.3", "each layer over the one before").within(Range::Between(1.0, 2.0)),
];

/// Keys of `tank`.
pub(super) const TANK: &[Key] = &[
    length("width", OF_TANK, "from wall to wall"),
    length("depth", OF_TANK, "of the water"),
    length("submergence", OF_TANK, "of the body's origin below the surface"),
];

/// Keys of `fine`.
pub(super) const FINE: &[Key] = &[
    required("mesh", MESH, "write fine = { mesh = \"medium\", every = 5 }", "the finer mesh"),
    usual("every", Kind::Count(1000), "5", "every so many of the cases of a configuration"),
];

/// Keys of `[[source.cfd.study]]`.
pub(super) const STUDY: &[Key] = &[
    optional("configurations", Kind::Texts, "all of the plan", "names of the configurations"),
    required("speed", Kind::Axis(Dimension::SPEED), "name settings of the plan: speed = \"0.3 m/s\"", "speed"),
    usual("angle", Kind::Axis(Dimension::ANGLE), "0 deg", "angle of the velocity"),
    usual("pitch", Kind::Axis(Dimension::ANGLE), "0 deg", "angle of the velocity out of the plane"),
    optional("grids", Kind::Whole, "4, or none where radius is given", "grids of a family by √2, 3 to 6"),
    optional(
        "radius",
        Kind::Either(&[Kind::Number, Kind::List(&Kind::Number)]),
        "none",
        "radii of other domains, in lengths of the body",
    ),
];
