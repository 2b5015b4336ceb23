//! What is said of weight and buoyancy in three dimensions.

use std::f64::consts::FRAC_PI_2;

use froude_records::number::{percent, significant};

use super::answer::{Figures, Space};
use crate::dynamics::{Balance, Dynamics, RIGHTS_ITSELF_M};
use crate::robot_file::RobotFile;

/// Offsets smaller than this count as no trim, m.
const TRIMMED_M: f64 = 1e-4;

/// A body that nothing rights, before its figures.
pub(super) fn equilibrium(space: &Space) -> Option<String> {
    let ([roll, _], righting_m) = (space.tilt, space.balance.righting_m);
    if righting_m < -RIGHTS_ITSELF_M {
        let is_turned = 0.5 * (roll[0] + roll[1]).abs() > FRAC_PI_2;
        let so = if is_turned {
            "it has turned over, and swims bottom up"
        } else {
            "it swims as it lies, and wants to turn over"
        };
        return Some(format!(
            "unstable equilibrium, top-heavy: the centre of mass lies {} mm above the centre of buoyancy; {so}",
            significant(-1e3 * righting_m, 3)
        ));
    }
    (righting_m <= RIGHTS_ITSELF_M).then(|| "no stable equilibrium, nothing rights it: the centre of mass lies at the height of the centre of buoyancy, and any disturbance of roll and pitch stays; raise center_of_buoyancy or lower center_of_mass where the robot is weighted".to_owned())
}

pub(super) fn trim(balance: &Balance, out: &mut Vec<String>) {
    if balance.righting_m > RIGHTS_ITSELF_M {
        out.push(format!(
            "rights itself: its centre of mass lies {} mm below its centre of buoyancy",
            significant(1e3 * balance.righting_m, 3)
        ));
    }
    if balance.trim_m.abs() > TRIMMED_M {
        let way = if balance.trim_m > 0.0 { "ahead of" } else { "behind" };
        out.push(format!(
            "out of trim: straight and level, its centre of mass lies {} mm {way} its centre of buoyancy",
            significant(1e3 * balance.trim_m.abs(), 3)
        ));
    }
}

pub(super) fn water<C: Dynamics>(f: &Figures<'_, C>, space: &Space, file: &RobotFile, out: &mut Vec<String>) {
    let heavy = space.balance.heavy_kg;
    if heavy == 0.0 {
        let stated = f.robot.heavy_kg.unwrap_or(0.0);
        // The sum of the modules is rounded.
        if stated.abs() > 1e-12 * f.robot.mass_kg {
            out.push(format!(
                "neutral within the digits given: mass and displaced water differ by {} kg, and weight and buoyancy are taken as equal",
                significant(stated.abs(), 2)
            ));
        }
    } else {
        let (way, goes) = if heavy > 0.0 { ("heavier", "sinks") } else { ("lighter", "rises") };
        out.push(format!(
            "not neutral: the robot is {} kg {way} than the water that its modules displace ({} of its mass), and {goes} at {} m/s on its way",
            significant(heavy.abs(), 2),
            percent(heavy.abs() / f.robot.mass_kg),
            significant(space.sinking_m_s().abs(), 2)
        ));
    }
    if let (None, Some(first)) = (file.model.heave_drag, file.modules.first()) {
        out.push(format!(
            "the record has no vertical drag: it is taken as {} of the lateral drag, by the area seen from above; if it was measured, write heave_drag",
            significant(file.heave_drag(first), 3)
        ));
    }
    if file.model.roll_drag == [0.0; 2] {
        out.push("no roll_drag: the roll of a straight body is not damped".to_owned());
    }
}
