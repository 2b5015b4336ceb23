//! What laboratories of several languages call the quantities that Froude knows.
//!
//! Nothing is read by this table: it makes proposals, which a person confirms. Only the letters of SNAME (1950) are taken as they are, where
//! their units agree.

use crate::units::Dimension;

/// A quantity, and the names that people give it, without blanks, lines and capitals.
struct Known {
    name: &'static str,
    dimension: Option<Dimension>,
    /// -1 where the name says that it is written positive against the motion.
    sign: i8,
    words: &'static [&'static str],
}

const fn known(name: &'static str, dimension: Dimension, words: &'static [&'static str]) -> Known {
    Known { name, dimension: Some(dimension), sign: 1, words }
}

/// In the order in which they are looked up. English, German, French, Spanish, Norwegian, Japanese.
const KNOWN: [Known; 32] = [
    Known {
        name: "run",
        dimension: None,
        sign: 1,
        words: &[
            "run",
            "runno",
            "runno.",
            "runnr",
            "runid",
            "runnumber",
            "test",
            "testno",
            "testno.",
            "testid",
            "no",
            "no.",
            "nr",
            "nr.",
            "number",
            "#",
            "id",
            "lauf",
            "laufnr",
            "laufnr.",
            "versuch",
            "versuchsnr",
            "versuchsnr.",
            "versuchnr",
            "versuchnr.",
            "testnr",
            "testnr.",
            "messung",
            "messungnr",
            "messungnr.",
            "essaino",
            "essain°",
            "messpunkt",
            "essai",
            "numéro",
            "numero",
            "n°",
            "ensayo",
            "prueba",
            "forsøk",
            "kjøring",
            "kjøringnr",
            "試験番号",
            "番号",
            "計測番号",
        ],
    },
    Known {
        name: "configuration",
        dimension: None,
        sign: 1,
        words: &[
            "configuration",
            "config",
            "konfiguration",
            "configuración",
            "konfigurasjon",
            "modell",
            "model",
            "modèle",
            "modelo",
        ],
    },
    known(
        "speed",
        Dimension::SPEED,
        &[
            "u",
            "v",
            "vm",
            "speed",
            "velocity",
            "vel",
            "carriagespeed",
            "towingspeed",
            "towspeed",
            "flowspeed",
            "geschwindigkeit",
            "fahrgeschwindigkeit",
            "schleppgeschwindigkeit",
            "anströmgeschwindigkeit",
            "wagengeschwindigkeit",
            "vitesse",
            "vitesseduchariot",
            "vitessechariot",
            "velocidad",
            "velocidaddelcarro",
            "hastighet",
            "fart",
            "vognhastighet",
            "速度",
            "曳航速度",
            "台車速度",
            "流速",
            "船速",
        ],
    ),
    known("v_x", Dimension::SPEED, &["vx", "surgevelocity", "surgespeed"]),
    known("v_y", Dimension::SPEED, &["vy", "swayvelocity", "swayspeed"]),
    known("v_z", Dimension::SPEED, &["vz", "w", "heavevelocity", "heavespeed"]),
    Known {
        name: "f_x",
        dimension: Some(Dimension::FORCE),
        sign: -1,
        words: &[
            "drag",
            "resistance",
            "dragforce",
            "totalresistance",
            "d",
            "r",
            "rt",
            "rtm",
            "widerstand",
            "schleppwiderstand",
            "gesamtwiderstand",
            "résistance",
            "résistancetotale",
            "traînée",
            "trainee",
            "resistencia",
            "resistenciatotal",
            "arrastre",
            "motstand",
            "slepemotstand",
            "抵抗",
            "全抵抗",
            "抗力",
        ],
    },
    known(
        "f_x",
        Dimension::FORCE,
        &[
            "fx",
            "x",
            "surgeforce",
            "axialforce",
            "longitudinalforce",
            "längskraft",
            "axialkraft",
            "kraftx",
            "effortlongitudinal",
            "forcelongitudinale",
            "fuerzalongitudinal",
            "langskipskraft",
            "前後力",
        ],
    ),
    known(
        "f_y",
        Dimension::FORCE,
        &[
            "fy",
            "y",
            "sway",
            "swayforce",
            "sideforce",
            "lateralforce",
            "seitenkraft",
            "querkraft",
            "krafty",
            "forcelatérale",
            "effortlatéral",
            "fuerzalateral",
            "sidekraft",
            "tverrkraft",
            "tverrskipskraft",
            "横力",
        ],
    ),
    known(
        "f_z",
        Dimension::FORCE,
        &[
            "fz",
            "z",
            "heave",
            "heaveforce",
            "verticalforce",
            "vertikalkraft",
            "kraftz",
            "forceverticale",
            "effortvertical",
            "fuerzavertical",
            "上下力",
        ],
    ),
    known(
        "m_x",
        Dimension::MOMENT,
        &["mx", "k", "rollmoment", "momentderoulis", "momentodebalance", "rullemoment", "横揺モーメント"],
    ),
    known(
        "m_y",
        Dimension::MOMENT,
        &[
            "my",
            "m",
            "pitchmoment",
            "nickmoment",
            "stampfmoment",
            "trimmmoment",
            "momentdetangage",
            "momentodecabeceo",
            "stampemoment",
            "縦揺モーメント",
        ],
    ),
    known(
        "m_z",
        Dimension::MOMENT,
        &["mz", "n", "yawmoment", "giermoment", "momentdelacet", "momentodeguiñada", "giremoment", "回頭モーメント"],
    ),
    known("w_x", Dimension::ANGULAR_SPEED, &["wx", "p", "rollrate", "rollrate", "vitessederoulis"]),
    known("w_y", Dimension::ANGULAR_SPEED, &["wy", "q", "pitchrate", "nickrate", "vitessedetangage"]),
    known(
        "w_z",
        Dimension::ANGULAR_SPEED,
        &[
            "wz",
            "r",
            "yawrate",
            "gierrate",
            "drehrate",
            "vitessedelacet",
            "velocidaddeguiñada",
            "girhastighet",
            "回頭角速度",
        ],
    ),
    known(
        "angle",
        Dimension::ANGLE,
        &[
            "angle",
            "beta",
            "β",
            "drift",
            "driftangle",
            "winkel",
            "driftwinkel",
            "driftwinkelβ",
            "driftwinkelbeta",
            "schräganströmwinkel",
            "angledederive",
            "anglededérive",
            "angledérive",
            "dérive",
            "ángulodederiva",
            "deriva",
            "driftvinkel",
            "vinkel",
            "斜航角",
            "偏角",
            "角度",
        ],
    ),
    known(
        "temperature",
        Dimension::TEMPERATURE,
        &[
            "t",
            "tw",
            "temp",
            "temperature",
            "watertemperature",
            "watertemp",
            "wassertemperatur",
            "temperatur",
            "température",
            "températuredeleau",
            "temperatura",
            "temperaturadelagua",
            "vanntemperatur",
            "水温",
            "温度",
        ],
    ),
    known(
        "density",
        Dimension::DENSITY,
        &[
            "rho",
            "ρ",
            "density",
            "waterdensity",
            "dichte",
            "wasserdichte",
            "massevolumique",
            "densité",
            "densidad",
            "tetthet",
            "密度",
        ],
    ),
    known(
        "kinematic_viscosity",
        Dimension::KINEMATIC_VISCOSITY,
        &[
            "nu",
            "ν",
            "viscosity",
            "kinematicviscosity",
            "viskosität",
            "viscositécinématique",
            "viscosidad",
            "viskositet",
            "動粘度",
            "動粘性係数",
        ],
    ),
    known("volume", Dimension::VOLUME, &["volume", "volumen", "verdrängung", "volum", "排水容積"]),
    known("time", Dimension::TIME, &["t", "time", "timestamp", "zeit", "temps", "tiempo", "tid", "時間", "時刻"]),
    known(
        "position",
        Dimension::LENGTH,
        &[
            "position",
            "pos",
            "displacement",
            "weg",
            "déplacement",
            "posición",
            "desplazamiento",
            "posisjon",
            "位置",
            "変位",
        ],
    ),
    known(
        "command",
        Dimension::VOLTAGE,
        &[
            "command",
            "voltage",
            "volts",
            "u",
            "spannung",
            "tension",
            "voltaje",
            "tensión",
            "spenning",
            "電圧",
            "指令電圧",
        ],
    ),
    known(
        "current",
        Dimension::CURRENT,
        &["current", "i", "motorcurrent", "strom", "motorstrom", "courant", "corriente", "strøm", "電流"],
    ),
    known("thrust", Dimension::FORCE, &["thrust", "schub", "poussée", "empuje", "skyvekraft", "推力"]),
    known("torque", Dimension::MOMENT, &["torque", "q", "drehmoment", "couple", "par", "dreiemoment", "トルク"]),
    known(
        "rotation_rate",
        Dimension::ANGULAR_SPEED,
        &[
            "rpm",
            "n",
            "rps",
            "shaftspeed",
            "drehzahl",
            "régime",
            "velocidadderotación",
            "turtall",
            "omdreininger",
            "回転数",
        ],
    ),
    known(
        "roll",
        Dimension::ANGLE,
        &["roll", "phi", "φ", "rollangle", "rollwinkel", "krängung", "roulis", "gîte", "balance", "rulling", "横揺角"],
    ),
    known(
        "pitch",
        Dimension::ANGLE,
        &[
            "pitch",
            "theta",
            "θ",
            "pitchangle",
            "trim",
            "trimmwinkel",
            "assiette",
            "tangage",
            "cabeceo",
            "stamp",
            "縦揺角",
        ],
    ),
    known(
        "yaw",
        Dimension::ANGLE,
        &["yaw", "psi", "ψ", "heading", "kurs", "gierwinkel", "cap", "rumbo", "kurs", "方位角"],
    ),
    known(
        "acceleration",
        Dimension::ACCELERATION,
        &["acceleration", "acc", "a", "beschleunigung", "accélération", "aceleración", "akselerasjon", "加速度"],
    ),
];

/// What a name probably means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Meant {
    /// What Froude calls it.
    pub name: &'static str,
    /// -1 where it is written positive against the motion, as a resistance is.
    pub sign: i8,
}

