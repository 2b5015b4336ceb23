//! `[source.servo]`: any axis that a servo drives, and what of its logs is position and command.
//!
//! ```toml
//! [source.servo]
//! drive_gain = { value = "0.35 N m/A", standard = "2 %" }   # of the motor; times `gear` at the axis
//! gear       = 50
//! encoder    = "motor"                                       # or "axis": where the position is measured
//! friction   = "stribeck"
//! loads      = ["m_g_l*sin(angle)"]
//! ```

use std::path::PathBuf;

use froude_identify::declare::{Key, Kind, Range, Values, optional, usual};
use froude_identify::formula::{Constant, Formula};
use froude_identify::method::MethodError;
use froude_records::RecordError;
use froude_records::campaign::Campaign;
use froude_records::run::{Declared, declared_value};
use froude_records::section::Section;
use froude_records::table::{ColumnData, Table};
use froude_records::table_file::read_table;
use froude_records::units::{Dimension, Quantity};

use crate::servo::load::{Curve, Load};
use crate::servo::{Coordinate, Friction};

/// Name of the section, and of the method.
pub const SERVO: &str = "servo";

/// Laws of friction, by their words in a campaign.
pub(super) const FRICTIONS: [&str; 5] = ["coulomb", "viscous", "asymmetric", "stribeck", "load_dependent"];

/// Viscous friction alone.
pub(super) const VISCOUS: &str = "viscous";

/// What records call them.
const LAWS: [&str; 5] = ["symmetric", VISCOUS, "asymmetric", "stribeck", "load dependent"];

/// The keys of `[source.servo]`.
pub const KEYS: &[Key] = &[
    optional(
        "drive_gain",
        Kind::Any,
        "required unless the drive is logged as `force` or `torque`",
        "force or torque of the motor per unit of the command, `\"35 N/V\"` or `\"0.35 N m/A\"`; also `{ value, standard }`",
    ),
    optional(
        "gear",
        Kind::Coefficient,
        "1",
        "turns of the motor per turn of the axis; of an axis along a line `\"2000 rad/m\"`, the motor angle per unit of travel",
    ),
    optional(
        "encoder",
        Kind::Word(&["motor", "axis"]),
        "required with `gear`",
        "where the position is measured: at the `motor` or at the `axis`",
    ),
    optional("position", Kind::Text, "`position` or `angle`", "the column with the position"),
    optional(
        "speed",
        Kind::Text,
        "`speed`, `angular_speed` or `angle_dot`",
        "the column with the speed of a log without a position",
    ),
    optional(
        "command",
        Kind::Text,
        "`command`, `current`, `voltage`, `torque`, `force` or `thrust`",
        "the column with what the drive gets or gives",
    ),
    optional(
        "count",
        Kind::AnyQuantity,
        "required of a position in counts",
        "distance or angle of one count of the encoder: `\"0.1 mm\"`, `\"0.088 deg\"`",
    ),
    usual(
        "friction",
        Kind::Word(&FRICTIONS),
        "coulomb",
        "`coulomb` (with viscous), `viscous` alone, `asymmetric` (both, of each direction), `stribeck` (coulomb with F_s exp(−(v/v_s)²)), `load_dependent` (coulomb with F_l times the size of the load)",
    ),
    optional("stribeck_speed", Kind::AnyQuantity, "fitted", "v_s of `stribeck`"),
    optional(
        "loads",
        Kind::Texts,
        "none",
        "formulas over `angle` or `position` and `speed`, linear in their coefficients: `\"m_g_l*sin(angle)\"`, `\"k*position\"`, `\"D_II*speed*abs(speed)\"`; known numbers are those of `[constants]`",
    ),
    optional(
        "load_table",
        Kind::Text,
        "none",
        "a known load: a CSV with `angle [rad]` and `torque [N m]`, or `position [m]` and `force [N]`",
    ),
    optional(
        "delay",
        Kind::Constant(Dimension::TIME),
        "fitted",
        "from the stamp of a command to its force, half its hold included: half a step for a command that is held until the next sample, 0 for a measured current; also `{ value, standard }`",
    )
    .within(Range::NotNegative("a force does not precede its command")),
];

