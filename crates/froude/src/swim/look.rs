//! `froude robot inspect`: what a robot file comes to before it swims, and what in it does not fit together.
//!
//! Nothing is integrated. Numbers of the water are those of the records, shared out among the modules.

use std::f64::consts::PI;
use std::path::Path;

use froude_hydro::similarity::GRAVITY_M_S2;
use froude_records::number::{fixed, percent, significant};
use froude_records::page::{DocumentSection, TextTable};
use froude_records::robot::{ModuleFile, RobotFile, read_robot};
use froude_swim::blueprint::Blueprint;
use froude_swim::chain::Link;
use froude_swim::drag::LinkDrag;
use froude_swim::robot::Robot;
use serde_json::{Value, json};

use super::space::RIGHTS_ITSELF_M;
use super::told::NEUTRAL;
use crate::Error;

/// Speed at which the force of the whole robot is stated, m/s.
const SPEED_M_S: f64 = 0.3;
/// A number may be so many times what its shape makes of it, or as small a part, before it is said.
const LIKE_ITS_SHAPE: f64 = 3.0;
/// A body fills at most this part of the cylinder around it, and at least …
const FULLEST: f64 = 1.02;
/// … this.
const EMPTIEST: f64 = 0.3;
/// Sections that differ by less than this part are the same.
const SAME: f64 = 0.01;

/// Modules that follow one another and are alike.
#[derive(Debug, Clone, PartialEq)]
struct Kind {
    /// The first, from 1 at the head.
    first: usize,
    last: usize,
    file: ModuleFile,
    link: Link,
}

impl Kind {
    /// Of the elliptic cylinder around it, m³.
    fn cylinder_m3(&self) -> f64 {
        let link = &self.file.link;
        2.0 * PI * link.major_semi_axis_m * link.minor_semi_axis_m * link.half_length_m
    }

    /// What strips of elliptic sections take along across it, kg.
    fn strips_kg(&self, density_kg_m3: f64) -> f64 {
        let link = &self.file.link;
        2.0 * PI * density_kg_m3 * link.major_semi_axis_m.powi(2) * link.half_length_m
    }

    fn numbers(&self) -> String {
        if self.first == self.last { self.first.to_string() } else { format!("{} to {}", self.first, self.last) }
    }
}

/// What a robot file comes to.
#[derive(Debug, Clone, PartialEq)]
pub struct Look {
    file: RobotFile,
    robot: Robot,
    kinds: Vec<Kind>,
    /// The module that still water drives.
    driven: Option<usize>,
}

/// Looks at a robot file and the records that it names.
///
/// # Errors
///
/// A robot file or record that cannot be used.
pub fn look(path: &Path) -> Result<Look, Error> {
    let file = read_robot(path)?;
    let blueprint = Blueprint::of(&file)?;
    let robot = blueprint.estimated();
    let mut kinds: Vec<Kind> = Vec::new();
    for (i, (module, link)) in file.modules.iter().zip(&robot.chain.links).enumerate() {
        match kinds.last_mut().filter(|kind| kind.file == *module && kind.link == *link) {
            Some(kind) => kind.last = i + 1,
            None => kinds.push(Kind { first: i + 1, last: i + 1, file: module.clone(), link: *link }),
        }
    }
    let driven = blueprint.driven_by_water(&robot);
    Ok(Look { file, robot, kinds, driven })
}

/// Places along a straight robot, of mass and of buoyancy, and the depth of mass below buoyancy, m.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Trim {
    ahead_m: f64,
    below_m: f64,
}

impl Look {
    /// Force of still water on the straight robot that moves along or across itself, N.
    fn force_n(&self, velocity: [f64; 2]) -> [f64; 2] {
        let each = self.robot.chain.links.iter();
        each.map(|link| link.drag.load(link.half_length_m, [0.0, velocity[0], velocity[1]]))
            .fold([0.0; 2], |sum, [_, x, y]| [sum[0] + x, sum[1] + y])
    }

    fn displaced_kg(&self) -> Option<f64> {
        self.file.modules.iter().map(|m| Some(m.volume_m3? * self.file.density_kg_m3)).sum()
    }

    fn added_kg(&self) -> [f64; 2] {
        self.robot.chain.links.iter().fold([0.0; 2], |sum, link| [sum[0] + link.added.x, sum[1] + link.added.y])
    }

    /// Mass ahead of and below buoyancy of the straight robot; `None` where a module does not state its volume.
    fn trim(&self) -> Option<Trim> {
        let (mut mass, mut volume, mut place) = ([0.0; 3], [0.0; 3], 0.0);
        for module in &self.file.modules {
            let l = module.link.half_length_m;
            place -= l;
            let (m, v) = (module.mass_kg, module.volume_m3?);
            let ([gx, _, gz], [bx, _, bz]) = (module.spatial.centre_of_mass_m, module.spatial.centre_of_buoyancy_m);
            mass = [mass[0] + m, mass[1] + m * (place + gx), mass[2] + m * gz];
            volume = [volume[0] + v, volume[1] + v * (place + bx), volume[2] + v * bz];
            place -= l;
        }
        let between = |k: usize| mass[k] / mass[0] - volume[k] / volume[0];
        Some(Trim { ahead_m: between(1), below_m: between(2) })
    }

