//! The data set that Capytaine 3.0 writes of a radiation problem, in NetCDF-3.
//!
//! Names, dimensions and attributes are those of `capytaine.io.xarray`; `added_mass` and `radiation_damping` run over omega,
//! influenced_dof (force), radiating_dof (motion). Text is characters with `_Encoding = "utf-8"`, as xarray keeps it in this
//! format. One body has the degrees of freedom `Surge` …, several `name__Surge` …. Damping is 0: both limits make no waves.
//! `body_name` is what older readers look for.

use super::classic::{Classic, Values, Variable};
use super::{AddedMassFile, DEGREES_OF_FREEDOM, FileError};

/// Dimensions by their number.
const OMEGA: u32 = 0;
const INFLUENCED: u32 = 1;
const RADIATING: u32 = 2;
const DOF_CHARACTERS: u32 = 3;
const NAME_CHARACTERS: u32 = 4;

impl AddedMassFile<'_> {
    /// The bytes of a NetCDF-3 classic file that `xarray.open_dataset` reads and Capytaine's own functions take.
    ///
    /// `omega` holds 0, infinity or both. `water_depth` is infinite and `wave_direction` 0: readers ask for them.
    ///
    /// # Errors
    ///
    /// See [`FileError`].
    pub fn netcdf(&self) -> Result<Vec<u8>, FileError> {
        self.check()?;
        let limits = self.limits();
        let at = |zero: f64, infinite: f64| {
            let values = limits.iter().map(|(limit, _)| if *limit == "zero" { zero } else { infinite });
            Values::Doubles(values.collect())
        };
        let dof_names = self.dof_names();
        let (dof_text, dof_width) = characters(&dof_names);
        let (name_text, name_width) = characters(&[self.bodies.join("+")]);
        let elements: Vec<f64> = limits.iter().flat_map(|(_, matrix)| matrix.iter().flatten()).copied().collect();
        let zeros = vec![0.0; elements.len()];

        let (nothing, infinity) = (0.0, f64::INFINITY);
        let variables = vec![
            of_omega("omega", "Angular frequency", "rad/s", at(nothing, infinity)),
            of_omega("freq", "Frequency", "Hz", at(nothing, infinity)),
            of_omega("period", "Period", "s", at(infinity, nothing)),
            of_omega("wavenumber", "Angular wavenumber", "rad/m", at(nothing, infinity)),
            of_omega("wavelength", "Wave length", "m", at(infinity, nothing)),
            names("influenced_dof", "Influenced DOF", vec![INFLUENCED, DOF_CHARACTERS], dof_text.clone()),
            names("radiating_dof", "Radiating DOF", vec![RADIATING, DOF_CHARACTERS], dof_text),
            names("body_name", "Body name", vec![NAME_CHARACTERS], name_text),
            scalar("g", "Gravity", "m/s^2", self.gravity_m_s2),
            scalar("rho", "Water density", "kg/m^3", self.density_kg_m3),
            scalar("water_depth", "Water depth", "m", infinity),
            scalar("forward_speed", "Forward speed", "m/s", nothing),
            scalar("wave_direction", "Wave direction", "rad", nothing),
            matrices("added_mass", "Added mass", "kg, kg m, kg m^2", elements),
            matrices("radiation_damping", "Radiation damping", "kg/s, kg m/s, kg m^2/s", zeros),
        ];
        let size = dof_names.len();
        let dimensions = [
            ("omega".to_owned(), limits.len()),
            ("influenced_dof".to_owned(), size),
            ("radiating_dof".to_owned(), size),
            (format!("string{dof_width}"), dof_width),
            // Two dimensions of one name are not allowed; these have different meanings even where their lengths agree.
            (format!("body_string{name_width}"), name_width),
        ];
        let comment =
            "omega = 0: rigid free surface; omega = inf: phi = 0 on it. Without waves there is nothing between.";
        let attributes =
            vec![("title", "Added mass".to_owned()), ("source", "Froude".to_owned()), ("comment", comment.to_owned())];
        Classic { dimensions: dimensions.to_vec(), attributes, variables }.bytes(self.bodies.len())
    }

    /// Names of the degrees of freedom in the order of the matrices.
    fn dof_names(&self) -> Vec<String> {
        let of_body = |body: &String| {
            DEGREES_OF_FREEDOM.map(|dof| if self.bodies.len() == 1 { dof.to_owned() } else { format!("{body}__{dof}") })
        };
        self.bodies.iter().flat_map(of_body).collect()
    }
}

/// Texts of equal length, filled up with zeros, and that length.
fn characters(texts: &[String]) -> (Vec<u8>, usize) {
    let width = texts.iter().map(String::len).max().unwrap_or(0);
    let filled = texts.iter().flat_map(|text| text.bytes().chain(std::iter::repeat_n(0, width - text.len())));
    (filled.collect(), width)
}

fn described(long_name: &str, units: &str) -> Vec<(&'static str, String)> {
    vec![("long_name", long_name.to_owned()), ("units", units.to_owned())]
}

fn of_omega(name: &'static str, long_name: &str, units: &str, values: Values) -> Variable {
    Variable { name, dimensions: vec![OMEGA], attributes: described(long_name, units), values }
}

fn names(name: &'static str, long_name: &str, dimensions: Vec<u32>, text: Vec<u8>) -> Variable {
    let attributes = vec![("long_name", long_name.to_owned()), ("_Encoding", "utf-8".to_owned())];
    Variable { name, dimensions, attributes, values: Values::Text(text) }
}

fn scalar(name: &'static str, long_name: &str, units: &str, value: f64) -> Variable {
    let values = Values::Doubles(vec![value]);
    Variable { name, dimensions: vec![], attributes: described(long_name, units), values }
}

fn matrices(name: &'static str, long_name: &str, units: &str, elements: Vec<f64>) -> Variable {
    let mut attributes = described(long_name, units);
    let coordinates =
        "body_name forward_speed freq g period rho water_depth wave_direction wavelength wavenumber".to_owned();
    attributes.push(("coordinates", coordinates));
    Variable { name, dimensions: vec![OMEGA, INFLUENCED, RADIATING], attributes, values: Values::Doubles(elements) }
}