/// What a campaign declares of an axis.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    pub values: Values,
    /// Force or torque per unit of the command.
    pub gain: Option<(Declared, Dimension)>,
    pub gear: Option<(f64, Dimension)>,
    pub count: Option<Quantity>,
    stribeck_speed: Option<Quantity>,
    load_table: Option<PathBuf>,
}

impl Axis {
    /// Reads `[source.servo]`.
    ///
    /// # Errors
    ///
    /// [`RecordError`] with its place.
    pub fn read(s: &Section<'_>) -> Result<Self, RecordError> {
        let values = Values::read(s, KEYS)?;
        let quantity = |key: &'static str| s.get(key).map(|value| s.as_quantity(key, value)).transpose();
        let gain = s.get("drive_gain").map(|value| -> Result<_, RecordError> {
            // Its kind is that of its unit: of the value, where an uncertainty stands beside it.
            let dimension = if value.get_ref().is_table() {
                let table = s.as_section("drive_gain", value)?;
                let written =
                    table.need("value", "write drive_gain = { value = \"0.35 N m/A\", standard = \"2 %\" }")?;
                table.as_quantity("value", written)?.unit.dimension
            } else {
                s.as_quantity("drive_gain", value)?.unit.dimension
            };
            let gain = declared_value(s, "drive_gain", value, dimension)?;
            s.refuse("drive_gain", gain.value == 0.0, "is zero; a drive without force moves nothing")?;
            Ok((gain, dimension))
        });
        let gear = s.get("gear").map(|value| -> Result<_, RecordError> {
            let gear = if value.get_ref().is_str() {
                let quantity = s.as_quantity("gear", value)?;
                (quantity.value_si, quantity.unit.dimension)
            } else {
                (s.as_number("gear", value)?, Dimension::ONE)
            };
            s.refuse("gear", gear.0 == 0.0, "is zero; it is turns of the motor per turn of the axis")?;
            Ok(gear)
        });
        let out = Self {
            gain: gain.transpose()?,
            gear: gear.transpose()?,
            count: quantity("count")?,
            stribeck_speed: quantity("stribeck_speed")?,
            load_table: values.text("load_table").map(|path| s.source.relative(path)),
            values,
        };
        out.agrees()?;
        Ok(out)
    }

    /// Keys that need each other.
    fn agrees(&self) -> Result<(), RecordError> {
        let values = &self.values;
        let is_of = |law: &str| FRICTIONS.get(self.friction_index()) == Some(&law);
        if self.gear.is_some() && values.word("encoder", &[0, 1]).is_none() {
            return Err(values.missing("encoder", "write encoder = \"motor\" or encoder = \"axis\": where the position is measured, before or behind the gear"));
        }
        if values.is_stated("speed") && values.is_stated("position") {
            return Err(values.wrong("speed", "is for a log without a position; delete speed or position"));
        }
        if self.gear.is_none() && values.is_stated("encoder") {
            return Err(values.wrong("encoder", "is of a gear, which is not declared; write gear = 50, for example"));
        }
        if values.is_stated("stribeck_speed") && !is_of("stribeck") {
            return Err(values
                .wrong("stribeck_speed", "belongs to friction = \"stribeck\"; choose that law, or delete the key"));
        }
        if is_of("load_dependent") && values.texts("loads").is_empty() && self.load_table.is_none() {
            return Err(values.wrong(
                "friction",
                "is in proportion to a load, and none is declared; write loads = [\"m_g_l*sin(angle)\"], for example",
            ));
        }
        Ok(())
    }

    fn friction_index(&self) -> usize {
        self.values.word("friction", &[0, 1, 2, 3, 4]).unwrap_or(0)
    }

