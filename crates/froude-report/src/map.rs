//! A map of one quantity over two: a cell for each pair, coloured from dark to light, with a bar that says what a colour is.
//!
//! Cells without a number are hatched, so that "no answer" is not mistaken for a small one. The colours run from dark blue to ochre with rising lightness, and are told apart without red and green, and in grey.

use froude_records::page::Map;

use crate::canvas::{Align, Canvas, Ink, WHITE};
use crate::chart::on;
use crate::error::ReportError;
use crate::filled::{BAR, GAP, OVER, RIGHT, axes, bar};
use crate::plot::{Panel, RULE, Span, TEXT, TICK_SIZE, WIDTH, ramp};
use crate::symbol::Rich;

/// Most cells along an axis that are drawn; of more, evenly chosen ones.
const MOST: usize = 120;
const LEFT: f64 = 74.0;
const TOP: f64 = 14.0;
const HEIGHT: f64 = 380.0;
/// Between the lines of a hatched cell.
const HATCH: f64 = 7.0;
const HATCHED: Ink = Ink::new(0xb4_bc_c2);

/// The map as SVG.
///
/// # Errors
///
/// [`ReportError::Figure`] when the numbers are not those of its axes.
pub fn svg(map: &Map) -> Result<String, ReportError> {
    if map.values.len() != map.x.len() * map.y.len() {
        let (n, x, y) = (map.values.len(), map.x.len(), map.y.len());
        let reason = format!("{n} numbers for {x} × {y} cells");
        return Err(ReportError::Figure { figure: map.title.clone(), reason });
    }
    Ok(canvas(map).svg(&crate::figures::drawing::slug(&map.name), &map.title, &map.caption))
}

pub(crate) fn canvas(map: &Map) -> Canvas {
    let mut canvas = Canvas::new(WIDTH, TOP + HEIGHT + 52.0);
    let (x, y) = (chosen(map.x.len()), chosen(map.y.len()));
    let edges = |of: &[f64], which: &[usize]| edges(&which.iter().map(|i| of[*i]).collect::<Vec<_>>());
    let (x_edges, y_edges) = (edges(&map.x, &x), edges(&map.y, &y));
    let all = |edges: &[f64]| Span::of(edges.iter().copied()).unwrap_or(Span { low: 0.0, high: 1.0 });
    let frame = Panel {
        left: LEFT,
        top: TOP,
        width: WIDTH - LEFT - GAP - BAR - RIGHT,
        height: HEIGHT,
        x: all(&x_edges),
        y: all(&y_edges),
    };
    let value = |v: f64| on(map.value_scale, v);
    let shown = Span::of(map.values.iter().map(|v| value(*v)).filter(|v| v.is_finite()));
    let range = shown.unwrap_or(Span { low: 0.0, high: 1.0 });
    for (row, j) in y.iter().enumerate() {
        for (column, i) in x.iter().enumerate() {
            // What is drawn later covers what lies over.
            let corner = (frame.at_x(x_edges[column]), frame.at_y(y_edges[row + 1]) - OVER);
            let other = (frame.at_x(x_edges[column + 1]) + OVER, frame.at_y(y_edges[row]));
            let shown = value(map.values[j * map.x.len() + i]);
            if shown.is_finite() {
                canvas.rectangle(corner, other, ramp((shown - range.low) / range.width()));
            } else {
                hatched(&mut canvas, corner, other);
            }
        }
    }
    mark(map, &mut canvas, &frame);
    axes(&mut canvas, &frame, [&map.x_label, &map.y_label], [8, 6]);
    let place = Panel { left: frame.right() + GAP, width: BAR, x: Span { low: 0.0, high: 1.0 }, y: range, ..frame };
    bar(&mut canvas, &place, map.value_scale, &map.value_label, WIDTH - 14.0, ramp);
    canvas
}

fn mark(map: &Map, canvas: &mut Canvas, frame: &Panel) {
    let Some((column, row, name)) = &map.best else { return };
    let (Some(x), Some(y)) = (map.x.get(*column), map.y.get(*row)) else { return };
    let at = (frame.at_x(*x), frame.at_y(*y));
    canvas.dot(at, 5.5, TEXT);
    canvas.speck(at, 2.0, WHITE);
    // On the side where there is room, on a plate of its own.
    let is_left = at.0 > frame.left + 0.5 * frame.width;
    let text = Rich::plain(name);
    let long = crate::canvas::text_width(&text, TICK_SIZE) * 1.1 + 8.0;
    let from = if is_left { at.0 - 12.0 - long } else { at.0 + 12.0 };
    canvas.rectangle((from, at.1 - 10.0), (from + long, at.1 + 10.0), WHITE.faint(0.85));
    canvas.text(&text, (from + 4.0, at.1), TICK_SIZE, TEXT, Align::Left);
}