/// A name without blanks, lines and capitals.
fn plain(name: &str) -> String {
    name.to_lowercase().chars().filter(|c| !matches!(c, ' ' | '_' | '-' | '\u{a0}' | '\u{3000}')).collect()
}

/// What a name means for a column of this dimension; `None` for the dimension of a column without a unit.
pub(crate) fn meant(name: &str, dimension: Option<Dimension>) -> Option<Meant> {
    let plain = plain(name);
    // `-X` is written against its axis, and a text has no unit. `T` is a period as often as a time, and `M` a torque of a propeller.
    let is_open = name.trim().starts_with(['-', '−', '–'])
        || matches!((name.trim(), dimension), ("T", Some(Dimension::TIME)) | ("M", Some(Dimension::MOMENT)));
    let fits = |known: &&Known| {
        let is_text = known.dimension.is_none() && dimension.is_none_or(|of| of == Dimension::ONE);
        !is_open && known.words.contains(&plain.as_str()) && (known.dimension == dimension || is_text)
    };
    let known = KNOWN.iter().find(fits)?;
    Some(Meant { name: known.name, sign: known.sign })
}

/// What a name means where its unit is missing or unknown, if that is one thing alone.
pub(crate) fn meant_without_unit(name: &str) -> Option<(Meant, Option<Dimension>)> {
    let plain = plain(name);
    let mut all = KNOWN.iter().filter(|known| known.words.contains(&plain.as_str()));
    match (all.next(), all.next()) {
        (Some(known), None) => Some((Meant { name: known.name, sign: known.sign }, known.dimension)),
        _ => None,
    }
}

