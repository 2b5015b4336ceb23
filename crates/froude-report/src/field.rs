//! A quantity over a plane, on the polygons that it is known on: a slice through a flow, the pressure on one side of a body.
//!
//! **Colours.** Viridis (van der Walt and Smith 2015), whose steps look alike everywhere, without red and green and in grey too.
//! **Size.** A file stays small: polygons that no screen shows are left out, and of more than [`MOST`] the smallest; the caption says how many.

use froude_records::number::count;
use froude_records::page::{Field, Polygon, Scale, View};

use crate::canvas::{Align, Canvas, Ink, WHITE, Xy};
use crate::filled::{BAR, GAP, RIGHT, SHADES, axes, bar, shade};
use crate::plot::{AXIS, LABEL_SIZE, Panel, Span, TEXT, WIDTH};
use crate::symbol::Rich;

/// Most polygons that are drawn.
pub const MOST: usize = 12_000;
const LEFT: f64 = 74.0;
/// Above a view, for its title.
const HEAD: f64 = 26.0;
/// Below a view, for its axis.
const FOOT: f64 = 54.0;
/// Most height of all views together; they share a scale.
const HEIGHT: f64 = 560.0;
/// Least height of the bar.
const BAR_HEIGHT: f64 = 150.0;
/// Length of the arrow of the flow.
const ARROW: f64 = 44.0;
/// Areas below this many square pixels are not seen.
const UNSEEN: f64 = 0.005;

/// Viridis at every eighth, as `viridis(9)` of viridisLite prints it.
const VIRIDIS: [u32; 9] = [0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21908c, 0x27ad81, 0x5dc863, 0xaadc32, 0xfde725];

/// A polygon in the picture.
struct Placed {
    places: Vec<Xy>,
    area: f64,
    value: f64,
}

/// The picture as SVG.
///
#[must_use]
pub fn svg(field: &Field) -> String {
    drawn(field).0.svg(&crate::figures::drawing::slug(&field.name), &field.title, &caption(field))
}

pub(crate) fn canvas(field: &Field) -> Canvas {
    drawn(field).0
}

/// The caption, with how many polygons are not drawn.
#[must_use]
pub fn caption(field: &Field) -> String {
    match drawn(field).1 {
        0 => field.caption.clone(),
        n => format!("{} The {} smallest polygons are not drawn.", field.caption, count(n)),
    }
}

/// The picture, and how many polygons that could be seen are not in it.
fn drawn(field: &Field) -> (Canvas, usize) {
    let frames = frames(field);
    let views = field.views.iter().zip(&frames);
    let mut placed: Vec<Placed> =
        views.flat_map(|(view, frame)| view.polygons.iter().filter_map(move |p| place(p, frame))).collect();
    let mut largest: Vec<usize> = (0..placed.len()).collect();
    largest.sort_by(|a, b| placed[*b].area.total_cmp(&placed[*a].area));
    let mut kept = vec![false; placed.len()];
    for index in largest.iter().take(MOST) {
        kept[*index] = true;
    }
    let mut kept = kept.into_iter();
    placed.retain(|_| kept.next().unwrap_or(false));
    let left_out = largest.len() - placed.len();
    let range = Span::of(placed.iter().map(|p| p.value)).unwrap_or(Span { low: 0.0, high: 1.0 });
    let range = if range.width() > 0.0 { range } else { range.aired(0.0) };
    let height = frames.last().map_or(0.0, Panel::bottom).max(HEAD + BAR_HEIGHT);
    let mut canvas = Canvas::new(WIDTH, height + FOOT);
    for Placed { places, value, .. } in &placed {
        let part = ((value - range.low) / range.width() * SHADES as f64) as usize;
        canvas.mosaic(places, viridis(shade(part.min(SHADES - 1))));
    }
    for (view, frame) in field.views.iter().zip(&frames) {
        around(view, &mut canvas, frame);
    }
    let right = frames.iter().map(Panel::right).fold(LEFT, f64::max);
    let place = Panel {
        left: right + GAP,
        top: HEAD,
        width: BAR,
        height: height - HEAD,
        x: Span { low: 0.0, high: 1.0 },
        y: range,
    };
    bar(&mut canvas, &place, Scale::Linear, &field.value_label, place.right() + RIGHT - 14.0, viridis);
    (canvas, left_out)
}