/// Which of n are drawn.
fn chosen(n: usize) -> Vec<usize> {
    if n <= MOST {
        return (0..n).collect();
    }
    (0..MOST).map(|k| k * (n - 1) / (MOST - 1)).collect()
}

/// Where the cells of these numbers end: halfway to their neighbours.
fn edges(at: &[f64]) -> Vec<f64> {
    let Some((first, last)) = at.first().zip(at.last()) else { return vec![0.0] };
    if at.len() == 1 {
        let half = if *first == 0.0 { 0.5 } else { 0.5 * first.abs() };
        return vec![first - half, first + half];
    }
    let mut out: Vec<f64> = at.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
    out.insert(0, 2.0 * first - out[0]);
    out.push(2.0 * last - out[out.len() - 1]);
    out
}

fn hatched(canvas: &mut Canvas, (x0, y0): (f64, f64), (x1, y1): (f64, f64)) {
    canvas.rectangle((x0, y0), (x1, y1), RULE.faint(0.5));
    // Lines x + y = s, on one grid for all cells, so that those of neighbours meet.
    let mut s = ((x0 + y0) / HATCH).ceil() * HATCH;
    while s < x1 + y1 {
        let from = (x0.max(s - y1), s - x0.max(s - y1));
        let to = (x1.min(s - y0), s - x1.min(s - y0));
        canvas.line(from, to, HATCHED, 1.0);
        s += HATCH;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filled::SHADES;
    use froude_records::page::Scale;

    fn map() -> Map {
        Map {
            name: "speed".to_owned(),
            title: "Speed".to_owned(),
            x_label: "amplitude [deg]".to_owned(),
            y_label: "phase [deg]".to_owned(),
            value_label: "speed [m/s]".to_owned(),
            x: vec![10.0, 20.0, 30.0],
            y: vec![10.0, 20.0],
            values: vec![0.1, 0.2, 0.3, 0.2, f64::NAN, 0.1],
            best: Some((2, 0, "fastest".to_owned())),
            ..Map::default()
        }
    }

    #[test]
    fn a_map_has_a_cell_for_each_number_its_labels_and_its_mark() {
        let drawn = svg(&map()).unwrap();
        for text in ["amplitude [deg]", "phase [deg]", "speed [m/s]", "fastest"] {
            assert!(drawn.lines().any(|line| line.trim() == text), "{text} is missing");
        }
        // Five cells, one that is hatched, the plate, and the bar.
        assert_eq!(drawn.matches("<rect").count(), 6 + 1 + SHADES);
        assert!(!drawn.contains("NaN"));
    }

    /// Costs over five decades: what lies between is told apart, and none of nothing has a place.
    #[test]
    fn a_map_of_decades_has_their_colours() {
        let values = vec![0.1, 1.0, 10.0, 100.0, 1e4, 0.0];
        let drawn = svg(&Map { values, value_scale: Scale::Logarithmic, best: None, ..map() }).unwrap();
        assert_eq!(drawn.matches("<rect").count(), 6 + SHADES);
        for text in ["0.1", "1", "10", "100", "1000"] {
            assert!(drawn.lines().any(|line| line.trim() == text), "{text} is missing");
        }
    }

    #[test]
    fn numbers_of_other_axes_are_refused_and_none_at_all_is_no_panic() {
        let refused = svg(&Map { values: vec![1.0], ..map() }).unwrap_err();
        assert!(refused.to_string().contains("1 numbers for 3 × 2 cells"), "{refused}");
        assert!(svg(&Map { values: vec![f64::INFINITY; 6], best: Some((9, 9, String::new())), ..map() }).is_ok());
        assert!(svg(&Map::default()).is_ok());
    }

    #[test]
    fn a_large_map_is_drawn_by_some_of_its_cells() {
        let n = 1000;
        let x: Vec<f64> = (0..n).map(f64::from).collect();
        let drawn = svg(&Map { values: vec![1.0; 1_000_000], y: x.clone(), x, best: None, ..map() }).unwrap();
        assert_eq!(drawn.matches("<rect").count(), MOST * MOST + SHADES);
    }

    #[test]
    fn cells_end_halfway_to_their_neighbours() {
        assert_eq!(edges(&[10.0, 20.0, 40.0]), [5.0, 15.0, 30.0, 50.0]);
        assert_eq!(edges(&[4.0]), [2.0, 6.0]);
    }
}