/// The letters of SNAME (1950, Technical and Research Bulletin 1-5) and what Froude calls them, with their dimension.
const SNAME: [(&str, &str, Dimension); 12] = [
    ("u", "v_x", Dimension::SPEED),
    ("v", "v_y", Dimension::SPEED),
    ("w", "v_z", Dimension::SPEED),
    ("p", "w_x", Dimension::ANGULAR_SPEED),
    ("q", "w_y", Dimension::ANGULAR_SPEED),
    ("r", "w_z", Dimension::ANGULAR_SPEED),
    ("X", "f_x", Dimension::FORCE),
    ("Y", "f_y", Dimension::FORCE),
    ("Z", "f_z", Dimension::FORCE),
    ("K", "m_x", Dimension::MOMENT),
    ("M", "m_y", Dimension::MOMENT),
    ("N", "m_z", Dimension::MOMENT),
];

/// What the letters among some columns (name and dimension) are in SNAME, each with its place; empty where `u` is not among them, so that a lone `v` stays
/// what it is, a speed.
pub(crate) fn of_sname(columns: &[(&str, Option<Dimension>)]) -> Vec<(usize, &'static str)> {
    let is = |letter: &str, name: &str, dimension: Dimension| {
        columns.iter().any(|(own, of)| (*own == letter || *own == name) && *of == Some(dimension))
    };
    if !is("u", "v_x", Dimension::SPEED) {
        return Vec::new();
    }
    // `u` twice is a velocity and an uncertainty, and `v` beside it a speed.
    if columns.iter().enumerate().any(|(at, (own, _))| {
        SNAME.iter().any(|(letter, ..)| letter == own) && columns[..at].iter().any(|(other, _)| other == own)
    }) {
        return Vec::new();
    }
    let of = |(at, (own, dimension)): (usize, &(&str, Option<Dimension>))| {
        let (_, name, _) = SNAME.iter().find(|(letter, _, of)| letter == own && Some(*of) == *dimension)?;
        (!columns.iter().any(|(other, _)| other == name)).then_some((at, *name))
    };
    columns.iter().enumerate().filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_six_languages_are_known_by_their_dimension() {
        let of = |name: &str, dimension| meant(name, dimension).map(|found| (found.name, found.sign));
        for name in
            ["Geschwindigkeit", "Vitesse du chariot", "Velocidad", "Hastighet", "曳航速度", "Carriage speed", "U"]
        {
            assert_eq!(of(name, Some(Dimension::SPEED)), Some(("speed", 1)), "{name}");
        }
        for name in ["Widerstand", "Résistance", "Arrastre", "Motstand", "抵抗", "Drag", "R_T"] {
            assert_eq!(of(name, Some(Dimension::FORCE)), Some(("f_x", -1)), "{name}");
        }
        assert_eq!(of("Giermoment", Some(Dimension::MOMENT)), Some(("m_z", 1)));
        assert_eq!(of("t", Some(Dimension::TIME)), Some(("time", 1)));
        assert_eq!(of("t", Some(Dimension::TEMPERATURE)), Some(("temperature", 1)));
        assert_eq!(of("Lauf", None), Some(("run", 1)));
        assert_eq!((of("-X", Some(Dimension::FORCE)), of("Test", Some(Dimension::FORCE))), (None, None));
        assert_eq!((of("T", Some(Dimension::TIME)), of("current speed", Some(Dimension::SPEED))), (None, None));
        assert_eq!(of("Geschwindigkeit", Some(Dimension::FORCE)), None);
        assert_eq!(meant_without_unit("Widerstand").map(|(m, d)| (m.name, d)), Some(("f_x", Some(Dimension::FORCE))));
        assert_eq!(meant_without_unit("t"), None);
    }

    #[test]
    fn letters_of_sname_need_their_dimension_and_a_surge_velocity() {
        let (v, f, m) = (Some(Dimension::SPEED), Some(Dimension::FORCE), Some(Dimension::MOMENT));
        let rate = Some(Dimension::ANGULAR_SPEED);
        assert_eq!(
            of_sname(&[("u", v), ("v", v), ("r", rate), ("X", f), ("N", m)]),
            [(0, "v_x"), (1, "v_y"), (2, "w_z"), (3, "f_x"), (4, "m_z")]
        );
        // An uncertainty of a force beside velocities.
        assert_eq!(of_sname(&[("u", v), ("v", v), ("u", f)]), []);
        assert!(of_sname(&[("v", v), ("X", f)]).is_empty());
        assert_eq!(of_sname(&[("u", v), ("X", Some(Dimension::LENGTH)), ("f_x", f)]), [(0, "v_x")]);
        assert_eq!(of_sname(&[("v_x", v), ("X", f), ("p", Some(Dimension::PRESSURE))]), [(1, "f_x")]);
        assert!(of_sname(&[("u", Some(Dimension::VOLTAGE)), ("v", v)]).is_empty());
    }
}