/// Places of the views: below each other, of one scale.
fn frames(field: &Field) -> Vec<Panel> {
    let long = |[a, b]: [f64; 2]| (b - a).abs();
    let widest = field.views.iter().map(|view| long(view.x)).fold(0.0, f64::max);
    let tall: f64 = field.views.iter().map(|view| long(view.y)).sum();
    let room = WIDTH - LEFT - GAP - BAR - RIGHT;
    let scale = (room / widest).min(HEIGHT / tall);
    if !(scale.is_finite() && scale > 0.0) {
        return Vec::new();
    }
    let mut top = 0.0;
    let frame = |view: &View| {
        let (x, y) = (Span { low: view.x[0], high: view.x[1] }, Span { low: view.y[0], high: view.y[1] });
        let (width, height) = (scale * long(view.x), scale * long(view.y));
        let frame = Panel { left: LEFT, top: top + HEAD, width, height, x, y };
        top = frame.bottom() + FOOT;
        frame
    };
    field.views.iter().map(frame).collect()
}

/// What stands over and around the polygons.
fn around(view: &View, canvas: &mut Canvas, frame: &Panel) {
    for [from, to] in &view.lines {
        let at = |[x, y]: [f64; 2]| Some((frame.at_x(x), frame.at_y(y))).filter(|at| is_within(*at, frame));
        if let Some((from, to)) = at(*from).zip(at(*to)) {
            canvas.line(from, to, TEXT, 1.0);
        }
    }
    let corners = [
        (frame.left, frame.top),
        (frame.right(), frame.top),
        (frame.right(), frame.bottom()),
        (frame.left, frame.bottom()),
    ];
    canvas.path(&[&corners[..], &corners[..1]].concat(), AXIS, 1.0);
    let title = Rich::plain(&view.title);
    canvas.text(&title, (frame.left, frame.top - 12.0), LABEL_SIZE, TEXT, Align::Left);
    let ticks = [(frame.width / 80.0) as usize, (frame.height / 40.0) as usize].map(|n| n.clamp(2, 9));
    axes(canvas, frame, [&view.x_label, &view.y_label], ticks);
    if let Some((direction, name)) = &view.flow {
        arrow(canvas, frame, *direction, name);
    }
}

/// An arrow on a plate in the upper left corner.
fn arrow(canvas: &mut Canvas, frame: &Panel, direction: [f64; 2], name: &str) {
    // On the page an axis may fall, and ordinates go down.
    let (x, y) = (direction[0] * frame.x.width().signum(), -direction[1] * frame.y.width().signum());
    let size = x.hypot(y);
    if !(size.is_finite() && size > 0.0) {
        return;
    }
    let (x, y) = (x / size, y / size);
    let half = 0.5 * ARROW;
    let (plate, name) = (ARROW + 14.0, Rich::plain(name));
    let wide = plate + crate::canvas::text_width(&name, LABEL_SIZE) + 8.0;
    let corner = (frame.left + 6.0, frame.top + 6.0);
    canvas.rectangle(corner, (corner.0 + wide, corner.1 + plate), WHITE.faint(0.85));
    let middle = (corner.0 + 0.5 * plate, corner.1 + 0.5 * plate);
    let at = |along: f64, across: f64| (middle.0 + along * x - across * y, middle.1 + along * y + across * x);
    canvas.line(at(-half, 0.0), at(half - 6.0, 0.0), TEXT, 1.8);
    canvas.area(&[at(half, 0.0), at(half - 11.0, 4.5), at(half - 11.0, -4.5)], TEXT);
    canvas.text(&name, (corner.0 + plate, middle.1), LABEL_SIZE, TEXT, Align::Left);
}

fn is_within((x, y): Xy, frame: &Panel) -> bool {
    (frame.left..=frame.right()).contains(&x) && (frame.top..=frame.bottom()).contains(&y)
}

/// A polygon in its frame, cut at the edges; `None` where nothing of it is seen.
fn place(polygon: &Polygon, frame: &Panel) -> Option<Placed> {
    let places = polygon.corners.iter().map(|[x, y]| (frame.at_x(*x), frame.at_y(*y))).collect();
    let places = cut(places, frame);
    let pairs = places.iter().zip(places.iter().cycle().skip(1));
    let area = 0.5 * pairs.map(|(a, b)| a.0 * b.1 - b.0 * a.1).sum::<f64>().abs();
    (area > UNSEEN && polygon.value.is_finite()).then_some(Placed { places, area, value: polygon.value })
}

/// What of a convex polygon is within a frame (Sutherland and Hodgman 1974).
fn cut(places: Vec<Xy>, frame: &Panel) -> Vec<Xy> {
    // How far within each edge a place is.
    let edges: [&dyn Fn(Xy) -> f64; 4] =
        [&|at| at.0 - frame.left, &|at| frame.right() - at.0, &|at| at.1 - frame.top, &|at| frame.bottom() - at.1];
    edges.iter().fold(places, |places, within| {
        let mut kept = Vec::with_capacity(places.len() + 1);
        for (a, b) in places.iter().zip(places.iter().cycle().skip(1)) {
            let (of_a, of_b) = (within(*a), within(*b));
            if of_a >= 0.0 {
                kept.push(*a);
            }
            if (of_a >= 0.0) != (of_b >= 0.0) {
                let part = of_a / (of_a - of_b);
                kept.push((a.0 + part * (b.0 - a.0), a.1 + part * (b.1 - a.1)));
            }
        }
        kept
    })
}