    /// What a person reads.
    #[must_use]
    pub fn section(&self) -> DocumentSection {
        let number = |x: f64| significant(x, 4);
        let modules = self.kinds.iter().map(|kind| {
            let (m, link) = (&kind.file, &kind.link);
            let litres = m.volume_m3.map_or_else(String::new, |v| number(1e3 * v));
            let mm = |x: f64| fixed(1e3 * x, 1);
            let [_, _, below] =
                std::array::from_fn::<f64, 3, _>(|k| m.spatial.centre_of_mass_m[k] - m.spatial.centre_of_buoyancy_m[k]);
            let body = [number(m.mass_kg), litres, number(m.inertia_kg_m2), mm(m.ahead_m), mm(below)];
            [
                vec![kind.numbers(), m.name.clone()],
                body.to_vec(),
                vec![number(link.added.x), number(link.added.y), number(link.added.turn)],
            ]
            .concat()
        });
        let drag = self.kinds.iter().map(|kind| {
            let d: &LinkDrag = &kind.link.drag;
            let cross = d.cross.map_or([0.0; 2], |c| c.of_speed);
            let all = [d.along, d.across, cross].concat();
            [vec![kind.numbers(), kind.file.name.clone()], all.into_iter().map(number).collect()].concat()
        });
        let head = |names: &[&str]| names.iter().map(|n| (*n).to_owned()).collect::<Vec<_>>();
        let (along, across) = (self.force_n([SPEED_M_S, 0.0]), self.force_n([0.0, SPEED_M_S]));
        let row = |name: &str, value: String, unit: &str| vec![name.to_owned(), value, unit.to_owned()];
        let mut whole = vec![
            row("modules", self.file.modules.len().to_string(), ""),
            row("mass", number(self.robot.mass_kg), "kg"),
        ];
        if let Some(displaced) = self.displaced_kg() {
            whole.push(row("mass of the water displaced", number(displaced), "kg"));
        }
        if let Some(trim) = self.trim() {
            whole.push(row("centre of mass ahead of that of buoyancy", fixed(1e3 * trim.ahead_m, 1), "mm"));
            whole.push(row("and below it", fixed(1e3 * trim.below_m, 1), "mm"));
            let restoring = self.robot.mass_kg * GRAVITY_M_S2 * trim.below_m;
            whole.push(row("restoring moment of a roll", number(restoring), "N m/rad"));
        }
        let [surge, sway] = self.added_kg();
        whole.extend([
            row("added mass along, straight", number(surge), "kg"),
            row("added mass across, straight", number(sway), "kg"),
            row("force along at 0.3 m/s", number(along[0]), "N"),
            row("force across at 0.3 m/s", number(across[1]), "N"),
        ]);
        DocumentSection {
            title: self.file.name.clone(),
            paragraphs: self.sentences(),
            tables: vec![
                TextTable {
                    caption: format!("{}, straight", self.file.name),
                    head: head(&["quantity", "value", "unit"]),
                    rows: whole,
                },
                TextTable {
                    caption: "bodies and the water that they take along".to_owned(),
                    head: head(&[
                        "module",
                        "name",
                        "mass, kg",
                        "volume, l",
                        "inertia, kg m²",
                        "mass ahead, mm",
                        "mass below buoyancy, mm",
                        "added surge, kg",
                        "sway, kg",
                        "yaw, kg m²",
                    ]),
                    rows: modules.collect(),
                },
                TextTable {
                    caption: format!(
                        "drag of {}: −(c₁ + c₂|v|) v; by flow across, against the motion along",
                        self.robot.estimates.0
                    ),
                    head: head(&[
                        "module",
                        "name",
                        "along c₁, kg/s",
                        "c₂, kg/m",
                        "across c₁, kg/s",
                        "c₂, kg/m",
                        "by flow across, kg/s",
                        "kg/m",
                    ]),
                    rows: drag.collect(),
                },
            ],
            charts: Vec::new(),
        }
    }

