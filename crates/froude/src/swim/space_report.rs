//! The report of a swim in three dimensions: the answer with its remarks, and the way in figures.

use froude_records::page::{Chart, DocumentSection};
use froude_report::ReportError;
use froude_report::document::Document;
use froude_swim::spatial::swim::SpatialMoment;

use super::SpatialSwum;
use super::report::{joint_chart, line, panel};

impl SpatialSwum {
    /// The page as one self-contained HTML file.
    ///
    /// # Errors
    ///
    /// [`ReportError`] when the drawing library refuses a chart.
    pub fn page(&self, moments: &[SpatialMoment], date: Option<String>) -> Result<String, ReportError> {
        let summary = DocumentSection { title: "The answer".to_owned(), ..self.section() };
        let way = DocumentSection {
            title: "The way".to_owned(),
            charts: vec![path(moments), attitude(moments), motion(moments)],
            ..DocumentSection::default()
        };
        let joints = DocumentSection {
            title: "Joints".to_owned(),
            charts: vec![joints(moments), powers(moments)],
            ..DocumentSection::default()
        };
        Document {
            sort: "Swimming robot".to_owned(),
            title: self.name.clone(),
            subtitle: format!(
                "{} modules in three dimensions, drag of {}",
                self.robot.chain.links.len(),
                self.robot.plane.estimates.0
            ),
            date,
            sections: vec![summary, way, joints],
            ..Document::default()
        }
        .html()
    }
}

fn column(moments: &[SpatialMoment], of: impl Fn(&SpatialMoment) -> f64) -> Vec<f64> {
    moments.iter().map(of).collect()
}

fn time(moments: &[SpatialMoment]) -> Vec<f64> {
    column(moments, |m| m.time_s)
}

fn path(moments: &[SpatialMoment]) -> Chart {
    let x = column(moments, |m| m.centre_m[0]);
    Chart {
        name: "path".to_owned(),
        title: "Path in the tank".to_owned(),
        caption:
            "Path of the centre of mass over the ground, from above and as depth (z is down); each axis has its scale."
                .to_owned(),
        x_label: "x [m]".to_owned(),
        panels: vec![
            panel("y [m]", vec![line("centre of mass", &x, column(moments, |m| m.centre_m[1]))]),
            panel("z [m]", vec![line("centre of mass", &x, column(moments, |m| m.centre_m[2]))]),
        ],
        ..Chart::default()
    }
}

fn attitude(moments: &[SpatialMoment]) -> Chart {
    let time = time(moments);
    let angle = |k: usize| column(moments, |m| m.angles[k].to_degrees());
    Chart {
        name: "attitude".to_owned(),
        title: "How the head lies".to_owned(),
        caption: "Roll (starboard down), pitch (bow up) and heading of the head.".to_owned(),
        x_label: "time [s]".to_owned(),
        panels: vec![
            panel("angle [deg]", vec![line("roll", &time, angle(0)), line("pitch", &time, angle(1))]),
            panel("heading [deg]", vec![line("heading", &time, angle(2))]),
        ],
        ..Chart::default()
    }
}

fn motion(moments: &[SpatialMoment]) -> Chart {
    let time = time(moments);
    let lines = |from: usize, names: [&str; 3], scale: f64| {
        let one = |k: usize| line(names[k], &time, column(moments, |m| scale * m.state.head[from + k]));
        vec![one(0), one(1), one(2)]
    };
    Chart {
        name: "motion".to_owned(),
        title: "Motion of the head".to_owned(),
        caption: "Motion of the head through the water in its own axes: forward, to starboard, down.".to_owned(),
        x_label: "time [s]".to_owned(),
        panels: vec![
            panel("speed [m/s]", lines(3, ["surge", "sway", "heave"], 1.0)),
            panel("turn rate [deg/s]", lines(0, ["roll", "pitch", "yaw"], 1_f64.to_degrees())),
        ],
        ..Chart::default()
    }
}

fn joints(moments: &[SpatialMoment]) -> Chart {
    let n = moments.first().map_or(0, |m| m.torque_n_m.len());
    joint_chart(&time(moments), n, &|i| column(moments, |m| m.shape.angle[i].to_degrees()), &|i| {
        column(moments, |m| m.torque_n_m[i])
    })
}

fn powers(moments: &[SpatialMoment]) -> Chart {
    let time = time(moments);
    let series = ["net, of the motors", "positive", "drag"].iter().enumerate();
    Chart {
        name: "powers".to_owned(),
        title: "Powers".to_owned(),
        caption: "What the motors give, its positive part, and what drag takes; between net power and drag lie the kinetic energy of body and water and what weight and buoyancy do.".to_owned(),
        x_label: "time [s]".to_owned(),
        panels: vec![panel(
            "power [W]",
            series.map(|(k, name)| line(name, &time, column(moments, |m| m.power_w[k]))).collect(),
        )],
        ..Chart::default()
    }
}