/// Colour of a place from 0 to 1.
fn viridis(t: f64) -> Ink {
    let place = t.clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f64;
    let low = (place as usize).min(VIRIDIS.len() - 2);
    let (part, [a, b]) = (place - low as f64, [VIRIDIS[low], VIRIDIS[low + 1]]);
    let mix = |shift: u32| {
        let of = |hex: u32| f64::from((hex >> shift) & 0xff);
        ((of(a) + (of(b) - of(a)) * part).round() as u32) << shift
    };
    Ink::new(mix(16) | mix(8) | mix(0))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A chequered square of n × n cells, of which the last column lies outside of the view and the one before half.
    fn field(n: usize) -> Field {
        let side = 1.0 / n as f64;
        let cell = |k: usize| {
            let (x, y) = ((k % n) as f64 * side, (k / n) as f64 * side);
            Polygon { corners: vec![[x, y], [x + side, y], [x + side, y + side], [x, y + side]], value: x + y }
        };
        let view = View {
            title: "from below".to_owned(),
            x_label: "x [m]".to_owned(),
            y_label: "y [m]".to_owned(),
            x: [0.0, 1.0 - 1.5 * side],
            y: [0.0, 1.0],
            polygons: (0..n * n).map(cell).collect(),
            lines: vec![[[0.1, 0.1], [0.2, 0.2]], [[0.1, 0.1], [7.0, 0.2]]],
            flow: Some(([-1.0, 0.0], "U".to_owned())),
        };
        Field {
            name: "wake".to_owned(),
            title: "Wake".to_owned(),
            caption: "Speeds.".to_owned(),
            value_label: "|U|/U∞ [-]".to_owned(),
            views: vec![view],
        }
    }

    fn polygons(svg: &str) -> usize {
        svg.lines().filter(|line| line.starts_with("<path")).map(|line| line.matches('z').count()).sum()
    }

    #[test]
    fn a_field_has_its_polygons_within_the_view_its_labels_and_its_bar() {
        let drawn = svg(&field(10));
        assert_eq!(polygons(&drawn), 90);
        for text in ["x [m]", "y [m]", "from below", "|U|/U∞ [-]", "U", "1.0"] {
            assert!(drawn.lines().any(|line| line.trim() == text), "{text} is missing");
        }
        assert_eq!(drawn.matches("<rect").count(), SHADES + 1);
        assert!(drawn.ends_with("</svg>\n") && drawn.matches("<g ").count() == drawn.matches("</g>").count());
        assert_eq!(caption(&field(10)), "Speeds.");
    }

    #[test]
    fn of_too_many_the_smallest_are_left_out_and_counted() {
        let n = 120;
        let drawn = svg(&field(n));
        assert_eq!(polygons(&drawn), MOST);
        let left_out = count(n * (n - 1) - MOST);
        assert_eq!(caption(&field(n)), format!("Speeds. The {left_out} smallest polygons are not drawn."));
    }

    /// CIE 1976 lightness rises evenly from dark to light: what makes a map of colours fair.
    #[test]
    fn the_lightness_of_colours_rises_evenly() {
        let lightness = |t: f64| {
            let (r, g, b) = viridis(t).rgb;
            let linear = |c: u8| {
                let c = f64::from(c) / 255.0;
                if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
            };
            let y = 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
            if y > 0.008856 { 116.0 * y.cbrt() - 16.0 } else { 903.3 * y }
        };
        let (dark, light) = (lightness(0.0), lightness(1.0));
        assert!(dark < 20.0 && light > 88.0, "{dark} {light}");
        for step in 0..=50 {
            let t = f64::from(step) / 50.0;
            let even = dark + t * (light - dark);
            assert!((lightness(t) - even).abs() < 3.0, "{t}: {} {even}", lightness(t));
        }
    }

    proptest! {
        #[test]
        fn no_numbers_bring_the_drawing_down(numbers in proptest::collection::vec(any::<f64>(), 12)) {
            let [a, b, c, d, e, f, g, h, i, j, k, l] = numbers[..] else { return Ok(()) };
            let view = View {
                x: [a, b],
                y: [c, d],
                polygons: vec![Polygon { corners: vec![[e, f], [g, h], [i, j]], value: k }],
                lines: vec![[[e, f], [k, l]]],
                flow: Some(([l, a], String::new())),
                ..View::default()
            };
            let drawn = svg(&Field { views: vec![view], ..Field::default() });
            prop_assert!(!drawn.contains("NaN") && !drawn.contains("inf"));
            prop_assert!(svg(&Field::default()).ends_with("</svg>\n"));
        }
    }
}
