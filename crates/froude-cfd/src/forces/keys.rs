//! `[source.openfoam_forces]`: how the force files of a folder of OpenFOAM cases are to be understood.
//!
//! ```toml
//! [source.openfoam_forces]
//! pattern  = "U{speed [m/s]}_b{angle [deg]}"   # what the names of the cases' folders state
//! forward  = "-x"             # axis of the mesh that points to the bow
//! up       = "z"              # axis of the mesh that points up
//! turned   = "inflow"         # what was turned to give a drift angle: the inflow, or the body in the mesh
//! symmetry = "none"           # the whole body; or the plane that a half domain ends at: "z = 0"
//! rho_inf  = "1 kg/m^3"       # rhoInf of the function object; 1 for loads divided by the density
//! origin   = "0 m, 0 m, 0 m"  # point of the mesh about which moments are reported; left out: CofR
//! ```

use froude_added_mass::frame::{Axes, Direction, Orientation};
use froude_records::RecordError;
use froude_records::campaign::Source;
use froude_records::declare::{Key, Kind, Range, Values, optional, required};
use froude_records::units::{Dimension, parse_quantity};

use super::coefficients::Declared;

/// Name of the method, and of its section.
pub const NAME: &str = "openfoam_forces";

const AXES: [&str; 6] = ["x", "-x", "y", "-y", "z", "-z"];
const PLANES: [&str; 4] = ["none", "x = 0", "y = 0", "z = 0"];
const FORWARD: &str =
    "write forward = \"-x\" where the water flows along +x at no drift: the axis of the mesh that points to the bow";
const UP: &str = "write up = \"z\", for example: the axis of the mesh that points up";
const SYMMETRY: &str = "write symmetry = \"none\" where the mesh goes around the whole body, or symmetry = \"z = 0\", \"y = 0\" or \"x = 0\" for the plane that half of the body ends at: loads of a half domain are doubled";

const fn positive(name: &'static str, dimension: Dimension, doc: &'static str) -> Key {
    optional(name, Kind::Quantity(dimension), "from the comment lines of the files", doc).within(Range::Positive)
}

/// Keys of the section.
pub const KEYS: &[Key] = &[
    optional(
        "pattern",
        Kind::Text,
        "`list`, or the inflow in the file `0/U` of each case",
        "names of the cases' folders with what they state, each with its unit: \"U{speed [m/s]}_b{angle [deg]}\", also {configuration}",
    ),
    optional(
        "list",
        Kind::Text,
        "`pattern`, or the inflow in the file `0/U` of each case",
        "a table with the columns case, speed [m/s] and angle [deg]",
    ),
    optional("object", Kind::Text, "the only one with force files", "name of the function object in postProcessing"),
    required(
        "forward",
        Kind::Word(&AXES),
        FORWARD,
        "axis of the force files that points to the bow, at no drift: that of the mesh, unless the function object has a `coordinateSystem`",
    ),
    required("up", Kind::Word(&AXES), UP, "axis of the force files that points up"),
    optional(
        "turned",
        Kind::Word(&["inflow", "body"]),
        "required with drift",
        "what was turned for a drift angle: the `inflow`, so that the axes of the files lie with the body, or the `body` in the mesh",
    ),
    required(
        "symmetry",
        Kind::Word(&PLANES),
        SYMMETRY,
        "symmetry plane of a half model, in the axes of the files; `none` if the mesh contains the whole body",
    ),
    optional(
        "rho_inf",
        Kind::Quantity(Dimension::DENSITY),
        "required for forces; coefficients need none",
        "rhoInf of the function object, the density used for its loads; \"1 kg/m^3\" for loads divided by the density",
    )
    .within(Range::Positive),
    optional(
        "centre_of_rotation",
        Kind::Text,
        "CofR of the comment lines",
        "point of the mesh that the moments in the files are about, where the files do not state it",
    ),
    optional("origin", Kind::Text, "CofR", "point of the mesh about which moments are reported: \"0 m, 0 m, -0.2 m\""),
    positive("a_ref", Dimension::AREA, "Aref of coefficients"),
    positive("l_ref", Dimension::LENGTH, "lRef of coefficients"),
    positive("mag_u_inf", Dimension::SPEED, "magUInf of coefficients"),
    optional(
        "window",
        Kind::Number,
        "the last quarter of a case",
        "length of the window that loads are averaged and judged over, in the time of the files (s, or iterations)",
    )
    .within(Range::Positive),
];