    /// How the law of friction is called.
    pub fn law(&self) -> &'static str {
        LAWS.get(self.friction_index()).copied().unwrap_or("symmetric")
    }

    /// The law of friction.
    ///
    /// # Errors
    ///
    /// Stribeck's speed in the unit of another axis.
    pub fn friction(&self, coordinate: Coordinate) -> Result<Friction, RecordError> {
        let of_speed = coordinate.speed_dimension();
        if let Some(speed) = &self.stribeck_speed
            && (speed.unit.dimension != of_speed || speed.value_si <= 0.0)
        {
            let unit = coordinate.names().speed[1];
            return Err(self.values.wrong(
                "stribeck_speed",
                format!("is {} {}; expected a positive speed in {unit}", speed.value_si, speed.unit.dimension),
            ));
        }
        let symmetric = Friction::symmetric();
        Ok(match FRICTIONS.get(self.friction_index()).copied() {
            Some("viscous") => Friction { is_viscous: true, ..symmetric },
            Some("asymmetric") => Friction::asymmetric(),
            Some("stribeck") => Friction {
                stribeck_speed_m_s: self.stribeck_speed.as_ref().map(|speed| speed.value_si),
                fitted_stribeck: self.stribeck_speed.is_none().then_some(0.0),
                ..symmetric
            },
            Some("load_dependent") => Friction { is_of_load: true, ..symmetric },
            _ => symmetric,
        })
    }

    /// The loads, over the range of positions; `None` where only a speed was recorded.
    ///
    /// # Errors
    ///
    /// A formula that cannot be read, reads a position that was not recorded or names a coefficient of the axis; a table that does not reach as far as the motion.
    pub fn load(
        &self,
        campaign: &Campaign,
        coordinate: Coordinate,
        range: Option<[f64; 2]>,
    ) -> Result<Load, MethodError> {
        let exponents = |d: Dimension| [d.m, d.kg, d.s, d.k, d.a];
        let wrong = |what: String| MethodError::from(self.values.wrong("loads", what));
        let (of_load, of_position) = match coordinate {
            Coordinate::Linear => (Dimension::FORCE, Dimension::LENGTH),
            Coordinate::Rotary => (Dimension::MOMENT, Dimension::ONE),
        };
        let is_position = |name: &str| name == "position" || name == "angle" && coordinate == Coordinate::Rotary;
        let names = coordinate.names();
        let of_speed = coordinate.speed_dimension();
        let channels = |name: &str| match name {
            _ if is_position(name) => Some(exponents(of_position)),
            _ if name == names.speed[0] => Some(exponents(of_speed)),
            _ => None,
        };
        let no_position = "the logs have a speed but no position, which this load needs";
        let known: Vec<Constant> = campaign
            .constants
            .iter()
            .map(|(name, q)| (name.clone(), q.value_si, exponents(q.unit.dimension)))
            .collect();
        let mut load = Load::default();
        for text in self.values.texts("loads") {
            let formula = Formula::parse(
                "drive",
                &with_word(text, "speed", names.speed[0]),
                &channels,
                exponents(of_load),
                &known,
            )
            .map_err(|error| wrong(format!("{text:?} cannot be read: {error}")))?;
            if formula.offset {
                return Err(wrong(format!(
                    "{text:?} has a term without position or speed: `offset` is fitted anyway; leave it out"
                )));
            }
            let is_of_motion = |formula: &Formula| formula.channels.iter().any(|name| name == names.speed[0]);
            if range.is_none() && formula.channels.iter().any(|name| is_position(name)) {
                return Err(wrong(format!("{text:?}: {no_position}")));
            }
            if self.law() == LAWS[4] && is_of_motion(&formula) {
                return Err(wrong(format!(
                    "{text:?} depends on the speed, and friction = \"load_dependent\" is that of a bearing under its load, not under drag; choose another friction law"
                )));
            }
            let own = load.terms.iter().flat_map(|(formula, _): &(Formula, _)| &formula.coefficients);
            let of_motion = [names.speed[0], names.acceleration[0]];
            let taken: Vec<&str> = own.map(|(name, _)| name.as_str()).chain(RESERVED).chain(of_motion).collect();
            if let Some((name, _)) = formula.coefficients.iter().find(|(name, _)| name.starts_with("F_")) {
                return Err(wrong(format!(
                    "{text:?} names the coefficient {name}; names that begin with F_ are reserved for friction: rename it"
                )));
            }
            if let Some((name, _)) = formula.coefficients.iter().find(|(name, _)| taken.contains(&name.as_str())) {
                return Err(wrong(format!(
                    "{text:?} names the coefficient {name}, which is there already; give it another name"
                )));
            }
            let unit = |[m, kg, s, k, a]: [i8; 5]| Dimension { m, kg, s, k, a }.to_string();
            let units = formula.coefficients.iter().map(|(_, dim)| unit(*dim)).collect();
            load.terms.push((formula, units));
        }
        if let Some(path) = &self.load_table {
            let Some(range) = range else { return Err(self.values.wrong("load_table", no_position).into()) };
            let table = read_table(path, None)?;
            load.known = Some(curve(&table, (of_position, of_load), range)?);
        }
        Ok(load)
    }
}

