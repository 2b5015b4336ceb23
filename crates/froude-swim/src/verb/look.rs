//! `froude robot inspect`: what a robot file comes to before it swims, and what in it does not fit together.
//!
//! Nothing is integrated. Numbers of the water are those of the records, shared out among the modules.

use std::f64::consts::PI;
use std::path::Path;

use froude_hydro::similarity::GRAVITY_M_S2;
use froude_records::block::{Block, ResultTable, TableBuilder, facts};
use froude_records::number::{percent, significant};
use froude_records::outcome::Outcome;

use super::VerbError;
use super::told::NEUTRAL;
use crate::blueprint::Blueprint;
use crate::chain::Link;
use crate::dynamics::RIGHTS_ITSELF_M;
use crate::robot::Robot;
use crate::robot_file::{ModuleFile, RobotFile, read_robot};

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
struct Look {
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
pub fn look(path: &Path) -> Result<Outcome, VerbError> {
    let file = read_robot(path)?;
    let blueprint = Blueprint::of(&file)?;
    let robot: Robot = blueprint.estimated();
    let mut kinds: Vec<Kind> = Vec::new();
    for (i, (module, link)) in file.modules.iter().zip(&robot.chain.links).enumerate() {
        match kinds.last_mut().filter(|kind| kind.file == *module && kind.link == *link) {
            Some(kind) => kind.last = i + 1,
            None => kinds.push(Kind { first: i + 1, last: i + 1, file: module.clone(), link: *link }),
        }
    }
    let driven = blueprint.driven_by_water(&robot);
    let blocks = Look { file, robot, kinds, driven }.blocks();
    Ok(Outcome { blocks, ..Outcome::default() })
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
            let ([gx, _, gz], [bx, _, bz]) = (module.centre_of_mass_m, module.centre_of_buoyancy_m);
            mass = [mass[0] + m, mass[1] + m * (place + gx), mass[2] + m * gz];
            volume = [volume[0] + v, volume[1] + v * (place + bx), volume[2] + v * bz];
            place -= l;
        }
        let between = |k: usize| mass[k] / mass[0] - volume[k] / volume[0];
        Some(Trim { ahead_m: between(1), below_m: between(2) })
    }

    fn blocks(&self) -> Vec<Block> {
        vec![self.whole().into(), self.bodies().into(), self.drag().into(), Block::text("remarks", self.sentences())]
    }

    /// The straight robot.
    fn whole(&self) -> ResultTable {
        let (along, across) = (self.force_n([SPEED_M_S, 0.0]), self.force_n([0.0, SPEED_M_S]));
        let ([surge, sway], trim, mass) = (self.added_kg(), self.trim(), self.robot.mass_kg);
        let f = facts("", format!("{}, straight", self.file.name), self);
        f.build(vec![
            f.text("robot", "", |l| l.file.name.clone()),
            f.count("modules", "modules", |l| l.file.modules.len()),
            f.text("drag", "", |l| l.robot.estimates.0.clone()),
            f.text("added_mass", "", |l| l.robot.estimates.1.clone()),
            f.number("mass_kg", "mass [kg]", |_| mass),
            f.number("displaced_kg", "mass of the water displaced [kg]", Self::displaced_kg),
            f.number("mass_ahead_of_buoyancy_m", "centre of mass ahead of centre of buoyancy [mm]", |_| {
                trim.map(|t| t.ahead_m)
            })
            .places(1),
            f.number("mass_below_buoyancy_m", "centre of mass below centre of buoyancy [mm]", |_| {
                trim.map(|t| t.below_m)
            })
            .places(1),
            f.number("restoring_n_m_rad", "restoring moment of a roll [N m/rad]", |_| {
                trim.map(|t| mass * GRAVITY_M_S2 * t.below_m)
            }),
            f.number("added_mass_surge_kg", "added mass, surge [kg]", |_| surge),
            f.number("added_mass_sway_kg", "added mass, sway [kg]", |_| sway),
            f.number("force_along_at_0.3_m_s_n", "axial force at 0.3 m/s [N]", |_| along[0]),
            f.number("force_across_at_0.3_m_s_n", "transverse force at 0.3 m/s [N]", |_| across[1]),
        ])
    }

    /// A row per kind of module: its body, and the water that it takes along.
    fn bodies(&self) -> ResultTable {
        let t = TableBuilder::new("kinds", "modules and their added mass", &self.kinds);
        let below = |m: &ModuleFile| m.centre_of_mass_m[2] - m.centre_of_buoyancy_m[2];
        t.build(vec![
            t.text("", "module", Kind::numbers),
            t.count("first", "", |k| k.first),
            t.count("last", "", |k| k.last),
            t.text("name", "name", |k| k.file.name.clone()),
            t.number("mass_kg", "mass [kg]", |k| k.file.mass_kg),
            t.number("volume_m3", "volume [l]", |k| k.file.volume_m3),
            t.number("inertia_kg_m2", "inertia [kg m²]", |k| k.file.inertia_kg_m2[2]),
            t.number("mass_ahead_m", "mass ahead [mm]", |k| k.file.centre_of_mass_m[0]).places(1),
            t.number("mass_below_buoyancy_m", "mass below buoyancy [mm]", |k| below(&k.file)).places(1),
            t.numbers("center_of_mass_m", "", |k| k.file.centre_of_mass_m.to_vec()),
            t.numbers("center_of_buoyancy_m", "", |k| k.file.centre_of_buoyancy_m.to_vec()),
            t.number("added_mass/surge_kg", "added mass, surge [kg]", |k| k.link.added.x),
            t.number("added_mass/sway_kg", "added mass, sway [kg]", |k| k.link.added.y),
            t.number("added_mass/yaw_kg_m2", "added inertia, yaw [kg m²]", |k| k.link.added.turn),
            t.number("added_mass/sway_yaw_kg_m", "", |k| k.link.added.turn_y),
        ])
    }

    /// The same for its drag.
    fn drag(&self) -> ResultTable {
        let caption = format!(
            "drag of {}: −(c₁ + c₂|v|) v; the cross-flow term acts along the axis, against the axial motion",
            self.robot.estimates.0
        );
        let t = TableBuilder::new("kinds", caption, &self.kinds);
        let cross = |k: &Kind, i: usize| k.link.drag.cross.map(|c| c.of_speed[i]);
        t.build(vec![
            t.text("", "module", Kind::numbers),
            t.text("", "name", |k| k.file.name.clone()),
            t.number("drag/along_kg_s", "axial c₁ [kg/s]", |k| k.link.drag.along[0]),
            t.number("drag/along_kg_m", "axial c₂ [kg/m]", |k| k.link.drag.along[1]),
            t.number("drag/across_kg_s", "transverse c₁ [kg/s]", |k| k.link.drag.across[0]),
            t.number("drag/across_kg_m", "transverse c₂ [kg/m]", |k| k.link.drag.across[1]),
            t.number("drag/by_flow_across_kg_s", "axial from cross-flow c₁ [kg/s]", |k| cross(k, 0)),
            t.number("drag/by_flow_across_kg_m", "axial from cross-flow c₂ [kg/m]", |k| cross(k, 1)),
        ])
    }

    fn sentences(&self) -> Vec<String> {
        let mut out = self.file.remarks.clone();
        if let (true, Some(trim)) = (self.file.model.is_3d, self.trim())
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
            like("an inertia", m.inertia_kg_m2[2], m.mass_kg * (l * l / 3.0 + b * b / 4.0), "kg m²", &mut out);
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
}