    fn sentences(&self) -> Vec<String> {
        let mut out = self.file.remarks.clone();
        if let (true, Some(trim)) = (self.file.spatial.is_3d, self.trim())
            && trim.below_m <= RIGHTS_ITSELF_M
        {
            out.push(format!(
                "no stable equilibrium: the centre of mass lies {} the centre of buoyancy, and nothing rights the robot; raise center_of_buoyancy or lower center_of_mass",
                if trim.below_m < -RIGHTS_ITSELF_M { "above" } else { "at the height of" }
            ));
        }
        let water = self.file.density_kg_m3;
        match self.robot.heavy_kg {
            None => {
                out.push("not every module states its volume: whether the robot is neutral is not known".to_owned());
            }
            Some(heavy) if heavy.abs() > NEUTRAL * self.robot.mass_kg => out.push(format!(
                "not neutral: {} kg {} than the water displaced, {} of its mass",
                significant(heavy.abs(), 2),
                if heavy > 0.0 { "heavier" } else { "lighter" },
                percent(heavy.abs() / self.robot.mass_kg)
            )),
            Some(_) => out.push("neutral".to_owned()),
        }
        for kind in &self.kinds {
            let (m, who) = (&kind.file, format!("module {} ({})", kind.numbers(), kind.file.name));
            let cylinder = kind.cylinder_m3();
            if let Some(volume) = m.volume_m3 {
                let part = volume / cylinder;
                if !(EMPTIEST..=FULLEST).contains(&part) {
                    out.push(format!(
                        "{who}: its volume of {} l is {} times that of the cylinder that its semi-axes and length make",
                        significant(1e3 * volume, 4),
                        significant(part, 3)
                    ));
                }
            }
            let (l, b) = (m.link.half_length_m, m.link.minor_semi_axis_m);
            let like = |what: &str, own: f64, shape: f64, unit: &str, out: &mut Vec<String>| {
                let times = own / shape;
                if !(1.0 / LIKE_ITS_SHAPE..=LIKE_ITS_SHAPE).contains(&times) {
                    out.push(format!(
                        "{who}: {what} of {} {unit} is {} times what its shape makes of it ({} {unit}); check it for a slip of a unit",
                        significant(own, 4),
                        significant(times, 3),
                        significant(shape, 4)
                    ));
                }
            };
            like("a mass", m.mass_kg, water * cylinder, "kg", &mut out);
            like("an inertia", m.inertia_kg_m2, m.mass_kg * (l * l / 3.0 + b * b / 4.0), "kg m²", &mut out);
            let strips = kind.strips_kg(water);
            like("an added mass in sway", kind.link.added.y, strips, "kg", &mut out);
            like("an added inertia in yaw", kind.link.added.turn, strips * l * l / 3.0, "kg m²", &mut out);
            let of = &self.robot.refers_to;
            let pairs = [
                ("half height", m.link.major_semi_axis_m, of.major_semi_axis_m),
                ("half width", b, of.minor_semi_axis_m),
                ("half length", l, of.half_length_m),
            ];
            for (what, own, other) in pairs.into_iter().filter(|(_, own, other)| (own / other - 1.0).abs() > SAME) {
                out.push(format!(
                    "{who}: its {what} is {} mm, and that of the link which the drag refers to {} mm",
                    significant(1e3 * own, 4),
                    significant(1e3 * other, 4)
                ));
            }
        }
        if let Some(module) = self.driven {
            out.push(format!("not dissipative: still water gives power to module {module} at speeds of the fit; choose another law or, where it is by-origin, distribution = \"uniform\""));
        }
        out
    }

    /// The same for a program, each number in SI.
    #[must_use]
    pub fn as_json(&self) -> Value {
        let kind = |kind: &Kind| {
            let (m, link) = (&kind.file, &kind.link);
            json!({
                "first": kind.first,
                "last": kind.last,
                "name": m.name,
                "mass_kg": m.mass_kg,
                "volume_m3": m.volume_m3,
                "inertia_kg_m2": m.inertia_kg_m2,
                "center_of_mass_m": m.spatial.centre_of_mass_m,
                "center_of_buoyancy_m": m.spatial.centre_of_buoyancy_m,
                "added_mass": {"surge_kg": link.added.x, "sway_kg": link.added.y, "yaw_kg_m2": link.added.turn, "sway_yaw_kg_m": link.added.turn_y},
                "drag": {
                    "along_kg_s": link.drag.along[0],
                    "along_kg_m": link.drag.along[1],
                    "across_kg_s": link.drag.across[0],
                    "across_kg_m": link.drag.across[1],
                    "by_flow_across_kg_s": link.drag.cross.map(|c| c.of_speed[0]),
                    "by_flow_across_kg_m": link.drag.cross.map(|c| c.of_speed[1]),
                },
            })
        };
        json!({
            "robot": self.file.name,
            "modules": self.file.modules.len(),
            "drag": self.robot.estimates.0,
            "added_mass": self.robot.estimates.1,
            "mass_kg": self.robot.mass_kg,
            "displaced_kg": self.displaced_kg(),
            "mass_ahead_of_buoyancy_m": self.trim().map(|t| t.ahead_m),
            "mass_below_buoyancy_m": self.trim().map(|t| t.below_m),
            "added_mass_surge_kg": self.added_kg()[0],
            "added_mass_sway_kg": self.added_kg()[1],
            "force_along_at_0.3_m_s_n": self.force_n([SPEED_M_S, 0.0])[0],
            "force_across_at_0.3_m_s_n": self.force_n([0.0, SPEED_M_S])[1],
            "kinds": self.kinds.iter().map(kind).collect::<Vec<_>>(),
            "remarks": self.sentences(),
        })
    }
}
