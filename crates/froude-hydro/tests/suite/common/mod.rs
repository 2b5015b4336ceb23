//! The published sets and the body that the tests use.

use froude_hydro::{Body, DragModel, Link, Setting};

/// USR Tables 5, 8, 9 and the two unrestricted rows of 10 and 11, as typed in
/// `usr-fluid-parameters/drag_coefficients_tables5_8_9.csv` (see its README for the
/// slips of print). Empty cells are coefficients that the model does not have.
pub const PUBLISHED: &str = "\
source,paper_table,model,C_f,C_d,C_f_I,C_d_I,C_f_II,C_d_II,C_fHT_I,C_dHT_I,C_fHT_II,C_dHT_II,C_XY_I,C_XY_II
cfd,5,f1,0.0046,0.1206,,,,,,,,,,
cfd,5,f2,,,0,0.0374,0.0112,0.4063,,,,,,
cfd,5,f3,,,0,0.0191,0.0066,0.4064,0,0.1956,0.1106,0,,
cfd,5,f4,,,0,0.0191,0.0066,0.4064,0.0063,0.1956,0.1050,0,0.0055,0.1957
cfd,5,f5,,,0.0003,0.0374,0.0062,0.3484,,,0.1134,0.6186,,0.1779
cfd,5,f6,0.2361,0.4807,,,,,,,,,,
towing_rig,8,f1,0.0242,0.2813,,,,,,,,,,
towing_rig,8,f2,,,0.0042,0.0193,0.0693,2.2438,,,,,,
towing_rig,8,f3,,,0.0109,0,0.0149,1.5249,0,0.0795,0.2363,1.8852,,
towing_rig,8,f4,,,0.0152,0,0.0045,1.5249,0,0.0795,0.2498,1.8852,0.0870,0.8704
towing_rig,8,f5,,,0.0177,0.0184,0,1.3918,,,0.2556,2.4598,,0.3472
towing_rig,8,f6,0.4319,1.7712,,,,,,,,,,
circulation_tank_restricted,9,f1,0.0207,0.3268,,,,,,,,,,
circulation_tank_restricted,9,f2,,,0,0.0603,0.0544,1.8601,,,,,,
circulation_tank_restricted,9,f3,,,0,0,0.0133,1.4272,0,0.1769,0.2602,1.1770,,
circulation_tank_restricted,9,f4,,,0,0,0.0133,1.4272,0.0148,0.1769,0.2451,1.1770,0.0351,0.4612
circulation_tank_restricted,9,f5,,,0.0032,0.0602,0.0088,1.1142,,,0.2675,2.0963,,0.2963
circulation_tank_restricted,9,f6,0.3363,1.6066,,,,,,,,,,
circulation_tank_unrestricted,10,f4,,,0,0.0569,0.0126,1.2402,0.0141,0.1929,0.2531,1.4444,0.0412,0.6654
circulation_tank_unrestricted,11,f1,0.0167,0.3835,,,,,,,,,,
";

/// A published set: where from, which model, coefficients in the model's order.
pub struct Set {
    pub source: &'static str,
    pub table: &'static str,
    pub model: DragModel,
    pub c: Vec<f64>,
}

/// Reads [`PUBLISHED`]; every coefficient of a model must be there, and no other.
pub fn published() -> Vec<Set> {
    let mut lines = PUBLISHED.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let sets: Vec<Set> = lines
        .map(|line| {
            let cells: Vec<&'static str> = line.split(',').collect();
            let model = DragModel::from_name(cells[2]).unwrap();
            let c: Vec<f64> = model
                .coefficients()
                .iter()
                .map(|info| {
                    let column = header.iter().position(|name| *name == info.name).unwrap();
                    cells[column].parse().unwrap()
                })
                .collect();
            let n_filled = cells[3..].iter().filter(|cell| !cell.is_empty()).count();
            assert_eq!(n_filled, c.len(), "{line}");
            Set { source: cells[0], table: cells[1], model, c }
        })
        .collect();
    assert_eq!(sets.len(), 20);
    sets
}

/// The stand-in for Mamba of `usr-fluid-parameters/README.md`, head and tail as in
/// DESIGN.md's campaign.
pub fn mamba() -> Body {
    Body {
        link: Link { major_semi_axis_m: 0.0588, minor_semi_axis_m: 0.0394, half_length_m: 0.09 },
        head_side_area_m2: 0.011,
        tail_side_area_m2: 0.008,
    }
}

/// [`mamba`] with `k` links in water of 1025 kg/m³ (USR Table 6).
pub fn setting(n_links: f64) -> Setting {
    Setting::as_published(mamba(), n_links, 1025.0)
}

/// Position of a coefficient, by its name.
pub fn index_of(model: DragModel, name: &str) -> Option<usize> {
    model.coefficients().iter().position(|c| c.name == name)
}