/// `text` with the name `other` in the place of the name `word`.
fn with_word(text: &str, word: &str, other: &str) -> String {
    let is_of_name = |c: char| c.is_alphanumeric() || c == '_';
    let mut out = String::new();
    for part in text.split_inclusive(|c| !is_of_name(c)) {
        let name = part.trim_end_matches(|c| !is_of_name(c));
        out.push_str(if name == word { other } else { name });
        out.push_str(&part[name.len()..]);
    }
    out
}

/// Names that the law of an axis has itself.
const RESERVED: [&str; 6] = ["J", "M", "v_s", "offset", "delay", "filter"];

/// A load over position out of a table.
fn curve(table: &Table, (of_position, of_load): (Dimension, Dimension), range: [f64; 2]) -> Result<Curve, MethodError> {
    let column = |dimension: Dimension, example: &str| {
        let of = |data: &ColumnData| matches!(data, ColumnData::Number { dimension: own, .. } if *own == dimension);
        let mut found = table.columns.iter().filter(|column| of(&column.data));
        match (found.next(), found.next()) {
            (Some(one), None) => Ok(one.name.as_str()),
            (found, _) => {
                let has = if found.is_some() { "several columns of this kind" } else { "no such column" };
                Err(MethodError::input(
                    &table.path,
                    format!(
                        "a table of a known load has two columns, position and load; this table has {has}: write {example}"
                    ),
                ))
            }
        }
    };
    let is_rotary = of_position == Dimension::ONE;
    let [at, load] = if is_rotary { ["`angle [rad]`", "`torque [N m]`"] } else { ["`position [m]`", "`force [N]`"] };
    let position = table.number(column(of_position, at)?, of_position)?.to_vec();
    let values = table.number(column(of_load, load)?, of_load)?.to_vec();
    if let Some(row) = position.windows(2).position(|w| w[1] <= w[0]) {
        let what = format!(
            "the position does not rise: sort the rows, and keep one of equal ones ({})",
            table.place_of_row(row + 1)
        );
        return Err(MethodError::input(&table.path, what));
    }
    let ends = [position.first(), position.last()].map(|end| end.copied().unwrap_or(f64::NAN));
    if !(ends[0] <= range[0] && range[1] <= ends[1]) {
        let what = format!(
            "the known load is stated from {} to {}, and the axis moves from {} to {} (SI): no load is continued beyond its table",
            ends[0], ends[1], range[0], range[1]
        );
        return Err(MethodError::input(&table.path, what));
    }
    Ok(Curve { position, load: values })
}