/// How force files are to be understood.
#[derive(Debug, Clone)]
pub(super) struct ForcesSpec {
    pub(super) pattern: Option<String>,
    pub(super) list: Option<std::path::PathBuf>,
    pub(super) object: Option<String>,
    /// Forward, starboard and down, in the axes of the mesh.
    pub(super) body: [[f64; 3]; 3],
    /// As it is written.
    pub(super) lies: Orientation,
    /// Whether the body was turned in the mesh; `None` if not declared.
    pub(super) is_body_turned: Option<bool>,
    /// Axis of the mesh that is normal to the plane of symmetry.
    pub(super) plane: Option<usize>,
    pub(super) rho_inf_kg_m3: Option<f64>,
    pub(super) centre_m: Option<[f64; 3]>,
    pub(super) origin_m: Option<[f64; 3]>,
    coefficients: Declared,
    pub(super) window: Option<f64>,
    values: Values,
}

impl ForcesSpec {
    /// Of a source; the section must be there, as nothing in it can be guessed.
    pub(super) fn of(source: &Source) -> Result<Self, RecordError> {
        let Some(section) = source.section(NAME)? else {
            let problem = format!(
                "source {:?} has no [source.{NAME}]; it needs forward, up, symmetry and, for forces, rho_inf. {FORWARD}; {UP}; {SYMMETRY}",
                source.name
            );
            return Err(RecordError::value(source.place.clone(), "method", problem));
        };
        let values = Values::read(&section, KEYS)?;
        let direction = |key: &str| {
            let all: [usize; 6] = std::array::from_fn(|i| i);
            let at = values.need(key, values.word(key, &all))?;
            Ok::<_, RecordError>(Direction { axis: at / 2, is_against: at % 2 == 1 })
        };
        let (forward, up) = (direction("forward")?, direction("up")?);
        let lies = Orientation::new(forward, up).ok_or_else(|| {
            values.wrong("up", format!("is {up}, and forward is {forward}: they lie along one axis of the mesh"))
        })?;
        let point =
            |key: &str| values.text(key).map(|text| point_m(text).map_err(|e| values.wrong(key, e))).transpose();
        let (pattern, list) = (values.text("pattern").map(str::to_owned), values.text("list"));
        if pattern.is_some() && list.is_some() {
            return Err(values.wrong("list", "and pattern both state the speeds of the cases; leave one out"));
        }
        let list = list.map(|list| section.source.relative(list));
        let spec = Self {
            pattern,
            list,
            object: values.text("object").map(str::to_owned),
            body: Axes::Ned.vectors(lies),
            lies,
            is_body_turned: values.word("turned", &[false, true]),
            plane: values.word("symmetry", &[None, Some(0), Some(1), Some(2)]).flatten(),
            rho_inf_kg_m3: values.number("rho_inf"),
            centre_m: point("centre_of_rotation")?,
            origin_m: point("origin")?,
            coefficients: Declared {
                speed_m_s: values.number("mag_u_inf"),
                area_m2: values.number("a_ref"),
                length_m: values.number("l_ref"),
                density_kg_m3: None,
            },
            window: values.number("window"),
            values,
        };
        if spec.plane == Some(forward.axis) {
            let problem = format!(
                "is {:?}, a plane across the body's axis forward ({forward}), which no flow past a body is symmetric about; expected the plane that halves the body lengthwise, or \"none\"",
                PLANES[1 + forward.axis]
            );
            return Err(spec.wrong("symmetry", problem));
        }
        Ok(spec)
    }

    /// What is declared of coefficients, in water of this density.
    pub(super) fn of_coefficients(&self, density_kg_m3: Option<f64>) -> Declared {
        Declared { density_kg_m3, ..self.coefficients }
    }

    /// The error of a key, at its place.
    pub(super) fn wrong(&self, key: &str, problem: impl Into<String>) -> RecordError {
        self.values.wrong(key, problem)
    }

    /// The error of a key that is needed.
    pub(super) fn missing(&self, key: &str, advice: &str) -> RecordError {
        self.values.missing(key, advice)
    }
}

/// Three lengths: `0 m, 0 m, -0.2 m`.
fn point_m(text: &str) -> Result<[f64; 3], String> {
    let advice = || format!("is {text:?}; write three lengths: \"0 m, 0 m, -0.2 m\"");
    let length = |text: &str| {
        let quantity = parse_quantity(text.trim()).map_err(|e| format!("{}: {e}", advice()))?;
        quantity.expect(Dimension::LENGTH).map_err(|e| format!("{}: {e}", advice()))
    };
    let parts: Vec<f64> = text.split(',').map(length).collect::<Result<_, String>>()?;
    parts.try_into().map_err(|_| advice())
}
